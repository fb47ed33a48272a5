"""Sweeps and searches over designs and machines, on executors of any kind.

    import splatline
    from splatline.study import Study

    if __name__ == "__main__":
        study = Study("study.sqlite", "guitar.ply", open("space.toml").read())
        study.run(workers=2)                                  # processes of this machine, or:
        study.run(dask_client.get_executor())                 # anything with submit(): concurrent.futures, mpi4py, Dask,
        study.run(submitit.AutoExecutor("logs"))              # submitit (one array of jobs on Slurm),
        study.run(RayExecutor())                              # Ray
        study.search({"area": "minimize", "psnr_db": "maximize"}, trials=200, workers=2)    # Optuna
        study.frame()                                         # a DataFrame
        study.write("out")                                    # points.csv, front.csv and front.html, as `splatline sweep` writes them
        study.parquet("points.parquet")                       # the rows, where pyarrow is installed

Every point is stored in one SQLite file as its results arrive, with a digest over what it is of and what came out. Who runs the same study
again goes on where it stopped; a point that is stored is not run again, whoever asked for it. A worker that dies costs the points that it was
at: they are tried again one by one, and one that ends its worker twice is stored as failed. Workers only compute: the file is written by the
process that runs the study, and read by whom you like.
"""

from __future__ import annotations

import concurrent.futures
import hashlib
import json
import multiprocessing
import os
import pickle
import sqlite3
import sys
import time
from collections import deque
from os import PathLike
from pathlib import Path
from typing import Any

from . import _native
from ._calls import SceneLike
from ._calls import plan as _plan

#: Names of the results of a point, in their order; what they mean is said in docs/results.
RESULTS: list[str] = _native.result_names()

#: Seconds between two looks at jobs that cannot be waited for.
_POLL = 0.02
#: How often a point that ends its worker is tried.
_TRIES = 2
#: Points of a job at most.
_MOST = 50

_SCHEMA = """
CREATE TABLE IF NOT EXISTS splatline_study (id INTEGER PRIMARY KEY CHECK (id = 1), identity TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS splatline_points (
    point TEXT PRIMARY KEY,      -- its values by axis, JSON with sorted keys
    results TEXT NOT NULL,       -- in the order of RESULTS, JSON
    failure TEXT,                -- why there are none
    digest TEXT NOT NULL,        -- SHA-256 of identity, point, results and failure
    stored_at REAL NOT NULL      -- seconds since 1970
);
"""


def _digest(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


_evaluations: dict[str, _native.Evaluation] = {}


def evaluate(setup: bytes, points: list[list[int]]) -> list[list[str]]:
    """What a worker does: results of points, each an index into every axis's values. Frames and references are kept for the next call."""
    key = hashlib.sha256(setup).hexdigest()
    if key not in _evaluations:
        _evaluations.clear()
        _evaluations[key] = _native.Evaluation(*pickle.loads(setup))
    return _evaluations[key].run(points)


class LocalExecutor:
    """Processes of this machine, each replaced where it dies: one that is killed takes no other's work with it.

    `alike` is how many leading indices of a job's first point say which pictures it needs: a worker is given jobs like its last one.
    """

    def __init__(self, workers: int, alike: int = 0):
        self._pools = [self._pool() for _ in range(workers)]
        self._free = deque(range(workers))
        self._waiting: list = []
        self._alike, self._last = alike, [None] * workers

    @staticmethod
    def _pool():
        # Spawned, not forked: threads of the parent would be missing in the child.
        return concurrent.futures.ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn"))

    def submit(self, function, *arguments):
        future: concurrent.futures.Future = concurrent.futures.Future()
        self._waiting.append((future, function, arguments))
        self._start()
        return future

    def _start(self):
        while self._free and self._waiting:
            place = self._free.popleft()
            future, function, arguments = self._waiting.pop(self._next(place))
            try:
                job = self._pools[place].submit(function, *arguments)
            except concurrent.futures.BrokenExecutor:
                self._pools[place] = self._pool()
                job = self._pools[place].submit(function, *arguments)
            job.add_done_callback(lambda job, future=future, place=place: self._ended(job, future, place))

    def _next(self, place) -> int:
        """Which job: one for whose pictures the worker has the errors, or one that no other worker is at, or the first."""
        if not self._alike:
            return 0
        keys = [arguments[-1][0][: self._alike] for *_, arguments in self._waiting]
        own = self._last[place]
        free = [key for key in keys if key not in self._last]
        key = own if own in keys else free[0] if free else keys[0]
        self._last[place] = key
        return keys.index(key)

    def _ended(self, job, future, place):
        failure = job.exception()
        if isinstance(failure, concurrent.futures.BrokenExecutor):
            self._pools[place] = self._pool()
        self._free.append(place)
        self._start()
        if failure is None:
            future.set_result(job.result())
        else:
            future.set_exception(failure)

    def shutdown(self):
        for pool in self._pools:
            pool.shutdown(wait=False, cancel_futures=True)


class RayExecutor:
    """Ray's tasks as an executor; `options` are those of `ray.remote`, num_cpus and the like."""

    def __init__(self, **options: Any):
        self._options = {"max_retries": 0, **options}

    def submit(self, function, *arguments):
        import ray

        return _RayTask(ray.remote(**self._options)(function).remote(*arguments))


class _RayTask:
    def __init__(self, reference):
        self._reference = reference

    def done(self):
        import ray

        return bool(ray.wait([self._reference], timeout=0)[0])

    def result(self):
        import ray

        return ray.get(self._reference)


class Study:
    """A space of designs and machines over frames, and the file that holds what is known of its points.

    path    SQLite file, made if it is not there
    frames  a scene, a path, a `Plan`, or a list of them; design and machine of the first are where the space starts
    space   text of a space file: [design], [machine], and for a sweep sample, count and seed
    errors  compare with the reference (PSNR and the rest); similarity  also SSIM, which takes thirty times as long as drawing
    part    whose prices of area count
    """

    def __init__(
        self,
        path: str | PathLike[str],
        frames: SceneLike | list[SceneLike],
        space: str,
        *,
        errors: bool = True,
        similarity: bool = True,
        part: str | None = None,
    ):
        frames = list(frames) if isinstance(frames, (list, tuple)) else [frames]
        self.plans = [_plan(frame) for frame in frames]
        self.path, self.text = Path(path), space
        self._points: list[list[int]] | None = None
        axes = _native.Space(space, points=False).axes()
        #: Values of every axis, the dearest first.
        self.axes: dict[str, list] = {key: values for key, values, _ in axes}
        self._parts = [changes for *_, changes in axes]
        self._errors, self._similarity, self._part = errors, similarity, part
        identity = json.loads(_native.identity(self.plans, space, part))
        # The space decides which points there are and not what comes of one: another may share the file.
        del identity["space"]
        self.identity = json.dumps({**identity, "errors": errors, "similarity": similarity}, sort_keys=True)
        self._database = sqlite3.connect(self.path, timeout=60)
        with self._database:
            self._database.executescript(_SCHEMA)
            known = self._database.execute("SELECT identity FROM splatline_study").fetchone()
            if known is None:
                self._database.execute("INSERT INTO splatline_study VALUES (1, ?)", (self.identity,))
            elif known[0] != self.identity:
                there, here = json.loads(known[0]), json.loads(self.identity)
                different = [name for name in here if here[name] != there.get(name)]
                raise _native.Error(f"{self.path}: holds a study with another {', '.join(different)}: name another file")

    # What is stored.

    def _key(self, point) -> str:
        return json.dumps({key: values[index] for (key, values), index in zip(self.axes.items(), point)}, sort_keys=True)

    def stored(self) -> dict[str, tuple[list[str], str | None]]:
        """Results and failure by the point's key, each checked against its digest; in the keys' order, whoever came first."""
        found = {}
        query = "SELECT point, results, failure, digest FROM splatline_points ORDER BY point"
        for point, results, failure, digest in self._database.execute(query):
            if digest != _digest(self.identity, point, results, failure or ""):
                raise _native.Error(f"{self.path}: the point {point} is not as it was written: delete it, and run the study again")
            found[point] = (json.loads(results), failure)
        return found

    def _store(self, points, all_results, failure=None):
        rows = []
        for point, results in zip(points, all_results):
            key, text = self._key(point), json.dumps(results)
            rows.append((key, text, failure, _digest(self.identity, key, text, failure or ""), time.time()))
        with self._database:
            self._database.executemany("INSERT OR IGNORE INTO splatline_points VALUES (?, ?, ?, ?, ?)", rows)

    # Running points.

    def _setup(self, threads) -> bytes:
        return pickle.dumps((self.plans, self.text, self._errors, self._similarity, self._part, threads))

    @property
    def points(self) -> list[list[int]]:
        """The space's points, each an index into every axis's values."""
        if self._points is None:
            self._points = _native.Space(self.text).points()
        return self._points

    def _jobs(self, points, workers):
        """Points that share pictures and rows together, in jobs small enough that all workers end at about the same time."""
        most = max(1, min(_MOST, len(points) // (4 * workers)))
        shared = [place for place, part in enumerate(self._parts) if part in ("design", "tile")]
        jobs, last = [], None
        for point in points:
            key = [point[place] for place in shared]
            if key != last or len(jobs[-1]) >= most:
                jobs.append([])
            jobs[-1].append(point)
            last = key
        return jobs

    def run(self, executor: Any = None, *, workers: int | None = None, threads: int | None = None, progress: bool | None = None) -> int:
        """Evaluates all points of the space that are not stored; the number of those that are new.

        executor  anything with submit(function, *arguments) whose jobs have done() and result(); without one, processes of this machine
        workers   how many of them; for other executors, how finely the work is cut
        threads   of each worker; for local processes an equal share of the processors, for others all that the job may use
        """
        known = self.stored()
        missing, seen = [], set()
        for point in self.points:
            key = self._key(point)
            if key not in known and key not in seen:
                missing.append(point)
                seen.add(key)
        processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        workers = workers or processors
        local = LocalExecutor(workers, self._parts.count("design")) if executor is None else None
        if local:
            threads = threads or max(1, processors // workers)
        try:
            self._run(local or executor, missing, self._setup(threads), workers, progress)
        finally:
            if local:
                local.shutdown()
        return len(missing)

    def _run(self, executor, points, setup, workers, progress):
        jobs = self._jobs(points, workers)
        bar = _Progress(len(points), progress)
        if hasattr(executor, "map_array") and jobs:
            # submitit: one array instead of as many jobs.
            flights = executor.map_array(evaluate, [setup] * len(jobs), jobs)
        else:
            flights = [executor.submit(evaluate, setup, job) for job in jobs]
        open_: dict = {id(flight): (flight, job, 1) for flight, job in zip(flights, jobs)}
        while open_:
            _wait([flight for flight, *_ in open_.values()])
            for flight, job, tries in [entry for entry in open_.values() if entry[0].done()]:
                del open_[id(flight)]
                found, lost = _outcome(flight)
                if lost:
                    again = [[point] for point in job] if len(job) > 1 else [job] if tries < _TRIES else []
                    for points_ in again:
                        flight = executor.submit(evaluate, setup, points_)
                        open_[id(flight)] = (flight, points_, 1 if len(job) > 1 else tries + 1)
                    if again:
                        continue
                self._store(job, found, lost)
                bar.advance(len(job))
        bar.close()

    # Searching.

    def search(
        self,
        objectives: dict[str, Any],
        *,
        limits: dict[str, tuple[float | None, float | None]] | None = None,
        trials: int,
        executor: Any = None,
        workers: int = 2,
        threads: int | None = None,
        sampler: Any = "tpe",
        seed: int = 1,
        progress: bool | None = None,
    ) -> Any:
        """Searches the space by Optuna with `workers` trials in flight; the Optuna study, which lies in the same file.

        objectives  result -> "minimize" or "maximize"
        limits      result -> (least, most), either of them None
        sampler     "tpe", "nsga2", or a sampler of Optuna's
        """
        import optuna

        limits = limits or {}
        if sampler == "tpe":
            sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True, constant_liar=True)
        elif sampler == "nsga2":
            sampler = optuna.samplers.NSGAIISampler(seed=seed)
        name = _digest(self.identity, json.dumps([objectives, {key: list(bounds) for key, bounds in limits.items()}]))[:16]
        storage = optuna.storages.RDBStorage(f"sqlite:///{self.path}", engine_kwargs={"connect_args": {"timeout": 60}})
        study = optuna.create_study(
            storage=storage, study_name=name, sampler=sampler, directions=list(objectives.values()), load_if_exists=True
        )
        done = sum(trial.state.is_finished() for trial in study.trials)
        setup = self._setup(threads)
        local = LocalExecutor(workers) if executor is None else None
        if local:
            setup = self._setup(threads or max(1, (os.cpu_count() or 1) // workers))
        executor = local or executor
        bar, left = _Progress(max(0, trials - done), progress), trials - done
        # Trials of the same point wait for the same job.
        open_: dict[str, tuple] = {}
        try:
            while left > 0 or open_:
                while left > 0 and sum(len(waiting) for *_, waiting in open_.values()) < workers:
                    left -= 1
                    trial = study.ask()
                    point = [_suggest(trial, key, values) for key, values in self.axes.items()]
                    key, known = self._key(point), self.stored_point(point)
                    if known is not None:
                        _tell(study, trial, known, objectives, limits)
                        bar.advance(1)
                    elif key in open_:
                        open_[key][-1].append(trial)
                    else:
                        open_[key] = (executor.submit(evaluate, setup, [point]), point, 1, [trial])
                if not open_:
                    continue
                _wait([flight for flight, *_ in open_.values()])
                for key, (flight, point, tries, waiting) in [entry for entry in open_.items() if entry[1][0].done()]:
                    found, lost = _outcome(flight)
                    if lost and tries < _TRIES:
                        open_[key] = (executor.submit(evaluate, setup, [point]), point, tries + 1, waiting)
                        continue
                    del open_[key]
                    self._store([point], found, lost)
                    for trial in waiting:
                        _tell(study, trial, self.stored_point(point), objectives, limits)
                    bar.advance(len(waiting))
        finally:
            if local:
                local.shutdown()
            bar.close()
        return study

    def forget_failures(self) -> int:
        """Lets the next run try again what is stored as failed; how many points that are."""
        with self._database:
            return self._database.execute("DELETE FROM splatline_points WHERE failure IS NOT NULL").rowcount

    def stored_point(self, point: list[int]) -> dict[str, Any] | None:
        """Results of a point by name, empty if it was left out or failed; None if it is not stored."""
        row = self._database.execute("SELECT results FROM splatline_points WHERE point = ?", (self._key(point),)).fetchone()
        return None if row is None else _numbers(json.loads(row[0]))

    # What came of it.

    def rows(self) -> list[dict[str, Any]]:
        """Every stored point: its values by axis, its results by name, and `failure`."""
        return [{**json.loads(point), **_numbers(results), "failure": failure} for point, (results, failure) in self.stored().items()]

    def frame(self) -> Any:
        """The same as a pandas DataFrame."""
        import pandas

        return pandas.DataFrame(self.rows())

    def parquet(self, path: str | PathLike[str]) -> None:
        """The same as a Parquet file, with what the study is of as its metadata."""
        import pyarrow
        import pyarrow.parquet

        rows = self.rows()
        names = dict.fromkeys(name for row in rows for name in row)
        table = pyarrow.table({name: [row.get(name) for row in rows] for name in names})
        pyarrow.parquet.write_table(table.replace_schema_metadata({"splatline": self.identity}), path)

    def write(self, folder: str | PathLike[str], title: str | None = None) -> None:
        """points.csv, front.csv and front.html, as `splatline sweep` writes them."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        found = [(json.loads(point), results) for point, (results, failure) in self.stored().items() if failure is None]
        texts = [[value if isinstance(value, str) else json.dumps(value) for value in map(point.get, self.axes)] + results for point, results in found]
        title = title or f"Speed, error and area: {self.plans[0].scene.name}"
        for name, text in zip(("points.csv", "front.csv", "front.html"), _native.sweep_pages(title, list(self.axes), texts, self._part)):
            (folder / name).write_text(text)


def _numbers(results: list[str]) -> dict:
    """Results by name; empty fields are left out."""
    named = ((name, text) for name, text in zip(RESULTS, results) if text)
    return {name: text if name == "left_out" else float(text) for name, text in named}


def _suggest(trial, key, values) -> int:
    """Numbers at equal distances have an order, which a sampler uses; all else are names."""
    steps = {after - before for before, after in zip(values, values[1:])} if all(type(value) is int for value in values) else set()
    if len(steps) == 1 and min(steps) > 0:
        return values.index(trial.suggest_int(key, values[0], values[-1], step=min(steps)))
    return values.index(trial.suggest_categorical(key, values))


def _tell(study, trial, results, objectives, limits):
    import optuna

    if not all(name in results for name in [*objectives, *limits]):
        study.tell(trial, state=optuna.trial.TrialState.FAIL)
        return
    for name, (least, most) in limits.items():
        if least is not None:
            trial.set_constraint(f"{name} at least", least - results[name])
        if most is not None:
            trial.set_constraint(f"{name} at most", results[name] - most)
    study.tell(trial, [results[name] for name in objectives])


def _outcome(flight):
    """A job's results, or none and why: how a worker dies is told by every executor in its own way."""
    try:
        return flight.result(), None
    except _native.Error:
        # What is wrong with one point of a space is wrong with the space.
        raise
    except Exception as failure:
        return [[]], f"{type(failure).__name__}: {failure}"


def _wait(flights):
    """Until one of the jobs may have ended."""
    if all(isinstance(flight, concurrent.futures.Future) for flight in flights):
        concurrent.futures.wait(flights, return_when=concurrent.futures.FIRST_COMPLETED)
    elif not any(flight.done() for flight in flights):
        time.sleep(_POLL)


class _Progress:
    """Points done and seconds left, on a terminal only."""

    def __init__(self, total: int, shown: bool | None):
        self.total, self.done, self.began = total, 0, time.time()
        self.shown = sys.stderr.isatty() if shown is None else shown

    def advance(self, points: int):
        self.done += points
        if self.shown:
            left = (time.time() - self.began) / self.done * (self.total - self.done)
            print(f"\r{self.done} of {self.total} points, {left:.0f} s left ", end="", file=sys.stderr, flush=True)

    def close(self):
        if self.shown and self.done:
            print(file=sys.stderr)
