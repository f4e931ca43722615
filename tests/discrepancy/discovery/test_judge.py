"""Each verdict, on trials made by hand; the criterion against its formula."""

import math
from types import SimpleNamespace

import pytest

from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.discovery import Verdict
from bondgraph.discrepancy.discovery.compare import delta_bic, log_ratio
from bondgraph.discrepancy.discovery.judge import CLEAR, judged

COUNT = 400


def trial(squares, *names, values=None, std=0.01, site="carriage", effective=COUNT, given=None):
    """A fit that leaves so much, with effects named."""
    added, grafts, fitted, spread = [], [], {}, {}
    for name in names:
        effect = EFFECTS[name]
        numbers = {key: (values or {}).get(key, 1.0) for key in effect.symbols}
        added.append(
            SimpleNamespace(
                effect=effect, site=SimpleNamespace(name=site), label=f"{name} at {site}", pair=()
            )
        )
        grafts.append(SimpleNamespace(parameters={key: f"{name}_{key}" for key in numbers}))
        fitted |= {f"{name}_{key}": value for key, value in numbers.items()}
        spread |= {f"{name}_{key}": std * abs(value or 1) for key, value in numbers.items()}
    return SimpleNamespace(
        added=tuple(added),
        grafts=tuple(grafts),
        squares={"x": squares},
        counts={"x": COUNT},
        effective={"x": effective},
        terms=sum(len(EFFECTS[name].coefficients) for name in names),
        strain=0.0,
        values=fitted,
        fit=SimpleNamespace(std=spread, values=fitted),
        label=" + ".join(f"{name} at {site}" for name in names),
    )


BASE = trial(100.0)
DRAG = trial(4.0, "quadratic_drag")


def judge(best, others=(), removed=1.0, near=1.0, above=True, base=BASE):
    return judged(best, (best, *others), removed, near, above)


def test_the_criterion_is_that_of_bayes():
    """n log(RSS0/RSS1) - k log n, n the effective number of samples."""
    assert delta_bic(BASE, DRAG) == pytest.approx(COUNT * math.log(25) - math.log(COUNT))
    assert delta_bic(DRAG, BASE) == pytest.approx(-delta_bic(BASE, DRAG))
    fewer = trial(4.0, "quadratic_drag", effective=50)
    assert delta_bic(BASE, fewer) == pytest.approx(50 * math.log(25) - math.log(50))
    assert log_ratio(BASE, fewer) == pytest.approx((50 * math.log(25), 50))


def test_a_clear_effect_is_named():
    said = judge(DRAG, [trial(20.0, "viscous_damping")])
    assert said.verdict is Verdict.NAMED and said.members == (DRAG,) and not said.failed


def test_a_rival_close_behind_makes_it_ambiguous():
    near = trial(4.02, "viscous_damping")
    said = judge(DRAG, [near, trial(20.0, "hysteresis")])
    assert said.verdict is Verdict.AMBIGUOUS and said.members == (DRAG, near)


def test_the_same_place_with_more_coefficients_for_nothing_is_no_rival():
    friction = trial(4.0, "coulomb_friction", effective=100)
    stribeck = trial(3.8, "stribeck_friction", effective=100)
    assert 0 < delta_bic(stribeck, friction) < CLEAR
    assert judge(friction, [stribeck]).verdict is Verdict.NAMED
    elsewhere = trial(3.8, "stribeck_friction", site="other", effective=100)
    assert judge(friction, [elsewhere]).verdict is Verdict.AMBIGUOUS


@pytest.mark.parametrize(("above", "verdict"), [(True, Verdict.UNNAMED), (False, Verdict.NONE)])
def test_without_an_effect_it_depends_on_whether_more_than_noise_is_left(above, verdict):
    assert judge(BASE, above=above, removed=0.0).verdict is verdict


def test_too_little_of_the_held_out_gap_is_not_enough():
    said = judge(DRAG, removed=0.4)
    assert said.verdict is Verdict.UNNAMED and "40%" in said.failed[0]
    assert judge(DRAG, removed=-math.inf).verdict is Verdict.UNNAMED
    assert judge(DRAG, removed=math.nan).verdict is Verdict.UNNAMED


def test_gain_that_held_out_data_do_not_show_over_noise_is_none():
    assert judge(DRAG, removed=0.1, above=False).verdict is Verdict.NONE


def test_far_above_the_noise_it_is_unnamed_unless_nearly_all_goes():
    assert judge(DRAG, removed=0.6, near=4.0).verdict is Verdict.UNNAMED
    assert judge(DRAG, removed=0.9, near=4.0).verdict is Verdict.NAMED


@pytest.mark.parametrize("value", [-1.0, 0.0])
def test_a_sign_that_no_element_has_is_not_named(value):
    said = judge(trial(4.0, "quadratic_drag", values={"drag": value}))
    assert said.verdict is Verdict.UNNAMED and "drag of quadratic_drag" in said.failed[0]


def test_a_coefficient_that_may_as_well_be_zero_is_not_named():
    said = judge(trial(4.0, "quadratic_drag", std=1.5))
    assert said.verdict is Verdict.UNNAMED and "uncertain" in said.failed[0]


def test_what_is_not_as_large_all_along_is_not_named():
    said = judged(DRAG, (DRAG,), 1.0, 1.0, True, ["in part 2 it is -3 times as large"])
    assert said.verdict is Verdict.UNNAMED and "part 2" in said.failed[0]
