"""The baseline is honest only if its answers are right."""

from __future__ import annotations

import functools
import itertools
from typing import Any

import numpy as np
import pytest

from ..oracles import brake, random_brakes
from . import baseline, timing
from .native import BaselineUnavailable

STORED = random_brakes.stored()


@pytest.fixture(autouse=True)
def _compiled() -> None:
    try:
        baseline.automaton()
    except BaselineUnavailable as reason:
        pytest.skip(str(reason))


@pytest.mark.parametrize(("name", "sticks"), [("fig6", 0), ("fig7", 1), ("fig8", 72), ("fig9", 64)])
def test_behaviours_of_the_paper(name: str, sticks: int) -> None:
    known = brake.acceptance()["sets"][name]
    run = baseline.run(brake.parameters(brake.figure(name)), 0.5, rtol=1e-6, n_out=501)
    assert len(run.stick_times) == sticks
    assert run.stick_times[:5] == pytest.approx(known["t_stick"], abs=2e-7)
    states = np.array(known["states"])
    rows = np.round(states[:, 0] * 1e3).astype(int)
    error = np.abs(run.states[rows] - states[:, 1:]) / np.ptp(states[:, 1:], axis=0)
    assert error.max() < 2e-4
    energies = [known["energy"][name] for name in brake.ENERGIES]
    assert run.energies == pytest.approx(energies, abs=2e-6 * energies[0])


@pytest.mark.parametrize("case", STORED, ids=lambda c: c["kind"])
def test_stored_brakes(case: dict[str, Any]) -> None:
    p = case["parameters"]
    start = brake.starting_state(brake.Brake(**p), case["initial"])
    run = baseline.run(p, 0.5, rtol=1e-9, n_out=501, start=start)
    assert len(run.stick_times) == case["n_stick"]
    assert len(run.events) == case["n_stick"] + case["n_slip"] + case["n_crossing"]
    assert run.stick_times[:5] == pytest.approx(case["t_stick"], abs=1e-9)
    states = np.array(case["states"])
    rows = np.round(states[:, 0] * 1e3).astype(int)
    error = np.abs(run.states[rows] - states[:, 1:]) / np.ptp(states[:, 1:], axis=0)
    assert error.max() < 1e-6


def test_prepared_run_repeats() -> None:
    call = baseline.prepare(brake.parameters(brake.figure("fig8")), 0.1, 1e-6, 11)
    assert call() == call() > 0


def test_the_loop_in_c_is_that_over_runs() -> None:
    base = brake.parameters(brake.figure("fig8"))
    points = [base | {"V0": speed} for speed in (0.6, 0.9, 1.4)]
    final, sticks = baseline.sweep(points, 0.1, 1e-6)
    for i, point in enumerate(points):
        run = baseline.run(point, 0.1, rtol=1e-6, n_out=2)
        assert (final[i] == run.states[-1]).all()
        assert sticks[i] == len(run.stick_times)
    assert sticks.max() > 5


def test_contestants_take_turns() -> None:
    order: list[str] = []
    contestants = {name: functools.partial(order.append, name) for name in "ab"}
    timings = timing.interleave(contestants, rounds=3, batch=0.0)
    assert set(timings) == {"a", "b"}
    assert [name for name, _ in itertools.groupby(order)][-6:] == list("ababab")
