"""Studies on executors of all kinds; workers are killed for real."""

import csv
import json
import multiprocessing
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import textwrap
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import pytest
import splatline
from splatline import study as module
from splatline.study import RESULTS, Study

SPACE = """
[design]
base = ["lean18", "standard24"]
[machine]
tile_width = [8, 16]
lanes = [1, 4]
layout = ["run", "quad"]
row_cycles = [1, 3]
"""


@pytest.fixture(scope="module")
def plan(scene, camera):
    return splatline.plan(scene, camera)


def results(study):
    return {key: values for key, (values, _) in study.stored().items()}


@pytest.fixture(scope="module")
def complete(plan, tmp_path_factory):
    """All points, by two processes of this machine."""
    study = Study(tmp_path_factory.mktemp("whole") / "study.sqlite", plan, SPACE)
    assert study.run(workers=2) == 32
    return study


def test_points_are_those_of_the_command_lines_sweep(complete, tmp_path, camera):
    (tmp_path / "camera.json").write_text(camera.to_json())
    (tmp_path / "space.toml").write_text(SPACE)
    words = ["sweep", "random:300", "--camera", "camera.json", "--space", "space.toml", "-o", "out"]
    subprocess.run([sys.executable, "-m", "splatline", *words], check=True, capture_output=True, cwd=tmp_path)
    known = results(complete)
    for line in csv.DictReader((tmp_path / "out" / "points.csv").open()):
        point = {key: type(values[0])(line[key]) for key, values in complete.axes.items()}
        assert known.pop(json.dumps(point, sort_keys=True)) == [line[name] for name in RESULTS]
    assert not known
    complete.write(tmp_path / "study")
    for name in ("points.csv", "front.csv", "front.html"):
        ours, theirs = ((tmp_path / folder / name).read_text() for folder in ("study", "out"))
        assert len(ours.splitlines()) == len(theirs.splitlines())
    assert "<svg" in (tmp_path / "study" / "front.html").read_text()


def test_rows_have_numbers_and_reasons(complete):
    rows = complete.rows()
    left_out = [row for row in rows if "left_out" in row]
    assert len(left_out) == 8 and all("2 or more lanes" in row["left_out"] for row in left_out)
    assert all(row["psnr_db"] > 50 and row["cycles"] > 0 for row in rows if row not in left_out)
    pandas = pytest.importorskip("pandas")
    assert isinstance(complete.frame(), pandas.DataFrame) and len(complete.frame()) == 32


def test_parquet_holds_the_rows(complete, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    complete.parquet(tmp_path / "points.parquet")
    table = parquet.read_table(tmp_path / "points.parquet")
    known = [{name: row.get(name) for name in table.column_names} for row in complete.rows()]
    assert table.to_pylist() == known and table.schema.metadata[b"splatline"].decode() == complete.identity


def test_what_is_stored_is_not_run_again(complete, plan, tmp_path):
    path = tmp_path / "study.sqlite"
    shutil.copy(complete.path, path)
    with sqlite3.connect(path) as database:
        database.execute("DELETE FROM splatline_points WHERE rowid % 4 = 0")
    again = Study(path, plan, SPACE)
    before = len(again.stored())
    assert again.run(workers=1) == 32 - before and again.run(workers=1) == 0
    # Also in their order, although every fourth one came last.
    assert list(results(again).items()) == list(results(complete).items())


def test_what_was_edited_is_found(complete, plan, tmp_path):
    path = tmp_path / "study.sqlite"
    shutil.copy(complete.path, path)
    with sqlite3.connect(path) as database:
        database.execute("UPDATE splatline_points SET results = replace(results, '1', '2') WHERE rowid = 5")
    with pytest.raises(splatline.Error, match="not as it was written"):
        Study(path, plan, SPACE).run(workers=1)
    with pytest.raises(splatline.Error, match="another camera"):
        Study(path, splatline.plan(plan.scene, plan.camera.resized(32, 24)), SPACE)


def workers():
    """Processes that compute for this one."""
    return [child.pid for child in multiprocessing.active_children()]


def killing(study, victims):
    """The same study, which kills one of its workers as soon as the first points are stored; the list of those that were killed."""
    store, killed = study._store, []

    def storing(*arguments):
        store(*arguments)
        if not killed:
            killed.append(next(iter(victims())))
            os.kill(killed[0], signal.SIGKILL)

    study._store = storing
    return killed


def test_a_killed_process_costs_its_points_only(complete, plan, tmp_path):
    study = Study(tmp_path / "study.sqlite", plan, SPACE)
    killed = killing(study, workers)
    study.run(workers=2)
    assert killed and results(study) == results(complete)


def test_a_search_survives_a_killed_process(complete, plan, tmp_path):
    pytest.importorskip("optuna")
    study = Study(tmp_path / "study.sqlite", plan, SPACE)
    killed = killing(study, workers)
    found = study.search({"area": "minimize"}, trials=12, workers=2)
    known = results(complete)
    assert killed and len(found.trials) == 12 and not any(row["failure"] for row in study.rows())
    assert all(known[key] == values for key, values in results(study).items())


def test_a_point_that_ends_its_worker_twice_is_stored_as_failed(complete, plan, tmp_path):
    class Deadly:
        """One point in three is the end of whoever computes it."""

        def __init__(self):
            self.local = module.LocalExecutor(2)

        def submit(self, function, setup, points):
            deadly = any(point[-1] == 1 and point[0] == 0 for point in points)
            return self.local.submit(os._exit, 3) if deadly else self.local.submit(function, setup, points)

    study = Study(tmp_path / "study.sqlite", plan, SPACE)
    executor = Deadly()
    study.run(executor, workers=2)
    executor.local.shutdown()
    failed = [row for row in study.rows() if row["failure"]]
    assert len(study.rows()) == 32 and len(failed) == 8
    assert all("BrokenProcessPool" in row["failure"] for row in failed)
    assert study.run(workers=2) == 0
    assert study.forget_failures() == 8 and study.run(workers=2) == 8
    assert results(study) == results(complete)


def test_a_killed_scheduler_loses_nothing_that_was_stored(complete, camera, tmp_path):
    (tmp_path / "camera.json").write_text(camera.to_json())
    program = """
        import splatline
        from splatline.study import Study
        if __name__ == "__main__":
            plan = splatline.plan("random:300", splatline.Camera.load("camera.json"))
            Study("study.sqlite", plan, open("space.toml").read()).run(workers=1)
    """
    (tmp_path / "program.py").write_text(textwrap.dedent(program))
    (tmp_path / "space.toml").write_text(SPACE)
    running = subprocess.Popen([sys.executable, "program.py"], cwd=tmp_path)

    def count():
        with sqlite3.connect(tmp_path / "study.sqlite", timeout=30) as database:
            return database.execute("SELECT count(*) FROM splatline_points").fetchone()[0]

    def points():
        try:
            return count()
        except sqlite3.OperationalError:
            return 0

    deadline = time.time() + 120
    while points() == 0 and time.time() < deadline:
        time.sleep(0.01)
    running.send_signal(signal.SIGKILL)
    running.wait()
    stored = points()
    assert stored > 0
    subprocess.run([sys.executable, "program.py"], cwd=tmp_path, check=True)
    plan = splatline.plan("random:300", splatline.Camera.load(tmp_path / "camera.json"))
    assert results(Study(tmp_path / "study.sqlite", plan, SPACE)) == results(complete)


def test_any_pool_of_the_standard_library_runs_it(complete, plan, tmp_path):
    for name, pool in {
        "threads": ThreadPoolExecutor(2),
        "processes": ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")),
    }.items():
        with pool:
            study = Study(tmp_path / f"{name}.sqlite", plan, SPACE)
            study.run(pool, workers=2)
        assert results(study) == results(complete)


def test_dask_runs_it_with_a_worker_killed(complete, plan, tmp_path):
    distributed = pytest.importorskip("dask.distributed")
    with distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        study = Study(tmp_path / "study.sqlite", plan, SPACE)
        killed = killing(study, lambda: client.run(os.getpid).values())
        study.run(client.get_executor(), workers=2)
    assert killed and results(study) == results(complete)


def slurm_is_up():
    if not shutil.which("sinfo"):
        return False
    return subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True, timeout=20).stdout.split("\n")[0] in ("idle", "mixed")


def test_slurm_runs_an_array_of_jobs(complete, plan, tmp_path_factory):
    submitit = pytest.importorskip("submitit")
    if not slurm_is_up():
        pytest.skip("there is no Slurm: sinfo names no idle node (sim/python/tests/slurm.sh starts one on this machine)")
    # A folder that the jobs see as well.
    folder = tmp_path_factory.mktemp("slurm")
    executor = submitit.AutoExecutor(folder / "logs", cluster="slurm")
    executor.update_parameters(timeout_min=5, cpus_per_task=1, slurm_array_parallelism=2, slurm_use_srun=False)
    study = Study(folder / "study.sqlite", plan, SPACE)
    assert study.run(executor, workers=2) == 32
    assert results(study) == results(complete)


def test_ray_runs_it(complete, plan, tmp_path):
    ray = pytest.importorskip("ray")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        study = Study(tmp_path / "study.sqlite", plan, SPACE)
        study.run(module.RayExecutor(), workers=2)
        assert results(study) == results(complete)
    finally:
        ray.shutdown()


def test_mpi_runs_it(complete, plan, camera, tmp_path):
    pytest.importorskip("mpi4py")
    if not shutil.which("mpirun"):
        pytest.skip("mpirun is not installed")
    (tmp_path / "camera.json").write_text(camera.to_json())
    (tmp_path / "space.toml").write_text(SPACE)
    program = """
        import splatline
        from mpi4py.futures import MPIPoolExecutor
        from splatline.study import Study
        if __name__ == "__main__":
            plan = splatline.plan("random:300", splatline.Camera.load("camera.json"))
            with MPIPoolExecutor() as pool:
                assert Study("study.sqlite", plan, open("space.toml").read()).run(pool, workers=2, threads=1) == 32
    """
    (tmp_path / "program.py").write_text(textwrap.dedent(program))
    words = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "3", sys.executable, "-m", "mpi4py.futures", "program.py"]
    said = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert said.returncode == 0, said.stderr[-3000:]
    assert results(Study(tmp_path / "study.sqlite", plan, SPACE)) == results(complete)


class Counting:
    """Threads that count how often each point is computed, and are slow enough for trials to meet in flight."""

    def __init__(self):
        self.threads, self.points = ThreadPoolExecutor(4), Counter()

    def submit(self, function, setup, points):
        self.points.update(map(tuple, points))
        return self.threads.submit(lambda: time.sleep(0.05) or function(setup, points))


def test_identical_points_are_run_once(plan, tmp_path):
    pytest.importorskip("optuna")
    executor, objectives = Counting(), {"area": "minimize", "cycles": "minimize"}
    space = '[design]\nbase = ["lean18", "standard24"]\n[machine]\nlanes = [1, 2]\n'
    study = Study(tmp_path / "study.sqlite", plan, space)
    found = study.search(objectives, trials=24, sampler="nsga2", executor=executor, workers=4)
    assert all(trial.state.name == "COMPLETE" for trial in found.trials) and len(found.trials) == 24
    study.run(executor, workers=4)
    executor.threads.shutdown()
    assert len(executor.points) == 4 and set(executor.points.values()) == {1}


@pytest.mark.parametrize("sampler", ["tpe", "nsga2"])
def test_optuna_searches_with_trials_in_flight(complete, plan, tmp_path, sampler):
    pytest.importorskip("optuna")
    path = tmp_path / "study.sqlite"
    study = Study(path, plan, SPACE)
    found = study.search({"area": "minimize", "cycles": "minimize"}, limits={"psnr_db": (60, None)}, trials=20, sampler=sampler, workers=2)
    known = results(complete)
    assert len(found.trials) == 20 and all(known[key] == values for key, values in results(study).items())
    # Resumed, and no trial of a point that is stored runs again.
    assert len(Study(path, plan, SPACE).search({"area": "minimize", "cycles": "minimize"}, limits={"psnr_db": (60, None)}, trials=22, sampler=sampler, workers=2).trials) == 22


def test_digests_are_over_identity_point_and_results(complete):
    database = sqlite3.connect(complete.path)
    for point, text, digest in database.execute("SELECT point, results, digest FROM splatline_points"):
        assert digest == module._digest(complete.identity, point, text, "")
