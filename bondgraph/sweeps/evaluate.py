"""The points of a chunk, run: from their values to a block. Nothing here knows other chunks."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy

from ..errors import BondGraphError
from ..simulation import CompiledModel, Outcome, Trajectory, simulate
from ..simulation.batch import run_many
from ..simulation.ends import Ends
from .block import CODES, ERROR, FINISHED, QUANTITY_FAILED, REFUSED, Block, Piece, failed, joined
from .job import Job
from .quantities import ENDS, Quantity

Array = numpy.ndarray
Columns = Mapping[str, Array]
NON_FINITE = Outcome.NON_FINITE.value


def evaluate(
    model: CompiledModel, job: Job, columns: Columns, stop: Callable[[], bool] | None = None
) -> Block:
    """Run a model at some points.

    What goes wrong at a point is told in its row and stops nothing.

    Parameters
    ----------
    model : CompiledModel
    job : Job
    columns : mapping of str to (n,) array
        Values in SI.
    stop : callable, optional
        Asked now and then; true ends the work with KeyboardInterrupt.

    Returns
    -------
    Block
        Of n points. Their order is that of the columns, and a point's row does
        not depend on the others'.
    """
    count = len(next(iter(columns.values())))
    if job.needs == ENDS:
        try:
            return _batch(model, job, columns, stop)
        except Exception as error:
            if count == 1:
                return _failed(error)
    return joined([_alone(model, job, _row(columns, i), stop) for i in range(count)])


def _row(columns: Columns, i: int) -> dict[str, Array]:
    return {name: column[i : i + 1] for name, column in columns.items()}


def _alone(model: CompiledModel, job: Job, row: Columns, stop: Callable[[], bool] | None) -> Block:
    if stop is not None and stop():
        raise KeyboardInterrupt
    if job.needs == ENDS:
        return evaluate(model, job, row, stop)
    begun = time.perf_counter()
    shared = tuple(dict(part) for part in job.shared)
    for name, column in row.items():
        shared[_role(model, name)][name] = float(column[0])
    try:
        run = simulate(
            model, job.t_span, shared[0], shared[1], shared[2], t_eval=job.t_eval, **job.options
        )
    except Exception as error:
        return _failed(error, time.perf_counter() - begun)
    return _measured(run, job, begun)


def _failed(error: Exception, seconds: float = 0.0) -> Block:
    if isinstance(error, BondGraphError):
        block = failed(REFUSED, f"refused: {error}")
    else:  # not foreseen, yet no reason to lose the other points
        block = failed(ERROR, f"{type(error).__name__}: {error}")
    return Block(block.outcome, block.t_end, block.messages, (), numpy.array([seconds]))


def _role(model: CompiledModel, name: str) -> int:
    """Where a name belongs: 0 parameters, 1 initial states, 2 inputs."""
    graph = model.equations.graph
    if any(symbol.name == name for symbol in graph.parameters):
        return 0
    return 2 if any(symbol.name == name for symbol in graph.inputs) else 1


# ---------------------------------------------------------------------- along a run


def _measured(run: Trajectory, job: Job, begun: float) -> Block:
    """Return the row of one run."""
    outcome, message = run.outcome.value, "" if run.outcome.ok else run.outcome.advice
    found: dict[str, Array] = {}
    if run.outcome.ok:
        try:
            for item in job.quantities:
                found |= _numbers(item.name, item.what, run)
        except Exception as error:
            found, outcome = {}, QUANTITY_FAILED
            message = f"{item.name}: {type(error).__name__}: {error}"
        bad = _not_finite(job, found)
        if bad:
            found, outcome, message = {}, NON_FINITE, f"{bad} is not finite"
    zero = numpy.zeros(1, dtype=int)
    return Block(
        numpy.array([CODES[outcome]], dtype=numpy.int8),
        numpy.array([run.t_end]),
        (message,),
        tuple(Piece(name, zero, value[None]) for name, value in found.items()),
        numpy.array([time.perf_counter() - begun]),
    )


def _numbers(name: str, what: Any, run: Trajectory) -> dict[str, Array]:
    if isinstance(what, Quantity):
        return {name: numpy.array(what.of_run(run))}
    value = what(run)
    if isinstance(value, Mapping):
        return {str(key): numpy.array(item, dtype=float) for key, item in value.items()}
    return {name: numpy.array(value, dtype=float)}


def _not_finite(job: Job, found: Mapping[str, Array]) -> str:
    """Name a quantity that ought to be a number and is none; a function may give NaN."""
    for item in job.quantities:
        owed = isinstance(item.what, Quantity) and not item.what.optional
        if owed and item.name in found and not math.isfinite(found[item.name]):
            return item.name
    return ""


# ---------------------------------------------------------------------- ends of a batch


def _batch(
    model: CompiledModel, job: Job, columns: Columns, stop: Callable[[], bool] | None
) -> Block:
    begun = time.perf_counter()
    ends = run_many(model, job.t_span, columns, *job.shared, stop=stop, **job.options)
    count = len(ends)
    codes = numpy.array(
        [CODES[REFUSED if item is None else item.value] for item in ends.outcomes],
        dtype=numpy.int8,
    )
    messages = ["" if item is None or item.ok else item.advice for item in ends.outcomes]
    for row, text in ends.refusals.items():
        messages[row] = f"refused: {text}"
    values = _of_ends(job, ends)
    for name, column in values.items():
        for row in numpy.flatnonzero((codes == FINISHED) & ~numpy.isfinite(column)).tolist():
            if not _optional(job, name):
                codes[row], messages[row] = CODES[NON_FINITE], f"{name} is not finite"
    good = numpy.flatnonzero(codes == FINISHED)
    return Block(
        codes,
        ends.t_end,
        tuple(messages),
        tuple(Piece(name, good, column[good]) for name, column in values.items()),
        numpy.full(count, (time.perf_counter() - begun) / count),
    )


def _of_ends(job: Job, ends: Ends) -> dict[str, Array]:
    return {item.name: item.what.of_ends(ends) for item in job.quantities}  # type: ignore[union-attr]


def _optional(job: Job, name: str) -> bool:
    return any(
        item.name == name and getattr(item.what, "optional", False) for item in job.quantities
    )
