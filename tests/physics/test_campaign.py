"""The campaigns themselves: the same seed draws the same, a failure is told and made small."""

import random
import time

import pytest

from .draws import Menu, draw
from .tally import TooLongError, campaign, watchdog

MENU = Menu(fields=1, sensors=1, blocks=1, signals=1, pairs=1)


def test_a_seed_draws_the_same_plan():
    first, second = (draw(random.Random("x"), MENU) for _ in range(2))
    assert first == second
    assert draw(random.Random("y"), MENU) != first


def test_a_failure_is_shrunk_to_what_matters():
    def check(plan, seed):
        plan.graph()
        assert not plan.of("GY"), "no gyrators"
        return []

    with pytest.raises(AssertionError, match="random graph 'faulty-") as caught:
        campaign("faulty", MENU, 50, check)
    kinds = str(caught.value).count("kind='")
    assert "no gyrators" in str(caught.value)
    # the gyrator, and what keeps the graph well formed
    assert kinds <= 5


def test_the_watchdog_bites(monkeypatch):
    monkeypatch.setattr("tests.physics.tally.LIMIT", 0.05)
    begin = time.process_time()
    with pytest.raises(TooLongError), watchdog():
        while time.process_time() - begin < 5:
            pass
    assert time.process_time() - begin < 5
