"""`reach`: what a model's own start ends in along one parameter, and where that changes."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy

from ..errors import SimulationError
from ..graph import BondGraph
from ..parameters import unknown_name
from ..simulation import CompiledModel
from ..stability.vary import Vary, as_vary
from .bench import Bench
from .line import Line, input_unit
from .reached import Change, Reach, ReachPoint
from .words import reach_words

Array = numpy.ndarray

# Frequencies of neighbours that differ by more are looked at: they may belong to two cycles.
JUMP, STILL_JUMP = 0.02, 0.01
HALVINGS = 3
# Next to zero a change is as sharp as beside this part of the range.
NEAR_ZERO = 0.01


def reach(
    graph: BondGraph | CompiledModel,
    vary: Vary | str | tuple[Any, ...],
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, float] | None = None,
    *,
    initial: Mapping[Any, float] | None = None,
    sharp: float = 1e-3,
    horizon: float | None = None,
    budget: float = 30.0,
    rtol: float = 1e-8,
) -> Reach:
    """Find what a model's own start ends in along one parameter, and where that changes.

    Parameters
    ----------
    graph : BondGraph or CompiledModel
    vary : Vary, str or tuple
        Range and number of points: ``("tau", 0.01, 0.06, 15)`` or ``"tau=0.01:0.06:15"``.
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    inputs : mapping, optional
        Constant inputs, zero unless given.
    initial : mapping, optional
        Another start: states by name to numbers, others as at the model's own.
    sharp : float
        A change is bisected to this share of the parameter.
    horizon : float, optional
        Longest time a run gets to settle, s of the model; chosen from the eigenvalues unless given.
    budget : float
        Seconds of the processor for all of it. What is left undone then is told in `notes`.
    rtol : float
        Of the runs.

    Returns
    -------
    Reach

    Raises
    ------
    BondGraphError
        For an unknown parameter, and a model that cannot be run as asked.

    Notes
    -----
    Basins may be interleaved: between two points that end alike another outcome may hide.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> found = reach(bicycle_brake.graph(), ("tau", 0.02, 0.04, 3), {"mu_s": 0.5})
    >>> found.outcomes, round(found.changes[0].value, 3)
    (('cycle', 'steady', 'steady'), 0.026)
    """
    bench = Bench(graph, inputs)
    item = _in_si(bench, as_vary(vary))
    if not 0 < sharp < 1:
        raise SimulationError(f"sharp is {sharp!r}; give a share between 0 and 1, such as 1e-3")
    until = time.process_time() + budget
    line = Line(bench, item, dict(parameters or {}), initial, (horizon, until, rtol))
    low, high = sorted((item.lo, item.hi))
    points, notes = [], []
    for value in numpy.linspace(low, high, item.n):
        if time.process_time() > until:
            notes.append(
                f"the {budget:g} s allowed were used up at {item.name} = {value:.6g}; raise budget"
            )
            break
        points.append(line.at(float(value)))
    changes = []
    for before, after in itertools.pairwise(points):
        if not _differ(before, after):
            continue
        if time.process_time() > until:
            notes.append("no seconds were left to bisect all changes; raise budget")
            break
        change = _change(line.at, before, after, (sharp, NEAR_ZERO * (high - low), until))
        if change is not None:
            changes.append(change)
    bad = [point for point in points if point.outcome in ("unsettled", "stopped", "refused")]
    notes += [f"{item.name} = {point.value:.6g}: {point.note}" for point in bad]
    outputs = tuple(bench.model.equations.outputs) or bench.names
    unit = line.unit
    return Reach(
        bench.graph.name,
        item.name,
        unit,
        {name: line.units.get(name, "") for name in outputs},
        line.span,
        tuple(points),
        tuple(changes),
        tuple(notes),
        reach_words(item.name, unit, points, changes),
    )


def _in_si(bench: Bench, item: Vary) -> Vary:
    table = {symbol.name: row for symbol, row in bench.graph.parameters.items()}
    if item.name not in table and item.name not in bench.inputs:
        raise unknown_name("parameter", item.name, [*table, *bench.inputs])
    row = table.get(item.name)
    return item.in_si(row.unit if row is not None else input_unit(bench, item.name))


def _differ(one: ReachPoint, other: ReachPoint) -> bool:
    if one.outcome != other.outcome:
        return True
    return _apart(one, other) > JUMP


def _apart(one: ReachPoint, other: ReachPoint) -> float:
    """Return how far the frequencies of two cycles are apart, relative."""
    if one.frequency_hz is None or other.frequency_hz is None:
        return 0.0
    return abs(one.frequency_hz / other.frequency_hz - 1)


def _change(
    at: Callable[[float], ReachPoint],
    before: ReachPoint,
    after: ReachPoint,
    limits: tuple[float, float, float],
) -> Change | None:
    """Bisect a change; None where a cycle's frequency turns out to change bit by bit."""
    sharp, least, until = limits
    alike, apart, halvings = before.outcome == after.outcome, _apart(before, after), 0
    while after.value - before.value > sharp * max(abs(before.value), abs(after.value), least):
        if time.process_time() > until:
            break
        middle = at((before.value + after.value) / 2)
        if middle.outcome == before.outcome and (
            not alike or _apart(before, middle) <= _apart(middle, after)
        ):
            before = middle
        else:
            after = middle
            alike = alike and middle.outcome == before.outcome
        halvings += 1
        if alike and halvings == HALVINGS and _apart(before, after) < 0.5 * apart:
            return None
    if alike and _apart(before, after) < STILL_JUMP:
        return None
    return Change((before.value + after.value) / 2, before.value, after.value, before, after)
