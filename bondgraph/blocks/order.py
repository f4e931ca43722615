"""Order: assignments sorted by what they need, and their loops solved and told."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import sympy

from ..codegen.symbols import symbols_in
from ..errors import AlgebraicLoopError, owners
from ..terms import slopes
from .components import components
from .elimination import Affine, Elimination, Names, combined, tidy
from .tearing import around, in_order, tear


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
            for symbol in symbols_in(explicit.get(variable, implicit.get(variable)))
            if symbol in number
        )
        for variable in variables
    ]
    state = _Solver(explicit, implicit)
    for members in components(needs):
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
        self.names = Names()
        self.assignments = self.names.assignments
        self.algebraic: list[sympy.Symbol] = []
        self.residuals: list[sympy.Expr] = []
        self.loops: list[AlgebraicLoop] = []
        self._open: list[sympy.Symbol] = []
        self._left: list[sympy.Expr] = []

    def solve(self, block: list[sympy.Symbol]) -> None:
        """Solve one block: for its tears by elimination, or keep them as algebraic variables."""
        tears = [variable for variable in block if variable in self.implicit]
        tears += tear([variable for variable in block if variable in self.explicit], self.explicit)
        torn = set(tears)
        inner = in_order([variable for variable in block if variable not in torn], self.explicit)
        rows = self._rows(tears, inner)
        if rows is None:
            self.algebraic += tears
            self.residuals += [self._residual(variable) for variable in tears]
        else:
            elimination = Elimination(rows, self.names)
            self.assignments += elimination.code()
            solved = {variable for variable, _ in elimination.solved}
            self._open += [variable for variable in tears if variable not in solved]
            self._left += elimination.left
        self.assignments += [(variable, self.explicit[variable]) for variable in inner]
        if len(block) > 1 or block[0] in self.explicit or rows is None:
            path = around(block, {**self.explicit, **self.implicit})
            self.loops.append(
                AlgebraicLoop(
                    tuple(variable.name for variable in path),
                    tuple(variable.name for variable in tears),
                    "algebraic" if rows is None else "linear",
                )
            )

    def check(self) -> None:
        """Raise if a linear loop left variables open; tell what such loops bind instead."""
        if not self._open:
            return
        wanted = set().union(*(relation.free_symbols for relation in self._left))
        known = expansion(self.assignments, wanted)
        bound = [tidy(relation.xreplace(known)).free_symbols for relation in self._left]
        names = tuple(variable.name for variable in self._open)
        raise SingularLoopError(
            f"the algebraic loop through {_few(names)} has no unique solution; "
            f"add a compliance or inertia in it, or remove a redundant element",
            owners(names) or names,
            frozenset().union(*bound),
        )

    def _residual(self, variable: sympy.Symbol) -> sympy.Expr:
        if variable in self.implicit:
            return self.implicit[variable]
        return variable - self.explicit[variable]

    def _rows(self, tears: list[sympy.Symbol], inner: list[sympy.Symbol]) -> list[Affine] | None:
        """Write the residuals of the tears as affine in the tears; None where one is not."""
        members = {*tears, *inner}
        known = {variable: Affine({variable: sympy.S.One}, sympy.S.Zero) for variable in tears}
        mark = len(self.assignments)
        rows = []
        for variable in (*inner, *tears):
            inside = variable not in known
            expression = self.explicit[variable] if inside else self._residual(variable)
            form = _affine(expression, known, members)
            if form is None:
                del self.assignments[mark:]
                return None
            if inside:
                known[variable] = form.mapped(self.names.named)
            else:
                rows.append(form)
        return rows


def _affine(
    expression: sympy.Expr,
    known: Mapping[sympy.Symbol, Affine],
    members: set[sympy.Symbol],
) -> Affine | None:
    """Write an expression as affine in the unknowns that its members stand for."""
    used = [symbol for symbol in sorted(expression.free_symbols, key=str) if symbol in members]
    factors = slopes(expression, used)
    if any(slope.free_symbols & members for slope in factors.values()):
        expression = tidy(expression)  # it may only look nonlinear
        factors = slopes(expression, used)
        if any(slope.free_symbols & members for slope in factors.values()):
            return None
    constant = expression.xreplace(dict.fromkeys(used, sympy.S.Zero))
    return combined(constant, ((known[symbol], slope) for symbol, slope in factors.items()))


def _few(names: tuple[str, ...]) -> str:
    return ", ".join(names if len(names) <= 4 else [*names[:4], "..."])


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
