"""Modes: a graph with switching elements, seen in one of its modes.

In a mode each Friction is an ordinary element: stuck it imposes zero flow,
slipping it is a dissipator with a smooth law. The graph of a mode goes through
the same causality and derivation as any other, so that a stuck brake loses a
state by the machinery that handles any derivative causality.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import sympy

from .elements import Element, Friction, R, Sf
from .errors import LawError, ParameterError
from .graph import BondGraph
from .laws import exact

STICK, SLIP_FORWARD, SLIP_BACKWARD = "stick", "slip+", "slip-"
CODES: Mapping[str, int] = MappingProxyType({STICK: 0, SLIP_FORWARD: 1, SLIP_BACKWARD: -1})
LABELS: Mapping[int, str] = MappingProxyType({code: label for label, code in CODES.items()})


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
    return tuple(name for name, element in graph.of(Friction) if element.smoothing is None)


def in_mode(graph: BondGraph, modes: Mapping[str, str]) -> BondGraph:
    """Return the graph as it is while its contacts stay in the given modes.

    Parameters
    ----------
    graph : BondGraph
    modes : mapping of str to str
        Qualified name of a Friction to ``"stick"``, ``"slip+"`` or ``"slip-"``;
        contacts not named keep their modes open.

    Returns
    -------
    BondGraph
        Causality and equations follow as for any graph.

    Raises
    ------
    ParameterError
        For a name that is no Friction, or a mode that does not exist.

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
        if not isinstance(element, Friction) or element.smoothing is not None:
            known = ", ".join(contacts(graph)) or "none"
            raise ParameterError(
                f"{name!r} is no Friction with modes of graph {graph.name!r}; it has {known}",
                elements=[name],
            )
        if mode not in CODES:
            raise ParameterError(
                f"{name!r} has no mode {mode!r}; use {', '.join(CODES)}", elements=[name]
            )
        changed[name] = _frozen_in(element, CODES[mode])
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
    changed = {name: _smooth(element, value) for name, element in graph.of(Friction)}
    return replace(graph, elements=MappingProxyType({**graph.elements, **changed}))


def _smooth(element: Friction, width: sympy.Expr) -> Friction:
    def kinetic(speed: sympy.Expr) -> sympy.Expr:
        return element.kinetic.xreplace({element.speed: speed})

    twin = Friction(element.name, kinetic=kinetic, breakaway=element.breakaway, smoothing=width)
    return twin.replaced({twin.e: element.e, twin.f: element.f})


def _frozen_in(element: Friction, code: int) -> Element:
    """Return the plain element that a contact is in one mode, with the same port variables."""
    plain: Sf | R
    if code == CODES[STICK]:
        plain = Sf(element.name, 0)
    else:
        law = element.slipping(sympy.Integer(code))
        plain = R(element.name, effort=lambda flow: law.xreplace({element.f: flow}))
    return plain.replaced({plain.e: element.e, plain.f: element.f})
