"""The public `sweep`: many runs of a model, from points to a dataset."""

from __future__ import annotations

import contextlib
import math
import time
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

from ..causality import CausalGraph
from ..errors import SweepError
from ..graph import BondGraph
from ..simulation import CompiledModel
from .block import Block, joined
from .choice import chosen, chunk_size, count_of, pool_for
from .dataset import needed, save, timed, to_dataset
from .folder import Folder, opened
from .job import in_si, made_job
from .points import as_points
from .pools import Here, Pool
from .progress import Progress, Teller
from .read import as_quantities
from .schedule import alone, carried_out
from .store import Chunks, pieces

if TYPE_CHECKING:
    import xarray

# The first chunk, whose time tells how large the others are to be.
PILOT = 9
# Seconds of a point, where all of the first chunk are refused.
UNKNOWN = 0.01


def sweep(
    model: BondGraph | CausalGraph | CompiledModel,
    points: Any,
    quantity: Any,
    *,
    t_span: tuple[float, float] | float,
    parameters: Mapping[Any, Any] | None = None,
    initial: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, Any] | None = None,
    t_eval: Any = None,
    rtol: float = 1e-6,
    atol: float = 0.0,
    max_step: float = math.inf,
    max_events: int = 100_000,
    max_steps: int = 10_000_000,
    time_budget: float = 600.0,
    backend: str = "auto",
    solver: str = "auto",
    executor: Any = None,
    workers: int | None = None,
    chunk: int | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    progress: Callable[[Progress], object] | None = None,
) -> xarray.Dataset:
    """Run a model at many points and keep some numbers of each run.

    What goes wrong at a point is an outcome in its cell and stops nothing. The
    result does not depend on chunks, executor or interruptions, to the last bit.

    Parameters
    ----------
    model : BondGraph, CausalGraph or CompiledModel
    points : Points or list of mappings
        `grid`, `samples`, or a design such as `latin_hypercube`. Parameters,
        initial states and constant inputs, by name.
    quantity : quantity, str, callable, or several in a sequence or mapping
        One of `bondgraph.sweeps`, such as ``Final("V_c")``; its text, such as
        ``"final:V_c"``; or a function of a `Trajectory` to a number, an array of
        one shape at all points, or a mapping of names to these. A mapping gives
        them names.
    t_span : (float, float) or float
        Start and end of each run, s.
    parameters, initial, inputs : mapping, optional
        What all points share, as for `simulate`; what `points` vary goes before.
    t_eval : (nt,) array-like, optional
        Times at which quantities along a run look at it; 4001 even ones unless
        given.
    rtol, atol, max_step, max_events, max_steps, time_budget, backend, solver
        As for `simulate`; the limits are those of each run.
    executor : concurrent.futures.Executor, {"serial", "threads", "processes"}, optional
        Where the runs are done; dask's ``Client.get_executor()`` is one. Unless
        given: threads where compiled runs need no Python, processes for long
        work that does, else this thread; the dataset's attribute ``executor``
        says which.
    workers : int, optional
        All processors unless given.
    chunk : int, optional
        Points handed over at a time; what takes about half a second unless given.
    out : path, optional
        A folder that gets each chunk when it is done, and ``dataset.nc`` at the
        end.
    resume : bool
        Take up what is in `out`. Chunks that are whole are kept, others computed.
    progress : callable, optional
        Told a `Progress` after each chunk.

    Returns
    -------
    xarray.Dataset
        With a variable each quantity, NaN where a point failed, and ``outcome``
        (see `outcomes`), ``t_end``, ``message`` and ``seconds``.

    Raises
    ------
    BondGraphError
        Where no point could be run: unknown names, times or options that make
        no run; and where `out` holds something else. KeyboardInterrupt leaves
        what is done in `out`.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.sweeps import Count, grid
    >>> found = sweep(mass_on_belt.graph(), grid(k=[50, 100]), Count("contact", "stick"), t_span=2.0)
    >>> found["count:contact:stick"].values.tolist()
    [2.0, 3.0]
    """
    needed()
    compiled = model if isinstance(model, CompiledModel) else CompiledModel(model)
    where = as_points(points)
    options = {
        "rtol": rtol,
        "atol": atol,
        "max_step": max_step,
        "max_events": max_events,
        "max_steps": max_steps,
        "time_budget": time_budget,
        "backend": backend,
        "solver": solver,
    }
    shared = (parameters, initial, inputs)
    job = made_job(compiled, t_span, as_quantities(quantity), shared, options, t_eval)
    columns = in_si(compiled, where)
    if chunk is not None and (not isinstance(chunk, int) or chunk < 1):
        raise SweepError(f"chunk is {chunk!r}; give a whole number of points, 1 or more")
    with contextlib.ExitStack() as stack:
        folder = opened(stack, out, resume, (compiled, job, where))
        work = _Work(compiled, job, columns, len(where), folder, Teller(progress, len(where)))
        blocks = work.all(executor, workers, chunk)
        result = to_dataset(compiled, job, where, blocks)
        if folder is not None:
            save(result, folder.path / "dataset.nc")
    result = timed(result, where, blocks)
    result.attrs["executor"] = work.told
    return result


@dataclass
class _Work:
    """A sweep under way: which chunks there are, which are done, who does the rest."""

    model: CompiledModel
    job: Any
    columns: Mapping[str, Any]
    count: int
    folder: Folder | None
    teller: Teller
    blocks: dict[int, Block] = field(default_factory=dict)
    told: str = "nothing was left to do"

    def all(self, executor: Any, workers: int | None, size: int | None) -> list[Block]:
        """Compute what is not on disk, and return the blocks of all chunks."""
        token = uuid.uuid4().hex
        chunks = self._known(size)
        rest = [i for i in range(len(chunks or ())) if i not in self.blocks]
        if chunks is not None and not rest:
            return self._in_order(chunks)
        with contextlib.ExitStack() as stack:
            pool = pool_for(executor, self.model, self.job, token, workers)
            first = pool or Here(self.model, self.job)
            stack.callback(first.close)
            if pool is not None and chunks is not None:  # nothing is to be found out
                self.told = pool.words
                carried_out(pool, self.columns, [(i, *chunks[i]) for i in rest], self._done)
                return self._in_order(chunks)
            start, stop = chunks[rest[0]] if chunks else (0, min(self.count, PILOT))
            block, seconds = _pilot(first, self.columns, start, stop)
            if chunks is None:
                width = first.workers if pool else count_of(workers)
                size = chunk_size(seconds, self.count - stop, width)
                chunks = ((0, stop), *pieces(self.count, size, stop))
                rest = list(range(len(chunks)))
                self._plan(chunks)
            self._done(rest[0], block)
            left = [(i, *chunks[i]) for i in rest[1:]]
            if pool is None and left:
                ahead = seconds * sum(stop - start for _, start, stop in left)
                pool, why = chosen(self.model, self.job, token, workers, ahead)
                stack.callback(pool.close)
                self.told = f"{pool.words}: {why}"
            else:
                self.told = first.words
            carried_out(pool or first, self.columns, left, self._done)
        return self._in_order(chunks)

    def _known(self, size: int | None) -> Chunks | None:
        """Return the chunks where they are known before any is computed, and read those on disk."""
        if self.folder is not None and self.folder.chunks is not None:
            chunks = self.folder.chunks
            for index, block in self.folder.found():
                self.blocks[index] = block
                self.teller.add(len(block), block.failed, resumed=True)
            return chunks
        if size is None:
            return None
        chunks = pieces(self.count, size)
        self._plan(chunks)
        return chunks

    def _plan(self, chunks: Chunks) -> None:
        if self.folder is not None:
            self.folder.plan(chunks)

    def _done(self, index: int, block: Block) -> None:
        if self.folder is not None:
            self.folder.store.write_chunk(index, block)
        self.blocks[index] = block
        self.teller.add(len(block), block.failed)

    def _in_order(self, chunks: Chunks) -> list[Block]:
        return [self.blocks[i] for i in range(len(chunks))]


def _pilot(pool: Pool, columns: Mapping[str, Any], start: int, stop: int) -> tuple[Block, float]:
    """Compute points and time them, the first one aside: it may wait for a compiler.

    Points that are refused cost nothing and tell nothing.
    """
    parts = [alone(pool, columns, start, start + 1)]
    if stop - start > 1:
        begun = time.perf_counter()
        parts.append(alone(pool, columns, start + 1, stop))
        seconds = time.perf_counter() - begun
    else:
        seconds = float(parts[0].seconds[0])
    ran = int(numpy.isfinite(parts[-1].t_end).sum())
    return joined(parts), seconds / ran if ran else UNKNOWN
