"""Rates by the chain rule along assignments."""

import pytest
import sympy

from bondgraph import TIME
from bondgraph.errors import LawError
from bondgraph.rates import Rates

a, b, d, p, q, u, x, y = sympy.symbols("a b d p q u x y", real=True)


def total(rate, explicit):
    """Expand until nothing more is assigned."""
    while rate.free_symbols & explicit.keys():
        rate = rate.xreplace({key: explicit[key] for key in rate.free_symbols & explicit.keys()})
    return sympy.expand(rate)


def test_chain_rule_through_shared_intermediate_results():
    explicit = {x: a * q**2, y: sympy.sin(x) + x}
    rates = Rates(explicit, {}, {q: d}, ())
    found = rates.of(y)
    assert found == sympy.Symbol("der(y)", real=True)
    assert [key.name for key in explicit] == ["x", "y", "der(y)", "der(x)"]
    assert explicit[found].has(sympy.Symbol("der(x)", real=True))
    expected = (sympy.cos(a * q**2) + 1) * 2 * a * q * d
    assert sympy.expand(total(found, explicit) - expected) == 0


def test_states_time_inputs_and_constants():
    rates = Rates({}, {}, {q: d}, (u,))
    assert rates.of(q) == d
    assert rates.of(TIME) == 1
    assert rates.of(a * b) == 0
    assert rates.of(u).name == "der(u)"
    assert rates.of(rates.of(u)).name == "der(der(u))"
    assert [symbol.name for symbol in rates.input_rates] == ["u", "der(u)"]


def test_implicit_variables_get_implicit_rates():
    implicit = {x: x**3 + x - q}
    rates = Rates({}, implicit, {q: d}, ())
    rate = rates.of(x)
    assert sympy.expand(implicit[rate] - ((3 * x**2 + 1) * rate - d)) == 0


def test_loops_of_rates_end():
    explicit = {x: q - y, y: 2 * x}
    rates = Rates(explicit, {}, {q: d}, ())
    rates.of(x)
    assert len(explicit) == 4


def test_rates_asked_for_together_may_need_each_other():
    """What the second is the rate of depends on the first, which is itself a rate."""
    explicit = {x: a * q**2, y: b * p}
    rates = Rates(explicit, {}, {q: d}, ())
    first, second = rates.later(y), rates.later(x)
    explicit[p] = second
    rates.finish()
    # y = b dx/dt = 2 a b q d, with d a variable that nothing is assigned to
    assert total(first, explicit) == 2 * a * b * d**2


def test_ever_higher_orders_are_refused():
    explicit = {x: q + p}
    rates = Rates(explicit, {}, {q: d}, ())
    explicit[p] = rates.later(x)
    with pytest.raises(LawError, match="ever higher order"):
        rates.finish()


class TestAnswers:
    def test_count_as_constant(self):
        explicit = {x: q + p, p: sympy.Integer(0)}
        rates = Rates(explicit, {}, {q: d}, (), answers={p})
        assert total(rates.of(x), explicit) == d

    def test_but_not_for_full_rates_nor_by_signals(self):
        heard = sympy.Dummy("p")
        explicit = {y: 3 * heard, x: q + p, p: u * q}
        rates = Rates(explicit, {}, {q: d}, (), answers={p}, signals={heard: p})
        assert rates.of(y).name == "der(y)"
        assert explicit[sympy.Symbol("der(y)", real=True)] == 3 * sympy.Symbol("rate(p)", real=True)
        assert explicit[sympy.Symbol("rate(p)", real=True)] == u * d
        assert rates.full.of(x).name == "rate(x)"
        assert sympy.expand(total(sympy.Symbol("rate(x)", real=True), explicit) - d - u * d) == 0
