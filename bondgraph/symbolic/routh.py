"""Routh-Hurwitz: for which parameters all roots lie in the left half plane.

The conditions come from Hurwitz determinants (in the form of Lienard and
Chipart, which needs every other one). They stay valid where the array breaks
off, and need no epsilon there.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from ..errors import ParameterError
from ..laws import exact
from ..parameters import Parameter
from ..resolver import resolve
from .array import RouthArray, array_of
from .determinant import determinant
from .latex import conditions_latex
from .limits import Budget, SymbolicError
from .polynomial import Polynomial, from_coefficients, read, split
from .rational import Poly, Polynomials, polynomials_over, split_monomial
from .signs import Signs, what_is_left
from .tidy import factored

NEGATIVE = "negative"


class Stability(enum.Enum):
    """What the conditions say before any number is given."""

    ALWAYS = "asymptotically stable for all parameters that their assumptions admit"
    CONDITIONAL = "asymptotically stable if and only if all conditions are positive"
    INTEGRATING = "never asymptotically stable: a root at zero is left whatever the others do"
    NEVER = "never asymptotically stable: on the limit at best"
    UNSTABLE = "unstable for all parameters that their assumptions admit"


@dataclass(frozen=True, eq=False)
class RouthHurwitz:
    """Conditions for all roots of a polynomial to lie in the left half plane.

    Attributes
    ----------
    status : Stability
        What is known without numbers.
    polynomial : Polynomial
        Without denominators and roots at zero; its leading coefficient is positive.
    integrators : int
        Roots at zero, which are set aside: each is a free integrator.
    conditions : tuple of Expr
        All must be positive for all other roots. What follows from the symbols' assumptions is left out.
    violated : tuple of Expr
        Conditions that no admissible parameters meet, as they are before simplification.
    reasons : tuple of str
        Why the roots can never all be to the left: one for each violated
        condition, and one for integrators.

    References
    ----------
    F. R. Gantmacher, The Theory of Matrices, vol. 2, Chelsea 1959, ch. XV.

    Examples
    --------
    >>> a = sympy.symbols("a0:4", positive=True)
    >>> cubic = routh_hurwitz(a)
    >>> cubic.conditions
    (-a0*a3 + a1*a2,)
    >>> cubic.holds({"a0": 1, "a1": 2, "a2": 2, "a3": 3})
    True
    """

    status: Stability
    polynomial: Polynomial
    integrators: int
    conditions: tuple[sympy.Expr, ...]
    violated: tuple[sympy.Expr, ...]
    reasons: tuple[str, ...]

    def holds(self, values: Mapping[Any, Any] | None = None) -> bool:
        """Tell whether the polynomial is asymptotically stable for numbers.

        Parameters
        ----------
        values : mapping, optional
            Symbol or name to a number in SI.

        Returns
        -------
        bool
            Decided exactly: a decimal number means the fraction that it is written as.

        Raises
        ------
        ParameterError
            For a value that is missing, unknown, or against what its symbol assumes.

        Examples
        --------
        >>> b, k = sympy.Symbol("b", real=True), sympy.Symbol("k", positive=True)
        >>> spring = routh_hurwitz((1, b, k))
        >>> spring.holds({b: 0.1, "k": 4}), spring.holds({"b": 0, "k": 4})
        (True, False)
        """
        numbers = self._numbers(values or {})
        found = [condition.xreplace(numbers) > 0 for condition in self.conditions]
        return not self.reasons and all(bool(item) for item in found)

    def array(self) -> RouthArray:
        """Return Routh's array of the polynomial.

        Returns
        -------
        RouthArray

        Raises
        ------
        SymbolicError
            When it is too large.
        """
        space = polynomials_over(self.polynomial.coefficients)
        whole = from_coefficients(space, self.polynomial.coefficients)
        return array_of(space, split(whole), self.polynomial.names)

    def to_latex(self) -> str:
        """Write the conditions as LaTeX, or what is known where there are none.

        Returns
        -------
        str
            An ``align*`` environment.
        """
        return conditions_latex(self.conditions, self.status.value, self.polynomial.names)

    def _repr_latex_(self) -> str:
        return self.to_latex()

    def _numbers(self, values: Mapping[Any, Any]) -> dict[sympy.Basic, sympy.Expr]:
        needed: set[sympy.Symbol] = set()
        for item in (*self.conditions, *self.polynomial.coefficients):
            needed |= item.free_symbols
        table = {symbol: Parameter() for symbol in sorted(needed, key=str)}
        found = resolve(table, values, partial=True)
        open_ = set().union(*(item.free_symbols for item in self.conditions), set())
        missing = sorted(symbol.name for symbol in open_ if symbol.name not in found)
        if missing:
            raise ParameterError(
                f"the conditions need a value for {', '.join(missing)}; give it in values={{...}}"
            )
        return {symbol: exact(found[symbol.name]) for symbol in table if symbol.name in found}


def routh_hurwitz(coefficients: Sequence[Any], s: sympy.Symbol | None = None) -> RouthHurwitz:
    """Return the conditions for a polynomial's roots to have negative real parts.

    Parameters
    ----------
    coefficients : sequence of number or Expr
        Highest power first. What symbols assume (``positive=True``) is used.
    s : Symbol, optional
        The polynomial's variable, for display.

    Returns
    -------
    RouthHurwitz

    Raises
    ------
    SymbolicError
        If all coefficients are zero, or the determinants are too large.

    Examples
    --------
    >>> routh_hurwitz((1, 2, 3)).status.name, routh_hurwitz((1, 0, 3)).reasons
    ('ALWAYS', ('the coefficient of s^1 is zero',))
    """
    numbers = [exact(item) for item in coefficients]
    space = polynomials_over(numbers)
    whole = space.normal(from_coefficients(space, numbers))
    return conditions_of(space, [whole], s or sympy.Symbol("s"))


def conditions_of(
    space: Polynomials,
    factors: Iterable[Poly],
    s: sympy.Symbol,
    names: Mapping[sympy.Basic, str] | None = None,
) -> RouthHurwitz:
    """Return the conditions for a product of polynomials of the ring."""
    integrators, product = 0, space.ring.one
    wanted: dict[Poly, str] = {}
    budget = Budget("the set of Routh-Hurwitz conditions")
    for factor in factors:
        zeros, rest = _without_zeros(space, factor)
        integrators += zeros
        rest = _led_by_plus(space, rest)
        for poly, words in _wanted(space, rest, budget):
            wanted.setdefault(poly, words)
        budget.spend(len(product) * len(rest))
        product = product * rest
    left, violated = what_is_left(space, wanted)
    for poly in (*left, product):
        budget.check(len(poly))
    signs = Signs(space, {})
    why = [_never(signs, poly) for poly in violated]
    reasons = [
        f"{wanted[poly]} is {word or 'never positive'}"
        for poly, word in zip(violated, why, strict=True)
    ]
    status = Stability.CONDITIONAL if left else Stability.ALWAYS
    if integrators:
        reasons.append(f"{integrators} root{'s' * (integrators > 1)} at zero: free integrators")
        status = Stability.INTEGRATING
    if violated:
        status = Stability.UNSTABLE if NEGATIVE in why else Stability.NEVER
    return RouthHurwitz(
        status,
        read(product, space, s, names=names or {}),
        integrators,
        tuple(factored(space, poly) for poly in left),
        tuple(factored(space, poly) for poly in violated),
        tuple(reasons),
    )


def _never(signs: Signs, poly: Poly) -> str:
    """Say what a polynomial is that is seen at once not to be positive; empty for others."""
    if not poly:
        return "zero"
    sign = signs.of(poly)
    return NEGATIVE if sign.strict and sign.value == -1 else ""


def _without_zeros(space: Polynomials, poly: Poly) -> tuple[int, Poly]:
    """Split off roots at zero."""
    if not poly:
        raise SymbolicError(
            "all coefficients are zero: every number is a root; check the polynomial"
        )
    zeros = split_monomial(poly)[0][0]
    return zeros, poly.exquo(space.s**zeros)


def _led_by_plus(space: Polynomials, poly: Poly) -> Poly:
    """Make the leading coefficient positive; one of unknown sign becomes a square."""
    first = split(poly)[0]
    sign = Signs(space, {}).of(first)
    if sign.value is None:
        return poly * first
    return poly * sign.value


def _wanted(space: Polynomials, poly: Poly, budget: Budget) -> Iterable[tuple[Poly, str]]:
    """Give what must be positive, after Lienard and Chipart, with its name; stop at what never is."""
    numbers = [space.normal(item) for item in split(poly)]
    degree = len(numbers) - 1
    signs = Signs(space, {})
    for place in range(degree, 0, -2):
        yield numbers[place], f"the coefficient of s^{degree - place}"
        if _never(signs, numbers[place]):
            return
    for order in range(1 + degree % 2, degree, 2):
        found = space.normal(hurwitz_determinant(space, numbers, order, budget))
        words = (
            f"Hurwitz determinant {order}" if order > 1 else f"the coefficient of s^{degree - 1}"
        )
        yield found, words
        if _never(signs, found):
            return


def hurwitz_determinant(
    space: Polynomials, numbers: Sequence[Poly], order: int, budget: Budget
) -> Poly:
    """Return a leading minor of the Hurwitz matrix.

    Parameters
    ----------
    space : Polynomials
    numbers : sequence of Poly
        Coefficients, highest power first.
    order : int
    budget : Budget

    Returns
    -------
    Poly
    """
    rows = []
    for row in range(1, order + 1):
        places = ((column - 1, 2 * column - row) for column in range(1, order + 1))
        entries = {column: numbers[at] for column, at in places if 0 <= at < len(numbers)}
        rows.append({column: entry for column, entry in entries.items() if entry})
    return determinant(rows, space.ring, budget)
