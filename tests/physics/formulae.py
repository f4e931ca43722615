"""Laws of random elements, each written once for any arithmetic.

A law is a plain formula, ``formula(m, x, a)``: m gives the functions (sympy to write a graph,
mpmath to evaluate at a point), x the variable, a a number. What follows from one (an effort
from an energy) is written down by hand beside it, not derived.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath
import sympy

Formula = Callable[[Any, Any, Any], Any]


class Store(NamedTuple):
    """A storage's co-energy variable as a function of its state, and its energy."""

    law: Formula
    energy: Formula


RESISTS: dict[str, Formula] = {
    "linear": lambda m, x, a: a * x,
    "cubic": lambda m, x, a: a * x + x**3,
    "tanh": lambda m, x, a: a * x + m.tanh(x),
    "rise": lambda m, x, a: a * x + m.exp(x) - 1,
}
STORES = {
    "linear": Store(lambda m, x, a: x / a, lambda m, x, a: x**2 / (2 * a)),
    "cubic": Store(lambda m, x, a: a * x + x**3, lambda m, x, a: a * x**2 / 2 + x**4 / 4),
    "growth": Store(lambda m, x, a: m.exp(x / a) - 1, lambda m, x, a: a * m.exp(x / a) - x),
    "swing": Store(lambda m, x, a: a * m.sin(x) + x, lambda m, x, a: x**2 / 2 - a * m.cos(x)),
    # a body's temperature by its entropy
    "hot": Store(lambda m, x, a: 2 * m.exp(x / a), lambda m, x, a: 2 * a * m.exp(x / a)),
}
# what a signal h makes of a number a
MODULATES: dict[str, Formula] = {
    "square": lambda m, h, a: a * (1 + h**2),
    "sine": lambda m, h, a: a * (2 + m.sin(h)),
}
FOLLOWS: dict[str, Formula] = {
    "linear": lambda m, h, a: a * h,
    "sine": lambda m, h, a: a * m.sin(h),
    "square": lambda m, h, a: a * h**2,
}
KINETIC: dict[str, Formula] = {
    "falling": lambda m, speed, a: a * (1 + m.exp(-speed)),
    "viscous": lambda m, speed, a: a + speed,
}
# beyond the quadratic part of a field of two ports or more: energy, and gradient in those two
COUPLES: dict[str, tuple[Callable[..., Any], Callable[..., Any]]] = {
    "quartic": (lambda x, y: (x - y) ** 4 / 4, lambda x, y: ((x - y) ** 3, -((x - y) ** 3))),
    "product": (lambda x, y: x**2 * y**2 / 2, lambda x, y: (x * y**2, x**2 * y)),
}


def symbolic(value: Fraction) -> sympy.Rational:
    """Return a fraction for sympy."""
    return sympy.Rational(value.numerator, value.denominator)


def precise(value: Fraction) -> mpmath.mpf:
    """Return a fraction for mpmath, in its working precision."""
    return mpmath.mpf(value.numerator) / value.denominator
