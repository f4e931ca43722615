"""Which pool a sweep takes unless it is given one, and how large its chunks are."""

from __future__ import annotations

import concurrent.futures as cf
import os
import sys
from pathlib import Path
from typing import Any

from ..errors import SweepError
from ..simulation import CompiledModel
from .job import Job
from .pools import Given, Here, Pool, Processes, Threads
from .quantities import ENDS
from .worker import compiled, packed

# Seconds that a chunk should take: long beside what it costs to hand over and write, short enough
# to lose, and to watch.
CHUNK_SECONDS = 0.5
MOST_POINTS = 2000
# Seconds of work from which on others are asked to help. Threads cost nothing to start; a process
# imports and derives the model before it is of use, some seconds.
THREADS_FROM, PROCESSES_FROM = 0.5, 15.0

WORDS = ("serial", "threads", "processes")


def pool_for(
    executor: Any, model: CompiledModel, job: Job, token: str, workers: int | None
) -> Pool | None:
    """Return the pool that was asked for; None where the choice is left open.

    Raises
    ------
    SweepError
        For what is no executor, or cannot take this sweep.
    """
    count = count_of(workers)
    if executor is None:
        return None
    if executor == "serial":
        return Here(model, job)
    if executor == "threads":
        return Threads(model, job, token, workers=count)
    if executor == "processes":
        return Processes(job, token, count)
    if isinstance(executor, cf.ThreadPoolExecutor):
        return Threads(model, job, token, executor)
    if callable(getattr(executor, "submit", None)):
        return Given(executor, job, token, workers)
    raise SweepError(
        f"executor {executor!r:.80} is none; give a concurrent.futures.Executor or one of {', '.join(WORDS)}"
    )


def chosen(
    model: CompiledModel, job: Job, token: str, workers: int | None, seconds: float
) -> tuple[Pool, str]:
    """Choose a pool by the seconds of work ahead, and say why.

    Parameters
    ----------
    model : CompiledModel
    job : Job
    token : str
    workers : int, optional
        All processors unless given.
    seconds : float
        Expected for the points to come, on one worker.

    Returns
    -------
    pool : Pool
    why : str
    """
    count = count_of(workers)
    if count == 1 or seconds < THREADS_FROM:
        return Here(model, job), "one worker" if count == 1 else "little work"
    fast = compiled(model, job)
    if fast and job.needs == ENDS:
        return Threads(model, job, token, workers=count), "compiled runs do not hold Python's lock"
    if seconds >= PROCESSES_FROM:
        held = _held_back(job, token)
        if not held:
            return Processes(job, token, count), "work in Python, which holds its lock"
    else:
        held = "too little work for processes"
    if fast:
        return Threads(model, job, token, workers=count), held
    return Here(model, job), held


def chunk_size(seconds: float, points: int, workers: int) -> int:
    """Return how many points a chunk has.

    Parameters
    ----------
    seconds : float
        Of one point.
    points : int
        All that are to come.
    workers : int

    Examples
    --------
    >>> chunk_size(1e-3, 100_000, 2), chunk_size(10.0, 100, 2), chunk_size(1e-3, 80, 2)
    (500, 1, 3)
    """
    by_time = int(CHUNK_SECONDS / max(seconds, 1e-9))
    share = -(-points // (16 * workers))  # that all have work till near the end
    return max(1, min(by_time, share, MOST_POINTS))


def count_of(workers: int | None) -> int:
    """Return the number of workers: all processors this process may use unless given."""
    if workers is None:
        try:
            return len(os.sched_getaffinity(0))
        except AttributeError:  # not on every system
            return os.cpu_count() or 1
    if not isinstance(workers, int) or workers < 1:
        raise SweepError(f"{workers!r} workers cannot work; give 1 or more")
    return workers


def _held_back(job: Job, token: str) -> str:
    """Say why processes are not started unasked; empty where they can be."""
    try:
        packed(job, token)
    except SweepError:
        return "a function that does not pickle"
    # A fresh process runs the script again to find its functions: fatal unless it is guarded.
    main = sys.modules.get("__main__")
    path = getattr(main, "__file__", None)
    if path is None or getattr(main, "__spec__", None) is not None:
        return ""
    try:
        guarded = "__name__" in Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        guarded = False
    return "" if guarded else "the script has no `if __name__ == '__main__'`"
