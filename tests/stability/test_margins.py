"""Margins against edges by hand."""

import math
import sys

import pytest
import sympy

from bondgraph import C, I, One, R, Se, assemble, models, steady_state
from bondgraph.errors import ParameterError
from bondgraph.stability import assess, margins
from tests.oracles.sliding import critical_slope, critical_speed

FIG9 = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}


def of(graph, parameters=None, **options):
    point = steady_state(graph, parameters, options.pop("inputs", None))
    return {item.parameter: item for item in margins(graph, point, parameters, **options)}


def test_margins_of_the_squealing_brake():
    found = of(models.bicycle_brake.graph(), FIG9)
    assert found["V0"].above.value == pytest.approx(critical_speed(0.2), rel=1e-9)
    assert found["V0"].below is None
    # c = - N (mu_s - mu_k) / v_s exp(-V0 / v_s)
    drop = -critical_slope() * 0.2 * math.exp(0.9 / 0.2)
    assert found["mu_s"].below.value == pytest.approx(0.4 + drop / 2250, rel=1e-9)
    # N0 = F_k / mu_k follows mu_k: F_k (mu_s / mu_k - 1) is the drop
    assert found["mu_k"].above.value == pytest.approx(0.5 / (1 + drop / 900), rel=1e-9)
    assert found["F_k"].below.value == pytest.approx(drop / 0.1 * 0.4, rel=1e-9)
    assert found["F_k"].factor == pytest.approx(drop / 0.1 * 0.4 / 900, rel=1e-9)
    order = [item.distance for item in found.values()]
    assert order == sorted(order)


def test_what_has_no_edge_says_how_far_it_was_followed():
    found = of(models.quarter_car.graph())
    assert all(item.nearest is None and item.factor is None for item in found.values())
    assert all(item.ends == ("limit", "limit") for item in found.values())
    assert all(math.isinf(item.distance) for item in found.values())


def test_the_span_counts():
    graph = models.bicycle_brake.graph()
    assert of(graph, names=["V0"], span=2.5)["V0"].nearest is None
    assert of(graph, names=["V0"], span=3.0)["V0"].below is not None


def test_a_derived_parameter_may_be_asked_for():
    """The wind-up's damper alone: b_t at which the friction's slope is critical."""
    (margin,) = of(models.bicycle_brake.graph(), FIG9, names=["b_t"]).values()
    zeta = margin.above.value / 0.0458366236 * 0.05
    c = -2250 * 0.1 / 0.2 * math.exp(-0.9 / 0.2)
    assert critical_slope(zeta=0.05, zeta_w=zeta) == pytest.approx(c, rel=1e-6)


def test_zero_has_no_factor_and_signs_are_kept():
    k, f = sympy.symbols("k f", real=True)
    spring = C("s", effort=lambda q: (k + 1) * q)
    graph = assemble(
        "strut",
        Se("push", f) >> One("v") >> (I("m", 1), spring, R("d", 0.5)),
        parameters={k: -0.4, f: 0.0},
    )
    found = of(graph)
    assert "f" not in found
    # less than -1 lets it fall over
    assert found["k"].below.value == pytest.approx(-1, rel=1e-9) and found["k"].above is None
    assert found["k"].factor == pytest.approx(2.5)


def test_rules_of_parameters_end_the_search_with_words():
    m = sympy.Symbol("m", positive=True)
    law = R("d", effort=lambda f: sympy.sqrt(2 - m) * f)
    graph = assemble("edge", One("v") >> (I("mass", m), C("k", 1), law), parameters={m: 1.0})
    margin = of(graph)["m"]
    assert margin.nearest is None or margin.above.value == pytest.approx(2, rel=1e-6)
    assert margin.ends[0] == "limit" and margin.ends[1] != "limit"


def test_an_unknown_name_is_refused():
    with pytest.raises(ParameterError, match="did you mean V0"):
        of(models.bicycle_brake.graph(), names=["V"])


def test_of_very_many_parameters_the_strongest_are_followed(monkeypatch):
    monkeypatch.setattr(sys.modules["bondgraph.stability.margins"], "SECONDS", 0.1)
    result = assess(models.bicycle_brake.graph(), FIG9)
    assert [item.parameter for item in result.margins] == ["mu_k", "mu_s", "V0", "v_s", "f_w"]
    assert any("the 5 that move the critical mode most" in text for text in result.warnings)
