"""Variables of a graph: one symbol for each effort and flow, shared at junctions."""

from __future__ import annotations

import sympy

from ..elements import EffortSource, FlowSource, One, R, Storage, Switched, Zero
from ..graph import BondGraph


class Nets:
    """Variables: one symbol for each effort and flow, shared at junctions."""

    def __init__(self, graph: BondGraph) -> None:
        self._parent = list(range(2 * len(graph.bonds)))
        self.at: dict[str, list[int]] = {name: [] for name in graph.elements}
        for index, bond in enumerate(graph.bonds):
            self.at[bond.tail].append(index)
            self.at[bond.head].append(index)
        for name, element in graph.elements.items():
            if isinstance(element, Zero | One):
                which = "e" if isinstance(element, Zero) else "f"
                for index in self.at[name][1:]:
                    self._join(_place(which, self.at[name][0]), _place(which, index))
        self._given: dict[int, sympy.Symbol] = {}
        self._name(graph)
        self._symbols = [self._given[self._find(place)] for place in range(len(self._parent))]

    def symbol(self, which: str, bond: int) -> sympy.Symbol:
        """Return the variable that a bond's effort ('e') or flow ('f') is."""
        return self._symbols[_place(which, bond)]

    def _find(self, place: int) -> int:
        parent = self._parent
        while parent[place] != place:
            parent[place] = place = parent[parent[place]]
        return place

    def _join(self, first: int, second: int) -> None:
        self._parent[self._find(second)] = self._find(first)

    def _name(self, graph: BondGraph) -> None:
        """Name each variable after a junction that shares it, else a port, else its bond."""
        for name, element in graph.elements.items():
            if isinstance(element, Zero | One):
                which = "e" if isinstance(element, Zero) else "f"
                self._give(which, self.at[name][0], name)
        for kinds in (Storage, (R, Switched, EffortSource, FlowSource)):
            for name, _ in graph.of(kinds):
                self._give("e", self.at[name][0], name)
                self._give("f", self.at[name][0], name)
        for index, bond in enumerate(graph.bonds):
            self._give("e", index, bond.name)
            self._give("f", index, bond.name)

    def _give(self, which: str, bond: int, after: str) -> None:
        shared = self._find(_place(which, bond))
        if shared not in self._given:
            self._given[shared] = sympy.Symbol(f"{after}.{which}", real=True)


def _place(which: str, bond: int) -> int:
    """Number efforts and flows: those of one bond are neighbours."""
    return 2 * bond + (which == "f")
