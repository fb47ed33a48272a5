"""Builds the shells and runs their cocotb benches on Icarus Verilog: the primitive's with a packet stream of 32 bits
and of 128, and the machine's.

    python3 sim/rtl/shell/run.py             both
    python3 sim/rtl/shell/run.py TILE ...    the primitive's alone, with these tiles
    python3 sim/rtl/shell/run.py machine     the machine's alone, which takes three minutes
    python3 sim/rtl/shell/run.py inputs      none: makes what they compare with, and prints for a shell where it is

Needs yosys, verilator, iverilog, a C compiler and cargo, and `pip install 'cocotb>=2' cocotbext-axi`. Icarus Verilog
11 does not read packages of types that are named through them, so Yosys writes the elaborated circuit as plain
Verilog first; what is simulated is that. All is built in target/shell.
"""

import os
import subprocess
import sys
from pathlib import Path

from cocotb_tools.runner import get_runner
from simulate import simulate

HERE = Path(__file__).resolve().parent
RTL = HERE.parent
ROOT = RTL.parent.parent
CAPI = ROOT / "sim" / "capi"
BUILD = ROOT / "target" / "shell"
DESIGN = "standard24"  # of sim/capi/cosim
STREAMS = (32, 128)
MACHINE = "lean18"


def run(*command, folder=ROOT):
    subprocess.run([str(word) for word in command], check=True, cwd=folder)


def kernel():
    """The example picture and the kernel behind the C interface, as a shared library."""
    run("cargo", "build", "-p", "splatline-capi")
    library = BUILD / "libkernel.so"
    svdpi = Path(subprocess.check_output(["verilator", "--getenv", "VERILATOR_ROOT"], text=True).strip()) / "include" / "vltstd"
    includes = [f"-I{folder}" for folder in (CAPI / "include", CAPI / "examples", CAPI / "cosim", svdpi)]
    sources = [CAPI / "examples" / "picture.c", CAPI / "cosim" / "tiles.c", CAPI / "cosim" / "dpi_model.c"]
    archive = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug" / "libsplatline_capi.a"
    run("cc", "-std=c99", "-O1", "-fPIC", "-shared", *includes, *sources, archive, "-o", library, "-lm", "-ldl", "-lpthread")
    return library


def lint(top, sources, parameters):
    """Verilator's warnings, all but those that lint.vlt gives a reason for, are failures."""
    chosen = [f"-G{name}={value}" for name, value in parameters.items()]
    files = ["lint.vlt", *sources, f"shell/{top}.sv"]
    run("verilator", "--lint-only", "-Wall", "--top-module", top, *chosen, *files, folder=RTL)


def verilog(top, sources, parameters):
    """An elaborated shell in plain Verilog."""
    out = BUILD / "_".join([top, *map(str, parameters.values())]) / f"{top}.v"
    out.parent.mkdir(parents=True, exist_ok=True)
    chosen = " ".join(f"-chparam {name} {value}" for name, value in parameters.items())
    script = f"read_verilog -sv {' '.join(sources)} shell/{top}.sv; hierarchy -top {top} {chosen}; rename -top {top}"
    run("yosys", "-q", "-p", f"{script}; proc; opt_clean; write_verilog -noattr {out}", folder=RTL)
    return out


def bench(top, sources, parameters):
    """The bench of a shell."""
    lint(top, sources, parameters)
    circuit = verilog(top, sources, parameters)
    runner = get_runner("icarus")
    runner.build(sources=[circuit], hdl_toplevel=top, build_dir=circuit.parent, timescale=("1ns", "1ps"), always=True)
    simulate(circuit.parent, top)


def primitive(tiles):
    """The primitive's shell with streams of all widths."""
    os.environ["SPLATLINE_KERNEL"] = str(kernel())
    os.environ["SPLATLINE_TILES"] = ",".join(tiles)
    sources = [f"{DESIGN}/splatline_pkg.sv", *(RTL / "files.txt").read_text().split()]
    for stream in STREAMS:
        bench("splat_axi", sources, {"STREAM": stream})


def frame():
    """A scene for the machine, and the kernel's frame of it."""
    file = BUILD / "frame.json"
    run("cargo", "run", "-p", "splatline-rtl", "--example", "rtl", "--", "frame", MACHINE, file)
    return file


def machine():
    """The machine's shell."""
    os.environ["SPLATLINE_FRAME"] = str(frame())
    packages = [f"{MACHINE}/{name}.sv" for name in ("splatline_pkg", "splatline_setup_pkg")]
    sources = [*packages, *(RTL / "machine_files.txt").read_text().split()]
    bench("machine_axi", sources, {"CORES": 2, "LANES": 1})


def main():
    BUILD.mkdir(parents=True, exist_ok=True)
    run(sys.executable, HERE / "registers.py", "--check")
    chosen = sys.argv[1:]
    if chosen == ["inputs"]:
        print(f"export SPLATLINE_KERNEL='{kernel()}' SPLATLINE_FRAME='{frame()}'")
        return
    if chosen != ["machine"]:
        primitive(chosen or ["0", "2"])
    if chosen in ([], ["machine"]):
        machine()


if __name__ == "__main__":
    main()
