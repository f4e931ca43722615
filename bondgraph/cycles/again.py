"""A run started anew from a row of another, with its parameters and inputs."""

from __future__ import annotations

from typing import Any

import numpy

from ..simulation import Samples, Trajectory, simulate
from ..simulation.problem import InputTable

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
    if not isinstance(given, InputTable):
        return {name: _part(given, place) for place, name in enumerate(names)}
    order = [symbol.name for symbol in equations.inputs]
    return {
        name: Samples(
            given.knots,
            given.values[:, order.index(name)],
            "linear" if given.hold[order.index(name)] else "zero",
        )
        for name in names
        if name in order
    }


def _part(function: Any, place: int) -> Any:
    return lambda time: float(function(time)[place])
