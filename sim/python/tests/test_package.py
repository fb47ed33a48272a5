"""The package as a package: types, help, command line, and the bench of the circuit."""

import inspect
import re
import shutil
import subprocess
import sys
from pathlib import Path

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
