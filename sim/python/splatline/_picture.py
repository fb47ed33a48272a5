"""A picture: views of one array, and how it came about."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import _native


@dataclass(frozen=True, eq=False)
class Picture:
    """Premultiplied red, green, blue and alpha, float64 of shape (height, width, 4), row by row from the top; linear, 1.0 is full.

    What the kernel drew are its integers times a power of two, exactly. `colour` and `alpha` are views, not copies; `record` is the report
    that `splatline render --json` writes.
    """

    rgba: np.ndarray
    record: dict = field(default_factory=dict, repr=False)

    @property
    def colour(self) -> np.ndarray:
        """Red, green, blue, premultiplied, (height, width, 3)."""
        return self.rgba[..., :3]

    @property
    def alpha(self) -> np.ndarray:
        """1 - transmittance, (height, width)."""
        return self.rgba[..., 3]

    @property
    def counts(self) -> dict:
        """Splats of the scene, those culled by reason, and pixels covered and visited once per splat."""
        scene = self.record["scene"]
        return {"splats": scene["splats"], "culled": scene["culled"], "pixels": self.record["pixels"]}

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        return np.array(self.rgba, dtype=dtype, copy=bool(copy) or dtype not in (None, self.rgba.dtype))

    def encode(self, format: str = "png", depth: int = 8, background=(0.0, 0.0, 0.0)) -> bytes:
        """The bytes of a png, npy or exr file; a PNG has `depth` bits a channel, and straight alpha if `background` is None."""
        return _native.encode(self.rgba, format, depth, background)

    def save(self, path, depth: int = 8, background=(0.0, 0.0, 0.0)) -> None:
        """Writes a .png, .npy or .exr file."""
        path = Path(path)
        path.write_bytes(self.encode(path.suffix[1:], depth, background))

    def _repr_png_(self) -> bytes:
        return self.encode()
