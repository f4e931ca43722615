"""Transfer functions in symbols."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from ..codegen.to_latex import latex_name
from .polynomial import Polynomial
from .tidy import tidy


@dataclass(frozen=True)
class TransferFunction:
    r"""A transfer function in lowest terms, from one input to one output.

    Attributes
    ----------
    output, input : str
    numerator, denominator : Polynomial
        Without common factors; coefficients have no denominators.

    Examples
    --------
    >>> s, k, b = sympy.symbols("s k b", positive=True)
    >>> lag = TransferFunction("x", "F", Polynomial((sympy.S.One,), s), Polynomial((b, k), s))
    >>> lag.expression, lag.dcgain(), lag.poles(), lag.relative_degree
    (1/(b*s + k), 1/k, {-k/b: 1}, 1)
    >>> print(lag.to_latex())
    G_{x,F}\left(s\right) = \frac{1}{b \, s + k}
    """

    output: str
    input: str
    numerator: Polynomial
    denominator: Polynomial

    @property
    def expression(self) -> sympy.Expr:
        """Numerator over denominator."""
        return self.numerator.expression / self.denominator.expression

    @property
    def relative_degree(self) -> int:
        """Degree of the denominator less that of the numerator.

        0 for a system that is proper but not strictly so; negative where the
        output holds the rate of the input.
        """
        return self.denominator.degree - self.numerator.degree

    def dcgain(self) -> sympy.Expr:
        """Return the gain at s = 0; ``zoo`` where there is a free integrator."""
        above, below = self.numerator.coefficients[-1], self.denominator.coefficients[-1]
        return sympy.zoo if below == 0 else tidy(above / below)

    def poles(self) -> dict[sympy.Expr, int]:
        """Return poles and their multiplicity, 1/s, where they have a closed form.

        Raises
        ------
        SymbolicError
            See `Polynomial.roots`.
        """
        return self.denominator.roots()

    def zeros(self) -> dict[sympy.Expr, int]:
        """Return zeros and their multiplicity, 1/s, where they have a closed form.

        Raises
        ------
        SymbolicError
            See `Polynomial.roots`.
        """
        return self.numerator.roots()

    def to_latex(self) -> str:
        """Write the transfer function as LaTeX, as one equation."""
        s = self.numerator.variable
        name = f"G_{{{latex_name(self.output)},{latex_name(self.input)}}}"
        left = rf"{name}\left({latex_name(s.name)}\right)"
        if self.denominator.coefficients == (1,):
            return f"{left} = {self.numerator.to_latex()}"
        return rf"{left} = \frac{{{self.numerator.to_latex()}}}{{{self.denominator.to_latex()}}}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"

    def __str__(self) -> str:
        return f"({self.numerator}) / ({self.denominator})"
