"""Expressions that every backend must know, with points inside their domain."""

from __future__ import annotations

import sympy

x, y = sympy.symbols("x y", real=True)

ANYWHERE = [-2.5, -1.0, -0.3, 0.0, 0.4, 1.0, 3.7]
INSIDE_ONE = [-0.9, -0.3, 0.0, 0.5, 0.99]
POSITIVE = [0.01, 0.5, 1.0, 2.0, 40.0]

CASES: dict[sympy.Expr, list[float]] = {
    **dict.fromkeys(
        [
            *(sympy.exp(x), sympy.sin(x), sympy.cos(x), sympy.tan(x / 3), sympy.atan(x)),
            *(sympy.sinh(x), sympy.cosh(x), sympy.tanh(x), sympy.asinh(x), sympy.erf(x)),
            *(sympy.Abs(x), sympy.sign(x), sympy.floor(x), sympy.ceiling(x), sympy.Heaviside(x)),
            *(sympy.Heaviside(x, 1), sympy.Min(x, y), sympy.Max(x, y, 0), sympy.atan2(x, y + 3)),
            *(sympy.Min(x, 1), sympy.Max(0, x)),
            *(x**2, x**3, x**8, x**9, x**12, 1 / (x + 5), (x + 5) ** -3, (x + 5) ** -9),
            *(sympy.sqrt(x**2 + 1), 1 / sympy.sqrt(x**2 + 1), (x**2 + 1) ** sympy.Rational(1, 3)),
            *(
                (x**2 + 1) ** y,
                (x + 4) ** (y + 1),
                2**x,
                sympy.pi * x + sympy.E,
                sympy.Rational(1, 3) * x,
            ),
            *(x - y, x * y / 7, -x, sympy.S(3), sympy.sqrt(2) * x, sympy.GoldenRatio + x),
            sympy.Piecewise((x**2, x > 1), (-x, x < -1), (sympy.sin(x), True)),
            sympy.Piecewise((1, sympy.And(x > 0, y > 0)), (2, sympy.Or(x < -2, y >= 1)), (3, True)),
            sympy.Piecewise((1, sympy.Not(sympy.And(x > 0, y > 0))), (x, True)),
            sympy.Piecewise((x, sympy.Eq(y, 1)), (y, sympy.Ne(x, 0)), (7, True)),
            sympy.Piecewise((x, x <= y), (y, True)),
        ],
        ANYWHERE,
    ),
    **dict.fromkeys([sympy.asin(x), sympy.acos(x), sympy.atanh(x)], INSIDE_ONE),
    **dict.fromkeys([sympy.log(x), sympy.sqrt(x), x**-0.5, x**1.7, sympy.acosh(x + 1)], POSITIVE),
}
