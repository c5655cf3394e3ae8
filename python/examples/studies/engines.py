"""Where tasks are run: here, on the cores of this machine, or on other machines."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import logging
import signal
import time
import uuid
import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from . import task
from .grid import StudyError, Task
from .task import Row, sentence

Compute = Callable[[dict[str, Any]], Row]
Outcome = tuple[Task, Row]

#: How often a task may lose its worker.
TRIES = 3
#: How often results are looked for, and how long no worker goes unmentioned, in seconds.
LOOK, PATIENCE = 0.02, 30.0


def serial(tasks: Sequence[Task], compute: Compute = task.compute) -> Iterator[Outcome]:
    """Runs tasks in this process, one after another."""
    import fsot

    with warnings.catch_warnings():
        # A table that Ctrl-C ends is not kept, whatever the warning says.
        warnings.simplefilter("ignore", fsot.Interrupted)
        for each in tasks:
            yield each, compute(each.work)


def on_dask(
    client: Any,
    tasks: Sequence[Task],
    compute: Compute = task.compute,
    say: Callable[[str], None] = print,
) -> Iterator[Outcome]:
    """Runs tasks on the workers of a `distributed.Client`, and gives rows as they come.

    Dask gives the tasks of a worker that dies to another one. It blames all of them, since it doesn't know
    which one killed it; those that it gives up are tried once more at the end, each alone, so that none fails
    for what its neighbour has done.
    """
    suspects: list[Task] = []
    for each, result in _together(client, tasks, compute, say):
        if _is_killed(result):
            suspects.append(each)
        else:
            yield each, _row(result)
    for suspect in suspects:
        for each, result in _together(client, [suspect], compute, say):
            yield each, _row(result)


def _together(
    client: Any, tasks: Sequence[Task], compute: Compute, say: Callable[[str], None]
) -> Iterator[tuple[Task, Any]]:
    import cloudpickle

    _, distributed = _dask()
    # Workers need not have this folder. Dask pickles by name what has one, so that the function that it gets
    # has none.
    cloudpickle.register_pickle_by_value(task)

    def carried(work: dict[str, Any]) -> Row:
        return compute(work)

    # Keys of our own, lest two studies on one scheduler share tasks.
    run = uuid.uuid4().hex[:8]
    by_key = {f"table-{run}{each.key[:24]}": each for each in tasks}
    works = [each.work for each in tasks]
    # What is running when this ends early is of no use to anybody: futures are not kept beyond.
    done = distributed.as_completed(
        client.map(carried, works, key=list(by_key), pure=False, batch_size=1000),
        with_results=True,
        raise_errors=False,
    )
    watch = _Watch(client, say)
    while not done.is_empty():
        batch = done.next_batch(block=False)
        for future, result in batch:
            if future.cancelled():
                raise StudyError("the scheduler is gone: start the study again, and it goes on")
            yield by_key.pop(future.key), result
        watch.look()
        if not batch:
            time.sleep(LOOK)


class _Watch:
    """Tells of workers that have gone, and of none being there."""

    def __init__(self, client: Any, say: Callable[[str], None]):
        self.client, self.say = client, say
        self.workers: set[str] = set()
        self.looked = 0.0
        self.attended = time.monotonic()

    def look(self) -> None:
        now = time.monotonic()
        if now - self.looked < 1:
            return
        self.looked = now
        workers = set(self.client.ncores())
        for worker in sorted(self.workers - workers):
            self.say(f"worker {worker} is gone: others do what it had begun")
        self.workers = workers
        if workers:
            self.attended = now
        elif now - self.attended > PATIENCE:
            self.attended = now
            self.say("there is no worker: waiting for one")


def _is_killed(result: Any) -> bool:
    from distributed import KilledWorker

    return isinstance(result, tuple) and isinstance(result[1], KilledWorker)


def _row(result: Any) -> Row:
    if not isinstance(result, tuple):
        return dict(result)
    error = result[1]
    if _is_killed(result):
        message = "its worker died each time: look for memory that is too little, or a limit of time"
    else:
        message = sentence(error)
    return {"state": "failed", "message": message}


@contextlib.contextmanager
def local(workers: int | None, tries: int) -> Iterator[Any]:
    """A client of workers of one thread each on this machine, as many as cores if nothing is said."""
    dask, distributed = _dask()
    from dask.system import CPU_COUNT

    with dask.config.set({"distributed.scheduler.allowed-failures": tries - 1}):
        cluster = distributed.LocalCluster(
            n_workers=workers or CPU_COUNT, threads_per_worker=1, silence_logs=logging.ERROR
        )
        with cluster, distributed.Client(cluster) as client:
            client.register_plugin(_deaf_to_interrupts())
            yield client


@contextlib.contextmanager
def existing(address: str) -> Iterator[Any]:
    """A client of a scheduler that runs already."""
    _, distributed = _dask()
    try:
        client = distributed.Client(address, timeout="20s")
    except (OSError, ValueError) as error:
        raise StudyError(f"no scheduler at {address}: {sentence(error)}") from error
    with client:
        yield client


@contextlib.contextmanager
def slurm(section: dict[str, Any], tries: int) -> Iterator[Any]:
    """A client of workers in jobs of SLURM."""
    dask, distributed = _dask()
    with dask.config.set({"distributed.scheduler.allowed-failures": tries - 1}):
        with slurm_cluster(section) as cluster:
            cluster.scale(jobs=section.get("jobs", 1))
            with distributed.Client(cluster) as client:
                yield client


def slurm_cluster(section: dict[str, Any]) -> Any:
    """The cluster of a section ``[slurm]``, without jobs: one worker a core, unless it says otherwise."""
    try:
        jobqueue: Any = importlib.import_module("dask_jobqueue")
    except ImportError as error:
        raise StudyError("SLURM needs dask-jobqueue: pip install dask-jobqueue") from error
    options = {key: value for key, value in section.items() if key != "jobs"}
    if "cores" in options:
        options.setdefault("processes", options["cores"])
    try:
        return jobqueue.SLURMCluster(**options)
    except (ValueError, TypeError) as error:
        raise StudyError(f"[slurm]: {sentence(error)}") from error


def dashboard(client: Any) -> str:
    """What to say of Dask's dashboard."""
    if importlib.util.find_spec("bokeh") is None:
        return "no dashboard: pip install bokeh for one"
    return f"dashboard: {client.dashboard_link}"


def _deaf_to_interrupts() -> Any:
    """Ctrl-C in a terminal reaches all processes; the study alone is to hear it, and ends its workers."""
    from distributed import WorkerPlugin

    class Deaf(WorkerPlugin):
        name = "deaf-to-interrupts"

        def setup(self, worker: Any) -> None:
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    return Deaf()


def _dask() -> tuple[Any, Any]:
    try:
        import dask
        import distributed
    except ImportError as error:
        raise StudyError(
            'Dask is missing: pip install "distributed>=2024.1", or run with --serial'
        ) from error
    return dask, distributed
