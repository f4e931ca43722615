"""Routh's array, for reading: the conditions come from determinants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy

from ..codegen.to_latex import latex
from .limits import Budget
from .rational import Poly, Polynomials
from .tidy import ratio


@dataclass(frozen=True, eq=False)
class RouthArray:
    """Rows of Routh's array, from the highest power down.

    Attributes
    ----------
    rows : tuple of tuple of Expr
        They end early where the array breaks off.
    breaks : str
        Where and how it breaks off; empty if it does not.

    Examples
    --------
    >>> from bondgraph.symbolic import routh_hurwitz
    >>> routh_hurwitz(sympy.symbols("a0:4", positive=True)).array().rows
    ((a0, a2), (a1, a3), ((-a0*a3 + a1*a2)/a1, 0), (a3, 0))
    >>> routh_hurwitz((1, 0, 3)).array().breaks
    'the row of s^1 is zero: roots lie symmetric about the origin'
    """

    rows: tuple[tuple[sympy.Expr, ...], ...]
    breaks: str
    degree: int
    names: Mapping[sympy.Basic, str] = field(default_factory=dict, repr=False)

    def to_latex(self) -> str:
        """Write the array as an ``array`` environment."""
        columns = len(self.rows[0])
        lines = [
            " & ".join([f"s^{{{self.degree - place}}}", *(latex(item, self.names) for item in row)])
            for place, row in enumerate(self.rows)
        ]
        body = " \\\\\n".join(lines)
        return f"\\begin{{array}}{{r|{'c' * columns}}}\n{body}\n\\end{{array}}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"


def array_of(
    space: Polynomials, numbers: Sequence[Poly], names: Mapping[sympy.Basic, str]
) -> RouthArray:
    """Return the array of a polynomial given by its coefficients, highest power first.

    Each row is kept times the pivot before it, so that its entries are
    polynomials and all divisions go out even.
    """
    budget = Budget("Routh's array")
    degree, width = len(numbers) - 1, (len(numbers) + 1) // 2
    padded = [*numbers, space.ring.zero]
    rows = [padded[0 : 2 * width : 2]]
    scales = [space.ring.one, space.ring.one]
    breaks = ""
    for place in range(1, degree + 1):
        row = padded[1 : 2 * width : 2] if place == 1 else _below(rows, scales, budget)
        rows.append(row)
        if space.is_zero(row[0]):
            breaks = _words(space, degree - place, row)
            break
        scales.append(row[0])
    shown = tuple(
        tuple(ratio(space, item, scale) for item in row)
        for row, scale in zip(rows, scales, strict=False)
    )
    return RouthArray(shown, breaks, degree, names)


def _below(rows: list[list[Poly]], scales: list[Poly], budget: Budget) -> list[Poly]:
    """Return the next row, times the last pivot."""
    above, row = rows[-2], rows[-1]
    below = []
    for upper, lower in zip(above[1:], row[1:], strict=True):
        budget.spend(len(row[0]) * len(upper) + len(above[0]) * len(lower))
        whole = row[0] * upper - above[0] * lower
        budget.check(len(whole))
        below.append(whole.exquo(scales[-3]))
    return [*below, row[0].ring.zero]


def _words(space: Polynomials, power: int, row: Sequence[Poly]) -> str:
    if all(space.is_zero(item) for item in row):
        return f"the row of s^{power} is zero: roots lie symmetric about the origin"
    return f"the row of s^{power} starts with zero: some root is not in the left half plane"
