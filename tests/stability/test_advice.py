"""Advice and verdicts: what the sentences say against the numbers they are made of."""

import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble, models
from bondgraph.stability import assess
from bondgraph.stability.advice import levers

k, b = sympy.symbols("k b", real=True)


def test_each_lever_is_told_in_the_direction_that_calms():
    result = assess(models.bicycle_brake.graph(), {"v_s": 0.2})
    chosen = levers(result.rows, result.sensitivities)
    for effect, sentence in zip(chosen, result.advice, strict=False):
        less = effect.growth(0.1) > 0
        assert sentence.startswith(f"10 % {'less' if less else 'more'} {effect.parameter} ")
        assert f"by {abs(effect.growth(0.1)):.3g} 1/s" in sentence
    # and the eigenvalue does go down, by what the sentence says
    effect = chosen[0]
    step = -0.001 if effect.growth(0.1) > 0 else 0.001
    moved = assess(
        models.bicycle_brake.graph(),
        {"v_s": 0.2, effect.parameter: effect.value * (1 + step)},
        span=None,
    )
    change = moved.rows[0].eigenvalue.real - result.rows[0].eigenvalue.real
    assert change == pytest.approx(-abs(effect.growth(0.001)), rel=0.01)


def test_a_steady_state_that_vanishes_is_said_to():
    i = sympy.Symbol("i", real=True)
    law = R("diode", flow=lambda v: v**3 - 3 * v)
    graph = assemble(
        "diode", Sf("s", i) >> Zero("n") >> (C("c", 1), law), parameters={i: (-3, "A")}
    )
    result = assess(graph, {"i": 1.0}, guess={"c.q": -1.5})
    assert "i has to rise by 100.0 % to 2 A for this steady state to vanish" in result.verdict
    assert "fold: a real mode, the branch turns" in result.verdict


def test_without_an_edge_that_is_said():
    result = assess(models.quarter_car.graph())
    assert "Of the parameters followed none, taken alone, makes it unstable" in result.verdict
    assert all("lowers the growth rate" in sentence for sentence in result.advice)


def test_a_model_without_states_has_nothing_to_change():
    result = assess(assemble("still", Se("s", 1) >> One("v") >> R("r", 2)))
    assert "nothing to be unstable" in result.verdict
    assert result.reasons == () and result.advice == () and result.margins == ()


def test_falling_laws_are_named_only_where_they_feed():
    result = assess(models.bicycle_brake.graph())  # at v_s = .05 the slope is nearly nothing
    assert not any("falls" in sentence for sentence in result.reasons)
    result = assess(models.bicycle_brake.graph(), {"v_s": 0.2}, span=None)
    assert any(
        "law of friction falls" in sentence and "-12.5" in sentence for sentence in result.reasons
    )


def test_onsets_stand_in_the_verdict():
    spring = C("s", stiffness=k)
    damper = R("d", effort=lambda f: b * f + f**3)
    graph = assemble("soft", One("v") >> (I("m", 1), spring, damper), parameters={k: 4.0, b: 0.1})
    result = assess(graph, vary=["b=-0.2:0.2:20"])
    assert "soft: the vibration grows from nothing" in " ".join(result.reasons)
