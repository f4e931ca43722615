"""What binds a dependent storage, and what moves along with an independent one."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

import sympy

from ..blocks.elimination import tidy
from ..elements import EffortSource, FlowSource, SignalBlock, Storage
from ..equations import Equations
from .value import Reduction

# Larger expressions are not for reading.
READABLE = 200


class Constraints:
    """Follows variables of the equations back to what they rest on.

    Parameters
    ----------
    equations : Equations
    imposed : collection of Symbol
        Values that modes impose, zero while a mode lasts.
    """

    def __init__(self, equations: Equations, imposed: Collection[sympy.Symbol] = ()) -> None:
        self._equations = equations
        self._zero = {symbol: sympy.S.Zero for symbol in imposed}
        self._known = dict(equations.assignments)
        self._known |= dict(zip(equations.algebraic, equations.residuals, strict=True))
        self._owner = dict(self._owners())
        self._sizes: dict[sympy.Basic, int] | None = None

    def _owners(self) -> Iterator[tuple[sympy.Basic, str]]:
        equations = self._equations
        states = set(equations.states)
        for name, _ in equations.graph.of((Storage, SignalBlock)):
            for letter in "qpy":
                state = equations.ports.get(f"{name}.{letter}")
                if state in states:
                    yield state, name
        for name, element in equations.graph.of((EffortSource, FlowSource)):
            yield (
                equations.ports[f"{name}.{'e' if isinstance(element, EffortSource) else 'f'}"],
                name,
            )
        for name, symbol in equations.switches.items():
            yield symbol, name
        for symbol in equations.inputs:
            if symbol not in self._zero:
                yield symbol, symbol.name

    def _count(self) -> dict[sympy.Basic, int]:
        """Count the operations that each variable would have, expanded; on first demand."""
        if self._sizes is None:
            self._sizes = {}
            for symbol, expression in self._equations.assignments:
                self._sizes[symbol] = _size(expression, self._sizes)
        return self._sizes

    def bound_by(self, expression: sympy.Expr, besides: Iterable[str] = ()) -> tuple[str, ...]:
        """Return the names of storages, sources, inputs and switches that an expression rests on."""
        found: dict[str, None] = {}
        seen: set[sympy.Basic] = set()
        waiting = sorted(expression.free_symbols, key=str)
        while waiting:
            symbol = waiting.pop()
            if symbol in seen:
                continue
            seen.add(symbol)
            if symbol in self._owner:
                found[self._owner[symbol]] = None
            elif symbol in self._known:
                waiting += sorted(self._known[symbol].free_symbols, key=str)
        order = [*self._equations.graph.elements, *map(str, self._equations.inputs)]
        return tuple(name for name in order if name in found and name not in besides)

    def expanded(self, expression: sympy.Expr) -> sympy.Expr | None:
        """Return an expression in states, inputs and parameters; None where it is too large."""
        if _size(expression, self._count()) > READABLE:
            return None
        value = self._equations.substituted(expression).xreplace(self._zero)
        return min(value, tidy(value), key=sympy.count_ops)

    def reductions(self, bound: dict[str, tuple[str, ...]]) -> tuple[Reduction, ...]:
        """Return each integral storage with those it alone carries, as one.

        Parameters
        ----------
        bound : dict of str to tuple of str
            Dependent storages, and what binds each.
        """
        elements = self._equations.graph.elements
        found: dict[str, list[str]] = {}
        values: dict[str, sympy.Expr] = {}
        for name in bound:
            for master in bound[name]:
                share = None
                if isinstance(elements.get(master), Storage):
                    share = self._share(name, master)
                if share is not None:
                    found.setdefault(master, []).append(name)
                    values[master] = values.get(master, sympy.S.Zero) + share
        kinds = {"C": "capacitance", "I": "inertance"}
        reductions = []
        for master, carried in found.items():
            own = self._own(master)
            if own is not None:
                value = sympy.simplify(own + values[master])
                kind = kinds[elements[master].kind]
                reductions.append(Reduction(master, tuple(carried), kind, value))
        return tuple(reductions)

    def _own(self, name: str) -> sympy.Expr | None:
        """Return the inertance or capacitance of a storage in integral causality: state per co-energy."""
        state, coenergy = self._pair(name)
        law = self.expanded(coenergy)
        slope = None if law is None else sympy.diff(law, state)
        return None if not slope else tidy(1 / slope)

    def _share(self, name: str, master: str) -> sympy.Expr | None:
        """Return what a dependent storage adds to its master; None unless it follows in proportion.

        With co-energy variables in the ratio n, the storage takes the power of n^2 times its own
        inertance or capacitance on the side of the master.
        """
        state, leading = self._pair(master)
        element = self._equations.graph.elements[name]
        assert isinstance(element, Storage)
        if element.inverse is None or element.coenergy not in element.inverse.free_symbols:
            return None
        following, leading = self.expanded(self._pair(name)[1]), self.expanded(leading)
        own = sympy.diff(element.inverse, element.coenergy)
        if following is None or not leading or element.coenergy in own.free_symbols:
            return None
        slope = sympy.diff(leading, state)
        ratio = tidy(sympy.diff(following, state) / slope) if slope != 0 else sympy.S.Zero
        if ratio == 0 or sympy.simplify(following - ratio * leading) != 0:
            return None
        # a law modulated by another element has no inertance of its own
        return None if own.atoms(sympy.Dummy) else ratio**2 * own

    def _pair(self, name: str) -> tuple[sympy.Expr, sympy.Expr]:
        """Return state and co-energy variable of a storage, in the equations' variables."""
        letters = ("q", "e") if self._equations.graph.elements[name].kind == "C" else ("p", "f")
        state, coenergy = (self._equations.ports[f"{name}.{letter}"] for letter in letters)
        return state, coenergy


def _size(expression: sympy.Expr, sizes: Mapping[sympy.Basic, int]) -> int:
    """Count the operations of an expression whose symbols stand for others."""
    inner = sum(sizes.get(node, 0) for node in sympy.preorder_traversal(expression))
    return int(sympy.count_ops(expression)) + inner
