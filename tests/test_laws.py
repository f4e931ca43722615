"""Laws are functions on exact expressions."""

import math

import numpy
import pytest
import sympy

from bondgraph.errors import LawError
from bondgraph.laws import exact, inverse, regularised, stribeck

v, s, s_e = sympy.symbols("v s s_e", real=True)


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


class TestInverse:
    @pytest.mark.parametrize(
        "law",
        [
            *(3 * v, 2 * v - 5, v**3 / 4, -7 * v**5, 4 * v * abs(v), -v * abs(v) ** 2),
            *(sympy.sign(v) * sympy.sqrt(abs(v)), s**2 * v * abs(v), 2 * sympy.sign(v) * v**2),
        ],
    )
    def test_there_and_back(self, law):
        back = inverse(law, v, s_e)
        assert back is not None
        for number in (-2.5, -0.3, 0.7, 4.0):
            at = {s: 1.3}
            there = float(law.subs(v, number).subs(at))
            assert float(back.subs(s_e, there).subs(at)) == pytest.approx(number, rel=1e-12)

    @pytest.mark.parametrize(
        "law",
        [
            *(None, v + v**3, v**2, abs(v), sympy.exp(v), sympy.Integer(3), v * abs(v) ** s),
            *(v * sympy.sign(v), 1 / v, v * abs(v - 1), sympy.sqrt(v)),
        ],
    )
    def test_none_where_it_is_not_known(self, law):
        assert inverse(law, v, s_e) is None
