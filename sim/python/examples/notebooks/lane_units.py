"""Transistors of one lane's arithmetic, unit by unit as Yosys synthesises it."""

import json
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


FAMILIES = {"xilinx7": "synth_xilinx -family xc7 -noiopad -noclkbuf -flatten", "ecp5": "synth_ecp5 -abc9", "ice40": "synth_ice40 -dsp"}
CELLS = {"CCU2C": ("luts", 2), "SB_LUT4": ("luts", 1), "SB_MAC16": ("dsps", 1), "MULT18X18D": ("dsps", 1), "DSP48E1": ("dsps", 1)}


def fabric(unit, command, **parameters):
    """Look-up tables and multipliers of a unit alone, counted as `rtl -- area` of sim/rtl/cosim counts them."""
    settings = " ".join(f"-set {name} {value}" for name, value in parameters.items())
    script = f"read_verilog -sv {UNITS}; chparam {settings} {unit}; {command} -top {unit}; tee -o /dev/stdout stat -json"
    text = subprocess.run(["yosys", "-q", "-p", script], capture_output=True, text=True, check=True).stdout
    cells = json.loads(text[text.index("{") :])["design"]["num_cells_by_type"]
    found = {"luts": 0, "dsps": 0}
    for kind, number in cells.items():
        what, each = CELLS.get(kind, ("luts" if kind.startswith("LUT") else None, 1))
        if what:
            found[what] += each * number
    return found


if __name__ == "__main__":  # Prints sim/machine/src/area/lane_units.csv.
    print("unit,format,transistors,family,luts,flip_flops,dsps,memory_kbit")
    floats = {name: {"E": e, "F": f} for name, (e, f) in FORMATS.items()}
    products = {f"{a}x{b}": {"A": a, "B": b} for a, b in ((6, 6), (6, 9), (8, 8), (12, 12), (16, 16), (18, 26))}
    sums = {str(a): {"A": a} for a in (8, 16, 32)}
    for unit, sizes in {"float_multiply": floats, "float_add": floats, "fixed_multiply": products, "fixed_add": sums}.items():
        for size, parameters in sizes.items():
            count = transistors(unit, **parameters)
            for family, command in FAMILIES.items():
                found = fabric(unit, command, **parameters)
                print(f"{unit},{size},{count},{family},{found['luts']},0,{found['dsps']},0", flush=True)
