"""Which solver auto takes, why, and that it gets there."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from scipy.linalg import expm

from bondgraph import C, CompiledModel, I, One, R, Se, Sf, Zero, assemble, models, simulate
from bondgraph.models import LIBRARY, bicycle_brake
from bondgraph.simulation.outcome import Outcome
from bondgraph.simulation.problem import InputTable
from bondgraph.simulation.solvers import choose
from tests.simulation.stiff import (
    ROBERTSON_40,
    VAN_DER_POL_2000,
    ladder,
    ladder_matrix,
    rates,
    robertson,
    van_der_pol,
)

NONE = InputTable(np.zeros(1), np.zeros((1, 0)), np.zeros(0))


def oscillator(stiffness=8, damping=0):
    parts = (I("m", 2, initial=3), C("k", stiffness=stiffness), R("b", damping))
    return assemble("oscillator", One("v") >> parts)


def test_robertson_is_stiff_after_its_start():
    run = simulate(robertson(), 40.0, t_eval=[40.0])
    assert run.solver == "rosenbrock" and "stiff" in run.solver_reason
    assert run.x[:, -1] == pytest.approx(ROBERTSON_40, rel=2e-4)
    longer = simulate(robertson(), 1e6, t_eval=[1e6])
    assert longer.outcome.ok and longer.steps < 5000
    assert longer.x[:, -1].sum() == pytest.approx(1, rel=1e-5)


def test_van_der_pol_is_stiff():
    run = simulate(van_der_pol(), 2000.0, t_eval=[2000.0], rtol=1e-8)
    assert run.solver == "rosenbrock"
    assert run.x[:, -1] == pytest.approx(VAN_DER_POL_2000, rel=1e-4)
    assert "-3.0e+03 1/s over 2000 s would take ~2e+06 explicit steps" in run.solver_reason


@pytest.mark.parametrize("size", [20, 90])
def test_a_stiff_ladder(size):
    capacitances = np.logspace(-2, -8, size)
    run = simulate(ladder(list(capacitances)), 1.0, t_eval=[0.01, 1.0], rtol=1e-8)
    assert run.solver == "rosenbrock"
    matrix, drive = ladder_matrix(capacitances)
    rest = -np.linalg.solve(matrix, drive)
    for t, charges in zip(run.t, run.x.T, strict=True):
        volts = rest - expm(matrix * t) @ rest
        assert charges / capacitances == pytest.approx(volts, abs=1e-6)


def test_a_short_run_of_a_stiff_ladder_is_explicit():
    run = simulate(ladder(list(np.logspace(-2, -8, 20))), 1e-7)
    assert run.solver == "dopri5" and run.outcome.ok


@pytest.mark.parametrize(
    ("stiffness", "damping", "until"), [(8, 0, 10), (8, 1, 1e4), (8e8, 0, 3), (8e8, 20, 3)]
)
def test_oscillators_are_explicit(stiffness, damping, until):
    """A fast swing has to be followed, by whatever solver."""
    graph = oscillator(stiffness, damping)
    found = CompiledModel(graph).stiffness((0, until), np.array([3.0, 0.0]), np.zeros(0), NONE)
    assert not found.stiff
    run = simulate(graph, min(until, 10))
    assert run.solver == "dopri5" and run.solver_reason.startswith("dopri5: explicit equations")


def test_an_overdamped_oscillator_is_stiff():
    run = simulate(oscillator(8, 1e6), 10.0)
    assert run.solver == "rosenbrock"
    assert run["k.q"][-1] == pytest.approx(3 / 1e6, rel=1e-3)


def test_a_fast_decay_beside_a_fast_swing_is_explicit():
    graph = rates("both", lambda x, v, y: (v, -1e10 * x, -1e6 * y), (1, 0, 1))
    assert simulate(graph, 0.1, max_steps=10).solver == "dopri5"


def test_reasons_are_given():
    def reason(graph, **options):
        return simulate(graph, 0.01, **options).solver_reason

    odd = R("odd", effort=lambda f: f + f**3)
    charging = assemble("charging", Se("E", 2) >> One("loop") >> (odd, C("c", 1)))
    assert reason(bicycle_brake.graph()) == "dopri5: 1 contact with modes, events are located"
    assert reason(charging) == "rosenbrock: 1 algebraic variable"
    assert reason(charging, solver="idas") == "idas: asked for"
    assert reason(oscillator(8, 1e9), backend="native", max_steps=9).startswith("dopri5: compiled")


@pytest.mark.parametrize("name", LIBRARY)
def test_the_library_is_explicit(name):
    run = simulate(getattr(models, name).graph(), 0.01)
    assert run.solver == "dopri5" == choose(run.model, "auto").solver


def test_a_model_that_becomes_stiff_names_the_solver_that_would_go_on():
    """y follows a clock at a rate of 1e4 t^8: nothing at the start says so."""
    graph = rates("stiffening", lambda clock, y: (1, -(10**4) * clock**8 * (y - clock)), (0, 1))
    run = simulate(graph, 20.0, max_steps=30_000, solver="dopri5")
    assert run.outcome is Outcome.STEP_LIMIT
    assert "solver='rosenbrock'" in run.advice and run.advice.startswith(run.outcome.advice)
    assert simulate(graph, 20.0, solver="rosenbrock").outcome.ok
    short = simulate(oscillator(), 100.0, max_steps=30)
    assert short.outcome is Outcome.STEP_LIMIT and "rosenbrock" not in short.advice


def test_a_source_without_states_is_explicit():
    graph = assemble("none", Sf("f", 1) >> Zero("z") >> R("r", 1))
    assert simulate(graph, 1.0).solver == "dopri5"


def test_many_states_and_many_knots_raise_the_price_of_an_implicit_solver():
    drive = sympy.Symbol("u")
    graph = assemble("rc", Se("E", drive) >> One("v") >> (R("r", 1), C("c", 1e-5)), inputs=[drive])
    few = {drive: ([0, 1], [0, 1])}
    many = {drive: (np.linspace(0, 1, 30_001), np.linspace(0, 1, 30_001))}
    assert simulate(graph, 1.0, inputs=few).solver == "rosenbrock"
    assert simulate(graph, 1.0, inputs=many).solver == "dopri5"
    for size, stiff in ((20, True), (60, False)):
        model = CompiledModel(ladder([2e-5] * size))
        found = model.stiffness((0.0, 0.5), np.zeros(size), np.zeros(0), NONE)
        assert found.stiff == stiff
