"""How laws become elements: the builders that several effects share."""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from ...elements import C, Element, Friction, R, Se, Sf
from .place import Change, Place
from .value import DISPLACEMENT, EFFORT, FLOW

Law = Mapping[str, sympy.Expr]
Symbols = Mapping[str, sympy.Symbol]


def resistor(place: Place, law: Law, symbols: Symbols) -> Change:
    """Bond an R with ``law["effort"]`` in FLOW or ``law["flow"]`` in EFFORT."""
    if "effort" in law:
        element = R(place.name, effort=lambda flow: law["effort"].xreplace({FLOW: flow}))
        return Change((place.node >> element,), first=(element,))
    element = R(place.name, flow=lambda effort: law["flow"].xreplace({EFFORT: effort}))
    return Change((place.node >> element,))


def spring(place: Place, law: Law, symbols: Symbols) -> Change:
    """Bond a C with ``law["energy"]`` in DISPLACEMENT, which starts where the place is."""
    element = C(
        place.name,
        energy=lambda q: law["energy"].xreplace({DISPLACEMENT: q}),
        initial=place.initial(place.displacement),
    )
    return Change((place.node >> element,), starts=begins(element.q, place))


def begins(state: sympy.Symbol, place: Place) -> dict[sympy.Symbol, sympy.Expr]:
    """Return where a displacement of the place begins, if the graph knows one."""
    return {} if place.displacement is None else {state: place.displacement}


def source(place: Place, law: Law, symbols: Symbols) -> Change:
    """Bond a source of ``law["effort"]`` or ``law["flow"]``."""
    element = Se(place.name, law["effort"]) if "effort" in law else Sf(place.name, law["flow"])
    return Change((element >> place.node,))


def resourced(element: Element, signal: sympy.Expr) -> Element:
    """Return a source of another effort or flow with the same port variables."""
    new = Se(element.name, signal) if isinstance(element, Se) else Sf(element.name, signal)
    return stands_for(new, element)


def stands_for(new: Element, old: Element) -> Element:
    """Return a new element that has the variables of an old one, so that others still hear it."""
    return new.replaced({new.symbols[key]: symbol for key, symbol in old.symbols.items()})


def weakened(old: R | Friction, share: sympy.Expr) -> Element:
    """Return a dissipator whose effort is a share of what it was, with the same port variables."""
    new: R | Friction
    if isinstance(old, Friction):
        new = Friction(
            old.name,
            kinetic=lambda speed: share * old.kinetic.xreplace({old.speed: speed}),
            breakaway=share * old.breakaway,
            smoothing=old.smoothing,
        )
    elif old.effort is not None:
        effort = old.effort
        new = R(old.name, effort=lambda f: share * effort.xreplace({old.f: f}))
    else:
        flow = old.flow
        assert flow is not None
        new = R(old.name, flow=lambda e: flow.xreplace({old.e: e / share}))
    return stands_for(new, old)
