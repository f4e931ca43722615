"""Accounts: power that sources give, power that dissipators take, energy that storages hold.

On a pseudo-bond the flow is heat, so that it alone is the power; elsewhere power is effort
times flow.
"""

from __future__ import annotations

from collections.abc import Callable

import sympy

from ..elements import (
    RS,
    C,
    EffortSource,
    FlowSource,
    Heat,
    Junction,
    One,
    OnePort,
    R,
    Storage,
    Switched,
    TwoPort,
)
from ..errors import GraphError
from ..graph import BondGraph
from ..terms import product
from .nets import Nets

Local = Callable[[sympy.Expr], sympy.Expr]


class Accounts:
    """Writes power and energy of each element in the equations' variables.

    Parameters
    ----------
    graph : BondGraph
    nets : Nets
    local : callable
        Puts the graph's variables in place of the elements' own symbols.

    Raises
    ------
    GraphError
        Where a pseudo-bond meets what knows power only: TF, GY, an inertia or a
        switching element.
    """

    def __init__(self, graph: BondGraph, nets: Nets, local: Local) -> None:
        self._graph = graph
        self._nets = nets
        self._local = local
        self._pseudo = pseudo_elements(graph)

    def supplied(self) -> dict[str, sympy.Expr]:
        """Return the power given by each source."""
        return {
            name: -self._taken(name, element)
            for name, element in self._graph.of((EffortSource, FlowSource))
            if not isinstance(element, Heat)
        }

    def dissipated(self) -> dict[str, sympy.Expr]:
        """Return the power taken by each dissipator; what an RS passes on as heat comes back."""
        found = {}
        for name, element in self._graph.of((R, Switched, Heat)):
            if isinstance(element, Heat):
                found[name] = -self._local(element.power)
            elif name not in self._pseudo:
                found[name] = self._taken(name, element)
            elif not self._beside_one(name):
                found[name] = self._local(element.f)
        return found

    def energies(self) -> dict[str, sympy.Expr | None]:
        """Return the energy of each storage, and of each field by the field's name."""
        found: dict[str, sympy.Expr | None] = {}
        for name, element in self._graph.of(Storage):
            if name in self._pseudo:
                found[name] = self._local(element.state)
            elif not element.partners:
                found[name] = None if element.energy is None else self._local(element.energy)
            elif element.energy != 0:
                found[name.rpartition(".")[0]] = self._local(element.energy)
        return found

    def _taken(self, name: str, element: OnePort) -> sympy.Expr:
        """Return the power that a one-port takes: along its bond, if the arrow points to it."""
        index = self._nets.at[name][0]
        sign = 1 if self._graph.bonds[index].head == name else -1
        flow = self._local(element.f)
        if name in self._pseudo:
            return sign * flow
        return product(sympy.Integer(sign), self._local(element.e), flow)

    def _beside_one(self, name: str) -> bool:
        bond = self._graph.bonds[self._nets.at[name][0]]
        other = bond.tail if bond.head == name else bond.head
        return isinstance(self._graph.elements[other], One)


def pseudo_elements(graph: BondGraph) -> set[str]:
    """Return the elements that stand on pseudo-bonds: what a pseudo junction or heat port reaches.

    Raises
    ------
    GraphError

    Examples
    --------
    >>> from bondgraph import C, R, Zero, assemble
    >>> room = Zero("room", pseudo=True)
    >>> sorted(pseudo_elements(assemble("g", room >> (C("air", 5), R("wall", 2)))))
    ['air', 'room', 'wall']
    """
    marked = [name for name, element in graph.of((Junction, Heat)) if element.pseudo]
    if not marked:
        return set()
    beside: dict[str, list[str]] = {name: [] for name in graph.elements}
    for bond in graph.bonds:
        beside[bond.tail].append(bond.head)
        beside[bond.head].append(bond.tail)
    found: set[str] = set()
    stack = marked
    while stack:
        name = stack.pop()
        if name in found:
            continue
        found.add(name)
        element = graph.elements[name]
        if isinstance(element, TwoPort | Switched) or (
            isinstance(element, Storage) and not isinstance(element, C)
        ):
            raise GraphError(
                f"graph {graph.name!r}: {element.kind} {name!r} stands on a pseudo-bond, whose flow is heat; "
                f"join the domains by an {RS.__name__}, or use true bonds (temperature and entropy flow)",
                elements=[name],
            )
        stack += beside[name]
    return found
