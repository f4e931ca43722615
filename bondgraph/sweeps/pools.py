"""Where chunks are computed: here, in threads, in processes, or by any other executor."""

from __future__ import annotations

import concurrent.futures as cf
import contextlib
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from typing import Any, Protocol

from ..errors import SweepError
from ..simulation import CompiledModel
from .block import Block
from .evaluate import Columns, evaluate
from .job import Job
from .worker import Parcel, begin, local_stop, packed, ready, run_parcel, shareable


class Died(Exception):
    """The worker of a chunk died: a process that crashed or was killed."""


class Pool(Protocol):
    """Computes chunks.

    Attributes
    ----------
    workers : int
        How many chunks it computes at a time.
    words : str
        What it is, for people.
    """

    workers: int
    words: str

    def submit(self, columns: Columns) -> cf.Future[Block]:
        """Begin a chunk; raises Died where the pool is broken."""

    def revive(self) -> None:
        """Make a broken pool work again."""

    def close(self) -> None:
        """Call off what has not been fetched and let go of all workers."""


class Here:
    """Computes chunks at once, in the thread that asks."""

    def __init__(self, model: CompiledModel, job: Job) -> None:
        self.model, self.job = model, job
        self.workers, self.words = 1, "this process"

    def submit(self, columns: Columns) -> cf.Future[Block]:
        """Compute a chunk."""
        future: cf.Future[Block] = cf.Future()
        future.set_result(evaluate(self.model, self.job, columns))
        return future

    def revive(self) -> None:
        """Nothing breaks."""

    def close(self) -> None:
        """Nothing to let go of."""


class Threads:
    """Computes chunks in threads of this process.

    A model that runs as compiled C is shared; else each thread makes its own.
    """

    def __init__(
        self,
        model: CompiledModel,
        job: Job,
        token: str,
        executor: cf.ThreadPoolExecutor | None = None,
        workers: int = 1,
    ) -> None:
        self._own = executor is None
        self._executor = executor or cf.ThreadPoolExecutor(workers, thread_name_prefix="sweep")
        self.workers = _width(self._executor, workers)
        self.words = f"{self.workers} threads"
        self._call_off, stop = local_stop()
        self._run: Callable[[Columns], Block]
        if shareable(model, job):
            self._run = lambda columns: evaluate(model, job, columns, stop)
        else:
            parcel = Parcel(token, job=job)
            self._run = lambda columns: run_parcel(parcel, columns)

    def submit(self, columns: Columns) -> cf.Future[Block]:
        """Begin a chunk."""
        return self._executor.submit(self._run, columns)

    def revive(self) -> None:
        """Nothing breaks."""

    def close(self) -> None:
        """Call the rest off; threads end when they are asked next."""
        self._call_off()
        if self._own:
            self._executor.shutdown(wait=True, cancel_futures=True)


class Processes:
    """Computes chunks in worker processes that end with this one, killed or not.

    Fresh ones, not forks: threads and locks of this process do not get into them.
    """

    def __init__(self, job: Job, token: str, workers: int) -> None:
        self.workers, self.words = workers, f"{workers} processes"
        self._parcel = packed(job, token)
        self._context = multiprocessing.get_context("spawn")
        self._stop = self._context.Event()
        self._executor = self._fresh()
        try:
            with _without_interrupts():
                first = self._executor.submit(ready)
            first.result()
        except cf.BrokenExecutor:
            raise SweepError(
                "worker processes do not start; in a script, put what it does under "
                "`if __name__ == '__main__':`, or use executor='threads'"
            ) from None

    def _fresh(self) -> cf.ProcessPoolExecutor:
        return cf.ProcessPoolExecutor(
            self.workers, mp_context=self._context, initializer=begin, initargs=(self._stop,)
        )

    def submit(self, columns: Columns) -> cf.Future[Block]:
        """Begin a chunk; raises Died."""
        try:
            with _without_interrupts():  # it may start a worker
                return self._executor.submit(run_parcel, self._parcel, columns)
        except cf.BrokenExecutor as error:
            raise Died from error

    def revive(self) -> None:
        """Start fresh workers."""
        self._executor.shutdown(wait=True, cancel_futures=True)
        self._executor = self._fresh()

    def close(self) -> None:
        """Call the rest off; workers end when they are asked next."""
        self._stop.set()
        self._executor.shutdown(wait=True, cancel_futures=True)


class Given:
    """Computes chunks by somebody's executor, which stays theirs."""

    def __init__(self, executor: cf.Executor, job: Job, token: str, workers: int | None) -> None:
        process_pool = isinstance(executor, cf.ProcessPoolExecutor)
        self._executor, self._replaced = executor, False
        self._parcel = packed(job, token, by_value=not process_pool, watched=process_pool)
        self._futures: set[cf.Future[Block]] = set()
        self.workers = workers or _width(executor, os.cpu_count() or 1)
        self.words = f"{type(executor).__name__} of {self.workers} workers"

    def submit(self, columns: Columns) -> cf.Future[Block]:
        """Begin a chunk; raises Died."""
        try:
            future = self._executor.submit(run_parcel, self._parcel, columns)
        except cf.BrokenExecutor as error:
            raise Died from error
        self._futures.add(future)
        future.add_done_callback(self._futures.discard)
        return future

    def revive(self) -> None:
        """Put a fresh process pool like the broken one in its place; others mend themselves."""
        broken = self._executor
        if isinstance(broken, cf.ProcessPoolExecutor):
            made: Any = broken
            self._executor = cf.ProcessPoolExecutor(
                made._max_workers,
                mp_context=made._mp_context,
                initializer=made._initializer,
                initargs=made._initargs,
            )
            if self._replaced:
                broken.shutdown(wait=True, cancel_futures=True)
            self._replaced = True

    def close(self) -> None:
        """Cancel what has not begun."""
        for future in list(self._futures):
            future.cancel()
        if self._replaced:
            self._executor.shutdown(wait=True, cancel_futures=True)


@contextlib.contextmanager
def _without_interrupts() -> Iterator[None]:
    """Let processes that are started meanwhile be deaf to Ctrl-C; this one hears of it afterwards."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _width(executor: Any, usual: int) -> int:
    """Return how many workers an executor has, as far as it tells."""
    told = getattr(executor, "_max_workers", None)
    if isinstance(told, int):
        return told
    client = getattr(executor, "_client", None)  # dask's
    try:
        return max(1, sum(client.ncores().values())) if client is not None else usual
    except (AttributeError, OSError):
        return usual
