"""The package as a package: types, help, command line, and the bench of the circuit."""

import inspect
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import splatline
from conftest import ROOT
from splatline import _native

PACKAGE = Path(splatline.__file__).parent


def test_stubs_are_what_there_is():
    """Names, parameters and defaults by stubtest, and the package's own annotations by mypy."""
    pytest.importorskip("mypy")
    settings = ["--mypy-config-file", str(ROOT / "sim" / "python" / "pyproject.toml")]
    stubs = subprocess.run([sys.executable, "-m", "mypy.stubtest", "splatline", *settings], capture_output=True, text=True, cwd="/")
    assert (PACKAGE / "py.typed").exists() and stubs.returncode == 0, stubs.stdout
    for name in splatline.__all__:
        what = getattr(splatline, name)
        if inspect.isfunction(what):
            assert "return" in what.__annotations__ and len(what.__annotations__) == 1 + len(inspect.signature(what).parameters), name


def test_everything_that_is_public_says_what_it_is():
    for name in splatline.__all__:
        if name != "__version__":
            assert inspect.getdoc(getattr(splatline, name)), name
    assert "UQ1.alpha" in _native.Kernel.opacities.__doc__ and "float64" in splatline.Scene.centres.__doc__


def test_versions_are_the_crates():
    manifest = (ROOT / "Cargo.toml").read_text()
    assert f'version = "{splatline.__version__}"' in manifest


def test_the_module_is_the_command_line():
    said = subprocess.run([sys.executable, "-m", "splatline", "--version"], capture_output=True, text=True)
    assert said.stdout == f"splatline {splatline.__version__}\n" and said.returncode == 0
    said = subprocess.run([sys.executable, "-m", "splatline", "render"], capture_output=True, text=True)
    assert said.returncode == 2 and "--output" in said.stderr


def test_float_units_round_as_halves_do(tmp_path):
    """What the notebook on formats weighs: against NumPy, but for numbers below the normal ones."""
    if not shutil.which("iverilog"):
        pytest.skip("iverilog is not installed")
    rng = np.random.default_rng(1)
    a, b = rng.integers(0, 1 << 16, (2, 20_000)).astype(np.uint16)
    # Half of them are near each other, where sums cancel.
    b[::2] = a[::2] ^ 0x8000 ^ rng.integers(0, 8192, 10_000).astype(np.uint16)
    exponent = lambda halves: halves >> 10 & 31  # noqa: E731
    normal = np.isin(exponent(a), [0, 31], invert=True) & np.isin(exponent(b), [0, 31], invert=True)
    a, b = a[normal], b[normal]
    (tmp_path / "pairs.hex").write_text("\n".join(f"{x:04x}{y:04x}" for x, y in zip(a, b)))
    (tmp_path / "bench.sv").write_text(f"""module bench;
        logic [31:0] pairs [0:{len(a) - 1}]; logic [15:0] a, b; wire [15:0] product, sum;
        float_multiply multiply(a, b, product); float_add add(a, b, sum);
        initial begin
            $readmemh("pairs.hex", pairs);
            for (int i = 0; i < {len(a)}; i++) begin {{a, b}} = pairs[i]; #1; $display("%h %h", product, sum); end
        end
    endmodule""")
    units = ROOT / "sim" / "python" / "examples" / "notebooks" / "lane_units.sv"
    subprocess.run(["iverilog", "-g2012", "-o", "bench", "bench.sv", units], cwd=tmp_path, check=True)
    printed = subprocess.run(["vvp", "bench"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout.split()
    found = np.array([int(word, 16) for word in printed], np.uint16).reshape(-1, 2)
    doubles = a.view(np.float16).astype(float), b.view(np.float16).astype(float)
    exact = np.stack([doubles[0] * doubles[1], doubles[0] + doubles[1]], axis=1)
    small = abs(exact) < 2.0**-14
    with np.errstate(over="ignore"):
        wanted = exact.astype(np.float16).view(np.uint16)
    # What is below the normal numbers is 0, or the least of them where it rounds up to it.
    assert len(a) > 15_000 and (found[~small] == wanted[~small]).all() and np.isin(found[small] & 0x7FFF, [0, 0x0400]).all()


@pytest.mark.bench
def test_the_circuit_equals_the_kernel_at_every_handshake():
    pytest.importorskip("cocotb_tools")
    pytest.importorskip("cocotbext.axi")
    for tool in ("iverilog", "yosys"):
        if not shutil.which(tool):
            pytest.skip(f"{tool} is not installed")
    bench = ROOT / "sim" / "python" / "examples" / "primitive" / "run.py"
    said = subprocess.run([sys.executable, bench], capture_output=True, text=True)
    assert said.returncode == 0, said.stdout[-3000:] + said.stderr[-3000:]
    assert re.search(r"\d+ packets, \d+ spans and \d+ pixels of 2 tiles: 0 differences", said.stdout + said.stderr)
