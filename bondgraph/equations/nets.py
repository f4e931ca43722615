"""Variables of a graph: one symbol for each effort and flow, shared at junctions."""

from __future__ import annotations

import sympy

from ..elements import EffortSource, FlowSource, One, R, Storage, Switched, Zero
from ..graph import BondGraph


class Nets:
    """Variables: one symbol for each effort and flow, shared at junctions."""

    def __init__(self, graph: BondGraph) -> None:
        self._parent: dict[tuple[str, int], tuple[str, int]] = {}
        self.at: dict[str, list[int]] = {name: [] for name in graph.elements}
        for index, bond in enumerate(graph.bonds):
            self._parent[("e", index)] = ("e", index)
            self._parent[("f", index)] = ("f", index)
            self.at[bond.tail].append(index)
            self.at[bond.head].append(index)
        for name, element in graph.elements.items():
            if isinstance(element, Zero | One):
                which = "e" if isinstance(element, Zero) else "f"
                for index in self.at[name][1:]:
                    self._join((which, self.at[name][0]), (which, index))
        self._symbols: dict[tuple[str, int], sympy.Symbol] = {}
        self._name(graph)

    def symbol(self, which: str, bond: int) -> sympy.Symbol:
        """Return the variable that a bond's effort ('e') or flow ('f') is."""
        return self._symbols[self._find((which, bond))]

    def _find(self, key: tuple[str, int]) -> tuple[str, int]:
        while self._parent[key] != key:
            self._parent[key] = self._parent[self._parent[key]]
            key = self._parent[key]
        return key

    def _join(self, first: tuple[str, int], second: tuple[str, int]) -> None:
        self._parent[self._find(second)] = self._find(first)

    def _name(self, graph: BondGraph) -> None:
        """Name each variable after a junction that shares it, else a port, else its bond."""
        for name, element in graph.elements.items():
            if isinstance(element, Zero | One):
                which = "e" if isinstance(element, Zero) else "f"
                self._give((which, self.at[name][0]), f"{name}.{which}")
        for kinds in (Storage, (R, Switched, EffortSource, FlowSource)):
            for name, _ in graph.of(kinds):
                self._give(("e", self.at[name][0]), f"{name}.e")
                self._give(("f", self.at[name][0]), f"{name}.f")
        for index, bond in enumerate(graph.bonds):
            self._give(("e", index), f"{bond.name}.e")
            self._give(("f", index), f"{bond.name}.f")

    def _give(self, key: tuple[str, int], name: str) -> None:
        self._symbols.setdefault(self._find(key), sympy.Symbol(name, real=True))
