"""Builds the shell and runs its cocotb bench on Icarus Verilog, with a packet stream of 32 bits and of 128:
`python3 sim/rtl/shell/run.py [TILE ...]`.

Needs yosys, iverilog, a C compiler and cargo, and `pip install 'cocotb>=2' cocotbext-axi`. Icarus Verilog 11 does not read packages of types that are named
through them, so Yosys writes the elaborated circuit as plain Verilog first; what is simulated is that. All is built in target/shell.
"""

import os
import subprocess
import sys
from pathlib import Path

from cocotb_tools.runner import get_runner

HERE = Path(__file__).resolve().parent
RTL = HERE.parent
ROOT = RTL.parent.parent
CAPI = ROOT / "sim" / "capi"
BUILD = ROOT / "target" / "shell"
DESIGN = "standard24"  # of sim/capi/cosim
STREAMS = (32, 128)


def run(*command, folder=ROOT):
    subprocess.run([str(word) for word in command], check=True, cwd=folder)


def number(name):
    """A constant of the design's package."""
    for line in (RTL / DESIGN / "splatline_pkg.sv").read_text().splitlines():
        words = line.split()
        if words[:3] == ["localparam", "int", name]:
            return int(words[4].rstrip(";"))
    raise SystemExit(f"{DESIGN}/splatline_pkg.sv has no {name}")


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


def verilog(stream):
    """The elaborated shell in plain Verilog, with a packet stream of so many bits."""
    units = (RTL / "files.txt").read_text().split()
    out = BUILD / f"splat_axi_{stream}.v"
    read = f"read_verilog -sv {DESIGN}/splatline_pkg.sv {' '.join(units)} shell/splat_axi.sv"
    run("yosys", "-q", "-p", f"{read}; hierarchy -top splat_axi -chparam STREAM {stream}; rename -top splat_axi; proc; opt_clean; write_verilog -noattr {out}", folder=RTL)
    return out


def bench(stream):
    """The bench on a shell with a packet stream of so many bits."""
    folder = BUILD / f"stream_{stream}"
    os.environ["SPLATLINE_STREAM"] = str(stream)
    runner = get_runner("icarus")
    runner.build(sources=[verilog(stream)], hdl_toplevel="splat_axi", build_dir=folder, timescale=("1ns", "1ps"), always=True)
    results = runner.test(hdl_toplevel="splat_axi", test_module="test_splat_axi", build_dir=folder, test_dir=folder)
    if "<failure" in Path(results).read_text():
        raise SystemExit(f"the bench failed with a stream of {stream} bits: see above")


def main():
    BUILD.mkdir(parents=True, exist_ok=True)
    os.environ["SPLATLINE_KERNEL"] = str(kernel())
    os.environ["SPLATLINE_PACKET_WORDS"] = str((number("PACKET_BITS") + 31) // 32)
    os.environ["SPLATLINE_TABLE"] = str((1 << number("TABLE")) + 1)
    os.environ["SPLATLINE_TILES"] = ",".join(sys.argv[1:] or ["0", "2"])
    for stream in STREAMS:
        bench(stream)


if __name__ == "__main__":
    main()
