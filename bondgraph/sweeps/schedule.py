"""Chunks through a pool: a few at a time, in whatever order they come back."""

from __future__ import annotations

import collections
import concurrent.futures as cf
import queue
from collections.abc import Callable, Iterable

from ..errors import SweepError
from .block import WORKER_DIED, Block, failed, joined
from .evaluate import Columns
from .pools import Died, Pool

# A point alone in a process that dies is tried again this often: the death may have been another's.
RETRIES = 1

Chunk = tuple[int, int, int]  # index, first point, the one after the last


def carried_out(
    pool: Pool, columns: Columns, chunks: Iterable[Chunk], done: Callable[[int, Block], None]
) -> None:
    """Compute chunks, twice as many in flight as there are workers.

    Chunks whose worker died are computed again one at a time, so that one which kills its worker
    is found and takes no others with it.

    Parameters
    ----------
    pool : Pool
    columns : mapping of str to (np,) array
        Of all points.
    chunks : iterable of (int, int, int)
        Index, first point and the one after the last.
    done : callable
        Takes index and block of each chunk, in this thread.
    """
    waiting = collections.deque(chunks)
    flying: dict[cf.Future[Block], Chunk] = {}
    landed: queue.SimpleQueue[cf.Future[Block]] = queue.SimpleQueue()
    limit = 1 if pool.workers == 1 else 2 * pool.workers
    suspects: list[Chunk] = []
    while waiting or flying or suspects:
        while waiting and not suspects and len(flying) < limit:
            chunk = waiting.popleft()
            try:
                future = pool.submit(_part(columns, *chunk[1:]))
            except Died:
                suspects.append(chunk)
                break
            flying[future] = chunk
            future.add_done_callback(landed.put)
        if flying:
            future = landed.get()
            chunk = flying.pop(future)
            try:
                block = fetched(future)
            except Died:
                suspects.append(chunk)
            else:
                done(chunk[0], block)
        elif suspects:
            pool.revive()
            for index, start, stop in suspects:
                done(index, alone(pool, columns, start, stop))
            suspects = []


def alone(pool: Pool, columns: Columns, start: int, stop: int, tried: int = 0) -> Block:
    """Compute points while nothing else is computed; halve them where the worker dies.

    Parameters
    ----------
    pool : Pool
    columns : mapping of str to (np,) array
    start, stop : int
        First point and the one after the last.
    tried : int
        How often a single point has been tried.

    Returns
    -------
    Block
        A point that kills its worker has the outcome ``worker died``.
    """
    try:
        return fetched(pool.submit(_part(columns, start, stop)))
    except Died:
        pool.revive()
    if stop - start > 1:
        middle = (start + stop) // 2
        halves = (start, middle), (middle, stop)
        return joined([alone(pool, columns, *half) for half in halves])
    if tried < RETRIES:
        return alone(pool, columns, start, stop, tried + 1)
    return failed(WORKER_DIED, f"the worker process died {tried + 1} times at this point")


def fetched(future: cf.Future[Block]) -> Block:
    """Return a chunk's block; raises Died, or SweepError where the executor gave up."""
    try:
        return future.result()
    except cf.BrokenExecutor as error:
        raise Died from error
    except cf.CancelledError:
        raise SweepError(
            "the executor called a chunk off; what was done is kept where out= was given"
        ) from None
    except Exception as error:
        if type(error).__name__ == "KilledWorker":  # dask's
            raise Died from error
        raise


def _part(columns: Columns, start: int, stop: int) -> Columns:
    return {name: column[start:stop] for name, column in columns.items()}
