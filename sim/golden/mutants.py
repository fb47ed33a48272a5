"""Which mistakes would exported vectors notice?

    python3 sim/golden/mutants.py out/vectors [more folders ...] [--jobs N] [--module NAME]

Every formula is changed in every small way: constants by one, another rounding, another comparison, another sign. A mutant is noticed if the
check of a folder fails. One that survives needs a proof in `equivalent.txt`, beside this file, that it changes no bit; otherwise vectors lack
a case.
"""

import argparse
import ast
import copy
import importlib
import os
import signal
import sys
from pathlib import Path
from types import ModuleType

HERE = Path(__file__).parent
PARTS = {
    "arithmetic": ("constants", "tables", "setup", "packets", "runs", "pixels"),
    "setup": ("constants", "setup", "packets"),
    "tables": ("tables", "pixels"),
    "rows": ("runs",),
    "pixels": ("constants", "pixels"),
}
ROUNDINGS = {
    "nearest": ("floored",),
    "floored": ("nearest",),
    "even": ("nearest",),
    "normalised": ("normalised_down",),
}
COMPARISONS = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
SIGNS = {ast.Add: ast.Sub, ast.Sub: ast.Add}
SECONDS = 120


def normalised_down(value, exponent, bits):
    """(1.5) with the magnitude cut instead of rounded."""
    if value == 0:
        return 0, -(1 << 20)
    drop = abs(value).bit_length() - bits
    magnitude = abs(value) << -drop if drop <= 0 else abs(value) >> drop
    return (magnitude if value > 0 else -magnitude), exponent + drop


def changes(node):
    """What a node can be changed into, with a name for each."""
    if isinstance(node, ast.Constant) and type(node.value) is int:
        for by in (1, -1):
            yield ast.Constant(node.value + by), f"{node.value} -> {node.value + by}"
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        for other in ROUNDINGS.get(node.func.id, ()):
            changed = copy.deepcopy(node)
            changed.func.id = other
            yield changed, f"{node.func.id} -> {other}"
    if isinstance(node, ast.Compare):
        for place, operator in enumerate(node.ops):
            if type(operator) in COMPARISONS:
                changed = copy.deepcopy(node)
                changed.ops[place] = COMPARISONS[type(operator)]()
                yield changed, "< <= > >="
    if isinstance(node, ast.BinOp) and type(node.op) in SIGNS:
        changed = copy.deepcopy(node)
        changed.op = SIGNS[type(node.op)]()
        yield changed, "+ -"


class Changer(ast.NodeTransformer):
    """Visits every node that is arithmetic; replaces the one whose turn it is."""

    def __init__(self, turn=None):
        self.turn, self.seen, self.names = turn, 0, []
        self.function = ""

    def visit_FunctionDef(self, node):
        self.function = node.name
        node.body = [node.body[0]] + [self.visit(part) for part in node.body[1:]]
        self.function = ""
        return node

    def visit_Subscript(self, node):
        # Indices name a part, not a quantity.
        node.value = self.visit(node.value)
        if not isinstance(node.slice, ast.Constant):
            node.slice = self.visit(node.slice)
        return node

    def generic_visit(self, node):
        for changed, name in changes(node):
            if self.turn == self.seen:
                self.seen += 1
                return changed
            self.seen += 1
            self.names.append(f"{self.function}:{ast.unparse(node)}:{name}")
        return super().generic_visit(node)


def tree_of(module):
    return ast.parse((HERE / f"{module}.py").read_text())


def mutants(module):
    """Names of all mutants of a module; their places are their turns."""
    changer = Changer()
    changer.visit(tree_of(module))
    return changer.names


def is_noticed(module, turn, folders):
    """Runs the parts of the check that the module takes part in."""
    tree = ast.fix_missing_locations(Changer(turn).visit(tree_of(module)))
    for name in (*PARTS, "check"):
        sys.modules.pop(name, None)
    try:
        changed = ModuleType(module)
        sys.modules[module] = changed
        if module != "arithmetic":
            importlib.import_module("arithmetic").normalised_down = normalised_down
        names = vars(changed)
        names.update(normalised_down=normalised_down)
        exec(compile(tree, module, "exec"), names)
        if module != "arithmetic":
            arithmetic = sys.modules["arithmetic"]
            names.update({n: getattr(arithmetic, n) for n in ("floored", "nearest")})
        check = importlib.import_module("check")
        for folder in folders:
            one = check.Check(folder)
            for part in PARTS[module]:
                getattr(one, part)()
    except Exception:
        return True
    return False


def start(module, turn, folders):
    """A process of its own for each mutant: some never end."""
    child = os.fork()
    if child == 0:
        signal.alarm(SECONDS)
        sys.stderr = open(os.devnull, "w")
        os._exit(1 if is_noticed(module, turn, folders) else 0)
    return child


def judged(todo, folders, jobs):
    """Yields every mutant with whether it was noticed; what runs out of time was."""
    running = {}
    while todo or running:
        while todo and len(running) < jobs:
            mutant = todo.pop()
            running[start(*mutant[:2], folders)] = mutant
        child, status = os.wait()
        yield running.pop(child), status != 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--module", action="append", choices=PARTS)
    arguments = parser.parse_args()
    from vectors import Folder

    folders = [Folder(path).keep() for path in arguments.folders]
    lines = (HERE / "equivalent.txt").read_text().splitlines()
    proofs = dict(line.split("  # ") for line in lines if line and not line.startswith("#"))
    todo = []
    for module in arguments.module or PARTS:
        todo += [(module, turn, f"{module}.{name}") for turn, name in enumerate(mutants(module))]
    count, noticed, proved, alive = len(todo), 0, 0, []
    for (_, _, name), dead in judged(todo[::-1], folders, arguments.jobs):
        if dead:
            noticed += 1
        elif name in proofs:
            proved += 1
        else:
            alive.append(name)
            print("survived:", name, flush=True)
    print(f"{count} mutants: {noticed} noticed, {proved} change nothing by proof, {len(alive)} survived")
    sys.exit(bool(alive))


if __name__ == "__main__":
    main()
