"""What the real recordings support, by plain least squares."""

import pytest

from . import reference
from .recordings import drops, pendulum


@pytest.mark.slow
@pytest.mark.parametrize("split", pendulum.SPLITS)
def test_the_bearing_rubs_and_the_air_drags(split):
    """Dry friction with quadratic drag; neither one beside viscous drag does as well."""
    runs = pendulum.recordings(split)
    of = {
        names: reference.swings(("pull", *names), *runs)
        for names in [
            ("viscous",),
            ("viscous", "coulomb"),
            ("viscous", "quadratic"),
            ("coulomb", "quadratic"),
        ]
    }
    viscous, both = of["viscous",], of["coulomb", "quadratic"]
    assert both.train < 0.5 * viscous.train and both.held_out < 0.6 * viscous.held_out
    for second in ("coulomb", "quadratic"):
        one = of["viscous", second]
        assert one.train > 2 * both.train and one.held_out > 0.85 * viscous.held_out
    assert both.values["coulomb"] == pytest.approx(0.155, rel=0.1)
    assert both.values["quadratic"] == pytest.approx(0.0043, rel=0.1)


@pytest.mark.parametrize("ball", drops.LIGHT)
def test_light_balls_are_held_by_air(ball):
    """Any drag takes most of the gap; in proportion to speed it takes more than to its square."""
    for held_out in (1, 2):
        (train,), (other,) = drops.recordings(ball, held_out)
        none, linear, square = (
            reference.falls(names, train, other) for names in [(), ("viscous",), ("quadratic",)]
        )
        assert max(linear.held_out, square.held_out) < 0.4 * none.held_out
        assert linear.held_out < square.held_out and linear.train < 0.7 * square.train


@pytest.mark.parametrize("ball", drops.HEAVY)
def test_heavy_balls_fall_freely(ball):
    """Drag that one drop suggests does not help the other."""
    drags = [("viscous",), ("quadratic",)]
    for held_out in (1, 2):
        (train,), (other,) = drops.recordings(ball, held_out)
        none = reference.falls((), train, other).held_out
        assert min(reference.falls(names, train, other).held_out for names in drags) > 0.8 * none
