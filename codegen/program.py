"""Program: named vector arguments, ordered assignments, named vector results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy

from .collector import held_back
from .symbols import symbols_in


class ProgramError(ValueError):
    """The assignments do not make a program: a symbol is used before it is known."""


@dataclass(frozen=True)
class Program:
    """Straight-line code on symbols.

    Attributes
    ----------
    name : str
        A valid identifier; the generated function's name.
    arguments : tuple of (str, tuple of Symbol)
        Vector arguments in order.
    assignments : tuple of (Symbol, Expr)
        Each uses arguments and earlier assignments only.
    results : tuple of (str, tuple of Expr)
        Vector results in order.

    Raises
    ------
    ProgramError
        If a symbol is used before it is known, or assigned twice.

    Examples
    --------
    >>> x, y = sympy.symbols("x y")
    >>> Program("square", (("x", (x,)),), ((y, x**2),), (("out", (y + 1,)),)).operations
    2
    """

    name: str
    arguments: tuple[tuple[str, tuple[sympy.Symbol, ...]], ...]
    assignments: tuple[tuple[sympy.Symbol, sympy.Expr], ...]
    results: tuple[tuple[str, tuple[sympy.Expr, ...]], ...]

    def __post_init__(self) -> None:
        if not self.name.isidentifier():
            raise ProgramError(f"program name {self.name!r} is no identifier")
        known: set[sympy.Basic] = set()
        for label, symbols in self.arguments:
            for symbol in symbols:
                if symbol in known:
                    raise ProgramError(
                        f"program {self.name!r}: argument {symbol} of {label!r} stands twice"
                    )
                known.add(symbol)
        for symbol, expression in self.assignments:
            if symbol in known:
                raise ProgramError(f"program {self.name!r}: {symbol} is assigned twice")
            self._check(expression, known, "assignment of", symbol)
            known.add(symbol)
        for label, expressions in self.results:
            for expression in expressions:
                self._check(expression, known, "result", repr(label))

    def _check(
        self, expression: sympy.Expr, known: set[sympy.Basic], what: str, name: object
    ) -> None:
        missing = symbols_in(expression) - known
        if missing:
            names = ", ".join(sorted(map(str, missing)))
            raise ProgramError(
                f"program {self.name!r}, {what} {name}: {names} not known at this point"
            )

    @property
    def operations(self) -> int:
        """Number of arithmetic operations, as sympy counts them."""
        expressions = [expression for _, expression in self.assignments]
        expressions += [expression for _, result in self.results for expression in result]
        return int(sum(sympy.count_ops(expression) for expression in expressions))

    @classmethod
    @held_back()
    def pruned(
        cls,
        name: str,
        arguments: Iterable[tuple[str, Iterable[sympy.Symbol]]],
        assignments: Iterable[tuple[sympy.Symbol, sympy.Expr]],
        results: Mapping[str, Iterable[sympy.Expr]],
    ) -> Program:
        """Build a program that keeps only the assignments its results need.

        Parameters
        ----------
        name : str
        arguments : iterable of (str, iterable of Symbol)
        assignments : iterable of (Symbol, Expr)
            Ordered.
        results : mapping of str to iterable of Expr

        Returns
        -------
        Program

        Examples
        --------
        >>> x, y, z = sympy.symbols("x y z")
        >>> program = Program.pruned("f", [("x", [x])], [(y, x + 1), (z, x * 2)], {"out": [y]})
        >>> program.assignments
        ((y, x + 1),)
        """
        wanted = {
            key: tuple(sympy.sympify(item) for item in value) for key, value in results.items()
        }
        needed: set[sympy.Basic] = set()
        for expressions in wanted.values():
            for expression in expressions:
                needed |= symbols_in(expression)
        kept = []
        for symbol, expression in reversed(list(assignments)):
            if symbol in needed:
                kept.append((symbol, expression))
                needed |= symbols_in(expression)
        return cls(
            name,
            tuple((label, tuple(symbols)) for label, symbols in arguments),
            tuple(reversed(kept)),
            tuple(wanted.items()),
        )
