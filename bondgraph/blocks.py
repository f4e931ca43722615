"""Ordering of assignments, and solution of what depends on itself.

Works on symbols only: a table of variables, each with an expression or with a
residual that must vanish. Strongly connected components are the algebraic
loops. A linear one is solved by elimination inside the block, in exact
arithmetic; a nonlinear one keeps its tearing variables as algebraic variables.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import networkx
import sympy

from .errors import AlgebraicLoopError

# A coefficient larger than this becomes an assignment of its own.
HOIST_OPERATIONS = 40


@dataclass(frozen=True)
class AlgebraicLoop:
    """A set of variables that depend on each other at the same instant.

    Attributes
    ----------
    variables : tuple of str
        In the order in which they depend on each other.
    tearing : tuple of str
        The variables solved for; the others follow from them.
    solved : str
        ``"linear"`` when solved symbolically, ``"algebraic"`` when kept.
    """

    variables: tuple[str, ...]
    tearing: tuple[str, ...]
    solved: str

    def __str__(self) -> str:
        path = " -> ".join(
            (*self.variables[:8], "..." if len(self.variables) > 8 else self.variables[0])
        )
        done = (
            "solved symbolically for" if self.solved == "linear" else "kept as algebraic variables:"
        )
        return f"{self.kind} {path}; {done} {', '.join(self.tearing)}"

    @property
    def kind(self) -> str:
        """What closes the loop: dependent rates, or an algebraic relation alone."""
        rates = any(name.startswith(("der(", "rate(")) for name in self.variables)
        return "loop of dependent rates" if rates else "algebraic loop"


class SingularLoopError(AlgebraicLoopError):
    """A linear loop that leaves variables open; ``bound`` holds the symbols it relates instead."""

    def __init__(
        self, message: str, elements: tuple[str, ...], bound: frozenset[sympy.Basic]
    ) -> None:
        super().__init__(message, elements=elements)
        self.bound = bound


@dataclass(frozen=True)
class Ordered:
    """What `order_and_solve` gives: code in order, and what remains implicit."""

    assignments: tuple[tuple[sympy.Symbol, sympy.Expr], ...]
    algebraic: tuple[sympy.Symbol, ...]
    residuals: tuple[sympy.Expr, ...]
    loops: tuple[AlgebraicLoop, ...]


def order_and_solve(
    explicit: Mapping[sympy.Symbol, sympy.Expr], implicit: Mapping[sympy.Symbol, sympy.Expr]
) -> Ordered:
    """Put assignments in order and solve the loops among them.

    Parameters
    ----------
    explicit : mapping of Symbol to Expr
        Variables given by an expression.
    implicit : mapping of Symbol to Expr
        Variables given by a residual that must be zero.

    Returns
    -------
    Ordered

    Raises
    ------
    AlgebraicLoopError
        When a linear loop has no unique solution.

    Examples
    --------
    >>> x, y, u = sympy.symbols("x y u")
    >>> order_and_solve({x: u - y, y: 2 * x}, {}).loops[0].solved
    'linear'
    """
    variables = list(explicit) + list(implicit)
    number = {variable: index for index, variable in enumerate(variables)}
    needs = [
        sorted(
            number[symbol]
            for symbol in (explicit.get(variable, implicit.get(variable))).free_symbols
            if symbol in number
        )
        for variable in variables
    ]
    network = networkx.DiGraph()
    network.add_nodes_from(range(len(variables)))
    network.add_edges_from((need, index) for index, wants in enumerate(needs) for need in wants)
    condensed = networkx.condensation(network)
    state = _Solver(explicit, implicit)
    for block in networkx.topological_sort(condensed):
        members = sorted(condensed.nodes[block]["members"])
        first = variables[members[0]]
        if len(members) == 1 and first in explicit and members[0] not in needs[members[0]]:
            state.assignments.append((first, explicit[first]))
        else:
            state.solve([variables[member] for member in members])
    state.check()
    return Ordered(
        tuple(state.assignments), tuple(state.algebraic), tuple(state.residuals), tuple(state.loops)
    )


class _Solver:
    """Solves one block after the other, collecting code."""

    def __init__(
        self,
        explicit: Mapping[sympy.Symbol, sympy.Expr],
        implicit: Mapping[sympy.Symbol, sympy.Expr],
    ) -> None:
        self.explicit = explicit
        self.implicit = implicit
        self.assignments: list[tuple[sympy.Symbol, sympy.Expr]] = []
        self.algebraic: list[sympy.Symbol] = []
        self.residuals: list[sympy.Expr] = []
        self.loops: list[AlgebraicLoop] = []
        self._hoisted = 0
        self._open: list[tuple[list[sympy.Symbol], list[sympy.Expr]]] = []

    def solve(self, block: list[sympy.Symbol]) -> None:
        tears = [variable for variable in block if variable in self.implicit]
        tears += _tear([variable for variable in block if variable in self.explicit], self.explicit)
        inner = _in_order([variable for variable in block if variable not in tears], self.explicit)
        solution = self._linear(tears, inner)
        if solution is None:
            self.algebraic += tears
            self.assignments += [(variable, self.explicit[variable]) for variable in inner]
            self.residuals += [
                self.implicit[tear] if tear in self.implicit else tear - self.explicit[tear]
                for tear in tears
            ]
        else:
            self.assignments += solution
            self.assignments += [(variable, self.explicit[variable]) for variable in inner]
        if len(block) > 1 or block[0] in self.explicit or solution is None:
            names = tuple(
                variable.name for variable in _around(block, self.explicit, self.implicit)
            )
            solved = "algebraic" if solution is None else "linear"
            self.loops.append(AlgebraicLoop(names, tuple(tear.name for tear in tears), solved))

    def _linear(
        self, tears: list[sympy.Symbol], inner: list[sympy.Symbol]
    ) -> list[tuple[sympy.Symbol, sympy.Expr]] | None:
        """Solve for the tears when all expressions of the block are affine in it."""
        members = {*tears, *inner}
        affine: dict[sympy.Symbol, _Affine] = {
            tear: _Affine({tear: sympy.S.One}, sympy.S.Zero) for tear in tears
        }
        mark = len(self.assignments)
        rows = []
        for variable in inner:
            form = self._affine(self.explicit[variable], affine, members)
            if form is None:
                del self.assignments[mark:]
                return None
            affine[variable] = form
        for tear in tears:
            residual = self.implicit[tear] if tear in self.implicit else tear - self.explicit[tear]
            form = self._affine(residual, affine, members)
            if form is None:
                del self.assignments[mark:]
                return None
            rows.append(form)
        return self._eliminate(tears, rows)

    def _affine(
        self,
        expression: sympy.Expr,
        known: Mapping[sympy.Symbol, _Affine],
        members: set[sympy.Symbol],
    ) -> _Affine | None:
        used = [symbol for symbol in sorted(expression.free_symbols, key=str) if symbol in members]
        total = _Affine({}, expression.xreplace({symbol: sympy.S.Zero for symbol in used}))
        for symbol in used:
            slope = sympy.diff(expression, symbol)
            if slope.free_symbols & members:
                slope = sympy.cancel(slope)
                if slope.free_symbols & members:
                    return None
            total = total.plus(known[symbol], slope)
        return total.mapped(self._hoist)

    def _hoist(self, value: sympy.Expr) -> sympy.Expr:
        """Give a large coefficient a name, so that later ones stay small."""
        if value.is_Atom or sympy.count_ops(value) <= HOIST_OPERATIONS:
            return value
        self._hoisted += 1
        symbol = sympy.Symbol(f"loop#{self._hoisted}", real=True)
        self.assignments.append((symbol, value))
        return symbol

    def _eliminate(
        self, tears: list[sympy.Symbol], rows: list[_Affine]
    ) -> list[tuple[sympy.Symbol, sympy.Expr]]:
        """Gauss elimination on the tears, exact, sparse, pivots of fewest terms first."""
        pending, solved = list(rows), []
        left = list(tears)
        while left:
            choice = _pivot(pending, left)
            if choice is None:
                self._open.append((left, [row.constant for row in pending]))
                break
            row, tear, coefficient = choice
            pending.remove(row)
            left.remove(tear)
            formula = (
                row.without(tear)
                .scaled(-1 / coefficient)
                .mapped(lambda value: self._hoist(_tidy(value)))
            )
            solved.append((tear, formula))
            pending = [
                other.without(tear)
                .plus(formula, other.terms[tear])
                .mapped(lambda value: self._hoist(_tidy(value)))
                if tear in other.terms
                else other
                for other in pending
            ]
        code: list[tuple[sympy.Symbol, sympy.Expr]] = []
        for tear, formula in reversed(solved):
            code.append((tear, _tidy(formula.expression())))
        return code

    def check(self) -> None:
        """Raise if a linear loop left variables open; tell what all such loops bind instead."""
        if not self._open:
            return
        relations = [relation for _, constants in self._open for relation in constants]
        wanted = set().union(*(relation.free_symbols for relation in relations))
        known = expansion(self.assignments, wanted)
        bound = [_tidy(relation.xreplace(known)).free_symbols for relation in relations]
        names = tuple(tear.name for tear in self._open[0][0])
        raise SingularLoopError(
            f"the algebraic loop through {', '.join(names)} has no unique solution; "
            f"add a compliance or inertia in it, or remove a redundant element",
            names,
            frozenset().union(*bound),
        )


@dataclass(frozen=True)
class _Affine:
    """Sum of coefficient times variable, plus a constant."""

    terms: Mapping[sympy.Symbol, sympy.Expr]
    constant: sympy.Expr

    def plus(self, other: _Affine, factor: sympy.Expr) -> _Affine:
        terms = dict(self.terms)
        for variable, value in other.terms.items():
            terms[variable] = terms.get(variable, sympy.S.Zero) + factor * value
        return _Affine(
            {variable: value for variable, value in terms.items() if value != 0},
            self.constant + factor * other.constant,
        )

    def without(self, variable: sympy.Symbol) -> _Affine:
        return _Affine(
            {key: value for key, value in self.terms.items() if key != variable}, self.constant
        )

    def scaled(self, factor: sympy.Expr) -> _Affine:
        return _Affine(
            {key: value * factor for key, value in self.terms.items()}, self.constant * factor
        )

    def mapped(self, change) -> _Affine:  # type: ignore[no-untyped-def]
        terms = {key: change(value) for key, value in self.terms.items()}
        return _Affine(
            {key: value for key, value in terms.items() if value != 0}, change(self.constant)
        )

    def expression(self) -> sympy.Expr:
        return sympy.Add(*(value * key for key, value in self.terms.items()), self.constant)


def _tidy(value: sympy.Expr) -> sympy.Expr:
    """Bring a small expression to one fraction, so that what is zero is seen to be."""
    if value.is_Atom or sympy.count_ops(value) > 4 * HOIST_OPERATIONS:
        return value
    try:
        return sympy.cancel(sympy.together(value))
    except sympy.PolynomialError:
        return value


def _pivot(
    rows: Iterable[_Affine], left: list[sympy.Symbol]
) -> tuple[_Affine, sympy.Symbol, sympy.Expr] | None:
    """Choose the row and variable whose coefficient is the plainest and surely not zero."""
    best = None
    for row in rows:
        for variable in left:
            coefficient = row.terms.get(variable)
            if coefficient is None or _tidy(coefficient) == 0:
                continue
            cost = (len(row.terms), not coefficient.is_number, sympy.count_ops(coefficient))
            if best is None or cost < best[0]:
                best = (cost, row, variable, coefficient)
    return None if best is None else best[1:]


def expansion(
    assignments: Sequence[tuple[sympy.Symbol, sympy.Expr]], wanted: Iterable[sympy.Basic]
) -> dict[sympy.Symbol, sympy.Expr]:
    """Expand assignments until only what is given is left, for wanted symbols and all they need.

    Examples
    --------
    >>> x, y, z = sympy.symbols("x y z")
    >>> expansion([(y, 2 * x), (z, y + 1)], [z])[z]
    2*x + 1
    """
    needed = set(wanted)
    for symbol, expression in reversed(assignments):
        if symbol in needed:
            needed |= expression.free_symbols
    known: dict[sympy.Symbol, sympy.Expr] = {}
    for symbol, expression in assignments:
        if symbol in needed:
            known[symbol] = expression.xreplace(known)
    return known


def _links(
    variables: Iterable[sympy.Symbol], table: Mapping[sympy.Symbol, sympy.Expr]
) -> networkx.DiGraph:
    members = list(variables)
    inside = set(members)
    network = networkx.DiGraph()
    network.add_nodes_from(members)
    for variable in members:
        needs = sorted(
            (symbol for symbol in table[variable].free_symbols if symbol in inside), key=str
        )
        network.add_edges_from((need, variable) for need in needs)
    return network


def _tear(
    variables: list[sympy.Symbol], explicit: Mapping[sympy.Symbol, sympy.Expr]
) -> list[sympy.Symbol]:
    """Choose variables whose removal leaves no loop: the busiest first."""
    network = _links(variables, explicit)
    tears = []
    stack = [network]
    while stack:
        part = stack.pop()
        for component in list(networkx.strongly_connected_components(part)):
            if len(component) == 1 and not part.has_edge(*(list(component) * 2)):
                continue
            inner = part.subgraph(component).copy()
            order = {variable: index for index, variable in enumerate(variables)}
            busiest = max(
                component,
                key=lambda item: (inner.in_degree(item) * inner.out_degree(item), -order[item]),
            )
            tears.append(busiest)
            inner.remove_node(busiest)
            stack.append(inner)
    return tears


def _in_order(
    variables: list[sympy.Symbol], explicit: Mapping[sympy.Symbol, sympy.Expr]
) -> list[sympy.Symbol]:
    return list(networkx.topological_sort(_links(variables, explicit)))


def _around(
    block: list[sympy.Symbol],
    explicit: Mapping[sympy.Symbol, sympy.Expr],
    implicit: Mapping[sympy.Symbol, sympy.Expr],
) -> list[sympy.Symbol]:
    """Walk once round the loop, for the report; the rest follows."""
    network = _links(block, {**explicit, **implicit})
    try:
        cycle = [edge[0] for edge in networkx.find_cycle(network)]
    except networkx.NetworkXNoCycle:
        cycle = []
    return cycle + [variable for variable in block if variable not in cycle]
