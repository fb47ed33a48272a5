"""Transistors of one lane's arithmetic, unit by unit as Yosys synthesises it."""

import subprocess
from functools import cache
from pathlib import Path

UNITS = Path(__file__).with_name("lane_units.sv")


@cache
def transistors(unit, **parameters):
    """Of a unit alone."""
    settings = " ".join(f"-set {name} {value}" for name, value in parameters.items())
    script = f"read_verilog -sv {UNITS}; chparam {settings} {unit}; synth -flatten -top {unit}; abc -g cmos; stat -tech cmos"
    text = subprocess.run(["yosys", "-p", script], capture_output=True, text=True, check=True).stdout
    return int(text.rsplit("Estimated number of transistors:", 1)[1].split()[0])


def fixed_lane(w):
    """Radial index by two differences; interpolation, opacity, share; colours and their sums, what is left of the light."""
    products = [(w["weight"] - 2, w["interpolation"]), (w["peak"] + 4, w["weight"]), (w["transmittance"] + 1, w["alpha"])]
    products += 3 * [(w["transmittance"] + 1, w["colour"] + 4)]
    sums = 2 * [32] + [w["weight"] + 1, w["transmittance"] + 1] + 3 * [w["accumulator"] + 4]
    return sum(transistors("fixed_multiply", A=a, B=b) for a, b in products if b > 0) + sum(transistors("fixed_add", A=a) for a in sums)


FORMATS = {"fp32": (8, 23), "fp16": (5, 10), "bfloat16": (8, 7), "e4m3": (4, 3), "e5m2": (5, 2)}


def float_lane(raster, kernel, blend):
    total = 0
    for form, products, sums in ((raster, 2, 3), (kernel, 1, 0), (blend, 5, 4)):
        E, F = FORMATS[form]
        total += products * transistors("float_multiply", E=E, F=F) + sums * transistors("float_add", E=E, F=F)
    return total
