"""Scenes from arrays."""

from __future__ import annotations

import copyreg
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _native

Scene = _native.Scene


def in_rows(name: str, values: Any, dtype: DTypeLike, dimensions: int) -> NDArray[Any]:
    """An array as Rust reads it, copied where it is another."""
    found = np.ascontiguousarray(values, dtype)
    if found.ndim != dimensions:
        raise _native.Error(f"{name} has the shape {np.shape(values)}: allowed are {dimensions} dimensions")
    return found


def _rotations(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation matrices of quaternions w, x, y, z of any length but 0, shape (n, 3, 3)."""
    largest = np.abs(quaternions).max(axis=1)
    if (largest == 0).any():
        raise _native.Error(f"rotations[{int(np.argmin(largest))}] is zero, which is no rotation")
    # By a power of two, so that no square is beyond what a double holds.
    quaternions = np.ldexp(quaternions, -np.frexp(largest)[1][:, None])
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1)[:, None]).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def from_arrays(
    centres: ArrayLike,
    weights: ArrayLike,
    colours: ArrayLike,
    *,
    axes: ArrayLike | None = None,
    scales: ArrayLike | None = None,
    rotations: ArrayLike | None = None,
    harmonics: ArrayLike | None = None,
    weight: str = "opacity",
    up: tuple[float, float, float] = (0.0, -1.0, 0.0),
    name: str = "arrays",
) -> Scene:
    """A scene of n splats, from float64 arrays (float32 for harmonics); others are converted. Each is copied once, splat by splat.

    centres    (n, 3)     scene units
    weights    (n,)       peak opacity 0 to 1, or with weight="mass" extinction times volume in square scene units
    colours    (n, 3)     linear RGB, with harmonics their constant part (0.5 + 0.2820948 f_dc)
    axes       (n, 3, 3)  three axes, each one standard deviation long, an axis a row; or instead
    scales     (n, 3)     standard deviations (not their logarithms), and
    rotations  (n, 4)     quaternions w, x, y, z; none are needed for scales alone
    harmonics  (n, k, 3)  coefficients of degree 1 and up, k = 3, 8, 15 or 24, in the trainers' order
    """
    centres = in_rows("centres", centres, np.float64, 2)
    if (axes is None) == (scales is None) or (scales is None and rotations is not None):
        raise _native.Error("give axes, or scales with rotations, and not both")
    if axes is None:
        lengths = in_rows("scales", scales, np.float64, 2)
        turns = np.tile([1.0, 0.0, 0.0, 0.0], (len(lengths), 1)) if rotations is None else np.asarray(rotations, np.float64)
        if lengths.shape != (len(centres), 3) or turns.shape != (len(centres), 4):
            raise _native.Error(
                f"scales has the shape {lengths.shape} and rotations {turns.shape}: allowed are "
                f"({len(centres)}, 3) and ({len(centres)}, 4)"
            )
        # An axis is a column of R S; here it is a row.
        axes = np.swapaxes(_rotations(turns) * lengths[:, None, :], 1, 2)
    return Scene.from_axes(
        centres,
        in_rows("axes", axes, np.float64, 3),
        in_rows("weights", weights, np.float64, 1),
        in_rows("colours", colours, np.float64, 2),
        None if harmonics is None else in_rows("harmonics", harmonics, np.float32, 3),
        weight,
        up,
        name,
    )


def _reduce(scene: Scene) -> tuple[Any, ...]:
    """For pickling: the file again, or its arrays."""
    if scene.path is not None:
        return Scene.load, (str(scene.path), None, scene.contents)
    base, harmonics = scene.harmonics or (scene.colours, None)
    arrays = (scene.centres, scene.axes, scene.weights, base.astype(np.float64), harmonics)
    return Scene.from_axes, (*arrays, scene.weight, scene.up, scene.name)


Scene.from_arrays = staticmethod(from_arrays)  # type: ignore[method-assign]
copyreg.pickle(Scene, _reduce)
