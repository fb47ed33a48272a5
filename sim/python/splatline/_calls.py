"""What is asked of a scene: every function takes a `Plan`, or the parts of one."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import Camera, Design, Machine, Plan
from ._picture import Picture
from ._scene import Scene, in_rows

#: A scene, its path, one of the command line's own (demo, random:COUNT[:SEED], deep-stack), or a whole plan.
SceneLike: TypeAlias = Scene | Plan | str | PathLike[str]


@dataclass(frozen=True)
class Rules:
    """Rules of blending: `3dgs` (Kerbl et al. 2023), `inria` (their program) or `ewa` (Zwicker et al. 2002), with what differs from them.

    Rules("3dgs", low_pass=0.1, alpha_max=0.99); keys are those of a plan file: kernel, normalised, low_pass (square pixels), compensated,
    spacing, cutoff (squared deviations), alpha_max, alpha_min and minimum_transmittance (0 to 1), omit_finishing, clamp_jacobian.
    """

    name: str
    changes: dict[str, Any] = field(default_factory=dict)

    def __init__(self, name: str, **changes: Any):
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "changes", changes)

    def to_dict(self) -> dict[str, Any]:
        return {"name": self.name, **self.changes}


def load(path: str | PathLike[str], transfer: str | PathLike[str] | None = None, contents: Any = None) -> Scene:
    """The scene of a file, in any format that the command line reads, or one of its scenes by name (demo, random:COUNT[:SEED], deep-stack).

    transfer  a transfer function's file, for a volume
    contents  what the file's contents are, as a plan file says it ({"gaussians": {}}, {"surface": {}}, ...); recognised unless given
    """
    return Scene.load(path, transfer, contents)


def _technique(scene: Scene, rules: Any, compositing: str, method: Any, style: dict[str, Any] | None) -> dict[str, Any]:
    if (style if scene.kind == "splats" else rules) is not None:
        raise _native.Error(f"{scene.name}: splats have rules and no style, and points of a surface a style and no rules")
    if scene.kind == "surface":
        return {"surface": {**scene.usual_style(), **(style or {})}}
    if rules is None:
        rules = scene.natural_rules
    rules = rules.to_dict() if isinstance(rules, Rules) else {"name": rules} if isinstance(rules, str) else dict(rules)
    return {"splats": {"rules": rules, "compositing": compositing, "method": method}}


def plan(
    scene: SceneLike,
    camera: Camera | None = None,
    design: Design | str = "standard24",
    *,
    rules: Rules | str | dict[str, Any] | None = None,
    compositing: str = "front-to-back",
    method: str | dict[str, Any] = "composited",
    style: dict[str, Any] | None = None,
    technique: dict[str, Any] | None = None,
    engine: str = "fixed",
    reference: str | None = None,
    machine: Machine | str | None = None,
) -> Plan:
    """All that decides a picture; what is left out is as on the command line.

    scene        a Scene, a path, or a Plan, which is given back as it is
    camera       a Camera; without one the whole scene is shown
    design       a Design or its name
    rules        Rules or a name, for splats
    compositing  front-to-back, back-to-front or x-ray
    method       how splats become pixels: composited, or as a plan file has it, {"sheets": {...}}, {"spheres": {...}}, ...
    style        changes of a surface's settings
    technique    all of the last four at once, as a plan file has it
    engine       fixed (the kernel), float, exact, fp32, fp16, bfloat16, fp8 (E4M3), and mixes: fp8-fp16, e5m2-fp16
    reference    what `compare` compares with: float or exact
    machine      a Machine or its name
    """
    if isinstance(scene, Plan):
        return scene
    if not isinstance(scene, Scene):
        scene = load(scene)
    if technique is None:
        technique = _technique(scene, rules, compositing, method, style)
    if not isinstance(design, Design):
        design = Design(design)
    if not isinstance(machine, Machine):
        machine = Machine(machine) if machine else Machine()
    return Plan(scene, camera or Camera.framing(scene), technique, design, engine, reference, machine)


def render(
    scene: SceneLike,
    camera: Camera | None = None,
    design: Design | str = "standard24",
    *,
    threads: int | None = None,
    repeat: int = 1,
    vectors: str | None = None,
    **options: Any,
) -> Picture:
    """Draws a scene (or a `Plan`); `options` are those of `plan`. Python's lock is released, and the pixels are not copied.

    threads  all processors unless given
    repeat   draws so often; times in the record are medians, in seconds
    vectors  avx2, avx512 or portable

    The picture is float64 of shape (height, width, 4): premultiplied linear red, green, blue, and alpha, in units of 1.0. What each engine
    computes: fixed is docs/specification.md; float is EWA (Zwicker et al. 2002) and 3DGS (Kerbl et al. 2023) in double precision; the others
    are the same formulas with every operation rounded to the format.
    """
    what = plan(scene, camera, design, **options)
    return Picture(*what.draw(threads, repeat, vectors), what)


@dataclass(frozen=True)
class Comparison:
    """What the kernel and the reference drew, and the record of `splatline compare`."""

    fixed: Picture
    reference: Picture
    record: dict[str, Any] = field(repr=False)

    @property
    def psnr_db(self) -> float:
        """Of the colours, in dB over a peak of 1.0; infinite where no sample differs."""
        psnr = self.record["error"]["rgb"]["psnr_db"]
        return np.inf if psnr is None else psnr


def compare(
    scene: SceneLike,
    camera: Camera | None = None,
    design: Design | str = "standard24",
    *,
    threads: int | None = None,
    repeat: int = 1,
    all_designs: bool = False,
    formats: bool = False,
    **options: Any,
) -> Comparison:
    """Draws by the kernel and by the reference and measures the difference, as `metrics` does; `options` are those of `plan`.

    all_designs  also every named design by both traversals, in record["table"]
    formats      also floating-point datapaths, in record["formats"]
    """
    what = plan(scene, camera, design, **options)
    fixed, reference, record = what.compare(threads, repeat, all_designs, formats)
    return Comparison(Picture(fixed, record, what), Picture(reference, record), record)


def metrics(picture: ArrayLike | Picture, reference: ArrayLike | Picture) -> dict[str, Any]:
    """Errors of a picture against another, arrays of shape (height, width, 4) or `Picture`s, for "rgb" and "alpha", and "flip".

    Both are clamped to 0 to 1 first, as a file holds them. In units of 1.0: max_abs, p95, p99, bias (picture minus reference); psnr_db over a
    peak of 1.0, None where no sample differs; ssim of the luminance in windows of 11 x 11 (Wang et al. 2004); flip is the mean of FLIP (Andersson et al. 2020).
    """
    return _native.metrics_of(in_rows("picture", picture, np.float64, 3), in_rows("reference", reference, np.float64, 3))


def footprints(
    scene: SceneLike, camera: Camera | None = None, design: Design | str = "standard24", *, engine: str = "fixed", **options: Any
) -> NDArray[np.void]:
    """Where every splat lands: a structured array of shape (n,) with float64 fields, NaN where the splat is culled.

    u, v                       centre in pixels, (0, 0) the upper left corner of the picture
    depth                      along the view, scene units
    conic_a, conic_b, conic_c  of the ellipse r = a dx^2 + 2 b dx dy + c dy^2, per square pixel
    x0, y0, x1, y1             its box in pixels, first inside and first beyond
    cutoff                     where r ends
    opacity                    at the centre, 0 to 1
    """
    names = ["u", "v", "depth", "conic_a", "conic_b", "conic_c", "x0", "y0", "x1", "y1", "cutoff", "opacity"]
    rows = plan(scene, camera, design, **options).footprints(engine)
    return rows.view([(name, np.float64) for name in names]).reshape(-1)


class Simulation(dict[str, Any]):
    """The record of `splatline simulate`, with its accounts as arrays."""

    @property
    def units(self) -> NDArray[np.void]:
        """Cycles of every unit over the whole picture: a structured array with name, and int64 busy, idle, and a field for each cause of stalls."""
        units = self["cycles"]["units"]
        causes = sorted({cause for unit in units.values() for cause in unit["stalled"]})
        columns = [("name", "U32"), ("busy", np.int64), ("idle", np.int64), *((cause, np.int64) for cause in causes)]
        rows = [
            (name, unit["busy"], unit["idle"], *(unit["stalled"].get(cause, 0) for cause in causes))
            for name, unit in units.items()
        ]
        return np.array(rows, dtype=columns)


def simulate(
    scene: SceneLike,
    camera: Camera | None = None,
    design: Design | str = "standard24",
    machine: Machine | str | None = None,
    *,
    part: str | None = None,
    **options: Any,
) -> Simulation:
    """Cycles, bytes, energy and area of a picture on a machine, which may be meant for a `part` (xc7a100t, ...).

    Cycles are the circuits' (docs/hardware-model.md); area comes from yosys's synthesis of them and energy from published tables, each with
    its source in the record.
    """
    return Simulation(plan(scene, camera, design, machine=machine, **options).simulate(part))


def _plans(frames: Any, camera: Camera | None, design: Design | str, options: dict[str, Any]) -> list[Plan]:
    frames = frames if isinstance(frames, (list, tuple)) else [frames]
    return [plan(frame, camera, design, **options) for frame in frames]


def fit(
    frames: SceneLike | list[SceneLike],
    limits: dict[str, float],
    camera: Camera | None = None,
    design: Design | str = "standard24",
    **options: Any,
) -> dict[str, Any]:
    """The smallest design within limits on its errors over one frame or several (scenes or plans); `design` is where it starts.

    limits  quantity -> bound: psnr_db (dB) at least; rms_error, largest_error, percentile99 (units of 1.0) and flip (0 to 1) at most

    The record of `splatline fit`: widths by name (bits), error, errors with one bit less in each width, the binding width, designs drawn.
    """
    return _native.fit_widths(_plans(frames, camera, design, options), limits)


def optimize(
    frames: SceneLike | list[SceneLike],
    limits: dict[str, float],
    camera: Camera | None = None,
    design: Design | str = "standard24",
    *,
    part: str | None = None,
    space: str | None = None,
    **options: Any,
) -> dict[str, Any]:
    """The cheapest design and machine that hold all limits over one frame or several, or the limits that cannot be held.

    limits  quantity -> bound: frames_per_second and psnr_db at least; luts, flip_flops, dsps, memory_kbit, bytes_per_second, largest_error,
            rms_error, percentile99, flip and millijoules_per_frame at most
    part    a part whose limits are added, and whose prices of area count
    space   text of a space file; the usual machines, and all widths where an error is limited, unless given
    """
    return _native.search_cheapest(_plans(frames, camera, design, options), limits, part, space)
