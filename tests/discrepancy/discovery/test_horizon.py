"""A growing horizon finds its way where a fit to the whole recording does not."""

import numpy
import pytest
import sympy

from bondgraph import C, I, One, assemble, fit
from bondgraph.discrepancy import Measurement
from bondgraph.discrepancy.discovery.horizon import grown_horizon
from bondgraph.simulation import CompiledModel

STIFFNESS = 100.0  # of a unit mass: 10 rad/s


def swinging(span):
    """Thirty periods and more of a free oscillator, in closed form."""
    k = sympy.Symbol("k", positive=True)
    spring = C("spring", stiffness=k, initial=1)
    graph = assemble("free", One("v") >> (I("mass", 1), spring), parameters={k: 160})
    t = numpy.linspace(0, span, 2001)
    noise = 0.01 * numpy.random.default_rng(0).normal(size=len(t))
    return CompiledModel(graph), Measurement(t, {"spring.q": numpy.cos(10 * t) + noise})


def test_a_frequency_a_quarter_off_is_found_over_many_periods():
    model, run = swinging(20.0)
    alone = fit(model, run, ["k"], segments=None)
    assert abs(alone.values["k"] / STIFFNESS - 1) > 0.1  # caught on the way
    grown = grown_horizon(model, [run], ["k"], {"k": 160.0}, 60.0)
    assert grown["k"] == pytest.approx(STIFFNESS, rel=1e-3)


def test_too_short_a_recording_has_no_horizon_to_grow():
    model, run = swinging(1.0)
    short = run.between(0, 0.01)
    assert grown_horizon(model, [short], ["k"], {"k": 160.0}, 60.0) is None
