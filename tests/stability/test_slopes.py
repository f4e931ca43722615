"""Slopes of laws against derivatives by hand."""

import pytest
import sympy
from scipy.optimize import brentq

from bondgraph import C, I, One, R, Se, Zero, assemble, models, steady_state
from bondgraph.stability import incremental_resistances
from tests.oracles.sliding import slope


def test_friction():
    found = incremental_resistances(steady_state(models.bicycle_brake.graph(), {"v_s": 0.2}))
    assert found == {"friction": pytest.approx(slope(0.9, 0.2), rel=1e-12)}
    backwards = steady_state(models.mass_on_belt.graph(), {"v_b": -0.15})
    forwards = steady_state(models.mass_on_belt.graph())
    one, other = (incremental_resistances(point)["contact"] for point in (backwards, forwards))
    assert one == pytest.approx(other) and one < 0


def test_laws_in_both_forms_and_hearing_others():
    push = sympy.Symbol("F", positive=True)
    spring = C("k", 1)
    heard = R("heard", effort=lambda f: spring.q * f**3)
    graph = assemble(
        "laws",
        Se("push", push)
        >> One("v")
        >> (I("m", 1), R("cube", effort=lambda f: f + f**3), R("l", 2)),
        One("w") >> (I("n", 1), spring, heard),
        parameters={push: 13.0},
    )
    found = incremental_resistances(steady_state(graph))
    speed = brentq(lambda v: v**3 + 3 * v - 13, 0, 9, xtol=1e-14)
    assert found["cube"] == pytest.approx(1 + 3 * speed**2, rel=1e-9)
    assert found["heard"] == pytest.approx(0, abs=1e-12) and "l" not in found
    node = Zero("n")
    orifice = R("orifice", flow=lambda e: e + e**3)
    tank = assemble(
        "tank", Se("p", 2) >> One("in") >> (R("pipe", 1), node), node >> (C("c", 1), orifice)
    )
    e = brentq(lambda e: e + e**3 - (2 - e), 0, 2, xtol=1e-14)
    found = incremental_resistances(steady_state(tank))
    assert found == {"orifice": pytest.approx(1 / (1 + 3 * e**2), rel=1e-9)}


def test_nothing_to_tell_of_linear_models():
    assert incremental_resistances(steady_state(models.quarter_car.graph())) == {}
