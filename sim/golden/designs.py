"""Exports vectors of many designs by the command `splatline` and checks them all.

    python3 sim/golden/designs.py target/release/splatline [--random N] [--seed S] [--large]

The named designs under both traversals, both rules and all operators; every width at its smallest and at its largest; N random designs;
with --large 10^5 splats and 10^6 pixels of each named design as well.
"""

import argparse
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
CHOICES = {
    "--traversal": ("spans", "box"),
    "--rules": ("3dgs", "ewa"),
    "--compositing": ("front-to-back", "back-to-front", "x-ray"),
}


def named(design):
    """All choices for a named design, one changed at a time from the first."""
    yield [design, "--splats", "144"]
    for option, values in CHOICES.items():
        for value in values:
            yield [design, "--splats", "72", "--size", "64x48", option, value]


def extremes():
    """Each width at its ends, beside those of standard24, and all together."""
    for name, ends in RANGES.items():
        for end in ends:
            yield {name: end}
    for side in range(2):
        widths = {name: ends[side] for name, ends in RANGES.items()}
        yield {**widths, "table": min(widths["table"], widths["radial"] + 2)}


def drawn(source):
    """A design of random widths and rounding."""
    widths = {name: source.randint(*ends) for name, ends in RANGES.items()}
    widths["table"] = min(widths["table"], widths["radial"] + 2)
    return {**widths, "rounding": source.choice(("nearest", "truncate"))}


def text(design):
    """A design as a file of the command."""
    lines = ['base = "standard24"']
    for name, value in design.items():
        lines.append(f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value}")
    return "\n".join(lines) + "\n"


def subjects(arguments, folder):
    """What is exported: the design and the other options."""
    for name in NAMED:
        yield from named(name)
        if arguments.large:
            yield [name, "--splats", "100000", "--size", "4x3", "--seed", "3"]
            yield [name, "--splats", "1600", "--size", "96x64", "--seed", "3"]
    source = random.Random(arguments.seed)
    designs = list(extremes()) + [drawn(source) for _ in range(arguments.random)]
    for number, design in enumerate(designs):
        file = folder / f"design{number}.toml"
        file.write_text(text(design))
        traversal = source.choice(CHOICES["--traversal"])
        rules = source.choice(CHOICES["--rules"])
        yield [str(file), "--splats", "72", "--size", "64x48", "--traversal", traversal, "--rules", rules]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("splatline")
    parser.add_argument("--random", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--large", action="store_true")
    arguments = parser.parse_args()
    words, count = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for design, *options in subjects(arguments, Path(folder)):
            out = Path(folder) / "vectors"
            command = [arguments.splatline, "vectors", "export", str(out), "--design", design, *options]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            check = Check(Folder(out))
            try:
                check.run()
            except Difference as difference:
                content = Path(design).read_text() if design.endswith(".toml") else ""
                sys.exit(f"{' '.join(command[2:])}: {difference}\n{content}")
            words, count = words + check.words, count + 1
    print(f"{count} exports, {words} words equal")


if __name__ == "__main__":
    main()
