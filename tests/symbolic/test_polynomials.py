"""The exact arithmetic below: quotients, determinants, common divisors, signs."""

from __future__ import annotations

import itertools
import random

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from bondgraph.symbolic import Polynomial, SymbolicError
from bondgraph.symbolic.common import common_divisor, lowest_terms
from bondgraph.symbolic.determinant import determinant
from bondgraph.symbolic.limits import Budget
from bondgraph.symbolic.rational import polynomials_over
from bondgraph.symbolic.signs import Signs, what_is_left
from bondgraph.symbolic.tidy import factors, tidy

from .graphs import positive

a, b, c = positive("a b c")
x, y = sympy.symbols("x y", real=True)
ring, r, s, t = sympy.ring("r s t", sympy.ZZ)

EXPRESSIONS = [
    a**2 / (b * c**3) - 2 * a**2 / 3,
    1 / (a + b) - 1 / (a + c),
    (a**2 - b**2) / (a - b),
    sympy.sqrt(a) + a,
    a ** sympy.Rational(3, 2) / b ** sympy.Rational(-1, 3) + a / 2 + b / 4,
    sympy.sqrt(a / b) + 1 / sympy.sqrt(a + b),
    sympy.exp(-x / a) ** 3 + sympy.exp(2 * x / a),
    sympy.exp(-2 * x) / (1 + sympy.exp(-x)) ** 2,
    (a / (b + 1 / c)) ** -2,
    sympy.sin(x) ** 3 * sympy.cos(x) + sympy.tanh(x) ** 2 / a,
    sympy.sqrt(2) * a + sympy.pi**2,
    sympy.Abs(x) * sympy.sign(x) / (x**2 + 1),
    a**x / a ** (-2 * x),
]


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
def test_quotients_and_tidying_keep_the_value(expression):
    space = polynomials_over([expression])
    found = space.quotient(expression)
    shown = space.expression(found.top) / space.expression(space.denominator(found))
    values = {a: 1.3, b: 0.7, c: 2.1, x: 0.4, y: -0.6}
    for item in (shown, tidy(expression)):
        assert abs(complex((item - expression).evalf(subs=values))) < 1e-12


def test_what_is_zero_is_seen():
    zeros = [
        sympy.sin(x) ** 2 + sympy.cos(x) ** 2 - 1,
        (a + b) ** 2 - a**2 - 2 * a * b - b**2,
        sympy.sqrt(a + b) ** 2 / (a + b) - 1,
        a / (a + b) + b / (a + b) - 1,
    ]
    assert [tidy(item) for item in zeros] == [0] * len(zeros)


def test_what_is_not_finite_is_refused():
    with pytest.raises(SymbolicError, match="not finite"):
        tidy(sympy.zoo * a)
    with pytest.raises(SymbolicError, match="by zero"):
        tidy(1 / ((a + b) ** 2 - a**2 - 2 * a * b - b**2))


MATRICES = st.integers(0, 4).flatmap(
    lambda n: st.lists(
        st.lists(
            st.sampled_from([0, 0, 1, -2, 3, r, -s, r + s, r * t - 1]), min_size=n, max_size=n
        ),
        min_size=n,
        max_size=n,
    )
)


@given(MATRICES)
def test_determinant_agrees_with_the_sum_over_permutations(rows):
    sparse = [{place: ring(item) for place, item in enumerate(row) if item != 0} for row in rows]
    expected = ring.zero
    for order in itertools.permutations(range(len(rows))):
        inversions = sum(p > q for i, p in enumerate(order) for q in order[i + 1 :])
        term = ring((-1) ** inversions)
        for row, place in zip(rows, order, strict=True):
            term = term * row[place]
        expected += term
    assert determinant(sparse, ring, Budget("it")) == expected


def drawn(seed, terms=4):
    draw = random.Random(seed)
    made = ring.zero
    for _ in range(terms):
        term = ring(draw.choice([-3, -1, 1, 2]))
        for gen in ring.gens:
            term *= gen ** draw.choice([0, 0, 1, 2])
        made += term
    return made or ring.one


@given(st.integers(0, 10**6))
def test_common_divisor_is_that_of_sympy(seed):
    shared, first, second = (drawn(seed + place, terms) for place, terms in enumerate((2, 4, 3)))
    first, second = first * shared, second * shared
    found, expected = common_divisor(first, second), first.gcd(second)
    assert found in (expected, -expected)


def test_lowest_terms_of_nothing():
    assert lowest_terms(ring.zero, r + s) == (0, 1)


@given(st.integers(0, 10**6))
def test_factors_multiply_back(seed):
    poly = drawn(seed) * drawn(seed + 1, 2) * -6
    product = ring.one
    for factor, power in factors(poly):
        product = product * factor**power
    assert product == poly


def test_large_polynomials_are_not_split_but_for_generators():
    """By its degrees this one could hold 10^6 terms; sympy may search for its factors without end."""
    whole = (r**99 + s**50) * (s**50 - t**99)
    assert dict(factors(6 * r * whole)) == {ring(6): 1, r: 1, whole: 1}


@given(st.integers(0, 10**6))
def test_signs_hold_for_numbers(seed):
    """Generators are positive, nonnegative and of either sign."""
    names = (positive("p"), sympy.Symbol("n", nonnegative=True), x)
    expression = drawn(seed, 3).as_expr(*names)
    space = polynomials_over([expression])
    poly = space.quotient(expression).top
    sign = Signs(space, {}).of(poly)
    left, violated = what_is_left(space, [poly])
    for values in ((0.5, 0, 2), (2, 1.5, -1), (1, 0, 0), (3, 0.1, 1)):
        at = dict(zip(names, values, strict=True))
        number = float(expression.subs(at))
        if sign.value is not None:
            assert number * sign.value > 0 if sign.strict else number * sign.value >= 0
        holds = not violated and all(float(space.expression(item).subs(at)) > 0 for item in left)
        assert holds == (number > 0)


class TestPolynomial:
    z = sympy.Symbol("s")

    def test_text(self):
        found = Polynomial((a, -1, b + c, 0, -x), self.z)
        assert str(found) == "a*s^4 - s^3 + (b + c)*s^2 - x"
        assert str(Polynomial((sympy.S.Zero,), self.z)) == "0"

    def test_roots_of_products(self):
        whole = sympy.Poly((self.z + a) ** 2 * (self.z**2 + b) * self.z, self.z)
        found = Polynomial(tuple(whole.all_coeffs()), self.z).roots()
        assert found == {0: 1, -a: 2, sympy.I * sympy.sqrt(b): 1, -sympy.I * sympy.sqrt(b): 1}

    def test_no_closed_form(self):
        with pytest.raises(SymbolicError, match="degree 3"):
            Polynomial((a, b, c, x), self.z).roots()
