"""Graphs in modes: switching elements replaced by what they are while a mode lasts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import sympy

from ..elements import DryFriction, Element, Friction, Switched
from ..errors import LawError, ParameterError
from ..graph import BondGraph
from ..laws import exact


def contacts(graph: BondGraph) -> tuple[str, ...]:
    """Return the qualified names of the elements that have modes.

    Parameters
    ----------
    graph : BondGraph

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> from bondgraph import Friction, I, One, assemble
    >>> v = One("v")
    >>> contacts(assemble("sled", v >> (I("m", 1), Friction("floor", kinetic=lambda speed: 3))))
    ('floor',)
    """
    return tuple(name for name, element in graph.of(Switched) if element.switches)


def in_mode(graph: BondGraph, modes: Mapping[str, str]) -> BondGraph:
    """Return the graph as it is while its contacts stay in the given modes.

    Parameters
    ----------
    graph : BondGraph
    modes : mapping of str to str
        Qualified name of a switching element to the label of a mode, such as
        ``"stick"``, ``"slip+"`` or ``"slip-"`` of a Friction, ``"blocking"`` or
        ``"conducting"`` of a Diode; those not named keep their modes open.

    Returns
    -------
    BondGraph
        Causality and equations follow as for any graph.

    Raises
    ------
    ParameterError
        For a name that has no modes, or a mode that does not exist.

    Examples
    --------
    >>> from bondgraph import Friction, I, One, assemble, derive
    >>> v = One("v")
    >>> sled = assemble("sled", v >> (I("m", 1), Friction("floor", kinetic=lambda speed: 3)))
    >>> [str(rate) for rate in derive(in_mode(sled, {"floor": "slip+"})).explicit().values()]
    ['-3']
    """
    changed: dict[str, Element] = {}
    for name, mode in modes.items():
        element = graph.elements.get(name)
        if not isinstance(element, Switched) or not element.switches:
            known = ", ".join(contacts(graph)) or "none"
            raise ParameterError(
                f"{name!r} is no element with modes of graph {graph.name!r}; it has {known}",
                elements=[name],
            )
        try:
            changed[name] = element.plain(element.code(mode))
        except LawError as error:
            raise ParameterError(str(error), elements=[name]) from None
    return replace(graph, elements=MappingProxyType({**graph.elements, **changed}))


def smoothed(graph: BondGraph, width: Any) -> BondGraph:
    """Return the graph with the jump of dry friction replaced by ``tanh(slip / width)``.

    For comparison only: a smooth contact creeps where a real one sticks.

    Parameters
    ----------
    graph : BondGraph
    width : number or Expr
        Slip over which the friction turns, m/s.

    Returns
    -------
    BondGraph

    Raises
    ------
    LawError
        If the width is not positive.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> contacts(smoothed(mass_on_belt.graph(), 1e-3))
    ()
    """
    value = exact(width)
    if value.is_positive is False:
        raise LawError(f"the smoothing width is {width}; it must be positive")
    changed = {name: _smooth(element, value) for name, element in graph.of(DryFriction)}
    return replace(graph, elements=MappingProxyType({**graph.elements, **changed}))


def _smooth(element: DryFriction, width: sympy.Expr) -> DryFriction:
    def kinetic(speed: sympy.Expr) -> sympy.Expr:
        return element.kinetic.xreplace({element.speed: speed})

    twin = Friction(element.name, kinetic=kinetic, breakaway=element.breakaway, smoothing=width)
    return twin.replaced({twin.e: element.e, twin.f: element.f})
