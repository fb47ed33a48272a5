"""Prints one record's way through all formulas of docs/specification.md, with every intermediate word.

    python3 sim/golden/explain.py out/vectors pixels:4711

STAGE:NUMBER is a record of splats, any stage of setup, packets, runs, pixels or tile (of which the last splat over the pixel is shown), or of a
stage of the other systems.
A line is a formula, its name, what it was given and what it gives; what a formula asks others for stands below it, further to the right.
"""

import inspect
import os
import sys

import arithmetic
import deep
import harmonics
import pixels
import points
import rows
import setup
import spheres
import surface
import systems
import tables
from vectors import Folder, print_of

FILES = {module.__file__ for module in (arithmetic, setup, rows, tables, pixels, harmonics, surface, deep, points, spheres)}
# What every formula uses says little by itself.
QUIET = ("1.1)", "1.2)", "1.6)")
# Records whose sums go on from those before them, and the field that they share.
SUMS = {"samples": 2, "gathers": 0}
SPLATS = ("splats", "camera", "projected", "columns", "covariance", "opacity")


def shown(value):
    """A word in decimal and hexadecimal; a number as mantissa and power of two."""
    if isinstance(value, bool) or value is None:
        return str(value)
    if isinstance(value, int):
        return str(value) if abs(value) < 10 else f"{value} (0x{value & ((1 << 64) - 1):x})"
    if isinstance(value, tuple) and len(value) == 2 and all(type(part) is int for part in value):
        return f"{value[0]} 2^{value[1]}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(shown(part) for part in value) + "]"
    return ""


class Trace:
    """Prints the calls of formulas while it is on."""

    def __init__(self):
        self.depth = 0

    def __enter__(self):
        sys.setprofile(self.event)

    def __exit__(self, *error):
        sys.setprofile(None)

    def event(self, frame, event, value):
        code = frame.f_code
        if event not in ("call", "return") or code.co_filename not in FILES or code.co_name.startswith("<"):
            return
        text = code.co_consts[0] if code.co_consts and isinstance(code.co_consts[0], str) else ""
        if not text.startswith("(") or text[1:].startswith(QUIET) or code.co_flags & inspect.CO_GENERATOR:
            return
        if event == "call":
            given = [frame.f_locals[name] for name in code.co_varnames[: code.co_argcount]]
            words = ", ".join(word for word in map(shown, given) if word)
            self.put(f"{text.split(')')[0][1:]:<5}{code.co_name}({words})")
            self.depth += 1
        else:
            self.depth -= 1
            if shown(value):
                self.put(f"   = {shown(value)}")

    def put(self, text):
        sys.setprofile(None)
        print("  " * self.depth + text)
        sys.setprofile(self.event)


class Way:
    """A folder, and the records that belong to one."""

    def __init__(self, folder):
        self.folder, self.widths = folder, folder.widths()
        self.rules, self.view = folder.rules(), folder.view()
        self.box = folder.traversal() == "box"

    def record(self, stage, number):
        """A record as the file has it, printed field by field."""
        for at, record in enumerate(self.folder.records(stage)):
            if at == number:
                words = [f"{n} {shown(v)}" for n, v in zip(self.folder.names(stage), record)]
                print(f"{stage} {number} in the file: " + ", ".join(words))
                return record
        sys.exit(f"{stage} has no record {number}")

    def find(self, stage, known):
        """The last record whose first fields are those."""
        place = None
        for at, record in enumerate(self.folder.records(stage)):
            if record[: len(known)] == list(known):
                place = at
        return place

    def splat(self, number):
        splat = self.folder.splats[number]
        self.record("splats", number)
        try:
            with Trace():
                setup.footprint(self.widths, self.view, self.rules, splat)
        except setup.Cull as cull:
            print(f"culled: {cull.args[0]}")

    def packet(self, number):
        print_ = print_of(self.folder.names("packets"), self.record("packets", number))
        self.splat(print_.splat)
        return print_

    def run(self, packet, y, x):
        """The row and the run that hold a pixel."""
        print_ = self.packet(packet)
        print(f"\nrow {y}")
        if self.box:
            with Trace():
                return next(run for run in rows.box_runs(self.widths, print_) if run[0] == y), print_
        constants = rows.Constants(self.widths, print_)
        walk = rows.span_rows(self.widths, print_, constants)
        for row in range(print_.first[1], y):
            if row == print_.first[1] or row == y - y % rows.BLOCK:
                with Trace():
                    next(walk)
            else:
                next(walk)
        with Trace():
            _, centre, vertical, first, end = next(walk)
            start = max(first, x - x % rows.BLOCK)
            rows.Constants(self.widths, print_)
            words = rows.seed(self.widths, print_, constants, start, centre, vertical)
        stop = min(start - start % rows.BLOCK + rows.BLOCK, end)
        return (y, start, stop - start, *words), print_

    def pixel(self, number):
        record = self.record("pixels", number)
        packet, y, x = record[:3]
        run, print_ = self.run(packet, y, x)
        print(f"\npixel {x} of the run from column {run[1]}")
        bits, fraction = (rows.BOX_LANE, rows.BOX) if self.box else (self.widths.lane, self.widths.radial)
        before = pixels.clear(self.widths)
        for at, other in enumerate(self.folder.records("pixels")):
            if at >= number:
                break
            if other[1:3] == [y, x]:
                before = other[5:]
        words = pixels.lane_words(run, bits)
        for _ in range(x - run[1]):
            next(words)
        with Trace():
            word = next(words)
            end = pixels.lane_end(self.widths, print_.cutoff)
            radial = pixels.radial_index(self.widths, word, fraction)
            blend = pixels.Blend(self.widths, self.rules)
            table = tables.Table.__new__(tables.Table)
        table.entries = [entry for entry, in self.folder.records("table")]
        table.rest = tables.rest_bits(self.widths, self.rules.table_range)
        table.kept = min(self.widths.interpolation, table.rest)
        print(f"lane word {shown(word)}, end {shown(end)}; pixel before: {shown(before)}")
        name = self.folder.manifest["compositing"].replace("-", "_")
        with Trace():
            kernel = tables.kernel_value(table, radial)
            alpha = pixels.opacity(self.widths, blend, print_.peak, kernel)
            if alpha and not before[4]:
                getattr(pixels, name)(self.widths, blend, before, alpha, print_.colour)
        print(f"pixel after: {shown(before)}")
        mine = [packet, y, x, radial, alpha, *before]
        print("equal to the file's record" if mine == record else f"the file differs: {shown(record)}")

    def system(self, stage, number):
        """A record of the other systems; of a sum that goes on, the last step is shown."""
        record, records, first = self.record(stage, number), list(self.folder.records(stage)), number
        while stage in SUMS and first > 0 and records[first - 1][SUMS[stage]] == record[SUMS[stage]]:
            first -= 1
        # A stage finds splats by a record's place.
        self.splats = self.folder.splats[first:]
        steps = systems.STAGES[stage](self, records[first : number + 1])
        for _ in range(first, number):
            next(steps)
        with Trace():
            mine = next(steps)
        print("equal to the file's record" if list(map(int, mine)) == record else f"the file differs: {shown(mine)}")

    def explain(self, stage, number):
        if stage in SPLATS:
            if stage != "splats":
                self.record(stage, number)
            self.splat(number)
        elif stage == "packets":
            self.packet(number)
        elif stage == "runs":
            packet, y, x = self.record("runs", number)[:3]
            print(f"\nrun by the formulas: {shown(self.run(packet, y, x)[0])}")
        elif stage == "pixels":
            self.pixel(number)
        elif stage == "tile":
            self.record("tile", number)
            y, x = divmod(number, self.view.viewport[0])
            places = [at for at, r in enumerate(self.folder.records("pixels")) if r[1:3] == [y, x]]
            if places:
                self.pixel(places[-1])
        elif stage in systems.STAGES and stage != "perspective":
            self.system(stage, number)
        else:
            known = [*SPLATS, "packets", "runs", "pixels", "tile", *(stage for stage in systems.STAGES if stage != "perspective")]
            sys.exit(f"'{stage}' has no way to explain: give a record of {', '.join(known)}")


def main(arguments):
    if len(arguments) != 2 or not arguments[1].partition(":")[2].isdigit():
        sys.exit(__doc__)
    stage, _, number = arguments[1].partition(":")
    try:
        Way(Folder(arguments[0])).explain(stage, int(number))
        sys.stdout.flush()
    except BrokenPipeError:
        # A reader that has gone away (`| head`) is no error; nowhere takes what Python flushes when it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (OSError, ValueError) as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(f"{type(error).__name__}: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
