"""Simpler effects in the place of those that come down to them; fits are stood in for."""

from types import SimpleNamespace

import pytest

from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.discovery import refine
from bondgraph.discrepancy.discovery.bench import Added
from bondgraph.discrepancy.discovery.propose import idle_pair

from .test_judge import trial

SITE = SimpleNamespace(name="carriage", at=("carriage",))
NUMBERS = {
    "level": 2.0,
    "excess": 1.0,
    "speed": 0.1,
    "stiffness": 5.0,
    "damping": 0.1,
    "viscous": 0.0,
}


def added(name):
    effect = EFFECTS[name]
    return Added(effect, SITE, {key: NUMBERS.get(key, 1.0) for key in effect.symbols})


def fit(squares, name):
    found = trial(squares, name)
    found.added = (added(name),)
    return found


@pytest.fixture
def simplified(monkeypatch):
    def run(current, leaves):
        asked = []

        def tried(bench, grown, own):
            (item,) = grown
            asked.append((item.effect.name, dict(item.starts)))
            return fit(leaves[item.effect.name], item.effect.name)

        monkeypatch.setattr(refine, "tried", tried)
        monkeypatch.setattr(refine, "Trial", SimpleNamespace)
        trials = [current]
        found = refine.simplified(
            None, trial(100.0), current, trials, tuple(EFFECTS.values()), lambda text: None
        )
        return found.added[0].effect.name, asked

    return run


def test_bristles_that_are_not_needed_give_way_twice(simplified):
    name, asked = simplified(
        fit(4.0, "lugre_friction"), {"stribeck_friction": 4.0, "coulomb_friction": 4.0}
    )
    assert name == "coulomb_friction"
    assert [each for each, _ in asked] == ["stribeck_friction", "coulomb_friction"]
    assert asked[0][1].keys() == {"level", "excess", "speed"}


def test_what_would_lose_something_stays(simplified):
    name, _ = simplified(
        fit(4.0, "lugre_friction"), {"stribeck_friction": 4.0, "coulomb_friction": 9.0}
    )
    assert name == "stribeck_friction"


def test_an_effect_without_a_simpler_one_is_left_alone(simplified):
    name, asked = simplified(fit(4.0, "quadratic_drag"), {})
    assert name == "quadratic_drag" and not asked


def test_every_limit_is_an_effect_whose_coefficients_the_other_has():
    for effect in EFFECTS.values():
        for name in effect.limits:
            assert set(EFFECTS[name].fitted) <= set(effect.fitted)


def test_a_pair_that_is_no_likelier_than_one_of_it_is_idle():
    one, two = (SimpleNamespace(label=label) for label in "ab")
    single = SimpleNamespace(added=[one], likelihood=-100.0)
    idle = SimpleNamespace(added=[one, two], likelihood=-101.0)
    useful = SimpleNamespace(added=[one, two], likelihood=-150.0)
    assert idle_pair(idle, [single, idle])
    assert not idle_pair(useful, [single, useful])
    assert not idle_pair(single, [single, idle])
