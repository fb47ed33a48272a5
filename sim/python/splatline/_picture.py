"""A picture: views of one array, and how it came about."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from . import _native


@dataclass(frozen=True, eq=False)
class Picture:
    """Premultiplied red, green, blue and alpha, float64 of shape (height, width, 4), row by row from the top; linear, 1.0 is full.

    What the kernel drew are its integers times a power of two, exactly. `colour` and `alpha` are views, not copies; `record` is the report
    that `splatline render --json` writes.
    """

    rgba: NDArray[np.float64]
    record: dict[str, Any] = field(default_factory=dict, repr=False)
    plan: _native.Plan | None = field(default=None, repr=False)

    @property
    def colour(self) -> NDArray[np.float64]:
        """Red, green, blue, premultiplied, (height, width, 3)."""
        return self.rgba[..., :3]

    @property
    def alpha(self) -> NDArray[np.float64]:
        """1 - transmittance, (height, width)."""
        return self.rgba[..., 3]

    @property
    def depth(self) -> NDArray[np.float64]:
        """Mean depth along the view, weighted as the colours are, scene units, (height, width); NaN where nothing is drawn.

        Drawn when it is asked for, by the same plan, with each splat's depth in place of its colour.
        """
        plan = self.plan
        if plan is None or plan.scene.kind != "splats":
            raise _native.Error("depth is that of splats drawn by `render`")
        scene, camera, settings = plan.scene, plan.camera, plan.to_dict()
        along = camera.world_to_camera[2]
        depths = np.maximum(scene.centres @ along[:3] + along[3], 0.0)
        colours = np.repeat(depths[:, None], 3, axis=1)
        with_depths = _native.Scene.from_axes(scene.centres, scene.axes, scene.weights, colours, None, scene.weight, scene.up, scene.name)
        technique, engine = settings["technique"], settings["engine"]
        drawn = _native.Plan(with_depths, camera, technique, plan.design, engine, None, plan.machine).draw()[0]
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(drawn[..., 3] > 0, drawn[..., 0] / drawn[..., 3], np.nan)

    @property
    def counts(self) -> dict[str, Any]:
        """Splats of the scene, those culled by reason, and pixels covered and visited once per splat."""
        scene = self.record["scene"]
        return {"splats": scene["splats"], "culled": scene["culled"], "pixels": self.record["pixels"]}

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.rgba, dtype=dtype, copy=bool(copy) or dtype not in (None, self.rgba.dtype))

    def encode(
        self, format: str = "png", depth: int = 8, background: tuple[float, float, float] | None = (0.0, 0.0, 0.0)
    ) -> bytes:
        """The bytes of a png, npy or exr file; a PNG has `depth` bits a channel, and straight alpha if `background` is None."""
        return _native.encode(self.rgba, format, depth, background)

    def save(
        self, path: str | PathLike[str], depth: int = 8, background: tuple[float, float, float] | None = (0.0, 0.0, 0.0)
    ) -> None:
        """Writes a .png, .npy or .exr file."""
        path = Path(path)
        path.write_bytes(self.encode(path.suffix[1:], depth, background))

    def _repr_png_(self) -> bytes:
        return self.encode()
