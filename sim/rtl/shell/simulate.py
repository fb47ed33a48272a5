"""Runs a shell's bench on its circuit as Icarus Verilog has compiled it; fails if a test fails, or none ran.

    simulate.py TOP     in the folder in which FuseSoC's targets `sim` and `machine_sim` have built it

Edalize 0.6.8's own `cocotb_module` does not start cocotb 2.1, and goes by the simulator's exit code, which is 0
whatever the tests found.
"""

import shutil
import sys
from pathlib import Path

from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner


def simulate(folder, top):
    """The bench of sim.vvp in this folder."""
    place = {"build_dir": folder, "test_dir": folder, "hdl_toplevel_lang": "verilog"}
    results = get_runner("icarus").test(hdl_toplevel=top, test_module=f"test_{top}", **place)
    tests, failures = get_results(results)
    if failures or not tests:
        raise SystemExit(f"the bench of {top} in {folder}: {failures} of {tests} tests failed")


if __name__ == "__main__":
    # Edalize names what it has built after the core, as the list of its sources.
    shutil.copy(next(Path().glob("*.scr")).stem, "sim.vvp")
    simulate(Path().resolve(), sys.argv[1])
