"""Routh-Hurwitz conditions against published polynomials and against roots."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from bondgraph import models, routh_hurwitz, symbolic_system
from bondgraph.errors import ParameterError
from bondgraph.symbolic import Stability, SymbolicError

from . import graphs
from .graphs import positive

real = {n: sympy.symbols(f"a0:{n + 1}", real=True) for n in range(7)}
GENERAL = {n: routh_hurwitz(symbols) for n, symbols in real.items()}
NUMBERS = st.integers(-4, 12)


class TestPublished:
    def test_low_degrees(self):
        a = positive("a0:5")
        assert [routh_hurwitz(a[: n + 1]).conditions for n in range(3)] == [(), (), ()]
        (cubic,) = routh_hurwitz(a[:4]).conditions
        assert sympy.expand(cubic - (a[1] * a[2] - a[0] * a[3])) == 0
        (quartic,) = routh_hurwitz(a).conditions
        expected = a[1] * a[2] * a[3] - a[0] * a[3] ** 2 - a[1] ** 2 * a[4]
        assert sympy.expand(quartic - expected) == 0

    def test_range_of_a_gain(self):
        # K. Ogata, Modern Control Engineering: s^4 + 3 s^3 + 3 s^2 + 2 s + K, 0 < K < 14/9
        K = sympy.Symbol("K", real=True)
        found = routh_hurwitz((1, 3, 3, 2, K))
        assert set(found.conditions) == {K, 14 - 9 * K}
        assert found.holds({K: 1.55}) and not found.holds({K: 1.56}) and not found.holds({K: 0})

    def test_two_roots_to_the_right(self):
        # Ogata: s^4 + 2 s^3 + 3 s^2 + 4 s + 5, first column 1, 2, 1, -6, 5
        found = routh_hurwitz((1, 2, 3, 4, 5))
        assert found.status is Stability.UNSTABLE
        assert [row[0] for row in found.array().rows] == [1, 2, 1, -6, 5]

    def test_zero_in_the_first_column(self):
        # Ogata: s^3 + 2 s^2 + s + 2, a pair on the imaginary axis
        found = routh_hurwitz((1, 2, 1, 2))
        assert found.status is Stability.NEVER and not found.holds()
        assert found.reasons == ("Hurwitz determinant 2 is zero",)
        assert "s^1 is zero" in found.array().breaks

    def test_first_column_zero_where_the_row_is_not(self):
        found = routh_hurwitz((1, 1, 2, 2, 3))
        assert not found.holds() and "s^2 starts with zero" in found.array().breaks

    def test_row_of_zeros(self):
        # Ogata: s^5 + 2 s^4 + 24 s^3 + 48 s^2 - 25 s - 50, roots +-1, +-5j, -2
        found = routh_hurwitz((1, 2, 24, 48, -25, -50))
        assert found.status is Stability.UNSTABLE and "s^3 is zero" in found.array().breaks

    def test_array_of_a_cubic(self):
        a = positive("a0:4")
        first = [row[0] for row in routh_hurwitz(a).array().rows]
        assert first[:2] == [a[0], a[1]] and first[3] == a[3]
        assert sympy.cancel(first[2] - (a[1] * a[2] - a[0] * a[3]) / a[1]) == 0


class TestModels:
    def test_quarter_car_needs_its_damper_alone(self):
        found = symbolic_system(models.quarter_car.graph()).routh_hurwitz()
        assert found.conditions == (sympy.Symbol("b_s", nonnegative=True),)

    def test_mass_on_belt_with_any_slope_of_friction(self):
        slope, level, v_b, c = sympy.Symbol("slope", real=True), *positive("level v_b c")
        graph = graphs.belt(lambda speed: level + slope * (speed - v_b))
        at = {"mass.p": 0}
        found = symbolic_system(graph, at, modes={"contact": "slip+"}).routh_hurwitz()
        assert found.conditions == (c + slope,)
        assert found.holds({"slope": -0.09, "c": 0.1}) and not found.holds(
            {"slope": -0.1, "c": 0.1}
        )

    def test_brake_of_the_frame(self):
        graph = models.frame_brake.graph()
        p = {symbol.name: symbol for symbol in graph.parameters}
        at = {"rear.mass.p": 0, "line.fluid.q": p["C_h"] * p["p_l"]}
        system = symbolic_system(graph, at, modes={"friction": "slip+"})
        (condition,) = system.routh_hurwitz().conditions
        fall = (p["mu_s"] - p["mu_k"]) * sympy.exp(-p["omega_t"] * p["r_r"] / p["v_s"]) / p["v_s"]
        expected = p["b_f"] - p["A_p"] * p["p_l"] * fall
        assert sympy.simplify(condition / p["v_s"] - expected) == 0

    def test_a_stuck_brake_drifts(self):
        graph = models.frame_brake.graph()
        found = symbolic_system(graph, modes={"friction": "stick"}).routh_hurwitz()
        assert found.status is Stability.INTEGRATING and found.integrators == 1
        assert "free integrator" in found.reasons[0]

    @pytest.mark.parametrize("cells, kinds", [(2, "R"), (4, "R"), (2, "RL")])
    def test_passive_ladders_are_stable(self, cells, kinds):
        found = symbolic_system(graphs.ladder(cells, kinds)).routh_hurwitz()
        assert all(found.holds(dict.fromkeys(item.free_symbols, 2)) for item in found.conditions)
        assert found.status in (Stability.ALWAYS, Stability.CONDITIONAL)

    def test_a_ladder_without_losses_is_not(self):
        found = symbolic_system(graphs.ladder(3, "L")).routh_hurwitz()
        assert found.status is Stability.NEVER
        assert found.reasons == ("the coefficient of s^5 is zero",)


class TestAssumptions:
    def test_signs_that_are_known_are_left_out(self):
        m, k, b = *positive("m k"), sympy.Symbol("b", nonnegative=True)
        assert routh_hurwitz((m, b, k)).conditions == (b,)
        assert routh_hurwitz((m, k + b, k)).status is Stability.ALWAYS
        assert routh_hurwitz((-m, -k, -k)).status is Stability.ALWAYS
        assert routh_hurwitz((m, -k, k)).status is Stability.UNSTABLE

    def test_one_condition_shortens_another(self):
        x, y = sympy.symbols("x y", real=True)
        assert set(routh_hurwitz((1, x, x * y)).conditions) == {x, y}
        assert set(routh_hurwitz((1, x, x**3)).conditions) == {x}

    def test_conditions_that_contradict_each_other(self):
        x = sympy.Symbol("x", real=True)
        found = routh_hurwitz((1, x, -x))
        assert found.status is Stability.NEVER and not found.holds({x: 1})

    def test_a_leading_coefficient_of_either_sign(self):
        x, y = sympy.symbols("x y", real=True)
        found = routh_hurwitz((x, 1, y))
        assert set(found.conditions) == {x, y}
        assert routh_hurwitz((x, -1)).conditions == (-x,)

    def test_a_square_must_not_vanish(self):
        x = sympy.Symbol("x", real=True)
        found = routh_hurwitz((1, 1, x**2))
        assert found.conditions == (x**2,)
        assert found.holds({x: -1}) and not found.holds({x: 0})

    def test_values_must_be_admissible(self):
        b, k = sympy.Symbol("b", real=True), positive("k")
        found = routh_hurwitz((1, b, k))
        with pytest.raises(ParameterError, match=r"k.*positive"):
            found.holds({"b": 1, "k": -1})
        with pytest.raises(ParameterError, match="a value for b"):
            found.holds({"k": 1})
        with pytest.raises(ParameterError, match="'z' is not known"):
            found.holds({"z": 1})

    def test_zero_polynomial(self):
        with pytest.raises(SymbolicError, match="all coefficients are zero"):
            routh_hurwitz((0, 0))


@given(st.integers(0, 6).flatmap(lambda n: st.lists(NUMBERS, min_size=n + 1, max_size=n + 1)))
def test_numbers_agree_with_roots(numbers):
    assume(numbers[0] != 0)
    real_parts = np.roots(numbers).real
    found = routh_hurwitz(numbers)
    assume(all(abs(real_parts) > 1e-6))
    assert found.holds() == all(real_parts < 0)
    assert found.conditions == ()
    if found.status is Stability.UNSTABLE:
        assert any(real_parts > 0)


@given(
    st.integers(1, 6).flatmap(
        lambda n: st.lists(st.integers(1, 12), min_size=n + 1, max_size=n + 1)
    )
)
def test_general_conditions_agree_with_roots(numbers):
    """Positive coefficients: the signs of the determinants alone decide."""
    real_parts = np.roots(numbers).real
    assume(all(abs(real_parts) > 1e-6))
    found = GENERAL[len(numbers) - 1]
    values = {f"a{place}": number for place, number in enumerate(numbers)}
    assert found.holds(values) == all(real_parts < 0)


ROOTS = st.lists(
    st.one_of(
        st.tuples(st.integers(1, 4)).map(lambda r: [1, r[0]]),
        st.tuples(st.integers(1, 4), st.integers(1, 4)).map(
            lambda r: [1, 2 * r[0], r[0] ** 2 + r[1] ** 2]
        ),
    ),
    min_size=1,
    max_size=3,
)


@given(ROOTS, st.sampled_from(["stable", "pair", "zero", "right", "saddle"]))
def test_polynomials_made_from_roots(factors, extra):
    """On the axis nothing can be told by rounded roots: here they are exact."""
    more = {
        "stable": [1],
        "pair": [1, 0, 4],
        "zero": [1, 0],
        "right": [1, -1],
        "saddle": [1, 0, -1],
    }
    numbers = [1]
    for factor in [*factors, more[extra]]:
        numbers = [int(item) for item in np.convolve(numbers, factor)]
    found = routh_hurwitz(numbers)
    assert found.holds() == (extra == "stable")
    assert found.integrators == (extra == "zero")
    if extra in ("right", "saddle"):
        assert found.status in (Stability.UNSTABLE, Stability.NEVER)


@given(st.lists(st.integers(1, 9), min_size=2, max_size=7))
def test_the_array_changes_sign_once_for_each_root_to_the_right(numbers):
    real_parts = np.roots(numbers).real
    assume(all(abs(real_parts) > 1e-6))
    array = routh_hurwitz(numbers).array()
    assume(not array.breaks)
    signs = [math.copysign(1, row[0]) for row in array.rows]
    changes = sum(a != b for a, b in itertools.pairwise(signs))
    assert changes == sum(real_parts > 0)
