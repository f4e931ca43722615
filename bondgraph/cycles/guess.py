"""Where a search for a periodic orbit begins: states, period, parameters, inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import SimulationError
from ..simulation import CompiledModel, Trajectory
from ..values import initial_values, parameter_values
from .again import inputs_of
from .measure import limit_cycle

Array = numpy.ndarray

# A state that moves less than this share of its size is measured by its size.
QUIET = 1e-3


@dataclass(frozen=True, eq=False)
class Guess:
    """Where a search begins.

    Attributes
    ----------
    model : CompiledModel
    x : (n,) array
    period, start : float
        s.
    parameters, inputs, initial : mapping
        As for `bondgraph.simulate`; `initial` holds guesses of algebraic variables.
    run : Trajectory or None
        That ends near the orbit.
    """

    model: CompiledModel
    x: Array
    period: float
    start: float
    parameters: Any
    inputs: Any
    initial: dict[str, float]
    run: Trajectory | None = None


def taken(
    graph: Any,
    guess: Trajectory | Mapping[Any, float],
    timing: tuple[float | None, bool, float],
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, Any] | None,
) -> Guess:
    """Bring a guess in any of its forms to one.

    Parameters
    ----------
    graph : BondGraph, CompiledModel or None
    guess : Trajectory or mapping
    timing : (period or None, forced, start)
    parameters, inputs : mapping, optional

    Returns
    -------
    Guess

    Raises
    ------
    SimulationError
        Without model or period.
    """
    period, _, start = timing
    if period is not None and not (numpy.isfinite(period) and period > 0):
        raise SimulationError(f"period is {period!r}; give a positive number of seconds")
    if isinstance(guess, Trajectory):
        return _from_run(graph, guess, timing, parameters, inputs)
    if graph is None:
        raise SimulationError("a guess of states alone has no model; give the graph too")
    if period is None:
        raise SimulationError("states alone do not tell the period; give a guess of it, period=...")
    model = graph if isinstance(graph, CompiledModel) else CompiledModel(graph)
    equations = model.equations
    names = {state.name for state in equations.states}
    values = parameter_values(equations, parameters, model.resolver)
    x = numpy.array(initial_values(equations, values, guess))
    other = {
        key: value
        for key, value in ((str(getattr(k, "name", k)), v) for k, v in guess.items())
        if key not in names and key not in equations.outputs
    }
    return Guess(model, x, float(period), start, parameters, inputs, other)


def _from_run(
    graph: Any,
    run: Trajectory,
    timing: tuple[float | None, bool, float],
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, Any] | None,
) -> Guess:
    period, forced, start = timing
    model = run.model
    if graph is not None:
        model = graph if isinstance(graph, CompiledModel) else CompiledModel(graph)
    if period is None:
        period = limit_cycle(run, periods=1).period
    chosen = run.parameters if parameters is None else parameters
    given = inputs_of(run) if inputs is None else inputs
    if forced:
        turns = numpy.floor((run.t_end - start) / period + 1e-9)
        x = numpy.array([numpy.interp(start + turns * period, run.t, row) for row in run.x])
    else:
        x = run.x[:, _phase(run, period)].copy()
    initial = {s.name: float(v) for s, v in zip(model.equations.algebraic, run.z_end, strict=False)}
    return Guess(model, x, float(period), start, chosen, given, initial, run)


def _phase(run: Trajectory, period: float) -> int:
    """Return a row of the last period where most contacts slip, far from events."""
    rows = numpy.flatnonzero(run.t >= run.t_end - period)
    held = (run.codes[rows] == 0).sum(axis=1)
    rows = rows[held == held.min()]
    events = numpy.array([event.t for event in run.events])
    if not events.size:
        return int(rows[len(rows) // 2])
    distance = numpy.abs(run.t[rows][:, None] - events[None, :]).min(axis=1)
    return int(rows[numpy.argmax(distance)])


def sizes(run: Trajectory, period: float) -> Array:
    """Return sizes of the states over the last period of a run.

    Parameters
    ----------
    run : Trajectory
    period : float
        s.

    Returns
    -------
    (n,) array
        How far each moves; where it hardly does, how large it is.
    """
    late = run.x[:, run.t >= run.t_end - period * (1 + 1e-9)]
    moved, large = numpy.ptp(late, axis=1), numpy.abs(late).max(axis=1)
    found = numpy.where(moved > QUIET * large, moved, large)
    return numpy.where(found > 0, found, 1.0)
