"""What the tests draw: small scenes that need no file, and the shared data where they are there."""

from pathlib import Path

import pytest
import splatline

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT.parent / "shared" / "data"


@pytest.fixture(scope="session")
def scene():
    return splatline.load("random:300")


@pytest.fixture(scope="session")
def camera(scene):
    return splatline.Camera.framing(scene, size=(64, 48))


@pytest.fixture(scope="session")
def guitar():
    path = DATA / "gaussians" / "guitar.ply"
    if not path.exists():
        pytest.skip(f"{path} is not there")
    return path
