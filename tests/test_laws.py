"""Laws are functions on exact expressions."""

import math

import numpy
import pytest
import sympy

from bondgraph.errors import LawError
from bondgraph.laws import exact, regularised, stribeck

v, s = sympy.symbols("v s", real=True)


@pytest.mark.parametrize("number", [0.1, 0.2, 1e-3, -7.25, 1 / 3, 6.02e23, 1e-18])
def test_floats_become_the_rationals_they_are_written_as(number):
    value = exact(number)
    assert value.is_Rational
    assert float(value) == number


@pytest.mark.parametrize("number", [3, numpy.int64(3), numpy.float32(3), numpy.array(3.0)])
def test_any_number_is_taken(number):
    assert exact(number) == 3


def test_floats_inside_expressions():
    assert exact(0.1 * v + sympy.sin(0.5 * v)) == v / 10 + sympy.sin(v / 2)


@pytest.mark.parametrize(
    "value",
    [
        *("1", True, numpy.bool_(True), None, [1], (1, 2), {}, pytest.param(object(), id="object")),
        *(math.nan, math.inf, -math.inf, sympy.zoo, 1j, sympy.sqrt(-1)),
        *(numpy.array([1, 2]), sympy.Eq(v, 1)),
    ],
    ids=repr,
)
def test_what_is_no_finite_real_expression_is_refused(value):
    with pytest.raises(LawError):
        exact(value)


def test_stribeck_falls_from_static_to_kinetic():
    law = stribeck(s, normal=10, mu_s=0.4, mu_k=0.25, v_s=0.1)
    assert law.subs(s, 0) == 4
    assert sympy.limit(law, s, sympy.oo) == sympy.Rational(5, 2)
    slope = sympy.diff(law, s).subs(s, sympy.Rational(3, 10))
    assert float(slope) == pytest.approx(-10 * 0.15 / 0.1 * math.exp(-3))


def test_regularised_is_odd_and_saturates():
    smooth = regularised(8 - s, s, v, 0.01)
    assert smooth.subs(v, 0) == 0
    assert sympy.simplify(smooth + smooth.subs(v, -v)) == 0
    assert float(smooth.subs(v, 1)) == pytest.approx(7)
