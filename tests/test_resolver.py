"""Parameter tables resolved to SI, and every way a value can be wrong."""

import math
from fractions import Fraction

import pint
import pytest
import sympy

from bondgraph import Parameter
from bondgraph.errors import ParameterError
from bondgraph.resolver import Resolver, resolve

k, m, f, n = sympy.symbols("k m f n", positive=True)
Quantity = pint.UnitRegistry().Quantity


class TestResolve:
    table = {
        f: Parameter(2, "Hz"),
        m: Parameter(k / f**2),
        k: Parameter(0.5, "N/mm"),
        n: Parameter(m * 2),
    }

    def test_derived_values_follow_in_any_order(self):
        assert resolve(self.table) == {"f": 2.0, "m": 125.0, "k": 500.0, "n": 250.0}
        assert list(resolve(self.table)) == ["f", "m", "k", "n"]

    @pytest.mark.parametrize("key", ["k", k])
    @pytest.mark.parametrize(
        "value", [1000, 1000.0, (1, "N/mm"), Quantity(1, "kN/m"), Fraction(1000)]
    )
    def test_overrides(self, key, value):
        assert resolve(self.table, {key: value})["n"] == pytest.approx(500)

    def test_an_override_replaces_an_expression(self):
        values = resolve(self.table, {"m": 7})
        assert (values["m"], values["n"]) == (7, 14)

    def test_values_missing(self):
        table = {k: Parameter(), m: Parameter(2 * k), f: Parameter(3)}
        with pytest.raises(ParameterError, match="'k' has no value"):
            resolve(table)
        assert resolve(table, partial=True) == {"f": 3}
        assert resolve(table, {"k": 5}) == {"k": 5, "m": 10, "f": 3}

    def test_a_resolver_is_reused(self):
        resolver = Resolver(self.table)
        assert [resolver({"k": 4 * x})["n"] for x in (1, 2, 3)] == [2, 4, 6]
        assert resolver()["n"] == 250

    def test_each_set_of_given_names_has_its_own_plan(self):
        resolver = Resolver(self.table)
        for given in ({}, {"f": 1}, {"m": 7}, {"k": 9, "f": 3}, {}, {"n": 1, "m": 2}, {"f": 4}):
            assert resolver(given) == resolve(self.table, given)
            assert list(resolver(given)) == ["f", "m", "k", "n"]

    def test_functions_in_expressions(self):
        table = {k: Parameter(4), m: Parameter(sympy.sqrt(k) + sympy.exp(-k) + sympy.atan2(1, k))}
        assert resolve(table)["m"] == pytest.approx(2 + math.exp(-4) + math.atan2(1, 4))


class TestRefused:
    table = {k: Parameter(3.0, "N/m"), m: Parameter(2 * k, "kg")}

    def test_unknown_names_with_a_hint(self):
        with pytest.raises(ParameterError, match="'k_ff' is not known; did you mean k_f"):
            resolve({sympy.Symbol("k_f"): Parameter(1)}, {"k_ff": 1})
        with pytest.raises(ParameterError, match="'xyz' is not known; known: k, m"):
            resolve(self.table, {"xyz": 1})

    @pytest.mark.parametrize(
        "value",
        [
            *(math.nan, math.inf, True, None, "3", "3 N/m", [3], 1j, m),
            *((3, "kg"), (3, "N/parsec/fortnights"), (None, "N/m"), (m, "N/m"), Quantity(3, "kg")),
        ],
        ids=repr,
    )
    def test_values_that_are_no_number_in_a_fitting_unit(self, value):
        with pytest.raises(ParameterError, match="'k'"):
            resolve(self.table, {"k": value})

    @pytest.mark.parametrize(
        ("assumption", "value", "words"),
        [
            ("positive", 0, "positive"),
            ("positive", -1, "positive"),
            ("nonnegative", -1e-9, "at least zero"),
            ("negative", 0, "negative"),
            ("integer", 1.5, "a whole number"),
        ],
    )
    def test_values_against_what_the_symbol_assumes(self, assumption, value, words):
        symbol = sympy.Symbol("x", **{assumption: True})
        with pytest.raises(ParameterError, match=f"'x' is .*must be {words}"):
            resolve({symbol: Parameter(value)})

    def test_nonzero(self):
        symbol = sympy.Symbol("x", real=True, nonzero=True)
        with pytest.raises(ParameterError, match="different from zero"):
            resolve({symbol: Parameter(0)})

    def test_derived_values_too(self):
        with pytest.raises(ParameterError, match="'m' is -1; it must be positive"):
            resolve({f: Parameter(1), m: Parameter(f - 2)})

    def test_circles(self):
        with pytest.raises(ParameterError, match="in a circle: k -> m -> k"):
            resolve({k: Parameter(2 * m), m: Parameter(k / 3)})

    def test_symbols_that_are_no_parameters(self):
        with pytest.raises(ParameterError, match="'k' uses 'm', which is no parameter"):
            resolve({k: Parameter(2 * m)})

    @pytest.mark.parametrize(
        "expression", [1 / f, sympy.log(f), sympy.sqrt(f - 1), sympy.exp(1 / f)]
    )
    def test_expressions_without_a_real_value(self, expression):
        zero = sympy.Symbol("zero", real=True)
        table = {zero: Parameter(0), k: Parameter(expression.xreplace({f: zero}))}
        with pytest.raises(ParameterError, match=r"'k' = .* has no real value at zero = 0"):
            resolve(table)
