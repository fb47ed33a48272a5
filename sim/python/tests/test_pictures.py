"""Pictures are the kernel's words, records the command line's, and messages too."""

import csv
import json
import pickle
import subprocess
import sys
import threading
import time
import zlib

import numpy as np
import pytest
import splatline
from conftest import ROOT

PLANS = ROOT / "sim" / "plans"
GOLDEN = {line["plan"]: line for line in csv.DictReader((PLANS / "golden.csv").open())}
EYE = {"eye": (5.5, -2.1, 0.2), "target": (0.1, -2.1, 0.1), "up": (0, -1, 0)}


def command(*words, folder=None):
    return subprocess.run([sys.executable, "-m", "splatline", *map(str, words)], capture_output=True, text=True, cwd=folder)


@pytest.mark.parametrize("name", sorted(GOLDEN))
def test_all_systems_give_the_words_of_the_kernel(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    plan = splatline.Plan.from_file(PLANS / f"{name}.toml")
    picture = splatline.render(plan)
    # Of the picture's doubles, into which the kernel's words go without further rounding.
    assert f"{zlib.crc32(picture.rgba.tobytes()):08x}" == GOLDEN[name]["crc32"]
    again = splatline.Plan.from_dict(plan.to_dict(), plan.scene)
    assert (splatline.render(again).rgba == picture.rgba).all()


def test_three_designs_of_guitar_are_as_far_from_float_as_the_command_line_says(guitar, tmp_path):
    scene = splatline.load(guitar)
    camera = splatline.Camera.look_at(**EYE, size=(256, 256))
    (tmp_path / "camera.json").write_text(camera.to_json())
    reference = splatline.render(scene, camera, engine="float")
    for design in ("lean18", "standard24", "deep32"):
        found = splatline.metrics(splatline.render(scene, camera, design), reference)["rgb"]["psnr_db"]
        words = ["compare", guitar, "--camera", "camera.json", "--design", design, "--only", "-o", design]
        assert command(*words, folder=tmp_path).returncode == 0
        report = json.loads((tmp_path / design / "report.json").read_text())
        assert found == report["error"]["rgb"]["psnr_db"]
        assert splatline.compare(scene, camera, design).record["error"] == report["error"]


def test_the_pixels_are_not_copied(scene, camera):
    picture = splatline.render(scene, camera)
    assert picture.rgba.shape == (48, 64, 4) and picture.rgba.dtype == np.float64
    assert np.shares_memory(picture.colour, picture.rgba) and np.shares_memory(picture.alpha, picture.rgba)
    assert np.asarray(picture) is picture.rgba or np.shares_memory(np.asarray(picture), picture.rgba)
    owner = picture.rgba
    while isinstance(owner, np.ndarray):
        assert not owner.flags.owndata
        owner = owner.base
    # The vector that was drawn into, which Rust frees.
    assert type(owner).__name__ == "PySliceContainer"


def test_a_call_costs_less_than_adding_in_python():
    """A picture of one pixel: what is left is plan, threads, report and array. A ratio, since machines differ."""
    scene = splatline.load("random:1")
    plan = splatline.plan(scene, splatline.Camera.framing(scene, size=(1, 1)))
    splatline.render(plan)

    def seconds(work):
        began = time.perf_counter()
        work()
        return time.perf_counter() - began

    pairs = [(seconds(lambda: splatline.render(plan)), seconds(lambda: sum(range(100_000)))) for _ in range(101)]
    # The fastest: what else the machine does lengthens the others.
    call, adding = map(min, zip(*pairs))
    assert call < adding, f"{call * 1e3:.3f} ms a call, {adding * 1e3:.3f} ms for 100,000 additions"


def test_others_run_while_a_picture_is_drawn(scene, camera):
    drawing = threading.Thread(target=lambda: splatline.render(scene, camera.resized(1500, 1500), engine="float", threads=1))
    drawing.start()
    turns = 0
    while drawing.is_alive():
        turns += 1
    assert turns > 100


@pytest.mark.parametrize("engine", ["fixed", "float", "exact", "fp32", "fp16", "bfloat16", "fp8-fp16", "e5m2-fp16", "fp8"])
def test_every_engine_draws(scene, camera, engine):
    picture = splatline.render(scene, camera, engine=engine)
    assert picture.alpha.max() > 0.5 and picture.record["engine"] == engine
    assert picture.counts["splats"] == 300


def test_depth_is_the_mean_of_the_splats():
    camera = splatline.Camera.look_at((0, 0, 0), (0, 0, 1), (0, -1, 0), size=(33, 33))
    near, far = 0.5, 0.75
    scene = splatline.Scene.from_arrays([[0, 0, 2], [0, 0, 6]], [near, far], np.ones((2, 3)), scales=np.full((2, 3), [[0.2], [3.0]]))
    depth = splatline.render(scene, camera).depth
    # The first splat's share, and what it lets through of the second's.
    shares = np.array([near, (1 - near) * far])
    assert abs(depth[16, 16] - shares @ [2, 6] / shares.sum()) < 0.01
    assert abs(depth[16, 0] - 6) < 1e-5
    assert np.isnan(splatline.render(scene, camera.zoomed(0.05)).depth[0, 0])
    with pytest.raises(splatline.Error, match="splats drawn by"):
        _ = splatline.Picture(np.zeros((1, 1, 4))).depth


def test_arrays_make_the_scene_that_they_came_from(camera, scene):
    again = splatline.Scene.from_arrays(scene.centres, scene.weights, scene.colours, axes=scene.axes)
    assert (splatline.render(again, camera).rgba == splatline.render(scene, camera).rgba).all()


def test_scales_and_rotations_are_the_trainers(tmp_path, camera):
    """Against the loader of the trainers' PLY."""
    rng = np.random.default_rng(3)
    count = 40
    centres, quaternions = rng.normal(0, 1, (count, 3)), rng.normal(0, 1, (count, 4))
    scales, logits, dc = rng.normal(-2, 0.4, (count, 3)), rng.normal(0, 1, count), rng.normal(0, 0.4, (count, 3))
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    rows = np.concatenate([centres, dc, logits[:, None], scales, quaternions], axis=1).astype("<f4")
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}", *(f"property float {name}" for name in names), "end_header\n"]
    path = tmp_path / "trainer.ply"
    path.write_bytes("\n".join(header).encode() + rows.tobytes())
    loaded = splatline.load(path)
    centres, dc, logits, scales, quaternions = (a.astype(np.float32).astype(float) for a in (centres, dc, logits, scales, quaternions))
    made = splatline.Scene.from_arrays(
        centres, 1 / (1 + np.exp(-logits)), 0.5 + 0.28209479177387814 * dc, scales=np.exp(scales), rotations=quaternions
    )
    assert np.allclose(made.axes, loaded.axes, rtol=1e-6, atol=1e-9)
    assert np.allclose(made.colours, loaded.colours, atol=1e-6) and np.allclose(made.weights, loaded.weights, atol=1e-6)


def test_everything_survives_pickling(scene, camera, guitar):
    arrays = splatline.Scene.from_arrays(scene.centres, scene.weights, scene.colours, axes=scene.axes)
    design = splatline.Design("standard24", mantissa=20, rounding="truncate")
    machine = splatline.Machine(lanes=4, tile_width=16)
    for what in (arrays, scene):
        plan = splatline.plan(what, camera, design, machine=machine)
        again = pickle.loads(pickle.dumps(plan))
        assert again.to_dict() == plan.to_dict()
        assert (splatline.render(again).rgba == splatline.render(plan).rgba).all()
    for what in (camera, design, machine):
        assert pickle.loads(pickle.dumps(what)) == what


def test_messages_are_those_of_the_command_line(tmp_path, scene, camera):
    missing = tmp_path / "nothing.ply"
    said = command("render", missing, "-o", tmp_path / "x.png")
    with pytest.raises(splatline.Error) as raised:
        splatline.load(missing)
    assert said.returncode == 1 and said.stderr.strip() == f"error: {raised.value}"
    for wrong, words in {
        "unknown design 'lean'": lambda: splatline.render(scene, camera, "lean"),
        "mantissa = 40 is out of range: allowed are 8 to 31": lambda: splatline.Design(mantissa=40),
        "unknown key 'lane': did you mean lanes": lambda: splatline.Machine(lane=1),
        "lanes = 3: allowed are 1, 2, 4": lambda: splatline.Machine(lanes=3),
        "centres has the shape": lambda: splatline.Scene.from_arrays([[1, 2]], [1.0], [[1, 1, 1]], axes=[np.eye(3)]),
        "centres\\[1\\] holds a number that is not finite": lambda: splatline.Scene.from_arrays(
            [[1, 2, 3], [1, 2, np.nan]], [1.0, 1.0], np.ones((2, 3)), scales=np.ones((2, 3))
        ),
        "must lie between 0 and 180": lambda: splatline.Camera.look_at((0, 0, 0), (0, 0, 1), (0, 1, 0), fov=200),
        "unknown rules 'x'": lambda: splatline.render(scene, camera, rules="x"),
    }.items():
        with pytest.raises(splatline.Error, match=wrong):
            words()


def test_options_of_the_command_line_make_a_plan(tmp_path):
    plan = splatline.Plan.from_options(["random:300", "--size", "64x48", "--design", "lean18", "--compositing", "x-ray"])
    same = splatline.plan("random:300", plan.camera, "lean18", compositing="x-ray")
    assert (splatline.render(plan).rgba == splatline.render(same).rgba).all()
    with pytest.raises(splatline.Error, match="unexpected argument '--sise'"):
        splatline.Plan.from_options(["random:300", "--sise", "64x48"])


def test_cameras_of_others(tmp_path):
    camera = splatline.Camera.look_at(**EYE, fov=50, size=(100, 80))
    assert np.allclose(camera.eye, EYE["eye"])
    (tmp_path / "camera.json").write_text(camera.to_json())
    assert splatline.Camera.load(tmp_path / "camera.json") == camera
    assert [name for name, _ in splatline.Camera.load_all(tmp_path / "camera.json")] == ["camera.json"]
    assert camera.world_to_camera.shape == (3, 4) and camera.resized(50, 40).size == (50, 40)


def test_pictures_are_saved_as_the_command_line_saves_them(tmp_path, scene, camera):
    (tmp_path / "camera.json").write_text(camera.to_json())
    picture = splatline.render(scene, camera)
    for name in ("a.png", "a.npy", "a.exr"):
        picture.save(tmp_path / name)
        assert command("render", "random:300", "--camera", "camera.json", "-o", f"line-{name}", folder=tmp_path).returncode == 0
        assert (tmp_path / name).read_bytes() == (tmp_path / f"line-{name}").read_bytes()


def test_machines_and_searches_are_the_command_lines(tmp_path, scene, camera):
    (tmp_path / "camera.json").write_text(camera.to_json())
    view = ["random:300", "--camera", "camera.json"]
    record = splatline.simulate(scene, camera, machine=splatline.Machine("machine-4"), part="xc7a100t")
    assert command("simulate", *view, "--machine", "machine-4", "--part", "xc7a100t", "-o", "timing", folder=tmp_path).returncode == 0
    written = json.loads((tmp_path / "timing" / "timing.json").read_text())
    for same in ("cycles", "pace", "area", "energy"):
        assert json.loads(json.dumps(record[same])) == written[same]
    units = record.units
    causes = [name for name in units.dtype.names if name not in ("name",)]
    assert len(units) == len(record["cycles"]["units"]) and sum(units[name].sum() for name in causes) > 0

    fitted = splatline.fit(scene, {"rms_error": 1e-3}, camera)
    assert command("fit", *view, "--metric", "rms", "--max-error", "1e-3", "-o", "fit.toml", folder=tmp_path).returncode == 0
    assert splatline.Design(str(tmp_path / "fit.toml")).widths == fitted["widths"]
    with pytest.raises(splatline.Error, match="standard24 itself has rms error"):
        splatline.fit(scene, {"rms_error": 0.0}, camera)

    space = "[machine]\nlanes = [1, 2, 4, 8]\n"
    answer = splatline.optimize(scene, {"frames_per_second": 100.0}, camera, space=space)
    (tmp_path / "space.toml").write_text(space)
    assert command("optimize", *view, "--fps", "100", "--space", "space.toml", "-o", "answer", folder=tmp_path).returncode == 0
    written = json.loads((tmp_path / "answer" / "answer.json").read_text())["answer"]
    assert answer["holds"] and answer["found"][0]["machine"] == written["found"][0]["machine"]


def test_footprints_are_named(scene, camera):
    fixed, real = (splatline.footprints(scene, camera, engine=engine) for engine in ("fixed", "float"))
    assert len(fixed) == 300 and np.nanmax(abs(fixed["u"] - real["u"])) < 1e-3


def test_what_no_call_takes_is_said_by_name(scene, camera):
    arrays = {"centres": np.zeros((2, 3)), "weights": [0.5, 0.5], "colours": np.ones((2, 3)), "scales": np.ones((2, 3))}
    stages = splatline.Stages(scene, camera)
    packet = stages.setup([0]).words
    for call, words in [
        (lambda: splatline.Scene.from_arrays(**{**arrays, "centres": np.zeros(3)}), r"centres has the shape \(3,\): allowed are 2 dim"),
        (lambda: splatline.Scene.from_arrays(**{**arrays, "colours": None}), "colours has the shape"),
        (lambda: splatline.Scene.from_arrays(**{**arrays, "scales": 1.0}), "scales has the shape"),
        (lambda: splatline.Scene.from_arrays(**{**arrays, "scales": None, "axes": np.ones((2, 3, 3)), "rotations": np.ones((2, 4))}), "not both"),
        (lambda: splatline.metrics(np.zeros((5, 5)), np.zeros((5, 5))), "picture has the shape"),
        (lambda: splatline.render(scene, camera, style={"threshold": 1.0}), "splats have rules and no style"),
        (lambda: splatline.render(scene, camera, threads=10**6), "threads = 1000000: expected a whole number"),
        (lambda: splatline.render(scene, camera, rules=splatline.Rules("3dgs", low_pass=np.nan)), "low_pass is not finite"),
        (lambda: splatline.render(scene, camera, rules=splatline.Rules("3dgs", alpha_max=5)), "alpha_max = 5: allowed is 0 to 1"),
        (lambda: splatline.fit(scene, {"psnr_db": np.inf}, camera), "psnr_db is inf: expected a finite number"),
        (lambda: splatline.fit(scene, {"frames_per_second": 60}, camera), "and no others"),
        (lambda: splatline.fit(scene, {"psnr_db": 500}, camera), "below psnr_db 500.00"),
        (lambda: stages.tile(packet[0]), "packets has the shape"),
        (lambda: stages.spans(packet), "packet has the shape"),
        (lambda: stages.setup([True, False]), "splats must hold their numbers, not bool"),
    ]:
        with pytest.raises(splatline.Error, match=words):
            call()
    with pytest.raises(ValueError, match="length 3"):
        splatline.Scene.from_arrays(**arrays, up=(0, -1, 0, 5))
    assert len(stages.setup([]).sorted()) == 0


def test_quaternions_of_any_length_turn(camera):
    arrays = {"centres": np.zeros((1, 3)), "weights": [0.5], "colours": np.ones((1, 3)), "scales": [[1.0, 2.0, 3.0]]}
    turns = np.array([[1.0, -2.0, 0.5, 3.0]])
    axes = [splatline.Scene.from_arrays(**arrays, rotations=turns * size).axes for size in (1.0, 2.0**1000, 2.0**-1000)]
    assert (axes[0] == axes[1]).all() and (axes[0] == axes[2]).all()


def test_pictures_without_a_difference_have_an_infinite_psnr(camera):
    nothing = splatline.Scene.from_arrays(np.zeros((0, 3)), [], np.zeros((0, 3)), scales=np.zeros((0, 3)))
    comparison = splatline.compare(nothing, camera)
    assert comparison.psnr_db == np.inf and comparison.record["error"]["rgb"]["identical"]
