"""What is asked of a scene: every function takes a `Plan`, or the parts of one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from . import _native
from ._native import Camera, Design, Machine, Plan
from ._picture import Picture
from ._scene import Scene


@dataclass(frozen=True)
class Rules:
    """Rules of blending: `3dgs`, `inria` or `ewa`, with what differs from them.

    Rules("3dgs", low_pass=0.1, alpha_max=0.99); keys are those of a plan file: kernel, normalised, low_pass, compensated, spacing, cutoff,
    alpha_max, alpha_min, minimum_transmittance, omit_finishing, clamp_jacobian.
    """

    name: str
    changes: dict = field(default_factory=dict)

    def __init__(self, name: str, **changes):
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "changes", changes)

    def to_dict(self) -> dict:
        return {"name": self.name, **self.changes}


def load(path, transfer=None, contents=None) -> Scene:
    """The scene of a file, in any format that the command line reads, or one of its scenes by name (demo, random:COUNT[:SEED], deep-stack)."""
    return Scene.load(path, transfer, contents)


def _technique(scene, rules, compositing, method, style):
    if scene.kind == "surface":
        return {"surface": {**scene.usual_style(), **(style or {})}}
    if rules is None:
        rules = scene.natural_rules
    rules = rules.to_dict() if isinstance(rules, Rules) else {"name": rules} if isinstance(rules, str) else dict(rules)
    return {"splats": {"rules": rules, "compositing": compositing, "method": method}}


def plan(
    scene,
    camera=None,
    design="standard24",
    *,
    rules=None,
    compositing="front-to-back",
    method="composited",
    style=None,
    technique=None,
    engine="fixed",
    reference=None,
    machine=None,
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
    engine       fixed (the kernel), float, exact, fp32, fp16, bfloat16
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


def render(scene, camera=None, design="standard24", *, threads=None, repeat=1, vectors=None, **options) -> Picture:
    """Draws a scene (or a `Plan`); `options` are those of `plan`. Python's lock is released, and the pixels are not copied.

    threads  all processors unless given; repeat  draws so often, times are medians; vectors  avx2, avx512 or portable
    """
    what = plan(scene, camera, design, **options)
    return Picture(*what.draw(threads, repeat, vectors), what)


@dataclass(frozen=True)
class Comparison:
    """What the kernel and the reference drew, and the record of `splatline compare`."""

    fixed: Picture
    reference: Picture
    record: dict = field(repr=False)

    @property
    def psnr_db(self) -> float:
        """Of the colours."""
        return self.record["error"]["rgb"]["psnr_db"]


def compare(scene, camera=None, design="standard24", *, threads=None, repeat=1, all_designs=False, formats=False, **options) -> Comparison:
    """Draws by the kernel and by the reference and measures the difference; `options` are those of `plan`.

    all_designs  also every named design by both traversals, in record["table"]; formats  also fp32, fp16 and bfloat16, in record["formats"]
    """
    what = plan(scene, camera, design, **options)
    fixed, reference, record = what.compare(threads, repeat, all_designs, formats)
    return Comparison(Picture(fixed, record, what), Picture(reference, record), record)


def metrics(picture, reference) -> dict:
    """Errors of a picture (array or `Picture`, height x width x 4) against another, per channel group in units of 1.0, and FLIP."""
    arrays = [np.ascontiguousarray(one, np.float64) for one in (picture, reference)]
    return _native.metrics_of(*arrays)


def footprints(scene, camera=None, design="standard24", *, engine="fixed", **options) -> np.ndarray:
    """Where every splat lands, a structured array; NaN where it is culled. Pixels; r = a dx^2 + 2 b dx dy + c dy^2."""
    names = ["u", "v", "depth", "conic_a", "conic_b", "conic_c", "x0", "y0", "x1", "y1", "cutoff", "opacity"]
    rows = plan(scene, camera, design, **options).footprints(engine)
    return rows.view([(name, np.float64) for name in names]).reshape(-1)


class Simulation(dict):
    """The record of `splatline simulate`, with its accounts as arrays."""

    @property
    def units(self) -> np.ndarray:
        """Cycles of every unit over the whole picture: a structured array with name, busy, idle, and a column for each cause of stalls."""
        units = self["cycles"]["units"]
        causes = sorted({cause for unit in units.values() for cause in unit["stalled"]})
        columns = [("name", "U32"), ("busy", np.int64), ("idle", np.int64), *((cause, np.int64) for cause in causes)]
        rows = [
            (name, unit["busy"], unit["idle"], *(unit["stalled"].get(cause, 0) for cause in causes))
            for name, unit in units.items()
        ]
        return np.array(rows, dtype=columns)


def simulate(scene, camera=None, design="standard24", machine=None, *, part=None, **options) -> Simulation:
    """Cycles, traffic, energy and area of a picture on a machine, which may be meant for a `part` (xc7a100t, ...)."""
    return Simulation(plan(scene, camera, design, machine=machine, **options).simulate(part))


def _plans(frames, camera, design, options):
    frames = frames if isinstance(frames, (list, tuple)) else [frames]
    return [plan(frame, camera, design, **options) for frame in frames]


def fit(frames, limits, camera=None, design="standard24", **options) -> dict:
    """The smallest design within limits on its errors over one frame or several (scenes or plans); `design` is where it starts.

    limits  quantity -> bound: psnr_db at least; rms_error, largest_error, percentile99 and flip at most
    """
    return _native.fit_widths(_plans(frames, camera, design, options), limits)


def optimize(frames, limits, camera=None, design="standard24", *, part=None, space=None, **options) -> dict:
    """The cheapest design and machine that hold all limits over one frame or several, or the limits that cannot be held.

    limits  quantity -> bound: frames_per_second and psnr_db at least; luts, flip_flops, dsps, memory_kbit, bytes_per_second, largest_error,
            rms_error, percentile99, flip and millijoules_per_frame at most
    part    a part whose limits are added; space  text of a space file
    """
    return _native.search_cheapest(_plans(frames, camera, design, options), limits, part, space)
