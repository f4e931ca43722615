"""The paper's four behaviours, and brakes that are not in the paper, against the oracle."""

from __future__ import annotations

import numpy as np
import pytest

from bondgraph import CompiledModel, simulate, smoothed
from bondgraph.models import bicycle_brake, frame_brake
from tests.oracles import brake as oracle
from tests.oracles import random_brakes

FIGURES = oracle.acceptance()["sets"]
COLUMNS = ("omega_r", "V_c", "theta_w", "x_c")


@pytest.fixture(scope="module")
def model() -> CompiledModel:
    return CompiledModel(bicycle_brake.graph())


@pytest.mark.parametrize("figure", sorted(FIGURES))
def test_figure_of_the_paper(model, figure):
    case = FIGURES[figure]
    run = simulate(model, 0.5, case["params"], rtol=1e-9)
    sticks = run.sticks()
    slips = [event.t for event in run.events if event.from_mode == "stick"]
    assert run.outcome.ok
    assert len(sticks) == case["n_stick"]
    assert sticks[:5] == pytest.approx(case["t_stick"], abs=1e-9)
    assert slips[:5] == pytest.approx(case["t_slip"], abs=1e-9)
    assert abs(run.energy.relative_residual) < 1e-8
    assert run.energy.supplied == pytest.approx(case["energy"]["road"], rel=1e-6)


@pytest.mark.parametrize("figure", sorted(FIGURES))
def test_states_of_the_paper_up_to_60_ms(model, figure):
    case = FIGURES[figure]
    reference = np.array(case["states"])
    run = simulate(model, 0.06, case["params"], rtol=1e-9, t_eval=reference[:, 0])
    for column, name in zip(reference[:, 1:].T, COLUMNS, strict=True):
        assert np.abs(run[name] - column).max() < 1e-6 * np.ptp(column)


def test_limit_cycle_of_figure_8(model):
    sticks = simulate(model, 0.5, FIGURES["fig8"]["params"], rtol=1e-9).sticks()
    assert 4 / (sticks[-1] - sticks[-5]) == pytest.approx(143.318344, abs=1e-3)


@pytest.mark.parametrize("figure", sorted(FIGURES))
def test_stick_counts_hold_at_the_default_tolerance(model, figure):
    case = FIGURES[figure]
    assert len(simulate(model, 0.5, case["params"]).sticks()) == case["n_stick"]


@pytest.mark.parametrize("case", random_brakes.stored(), ids=lambda case: case["kind"])
def test_brakes_that_are_not_in_the_paper(model, case):
    reference = np.array(case["states"])
    settings = {"rtol": 1e-9, "initial": case.get("initial") or {}}
    run = simulate(model, 0.5, case["parameters"], **settings)
    assert len(run.sticks()) == case["n_stick"]
    assert run.sticks()[:5] == pytest.approx(case["t_stick"][:5], abs=1e-7)
    assert abs(run.energy.relative_residual) < 1e-8
    sampled = simulate(model, 0.5, case["parameters"], t_eval=reference[:, 0], **settings)
    for column, name in zip(reference[:, 1:].T, COLUMNS, strict=True):
        assert np.abs(sampled[name] - column).max() < 1e-6 * np.ptp(column)


def test_a_stuck_brake_does_not_creep(model):
    run = simulate(model, 0.1, FIGURES["fig8"]["params"], t_eval=np.linspace(0, 0.1, 4001))
    stuck = run.modes["friction"] == "stick"
    assert stuck.any() and not stuck.all()
    assert np.abs(run["slip"][stuck]).max() < 1e-12


def test_tanh_friction_is_wrong_in_the_way_that_is_known(model):
    settings = FIGURES["fig8"]["params"]
    coarse = simulate(
        smoothed(bicycle_brake.graph(), 1e-3), 0.5, settings, t_eval=np.linspace(0, 0.5, 50001)
    )
    rising = (coarse["V_c"][:-1] < 0) & (coarse["V_c"][1:] >= 0)
    frequency = 4 / np.diff(coarse.t[1:][rising][[-9, -1]])[0]  # the caliper swings twice a cycle
    assert not coarse.events
    assert frequency == pytest.approx(145.26, abs=0.15)  # for 1e-3 m/s; the cycle has 143.32


def test_the_rigid_wheel_settles_where_the_flexible_one_squeals(model):
    settings = FIGURES["fig9"]["params"]
    assert len(simulate(model, 0.5, settings, rtol=1e-9).sticks()) == 64
    assert len(simulate(frame_brake.graph(), 0.5, settings, rtol=1e-9).sticks()) == 0


def test_virtual_machine_agrees_with_compiled_code(model):
    settings = FIGURES["fig8"]["params"]
    grid = np.linspace(0, 0.03, 31)
    runs = [simulate(model, 0.03, settings, t_eval=grid, backend=b) for b in ("native", "vm")]
    assert [event.to_mode for event in runs[0].events] == [
        event.to_mode for event in runs[1].events
    ]
    assert np.allclose(
        [e.t for e in runs[0].events], [e.t for e in runs[1].events], rtol=0, atol=1e-11
    )
    assert np.allclose(runs[0].x, runs[1].x, rtol=1e-9, atol=1e-18)
