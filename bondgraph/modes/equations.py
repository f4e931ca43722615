"""Equations of one mode, on the state vector of the whole graph.

A mode may bind states: a blocking diode in series with an inductor, a closed switch
across a capacitor, a mass at its end stop. Their storages are then in derivative
causality, and their states follow from the others. The state vector stays whole all
the same: a bound state moves at the rate that keeps it bound.

What a mode holds is written with a value imposed on it, zero while the mode lasts. An
impact or a commutation is that value going to zero in no time: the rates of the states
are linear in its rate, and so tell the jump. No rule of impact is written down anywhere;
momentum and charge are kept because the graph keeps them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import sympy

from ..causality import assign_causality
from ..elements import C, DryFriction, Storage, Switched
from ..equations import Equations, derive
from ..errors import BondGraphError, CausalConflictError
from ..graph import BondGraph
from ..parameters import Parameter


@dataclass(frozen=True, eq=False)
class ModeEquations:
    """Equations of one mode.

    Attributes
    ----------
    held : frozenset of str
        Switching elements in their mode of code 0, in which the flow is held.
    equations : Equations
        Of the graph in the mode. Frictions that slip keep their direction open,
        and count it among the parameters.
    states : tuple of Symbol
        Of the whole graph.
    derivatives : tuple of Expr
        Rate of each state of the whole graph.
    bound : tuple of Symbol
        States of the whole graph that follow from others in this mode; each has
        an assignment in the equations.
    imposed, imposed_rates : mapping of str to Symbol
        By switching element: value imposed on what its mode holds, and its rate,
        where the equations use them.
    answers : mapping of str to Expr
        By switching element: effort where the flow is held, else flow.
    directions : mapping of str to Symbol
        By friction that slips: +1 or -1, a free symbol of the equations.
    margins, values : mapping of str to Expr
        By switching element: what stays positive while the mode lasts; the slip
        or holding effort of a Friction, the margin itself of others.
    """

    held: frozenset[str]
    equations: Equations
    states: tuple[sympy.Symbol, ...]
    derivatives: tuple[sympy.Expr, ...]
    bound: tuple[sympy.Symbol, ...]
    imposed: Mapping[str, sympy.Symbol]
    imposed_rates: Mapping[str, sympy.Symbol]
    answers: Mapping[str, sympy.Expr]
    directions: Mapping[str, sympy.Symbol]
    margins: Mapping[str, sympy.Expr]
    values: Mapping[str, sympy.Expr]


def mode_equations(base: Equations, held: Collection[str]) -> ModeEquations:
    """Derive the equations of a mode, on the states of the whole graph.

    Parameters
    ----------
    base : Equations
        Of the graph with all modes open.
    held : collection of str
        Switching elements in their mode of code 0; the others are in their other
        mode.

    Returns
    -------
    ModeEquations

    Raises
    ------
    BondGraphError
        Where the mode cannot be, such as two held flows in series, or where it
        frees a state that the whole graph does not have.

    Examples
    --------
    >>> from bondgraph import Diode, I, One, R, Se, assemble, derive
    >>> loop = One("loop")
    >>> graph = assemble("choke", Se("E", 1) >> loop >> (Diode("d"), I("coil", 2), R("r", 3)))
    >>> blocked = mode_equations(derive(graph), ["d"])
    >>> [str(state) for state in blocked.bound]
    ['coil.p']
    """
    frozen = _frozen(base.graph, held)
    equations = base if not frozen.imposed else _derived(frozen.graph, base)
    _refuse_open(equations)
    _refuse_freed(equations, base, held)
    rates, own = _rates(equations), equations.own_symbols
    watched = {
        name: _watched(element, name in held, frozen.directions.get(name), own)
        for name, element in base.graph.of(Switched)
        if element.switches
    }
    moving = {
        name: equations.input_rates[symbol]
        for name, symbol in frozen.imposed.items()
        if symbol in equations.input_rates
    }
    return ModeEquations(
        held=frozenset(held),
        equations=equations,
        states=base.states,
        derivatives=tuple(rates[state] for state in base.states),
        bound=tuple(state for state in base.states if state not in equations.states),
        imposed=MappingProxyType(frozen.imposed),
        imposed_rates=MappingProxyType(moving),
        answers=MappingProxyType({name: found[0] for name, found in watched.items()}),
        directions=MappingProxyType(frozen.directions),
        margins=MappingProxyType({name: found[1] for name, found in watched.items()}),
        values=MappingProxyType({name: found[2] for name, found in watched.items()}),
    )


@dataclass(frozen=True, eq=False)
class _Frozen:
    """A graph in a mode, with what is imposed on it and the directions left open."""

    graph: BondGraph
    imposed: dict[str, sympy.Symbol]
    directions: dict[str, sympy.Symbol]


def _frozen(graph: BondGraph, held: Collection[str]) -> _Frozen:
    """Put in place of switching elements what they are in the mode.

    A friction that slips by a law of its speed stays what it is, its direction open.
    """
    switches = {name: element for name, element in graph.of(Switched) if element.switches}
    directions = {
        name: sympy.Symbol(f"{name}.direction", real=True)
        for name, element in switches.items()
        if isinstance(element, DryFriction) and name not in held
    }
    imposed = {
        name: sympy.Symbol(f"{name}.imposed", real=True)
        for name, element in switches.items()
        if name not in directions or not _depends_on_speed(element)
    }
    plain = {
        name: switches[name].plain(directions.get(name, 0 if name in held else 1), symbol)
        for name, symbol in imposed.items()
    }
    constant = dict.fromkeys(directions.values(), Parameter())
    changed = replace(
        graph,
        elements=MappingProxyType({**graph.elements, **plain}),
        inputs=MappingProxyType({**graph.inputs, **dict.fromkeys(imposed.values(), "")}),
        parameters=MappingProxyType({**graph.parameters, **constant}),
    )
    return _Frozen(changed, imposed, directions)


def _watched(
    element: Switched,
    held: bool,
    direction: sympy.Symbol | None,
    own: Mapping[sympy.Basic, sympy.Expr],
) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
    """Return what a switching element answers, its margin and its value in a mode."""
    effort, flow = own[element.e], own[element.f]
    answer = effort if held else flow
    if direction is not None:
        return answer, direction * flow, flow
    margin = element.margin(0 if held else 1).xreplace(own)
    if isinstance(element, DryFriction):
        return answer, margin, effort
    return answer, margin, sympy.S.Zero if held else margin


def _refuse_freed(equations: Equations, base: Equations, held: Collection[str]) -> None:
    freed = [state.name for state in equations.states if state not in base.states]
    if freed:
        raise BondGraphError(
            f"graph {equations.name!r}: with {_named(held)} held, {', '.join(freed)} becomes free, which it is not "
            f"otherwise; put a small compliance or resistance beside it",
            elements=freed,
        )


def _derived(graph: BondGraph, base: Equations) -> Equations:
    """Derive with the storages dependent that always are; without, where that cannot be."""
    always = base.causal.derivative
    if always:
        try:
            return derive(assign_causality(graph, always))
        except CausalConflictError:
            pass
    return derive(graph)


def _depends_on_speed(element: Switched) -> bool:
    """Whether a friction's effort while it slips is a law of its speed, so that it is no source."""
    return isinstance(element, DryFriction) and element.speed in element.kinetic.free_symbols


def _refuse_open(equations: Equations) -> None:
    """Refuse a mode in which a friction's law of speed would have to decide the speed."""
    if equations.switches:
        names = list(equations.switches)
        raise BondGraphError(
            f"graph {equations.name!r}: while it slips, {', '.join(names)} would have to decide a flow, which dry "
            f"friction that depends on speed cannot; add a compliance or inertia beside it",
            elements=names,
        )


def _rates(equations: Equations) -> dict[sympy.Symbol, sympy.Expr]:
    """Return the rate of every state, bound or not."""
    rates: dict[sympy.Symbol, sympy.Expr] = dict(
        zip(equations.states, equations.derivatives, strict=True)
    )
    for name, element in equations.graph.of(Storage):
        letter, conjugate = ("q", "f") if isinstance(element, C) else ("p", "e")
        state = sympy.Symbol(f"{name}.{letter}", real=True)
        rates.setdefault(state, equations.ports[f"{name}.{conjugate}"])
    return rates


def _named(names: Collection[str]) -> str:
    return ", ".join(sorted(names)) or "nothing"
