"""How large an exact number is, and the double that equals it."""

from __future__ import annotations

import math

import sympy

from ..laws import exact


def as_double(number: sympy.Rational) -> float | None:
    """Return the double that is exactly this number; None where there is none.

    Examples
    --------
    >>> as_double(sympy.Rational(1, 5)), as_double(sympy.Rational(1, 3))
    (0.2, None)
    """
    try:
        value = float(number)
    except OverflowError:
        return None
    return value if math.isfinite(value) and exact(value) == number else None


def bit_count(number: sympy.Expr) -> int:
    """Return the bits of the longer of numerator and denominator; 0 if not rational."""
    if not isinstance(number, sympy.Rational):
        return 0
    return max(int(number.p).bit_length(), int(number.q).bit_length())


def growth(base: sympy.Expr, *exponents: sympy.Expr) -> float:
    """Bound the bits of a number raised to the product of exponents; 0 where none comes out."""
    if not base.is_number or (base is sympy.E and not any(e.has(sympy.log) for e in exponents)):
        return 0
    bits = float(max(2, *map(bit_count, base.atoms(sympy.Rational) | {sympy.S.One})))
    for exponent in exponents:
        sizes = [abs(float(number)) for number in exponent.atoms(sympy.Rational)]
        bits *= max([1.0, *sizes])
    return bits
