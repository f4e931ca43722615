"""Sizes by parts of a recording: of an effect that is there all along, and of one that comes and goes."""

import numpy
import pytest
import sympy

from bondgraph import I, One, R, Se, assemble, simulate
from bondgraph.discrepancy import Measurement, discover
from bondgraph.discrepancy.latent.steady import Steadiness

T = numpy.linspace(0, 30, 901)
PUSH = 3 * numpy.sin(T) + 2 * numpy.sin(0.37 * T)


def test_a_part_counts_where_its_size_is_told_and_is_another():
    found = Steadiness("x", numpy.array([1.1, 6.0, -2.0]), numpy.array([0.01, 5.0, 0.05]))
    assert found.unsteady == {2: -2.0}
    assert not Steadiness("x", numpy.array([1.1, 0.9]), numpy.array([0.01, 0.01])).unsteady


def _cart(drag, late=0.0):
    """A cart with drag, of which a part acts after half of the time only."""
    b, push, clock = sympy.Symbol("b", positive=True), sympy.Symbol("push"), sympy.Symbol("clock")
    v = One("v")
    film = R("film", effort=lambda f: b * f + (drag + late * clock) * f * abs(f))
    return assemble(
        "cart",
        Se("motor", push) >> v >> (I("m", 1), film),
        parameters={b: 0.5},
        inputs=[push, clock] if late else [push],
        outputs={"speed": v.f},
    )


def _found(graph, **inputs):
    run = simulate(graph, T[-1], inputs={"push": (T, PUSH), **inputs}, t_eval=T)
    noise = 0.01 * numpy.random.default_rng(0).normal(size=len(T))
    row = Measurement(T, {"push": PUSH, "speed": run["speed"] + noise})
    return discover(_cart(0.0), row, row, effects=["quadratic_drag", "effort_bias"])


def test_what_is_there_all_along_is_named():
    found = _found(_cart(0.4))
    assert found.verdict.value == "named" and found.effects[0].name == "quadratic_drag"


def test_what_turns_round_half_way_is_not():
    """A drag that brakes first and drives later has a mean size that is nobody's."""
    turned = (T, numpy.where(T < 15, 0.0, 1.0))
    found = _found(_cart(0.4, -0.35), clock=turned)
    assert found.verdict.value != "named"
    assert any("times as large as in all of them" in word for word in found.words) or (
        found.verdict.value == "unnamed"
    )


@pytest.mark.parametrize("late", [-0.05, 0.05])
def test_a_size_that_wanders_a_little_is_the_same(late):
    turned = (T, numpy.where(T < 15, 0.0, 1.0))
    assert _found(_cart(0.4, late), clock=turned).effects[0].name == "quadratic_drag"
