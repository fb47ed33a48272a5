"""Recomputes every stage of exported vectors by the formulas of docs/specification.md and names the first difference of each.

    python3 sim/golden/check.py out/vectors [more folders ...]

Each stage is computed from the stage before it as exported, so that a difference is named where it arises.
"""

import sys
from itertools import zip_longest

import arithmetic
import pixels
import rows
import setup
import systems
import tables
from vectors import Folder

PACKET_VERSION = 3


class Difference(Exception):
    """The first record that differs."""


def equal(stage, number, expected, got, names):
    """Both records, field by field."""
    if expected == got:
        return
    for name, mine, theirs in zip(names, expected, got):
        if mine != theirs:
            raise Difference(f"{stage}, record {number}, {name}: formulas give {mine}, the file has {theirs}")
    raise Difference(f"{stage}, record {number}: {len(expected)} fields, the file has {len(got)}")


class Check:
    """One folder."""

    def __init__(self, folder):
        self.folder = folder
        self.widths, self.rules, self.view = folder.widths(), folder.rules(), folder.view()
        self.splats, self.prints = folder.splats, folder.prints
        self.drawn, self.words = [], 0

    def compare(self, stage, records):
        """Computed records against a stage's file."""
        names = self.folder.names(stage)
        for number, (mine, theirs) in enumerate(zip_longest(records, self.folder.records(stage))):
            if mine is None or theirs is None:
                more = "the file has" if mine is None else "formulas give"
                raise Difference(f"{stage}: {more} more than {number} records")
            equal(stage, number, mine, theirs, names)
            self.words += len(names)

    def constants(self):
        """The manifest's constants that formulas give."""
        blend, mine = pixels.Blend(self.widths, self.rules), self.folder.constants
        given = {
            "lane_alpha_max": blend.alpha_max,
            "lane_opacity_min": blend.opacity_min,
            "lane_minimum_transmittance": blend.minimum,
            "axis_bits": setup.axis_bits(self.widths),
            "ln_2": arithmetic.LN_2,
        }
        for name, value in given.items():
            if mine[name] != value:
                raise Difference(f"constant {name}: formulas give {value}, the manifest has {mine[name]}")

    def tables(self):
        """(1.10), (1.12), (1.16), (4.2), and the functions of numbers."""
        self.compare("reciprocals", ([entry] for entry in arithmetic.RECIPROCALS))
        self.compare("roots", ([entry] for entry in arithmetic.ROOTS))
        self.compare("logarithms", (list(entry) for entry in arithmetic.LOGARITHMS))
        self.compare("functions", (function_record(r) for r in self.folder.records("functions")))
        entries = tables.gaussian_table(self.widths, self.rules.table_range)
        self.compare("table", ([entry] for entry in entries))

    def setup(self):
        """Section 2 and (3.1), a splat after the other."""
        names = ("camera", "projected", "columns", "covariance", "opacity")
        fields = {name: self.folder.names(name) for name in (*names, "packets")}
        files = {name: self.folder.records(name) for name in names}
        box = self.folder.traversal() == "box"
        packets = {record[-1]: record for record in self.folder.records("packets")}
        self.drawn = []
        for number, splat in enumerate(self.splats):
            records, print = setup_records(self.widths, self.view, self.rules, splat)
            for name in names:
                equal(name, number, records[name], next(files[name], []), fields[name])
            mine = packet(number, print, box) if print else []
            equal("packets", number, mine, packets.pop(number, []), fields["packets"])
            if print:
                self.drawn.append(mine)
            self.words += sum(map(len, records.values())) + len(mine)

    def packets(self):
        """(3.2) The order of what `setup` left."""
        order = sorted(self.drawn, key=lambda record: record[-2])
        if self.folder.manifest["compositing"] == "back-to-front":
            order.reverse()
        numbers = [record[-1] for record in self.folder.records("packets")]
        if numbers != [record[-1] for record in order]:
            raise Difference("packets: formulas give another order")

    def runs(self):
        """Sections 5 and 6."""
        walk = rows.span_runs if self.folder.traversal() == "spans" else rows.box_runs
        self.compare(
            "runs",
            ([n, *run] for n, print in enumerate(self.prints) for run in walk(self.widths, print)),
        )

    def pixels(self):
        """Sections 7 and 8, and the picture."""
        picture = {}
        self.compare("pixels", self.blended(picture))
        columns, lines = self.view.viewport
        clear = pixels.clear(self.widths)
        self.compare("tile", (picture.get((x, y), clear) for y in range(lines) for x in range(columns)))

    def blended(self, picture):
        """Every pixel inside a footprint, in drawing order."""
        widths, blend = self.widths, pixels.Blend(self.widths, self.rules)
        table = tables.Table(widths, self.rules.table_range)
        box = self.folder.traversal() == "box"
        bits, fraction = (rows.BOX_LANE, rows.BOX) if box else (widths.lane, widths.radial)
        composite = {
            "front-to-back": pixels.front_to_back,
            "back-to-front": pixels.back_to_front,
            "x-ray": pixels.x_ray,
        }[self.folder.manifest["compositing"]]
        for number, y, x, *run in self.folder.records("runs"):
            print = self.prints[number]
            end = pixels.lane_end(widths, print.cutoff)
            for column, word in enumerate(pixels.lane_words((y, x, *run), bits), x):
                radial = pixels.radial_index(widths, word, fraction)
                if radial >= end:
                    continue
                pixel = picture.setdefault((column, y), pixels.clear(widths))
                alpha = pixels.opacity(widths, blend, print.peak, tables.kernel_value(table, radial))
                if alpha > 0 and not pixel[4]:
                    composite(widths, blend, pixel, alpha, print.colour)
                yield [number, y, column, radial, alpha, *pixel]

    def systems(self):
        """Section 9."""
        systems.systems(self, systems.STAGES)

    def run(self):
        """All stages; the first difference is raised."""
        picture = (self.tables, self.setup, self.packets, self.runs, self.pixels)
        for part in (self.constants, *([self.systems] if "colours" in self.folder.stages else picture)):
            part()


def flat(numbers):
    """Mantissas and exponents one after the other."""
    return [part for number in numbers for part in number]


def function_record(record):
    """(1.11), (1.15), (1.17) of the argument that a record begins with."""
    x = tuple(record[:2])
    results = [arithmetic.reciprocal(x, bits) or (0, 0) for bits in (16, 17, 31)]
    results += [arithmetic.square_root(x, bits) for bits in (16, 17, 31)]
    return [*flat([x, *results]), arithmetic.logarithm(x) or 0]


def setup_records(widths, view, rules, splat):
    """The records of one splat in the stages of setup, and its footprint unless it is culled."""
    point, exponent = setup.camera_point(widths, view, splat.centre)
    records = {"camera": [*point, exponent]}
    try:
        projected = setup.project(widths, view, rules, point, exponent)
    except setup.Cull as cull:
        records["projected"] = [cull.args[0]] + [0] * 11
        records.update({"columns": [0] * 12, "covariance": [0] * 8, "opacity": [0] * 2})
        return records, None
    z, centre, ratios, gains = projected
    m = setup.columns(widths, view, ratios, gains, splat.axes)
    variance = setup.covariance(widths, rules, m)
    print, culled = None, 0
    try:
        print = setup.shaped(widths, view, rules, splat, projected, m, variance)
    except setup.Cull as cull:
        culled = cull.args[0]
    records["projected"] = [culled, setup.sort_key(z), *centre, *flat(ratios + gains)]
    weight = splat.weight
    if rules.compensated:
        weight = setup.compensated(widths, weight, m, variance[3])
    peak = setup.peak_opacity(widths, rules, weight, ratios, gains, variance[3])
    records["columns"] = flat(n for column in m for n in column)
    records["covariance"] = flat(variance)
    records["opacity"] = list(peak)
    return records, print


def packet(number, print, is_box):
    """(3.1) The fields of a packet, and behind it the sort key and the splat's number."""
    key, centre, box, form, (mantissas, exponent), cutoff, peak, channels = print
    first, end = zip(*box)
    coefficients = [*mantissas, exponent] if is_box else flat(form)
    return [PACKET_VERSION, *centre, *first, *end, *coefficients, cutoff, peak, *channels, key, number]


def main(folders):
    for path in folders:
        check = Check(Folder(path))
        try:
            check.run()
        except Difference as difference:
            sys.exit(f"{path}: {difference}")
        counts = ", ".join(f"{name} {stage['records']}" for name, stage in check.folder.stages.items())
        print(f"{path}: {check.words} words equal ({counts})")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
