"""Fixed-point splatting from Python: a bit-accurate model of splatting hardware, its cycles, and searches over designs.

    import splatline

    scene = splatline.load("guitar.ply")
    camera = splatline.Camera.look_at(eye=(5.5, -2.1, 0.2), target=(0.1, -2.1, 0.1), up=(0, -1, 0))
    picture = splatline.render(scene, camera, "lean18")            # the kernel's words as float64
    reference = splatline.render(scene, camera, engine="float")    # EWA in double precision
    print(splatline.metrics(picture, reference)["rgb"]["psnr_db"])

`render` draws, `compare` measures, `simulate` counts cycles, `fit` and `optimize` search, `splatline.study` sweeps on executors of any
kind, `splatline.stages` shows the kernel stage by stage. Records are dictionaries with the fields of the command line's JSON; what is wrong
raises `splatline.Error` in the command line's words. `python -m splatline` is the command line.
"""

from . import study
from ._calls import Rules, compare, fit, footprints, load, metrics, optimize, plan, render, simulate
from ._native import Camera, Design, Error, Machine, Plan, __version__
from ._picture import Picture
from ._scene import Scene
from .fixed import FixedArray
from .stages import Stages

__all__ = [
    "Camera",
    "Design",
    "Error",
    "FixedArray",
    "Machine",
    "Picture",
    "Plan",
    "Rules",
    "Scene",
    "Stages",
    "__version__",
    "compare",
    "fit",
    "footprints",
    "load",
    "metrics",
    "optimize",
    "plan",
    "render",
    "simulate",
    "study",
]
