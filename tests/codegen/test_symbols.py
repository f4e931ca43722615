"""The quick way to free symbols finds what sympy finds."""

import pytest
import sympy

from bondgraph.codegen.symbols import symbols_in

x, y, z = sympy.symbols("x y z")


@pytest.mark.parametrize(
    "expression",
    [
        *(x, sympy.S.Zero, sympy.pi, 2 * x * y - z / 3, x ** (y + 1), sympy.sqrt(x)),
        *(sympy.exp(-x * y), sympy.Piecewise((x, y > 0), (z, True)), sympy.Abs(x) + sympy.sign(y)),
        *(sympy.Integral(x * y, (x, 0, z)), sympy.Max(x, 2 * y), sympy.I * x),
    ],
)
def test_as_sympy_says(expression):
    assert symbols_in(expression) == expression.free_symbols


def test_the_set_is_the_caller_s():
    found = symbols_in(x)
    found.add(y)
    assert symbols_in(x) == {x}
