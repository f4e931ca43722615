"""The worked examples of the docs, where they take longer than a page may."""

import pytest

from bondgraph.discrepancy import discover

from .recordings import brake, drops, pendulum

PAIR = ["compliant_coupling at bond road>hub", "added_inertia at hub"]


def labels(found):
    return [effect.label for effect in found.effects]


def test_a_ball_that_only_falls_has_no_hysteresis():
    """What never turns back cannot yield: of no effect at no site is that even tried."""
    train, held_out = drops.recordings("Orange_Whiffle_Ball")
    found = discover(drops.graph(), train, held_out, free=[])
    tried = {effect.name for row in found.ranked for effect in row.effects}
    assert "viscous_damping" in tried and not tried & {"hysteresis", "lugre_friction"}


@pytest.mark.slow
@pytest.mark.parametrize("free", [None, ["k_f", "zeta_f"]])
def test_the_wheel_is_found_through_stick_and_slip(free):
    """With everything free as well; efforts and stiffnesses then share one scale."""
    train, held_out = brake.simulate(0, span=0.04)
    found = discover(brake.graph(), train, held_out, free=free)
    assert found.verdict == "named" and labels(found) == PAIR
    for effect in found.effects:
        for key, estimate in effect.parameters.items():
            truth = brake.EXPECTED.parameters[f"{effect.name}.{key}"]
            assert estimate.value == pytest.approx(truth, rel=0.01)
    assert found.gap["validation"]["slip"].removed > 0.98


@pytest.mark.slow
def test_the_rotor_tells_of_the_wheel_where_the_caliper_does_not():
    train, held_out = brake.simulate(0, "Fig. 6", span=0.04)
    found = discover(brake.graph("Fig. 6"), train, held_out, free=["k_f", "zeta_f"])
    assert found.verdict == "named" and labels(found) == PAIR
    alone = brake.simulate(0, "Fig. 6", ("x_c",), span=0.04)
    assert discover(brake.graph("Fig. 6"), *alone, free=["k_f", "zeta_f"]).verdict == "none"


@pytest.mark.slow
@pytest.mark.parametrize("split", pendulum.SPLITS)
def test_dry_friction_and_air_are_nearest_to_the_bearing(split):
    found = discover(pendulum.graph(), *pendulum.recordings(split))
    assert found.verdict == "unnamed"
    assert labels(found)[:2] == ["coulomb_friction at swing", "quadratic_drag at swing"]
    level, drag = (next(iter(effect.parameters.values())).value for effect in found.effects[:2])
    assert level == pytest.approx(0.155, rel=0.1) and drag == pytest.approx(0.0043, rel=0.1)
    assert found.parameters["drag"].value < 0.005
