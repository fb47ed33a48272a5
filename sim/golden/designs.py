"""Exports vectors of many designs by the command `splatline` and checks them all.

    python3 sim/golden/designs.py target/release/splatline [--random N] [--seed S] [--large]

The named designs under both traversals, both rules and all operators; other cameras and filters; every width at its smallest and at its
largest; N random designs; steps of the other systems for each of them. With --large 10^5 splats and a million pixels of each named design, each random design and each end of a width
instead: half an hour of one processor.
"""

import argparse
import gc
import random
import subprocess
import sys
import tempfile
from pathlib import Path

from check import Check, Difference
from vectors import Folder

NAMED = ("classic8", "micro16", "lean18", "standard24", "deep32")
RANGES = {
    "position": (8, 60),
    "view": (8, 31),
    "mantissa": (8, 31),
    "subpixel": (2, 24),
    "radial": (8, 44),
    "table": (2, 14),
    "interpolation": (0, 20),
    "weight": (4, 28),
    "peak": (4, 28),
    "alpha": (4, 28),
    "transmittance": (4, 30),
    "colour": (4, 28),
    "accumulator": (4, 27),
}
SMALL = ["--splats", "72", "--size", "64x48"]
# Stages of the other systems, by designs of which one rounds each way, through two cameras and by two rules.
SYSTEMS = (
    ["micro16", *SMALL, "--systems", "--rules", "ewa"],
    ["lean18", *SMALL, "--systems"],
    ["standard24", *SMALL, "--systems", "--orthographic"],
    ["classic8", *SMALL, "--systems"],
    ["deep32", *SMALL, "--systems", "--rules", "ewa", "--antialias", "none"],
    ["deep32", *SMALL, "--systems"],
    [{"colour": 28, "accumulator": 20, "rounding": "nearest-even"}, *SMALL, "--systems"],
)
LARGE = ["--splats", "100000", "--size", "9x6", "--seed", "3"]
# What only one design shows, for all to be noticed.
OTHERS = (
    ["lean18", *SMALL, "--traversal", "box", "--rules", "ewa"],
    ["lean18", *SMALL, "--compositing", "back-to-front"],
    ["lean18", *SMALL, "--compositing", "x-ray"],
    ["standard24", *SMALL, "--compositing", "x-ray"],
    ["lean18", *SMALL, "--orthographic"],
    ["standard24", *SMALL, "--orthographic"],
    ["lean18", "--splats", "200", "--size", "24x16", "--seed", "3", "--antialias", "mip"],
    ["lean18", *SMALL, "--antialias", "swan", "--rules", "ewa"],
    ["lean18", *SMALL, "--antialias", "swan"],
    ["standard24", *SMALL, "--antialias", "none", "--traversal", "box"],
    [{"interpolation": 19, "colour": 28, "rounding": "truncate"}, *SMALL],
    [{"transmittance": 4, "colour": 24, "accumulator": 27, "peak": 4, "weight": 4, "alpha": 8, "subpixel": 4}, *SMALL],
    [{"peak": 5, "weight": 4, "alpha": 8, "subpixel": 4, "rounding": "truncate"}, *SMALL, "--antialias", "none"],
    [{"transmittance": 9, "colour": 10, "accumulator": 18, "rounding": "nearest-even"}, *SMALL],
)
CHOICES = {
    "--traversal": ("spans", "box"),
    "--rules": ("3dgs", "ewa"),
    "--compositing": ("front-to-back", "back-to-front", "x-ray"),
}


def named(design):
    """All choices for a named design, one changed at a time from the first."""
    yield [design]
    for option, values in CHOICES.items():
        for value in values:
            yield [design, *SMALL, option, value]


def allowed(widths, rounding="nearest"):
    """At most what other widths and the rounding leave."""
    if rounding == "nearest-even":
        widths["accumulator"] = min(widths["accumulator"], 23)
    table = min(widths.get("table", 12), widths.get("radial", 27) + 2)
    return {**widths, "table": table, "rounding": rounding}


def extremes():
    """Each width at its ends, beside those of standard24, and all together."""
    for name, ends in RANGES.items():
        for end in ends:
            yield allowed({name: end})
    for side in range(2):
        yield allowed({name: ends[side] for name, ends in RANGES.items()})


def drawn(source):
    """A design of random widths and rounding."""
    widths = {name: source.randint(*ends) for name, ends in RANGES.items()}
    return allowed(widths, source.choice(("nearest", "nearest-even", "truncate")))


def text(design):
    """A design as a file of the command."""
    lines = ['base = "standard24"']
    for name, value in design.items():
        lines.append(f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value}")
    return "\n".join(lines) + "\n"


def subjects(arguments):
    """What is exported: the design and the other options."""
    source = random.Random(arguments.seed)
    widths = [*(drawn(source) for _ in range(arguments.random)), *extremes()]
    if arguments.large:
        yield from ([design, *LARGE] for design in [*NAMED, *widths])
        return
    for name in NAMED:
        yield from named(name)
    yield from (*OTHERS, *SYSTEMS)
    for design in widths:
        traversal = source.choice(CHOICES["--traversal"])
        rules = source.choice(CHOICES["--rules"])
        yield [design, *SMALL, "--traversal", traversal, "--rules", rules]
        yield [design, *SMALL, "--systems", "--rules", rules]


def export(splatline, out, design, options):
    """Writes the vectors of a design by its name or its widths; the options as one would type them."""
    if isinstance(design, dict):
        file, widths = Path(f"{out}.toml"), design
        file.write_text(text(widths))
        design = str(file)
    command = [splatline, "vectors", "export", str(out), "--design", design, *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return command[4:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("splatline")
    parser.add_argument("--random", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--large", action="store_true")
    arguments = parser.parse_args()
    words, count = 0, 0
    # Records are trees: looking for cycles among millions of them takes a tenth of the time.
    gc.disable()
    with tempfile.TemporaryDirectory() as folder:
        for design, *options in subjects(arguments):
            out = Path(folder) / "vectors"
            options = export(arguments.splatline, out, design, options)
            command = " ".join(options)
            check = Check(Folder(out))
            try:
                check.run()
            except Difference as difference:
                content = text(design) if isinstance(design, dict) else ""
                sys.exit(f"{command}: {difference}\n{content}")
            words, count = words + check.words, count + 1
            if arguments.large:
                stages = check.folder.stages
                counts = ", ".join(f"{stages[name]['records']} {name}" for name in ("splats", "pixels"))
                print(f"{command}: {counts}: {check.words} words equal", flush=True)
    print(f"{count} exports, {words} words equal")


if __name__ == "__main__":
    main()
