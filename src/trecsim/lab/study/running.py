"""Execute the runs of a study in parallel; each is stored when done, none is done twice."""

import hashlib
import json
import multiprocessing
import os
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

from trecsim.callbacks import Progress, Remark
from trecsim.errors import Error, SetupError
from trecsim.fusion import FusionSettings
from trecsim.lab.evaluation.ground_truth import compare
from trecsim.lab.study.code_digest import code_changed, code_digest
from trecsim.lab.study.folder import STUDY, changed_parts, check_folder
from trecsim.lab.study.plan import Study, settings_of
from trecsim.lab.study.runs_file import NAME, Run, opened, read_runs
from trecsim.lab.study.scenes import SceneChoice, load, prepare
from trecsim.lab.study.settings_file_table import toml_of
from trecsim.store.atomic import atomic_write, disk_faults
from trecsim.tracking import Tally, follow

_ONE_THREAD = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_LONGEST_FAULT = 500
Task = TypeVar("Task")


@dataclass(frozen=True, slots=True)
class Job:
    """One run to execute; `values` are the settings that the study varies."""

    key: str
    choice: SceneChoice
    seed: int | None
    out: Path
    settings: FusionSettings
    values: dict[str, Any]
    lag_s: float


@dataclass(frozen=True, slots=True)
class Done:
    """Number of runs of a study, of those executed now, and of those that failed."""

    runs: int
    made: int
    failed: int


def jobs_of(study: Study, out: Path) -> list[Job]:
    """Return all runs of a study, scene by scene."""
    lag_s = study.table.lag_s
    points = [(settings_of(study.design, point), point) for point in study.design.points]
    names = [factor.name for factor in study.design.factors]
    return [
        Job(
            key_of(choice, seed, settings, lag_s),
            choice, seed, out, settings, dict(zip(names, point, strict=True)), lag_s,
        )
        for choice, seed in study.blocks
        for settings, point in points
    ]  # fmt: skip


def key_of(choice: SceneChoice, seed: int | None, settings: FusionSettings, lag_s: float) -> str:
    """Return a key that identifies a run and the version of the code."""
    facts = [choice.facts, seed, asdict(settings), lag_s, code_digest()]
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:20]


def run_study(
    study: Study,
    out: Path,
    *,
    workers: int | None = None,
    progress: Progress | None = None,
    remark: Remark | None = None,
) -> Done:
    """Execute the missing runs of a study; all finished runs are kept if it is interrupted.

    Parameters
    ----------
    study
        The study.
    out
        Folder of the study, created if missing.
    workers
        Number of processes; all cores if None. With 1 everything runs in this process.
    progress
        Called with the number of finished runs, and of all.
    remark
        Called with remarks.

    Raises
    ------
    InputError
        The folder is not writable, contains something else, or is in use by another study.
    SetupError
        The disk is full, or the system killed a process.
    """
    remark = remark or (lambda text: None)
    check_folder(out)
    with disk_faults(out):
        out.mkdir(parents=True, exist_ok=True)
    with opened(out / NAME) as ledger:
        jobs, known = jobs_of(study, out), read_runs(out / NAME)
        if changed := changed_parts(study, out):
            remark(
                f"the study in {out} has changed: other {', '.join(changed)}; runs that still fit "
                "are reused"
            )
        with atomic_write(out / STUDY) as file:
            file.write(toml_of(study.table))
        good = {run.key for run in known if not run.fault}
        missing = [job for job in jobs if job.key not in good]
        _tell_what_is_known(known, len(jobs) - len(missing), len(missing), remark)
        counts = _Counts(len(jobs), len(jobs) - len(missing), progress)
        workers = min(workers or os.cpu_count() or 1, max(1, len(missing)))
        with _pool(workers) as pool:
            _make_scenes(pool, missing, workers)
            for job, future in _finished(pool, run_one, missing, 2 * workers):
                ledger.append(_outcome(job, future))
                counts.add(future.exception() is not None)
    if code_changed():
        remark(
            "the code changed while the study ran, so its runs may be of different versions; run "
            "it again"
        )
    return Done(len(jobs), len(missing), counts.failed)


def _tell_what_is_known(known: list[Run], reused: int, missing: int, remark: Remark) -> None:
    others = Counter(run.code for run in known if run.code != code_digest())
    if others:
        told = ", ".join(f"{count} of version {code}" for code, count in others.items())
        remark(
            f"runs made with other code are kept but not used: {told}; now it is {code_digest()}"
        )
    if reused:
        remark(f"{reused} runs are already there, {missing} are missing")


class _Counts:
    """Progress of the study."""

    def __init__(self, total: int, done: int, progress: Progress | None) -> None:
        self.failed = 0
        self._total, self._done, self._progress = total, done, progress
        self._tell()

    def add(self, failed: bool) -> None:
        """Count one more run."""
        self.failed += failed
        self._done += 1
        self._tell()

    def _tell(self) -> None:
        if self._progress is not None:
            self._progress(self._done, self._total)


def run_one(job: Job) -> dict[str, float]:
    """Track one scene with the settings of one point and return the figures."""
    scene = load(prepare(job.choice, job.seed, job.out))
    tally = Tally()
    tracked = follow(scene.poses, scene.rig, job.settings, lag_s=job.lag_s, tally=tally)
    found = compare(tracked, scene.truth.t_s, scene.truth.xyz_m)
    return {
        "mean_m": found.mean_m,
        "recall_15cm": found.recall_15cm,
        "switches": found.switches,
        "missed": found.missed,
        "ghosts": found.false_positives,
        "person_frames": found.person_frames,
        "fusion_ms": tally.fusion_ms()["median"],
    }


def _make_one(task: tuple[SceneChoice, int | None, Path]) -> Path:
    return prepare(*task)


def _outcome(job: Job, future: "Future[dict[str, float]]") -> Run:
    """Return the record of a run; a failure is a result as well."""
    error = future.exception()
    fault = ""
    if error is not None:
        text = str(error) if isinstance(error, Error) else f"{type(error).__name__}: {error}"
        fault = " ".join(text.split())[:_LONGEST_FAULT] or type(error).__name__
    figures = {} if error is not None else future.result()
    return Run(job.key, code_digest(), job.choice.name, job.seed, job.values, figures, fault)


def _make_scenes(pool: Executor, jobs: Sequence[Job], workers: int) -> None:
    """Simulate each scene once; failures are reported by the runs that need it."""
    tasks = list(dict.fromkeys((job.choice, job.seed, job.out) for job in jobs))
    for _ in _finished(pool, _make_one, tasks, 2 * workers):
        pass


def _finished(
    pool: Executor, function: Callable[[Task], Any], tasks: Iterable[Task], ahead: int
) -> "Iterator[tuple[Task, Future[Any]]]":
    """Yield each task when it is done; few are queued, so that stopping is quick.

    Raises
    ------
    SetupError
        A fault that concerns all tasks: a full disk, a killed process.
    """
    rest = iter(tasks)
    waiting = {pool.submit(function, task): task for task in islice(rest, ahead)}
    while waiting:
        done, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            task = waiting.pop(future)
            error = future.exception()
            if isinstance(error, BrokenProcessPool):
                raise SetupError(
                    "the system killed a process of the study, as it does when memory is full; "
                    "finished runs are kept: run it again with fewer --jobs"
                )
            if isinstance(error, SetupError):
                raise error
            yield task, future
            for following in islice(rest, 1):
                waiting[pool.submit(function, following)] = following


@contextmanager
def _pool(workers: int) -> Iterator[Executor]:
    if workers == 1:
        with ThreadPoolExecutor(1) as thread:
            yield thread
        return
    before = set(multiprocessing.active_children())
    with _one_thread_each():
        pool = ProcessPoolExecutor(
            workers, mp_context=multiprocessing.get_context("spawn"), initializer=_begin_worker
        )
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in set(multiprocessing.active_children()) - before:
                child.kill()  # workers ignore SIGTERM: it may reach the whole process group
            raise
        pool.shutdown()


def _begin_worker() -> None:
    """Ignore Ctrl-C, which the parent handles, and end when the parent is gone."""
    for one in (signal.SIGINT, signal.SIGTERM):  # the parent ends the work
        signal.signal(one, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Limit processes that start in this block to one thread each."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
