"""Which mistakes would exported vectors notice?

    python3 sim/golden/mutants.py target/release/splatline [--jobs N] [--module NAME] [--formula MODULE.NAME]

Exports the named designs as the command does by default, and the other subjects of `designs.py`.

Every formula is changed in every small way: constants by one, another rounding, another comparison, another sign. A mutant is noticed if the
check of a folder fails. One that survives needs a proof in `equivalent.txt`, beside this file, that it changes no bit; otherwise vectors lack
a case.
"""

import argparse
import ast
import copy
import gc
import importlib
import os
import resource
import sys
import tempfile
from pathlib import Path
from types import CodeType, FunctionType, ModuleType

HERE = Path(__file__).parent
PICTURE = {
    "arithmetic": ("constants", "tables", "setup", "packets", "runs", "pixels"),
    "setup": ("constants", "setup", "packets"),
    "tables": ("tables", "pixels"),
    "rows": ("runs",),
    "pixels": ("constants", "pixels"),
}
# Stages of the other systems.
SYSTEMS = {
    "harmonics": ("colours",),
    "surface": ("surfaces", "samples"),
    "deep": ("octaves", "deep"),
    "points": ("points", "gathers", "sheets"),
    "spheres": ("spheres", "perspective", "indices"),
}
PARTS = {**PICTURE, **SYSTEMS}
ROUNDINGS = {
    "nearest": ("floored",),
    "floored": ("nearest",),
    "even": ("nearest",),
    "normalised": ("normalised_down",),
}
COMPARISONS = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
SIGNS = {ast.Add: ast.Sub, ast.Sub: ast.Add}
# Of the processor, a mutant each: several times what all the checks take.
SECONDS = 20


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
        self.turn, self.seen, self.names, self.counts = turn, 0, [], {}
        self.function = self.changed = ""

    def visit_FunctionDef(self, node):
        outer, self.function = self.function, self.function or node.name
        node.body = [self.visit(part) for part in node.body]
        self.function = outer
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
                self.changed = self.function
                return changed
            self.seen += 1
            name = f"{self.function}:{ast.unparse(node)}:{name}"
            again = self.counts[name] = self.counts.get(name, 0) + 1
            self.names.append(name if again == 1 else f"{name} ({again})")
        return super().generic_visit(node)


def tree_of(module):
    return ast.parse((HERE / f"{module}.py").read_text())


def mutants(module):
    """Names of all mutants of a module; their places are their turns."""
    changer = Changer()
    changer.visit(tree_of(module))
    return changer.names


def exported(splatline, modules):
    """The vectors that are to notice."""
    import designs
    from designs import TELLING, export
    from vectors import Folder

    subjects = [*TELLING] if {*PICTURE} & {*modules} else []
    subjects += designs.SYSTEMS if {*SYSTEMS} & {*modules} else []
    with tempfile.TemporaryDirectory() as place:
        for number, (design, *options) in enumerate(subjects):
            out = Path(place) / str(number)
            command = " ".join(export(splatline, out, design, options))
            size = sum(file.stat().st_size for file in out.iterdir())
            print(f"{command}: {size / 1e6:.1f} MB", flush=True)
            yield Folder(out).keep()


def callers():
    """The parts of a check that call each formula, as (module, function): by names, so rather too many than too few."""
    check = importlib.import_module("check")
    formulas, found = {}, {}
    for module in (*(importlib.import_module(name) for name in PICTURE), check):
        for name, value in vars(module).items():
            if getattr(value, "__module__", "") == module.__name__:
                for method in vars(value).values() if isinstance(value, type) else [value]:
                    if isinstance(method, FunctionType):
                        called = name if method.__name__ == "__init__" else method.__name__
                        formulas.setdefault(called, []).append((module.__name__, method))
    for part in PARTS["arithmetic"]:
        todo, seen = [getattr(check.Check, part).__code__], set()
        while todo:
            code = todo.pop()
            todo += [other for other in code.co_consts if isinstance(other, CodeType)]
            for name in {*code.co_names} - seen - {*PARTS}:
                seen.add(name)
                for module, formula in formulas.get(name, ()):
                    found.setdefault((module, formula.__name__), set()).add(part)
                    todo.append(formula.__code__)
        if part == "setup":
            # `packets` compares what `setup` computed.
            for parts in found.values():
                if part in parts:
                    parts.add("packets")
    return found


def is_noticed(module, turn, folders, called):
    """Runs the parts of the check that call the formula; all of the module's for what is made when it is loaded, and of systems."""
    changer = Changer(turn)
    tree = ast.fix_missing_locations(changer.visit(tree_of(module)))
    formula = (module, changer.changed)
    for name in (*PARTS, "check", "systems"):
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
            if ("colours" in folder.stages) != (module in SYSTEMS):
                continue
            one = check.Check(folder)
            if module in SYSTEMS:
                check.systems.systems(one, SYSTEMS[module])
                continue
            for part in PARTS["arithmetic"]:
                if part in called.get(formula, PARTS[module]):
                    getattr(one, part)()
    except Exception:
        return True
    return False


def start(module, turn, *subjects):
    """A process of its own for each mutant: some never end."""
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        sys.stderr = open(os.devnull, "w")
        os._exit(1 if is_noticed(module, turn, *subjects) else 0)
    return child


def judged(todo, jobs, *subjects):
    """Yields every mutant with whether it was noticed; what runs out of time was."""
    running = {}
    while todo or running:
        while todo and len(running) < jobs:
            mutant = todo.pop()
            running[start(*mutant[:2], *subjects)] = mutant
        child, status = os.wait()
        yield running.pop(child), status != 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("splatline")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--module", action="append", choices=PARTS)
    parser.add_argument("--formula", default="", help="only mutants whose name begins so: arithmetic.saturated")
    arguments = parser.parse_args()
    modules = arguments.module or PARTS
    folders, called = list(exported(arguments.splatline, modules)), callers()
    # Nobody writes to the vectors: so that processes share them.
    gc.disable()
    gc.freeze()
    lines = (HERE / "equivalent.txt").read_text().splitlines()
    proofs = dict(line.split("  # ") for line in lines if line and not line.startswith("#"))
    todo = []
    for module in modules:
        todo += [(module, turn, f"{module}.{name}") for turn, name in enumerate(mutants(module))]
    todo = [mutant for mutant in todo if mutant[2].startswith(arguments.formula)]
    count, noticed, proved, alive = len(todo), 0, 0, []
    every = {f"{module}.{name}" for module in PARTS for name in mutants(module)}
    for name in sorted(proofs.keys() - every):
        print(f"a proof of no mutant: {name}")
    for (_, _, name), dead in judged(todo[::-1], arguments.jobs, folders, called):
        if dead:
            noticed += 1
            if name in proofs:
                print(f"noticed, in spite of its proof: {name}", flush=True)
        elif name in proofs:
            proved += 1
        else:
            alive.append(name)
            print(f"survived, {noticed} noticed before: {name}", flush=True)
    print(f"{count} mutants: {noticed} noticed, {proved} change nothing by proof, {len(alive)} survived")
    sys.exit(bool(alive))


if __name__ == "__main__":
    main()
