"""A run started anew from a row of another, with its parameters and inputs."""

from __future__ import annotations

from typing import Any

import numpy

from ..simulation import Samples, Trajectory, simulate
from ..simulation.inputs import HOLDS, InputTable, at

Array = numpy.ndarray


def again(
    run: Trajectory,
    span: tuple[float, float],
    x: Array,
    z: Array | None = None,
    t_eval: Any = None,
    rtol: float = 1e-10,
) -> Trajectory:
    """Simulate the model of a run from other states, all else the same.

    Contacts find their modes from the states: one whose slip is rounding noise begins stuck, or
    sticks at once.

    Parameters
    ----------
    run : Trajectory
    span : (float, float)
        Start and end, s.
    x : (n,) array
        States at the start.
    z : (nz,) array, optional
        Guess of the algebraic variables.
    t_eval, rtol
        As for `bondgraph.simulate`.

    Returns
    -------
    Trajectory

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> run = simulate(mass_on_belt.graph(), 1.0)
    >>> again(run, (0.0, 0.5), run.x[:, 0]).outcome.value
    'finished'
    """
    equations = run.model.equations
    start = {state.name: float(v) for state, v in zip(equations.states, x, strict=True)}
    if z is not None:
        start |= {s.name: float(v) for s, v in zip(equations.algebraic, z, strict=True)}
    return simulate(
        run.model,
        span,
        run.parameters,
        start,
        inputs_of(run),
        t_eval,
        rtol,
        solver=run.solver,  # type: ignore[arg-type]
    )


def inputs_of(run: Trajectory) -> dict[str, Any]:
    """Return the inputs of a run as `bondgraph.simulate` takes them.

    Parameters
    ----------
    run : Trajectory

    Returns
    -------
    dict of str to Samples or callable
    """
    equations, given = run.model.equations, run.inputs
    names = [symbol.name for symbol in equations.graph.inputs]
    order = [symbol.name for symbol in equations.inputs]
    if not isinstance(given, InputTable):
        return {name: _part(given, place) for place, name in enumerate(names)}
    return {name: _column(given, order.index(name)) for name in names if name in order}


def _column(table: InputTable, place: int) -> Any:
    """Return one input of a table: samples, or a function where its pieces are cubics."""
    hold = int(table.hold[place])
    if hold not in HOLDS.values():
        return lambda time: float(at(table, numpy.array([time]))[place, 0])
    label = next(name for name, code in HOLDS.items() if code == hold)
    return Samples(table.knots, table.values[:, place], label)


def _part(function: Any, place: int) -> Any:
    return lambda time: float(function(time)[place])
