"""Holds the circuit `splat_primitive` against the kernel, handshake by handshake: `python sim/python/examples/primitive/run.py`.

Needs yosys and Icarus Verilog, and `pip install splatline[verification]`. What is simulated is the primitive behind the buses of a board
(sim/rtl/shell), as plain Verilog: Icarus Verilog 11 does not read packages of types that are named through them.
"""

import subprocess
import sys
from pathlib import Path

from cocotb_tools.runner import get_runner

HERE = Path(__file__).resolve().parent
RTL = HERE.parents[2] / "rtl"
BUILD = HERE.parents[3] / "target" / "primitive_bench"
DESIGN = "standard24"


def verilog() -> Path:
    BUILD.mkdir(parents=True, exist_ok=True)
    out = BUILD / "splat_axi.v"
    units = (RTL / "files.txt").read_text().split()
    read = f"read_verilog -sv {DESIGN}/splatline_pkg.sv {' '.join(units)} shell/splat_axi.sv"
    script = f"{read}; hierarchy -top splat_axi; proc; opt_clean; write_verilog -noattr {out}"
    subprocess.run(["yosys", "-q", "-p", script], check=True, cwd=RTL)
    return out


def main():
    runner = get_runner("icarus")
    runner.build(sources=[verilog()], hdl_toplevel="splat_axi", build_dir=BUILD, timescale=("1ns", "1ps"), always=True)
    results = runner.test(hdl_toplevel="splat_axi", test_module="bench", build_dir=BUILD, test_dir=HERE, results_xml=str(BUILD / "results.xml"))
    if "<failure" in Path(results).read_text():
        sys.exit("the bench failed: see above")


if __name__ == "__main__":
    main()
