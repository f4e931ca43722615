"""Linearisation about a steady state or a given point.

A graph with contacts is linearised in one mode, where it is an ordinary smooth
graph. The steady state is found by solving; nothing is typed in.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..errors import ParameterError
from ..graph import BondGraph
from ..parameters import unknown_name
from ..smooth import Smooth
from ..steady import SteadyState, given_point, steady_state
from ..values import parameter_values
from .system import LinearSystem


def linearize(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None = None,
    at: SteadyState | Mapping[Any, float] | None = None,
    inputs: Mapping[Any, float] | None = None,
    modes: Mapping[str, str] | None = None,
) -> LinearSystem:
    """Linearise about a steady state or a given point.

    Parameters
    ----------
    graph : BondGraph
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    at : SteadyState or mapping, optional
        Where; found by `steady_state` unless given. A mapping gives states
        (others keep their initial value) and need not be an equilibrium. A
        SteadyState has its own parameters, inputs and modes: what else is given of
        them must agree.
    inputs : mapping, optional
        Constant inputs.
    modes : mapping of str to str, optional
        Modes of the contacts.

    Returns
    -------
    LinearSystem
        In the states alone: algebraic variables follow states and inputs.

    Raises
    ------
    SteadyStateError
    ParameterError
        For a parameter, input or mode that differs from a given SteadyState's.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> v = One("v")
    >>> system = linearize(assemble("msd", Se("F", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 0.5))))
    >>> system.poles().round(6).tolist()
    [(-0.125+1.99609j), (-0.125-1.99609j)]
    """
    if isinstance(at, SteadyState):
        _check_agreement(at, parameters, inputs, modes)
        point = at
    elif at is not None:
        point = given_point(graph, parameters, inputs, modes, at)
    else:
        point = steady_state(graph, parameters, inputs, modes)
    smooth = Smooth(point.equations, graph, held=point.parameters)
    return linearize_at(smooth, point)


def linearize_at(smooth: Smooth, point: SteadyState) -> LinearSystem:
    """Linearise functions that are at hand about a point of theirs.

    Parameters
    ----------
    smooth : Smooth
        Of the point's equations.
    point : SteadyState

    Returns
    -------
    LinearSystem
    """
    a, b, c, d = smooth.matrices(
        point.vector, list(point.inputs.values()), smooth.vector(point.parameters)
    )
    names = tuple(symbol.name for symbol in point.equations.inputs)
    outputs = tuple(point.equations.outputs)
    return LinearSystem(a, b, c, d, tuple(point.states), names, outputs, point)


def _check_agreement(
    point: SteadyState,
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, float] | None,
    modes: Mapping[str, str] | None,
) -> None:
    """Refuse what differs from the values that a steady state was found with."""
    values = parameter_values(point.equations, parameters) if parameters else {}
    named = [str(getattr(key, "name", key)) for key in parameters or {}]
    wanted: list[tuple[str, dict[str, Any], Mapping[str, Any]]] = [
        ("parameter", {name: values[name] for name in named}, point.parameters),
        ("input", {str(getattr(k, "name", k)): v for k, v in (inputs or {}).items()}, point.inputs),
        ("mode of", dict(modes or {}), point.modes),
    ]
    for kind, given, had in wanted:
        for name, value in given.items():
            if name not in had:
                raise unknown_name(kind, name, had)
            if value != had[name]:
                raise ParameterError(
                    f"{kind} {name!r} is {value!r}, but the steady state given in at=... was found "
                    f"with {had[name]!r}; leave it out, or find the steady state with it",
                    elements=[name],
                )
