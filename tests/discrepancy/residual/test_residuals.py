"""Residuals from runs, models and plain arrays."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import I, One, Parameter, R, Se, assemble, simulate
from bondgraph.discrepancy import Measurement, Residuals, residuals
from bondgraph.errors import MeasurementError
from bondgraph.models import mass_on_belt

F = sympy.Symbol("F", real=True)
T = np.linspace(0, 2, 201)


def cart():
    m, c = sympy.symbols("m c", positive=True)
    mass = I("mass", m)
    return assemble(
        "cart",
        Se("push", F) >> One("speed") >> (mass, R("bearing", c)),
        parameters={m: Parameter(2.0, "kg"), c: Parameter(1.0, "N*s/m")},
        inputs={F: "N"},
        outputs={"v": (mass.f, "m/s")},
    )


def test_a_model_follows_the_recorded_input_in_its_units():
    force = 3 * np.sin(4 * T)
    truth = solve_ivp(
        lambda t, v: (np.interp(t, T, force) - v) / 2,
        (0, 2),
        [0.5],
        t_eval=T,
        rtol=1e-8,
        max_step=0.01,
    ).y[0]
    run = Measurement(
        T, {"v": 100 * truth, "F": force / 1000}, {"v": "cm/s", "F": "kN"}, initial={"v": 0.5}
    )
    found = residuals(cart(), run, rtol=1e-9)
    assert np.abs(found.gap("v")).max() < 1e-5 < np.abs(truth).max()
    assert found.unit("v") == "m/s" and np.allclose(found.along("F"), force)


def test_held_inputs_are_held():
    force = np.where(np.arange(201) % 50 < 25, 1.0, -1.0)
    exact = [0.0]  # of steps, sample by sample
    decay = np.exp(-0.01 / 2)
    for value in force[:-1]:
        exact.append(exact[-1] * decay + value * (1 - decay))
    run = Measurement(T, {"v": exact, "F": force}, holds={"F": "zero"})
    assert np.abs(residuals(cart(), run, rtol=1e-9).gap("v")).max() < 1e-7
    lines = Measurement(T, {"v": exact, "F": force})
    assert np.abs(residuals(cart(), lines, rtol=1e-9).gap("v")).max() > 1e-3


def test_a_run_is_read_at_the_times_of_the_recording():
    run = simulate(mass_on_belt.graph(), 1.0, t_eval=np.linspace(0, 1, 101))
    part = Measurement(run.t[10:90:7], {"x": run["x"][10:90:7] + 0.5, "other": run.t[10:90:7]})
    found = residuals(run, part)
    assert found.signals == ("x",) and np.allclose(found.gap("x"), 0.5)
    assert "v" in found.states and len(found) == 12


def test_gaps_in_the_recording_stay_gaps():
    found = residuals({"v": [1.0, 2.0, 3.0]}, Measurement([0, 1, 2], {"v": [2, np.nan, 3]}))
    assert np.array_equal(found.gap("v"), [1, np.nan, 0], equal_nan=True)
    assert np.array_equal(Residuals([0, 1], {"v": [0, 0]}, {"v": [-2, 1]}).along("|v|"), [2, 1])


def refused():
    belt = simulate(mass_on_belt.graph(), 1.0, t_eval=[0, 0.5, 1.0])
    short = simulate(mass_on_belt.graph(), 1.0, t_eval=[0, 0.5, 1.0], max_steps=2)
    at = Measurement([0, 0.5, 1.0], {"x": [0, 0, 0]})
    holed = Measurement([0, 0.5, 1.0], {"v": [0, 0, 0], "F": [0, np.nan, 0]})
    yield "no row at t = 0.25 s", lambda: residuals(belt, Measurement([0, 0.25], {"x": [0, 0]}))
    yield "the run ended at", lambda: residuals(short, at)
    yield "y both measured and in the model", lambda: residuals(belt, at, ["y"])
    yield (
        "none of the recording's columns",
        lambda: residuals(belt, Measurement([0, 1], {"q": [0, 0]})),
    )
    yield "rtol would do nothing", lambda: residuals(belt, at, rtol=1e-3)
    yield "input 'F' has gaps", lambda: residuals(cart(), holed)
    yield "2 values for 3 times", lambda: residuals({"x": [0, 0]}, at)
    yield "not finite at t = 0.5 s", lambda: residuals({"x": [0, np.nan, 0]}, at)
    yield "not so: w", lambda: Residuals([0, 1], {"v": [0, 0]}, {"v": [0, 0], "w": [0, 0]})
    yield "increase", lambda: Residuals([0, 0], {"v": [0, 0]}, {"v": [0, 0]})
    yield (
        "'w' was not compared; there is v",
        lambda: Residuals([0, 1], {"v": [0, 0]}, {"v": [0, 0]}).gap("w"),
    )
    yield "no signal 'w'", lambda: Residuals([0, 1], {"v": [0, 0]}, {"v": [0, 0]}).along("w")


@pytest.mark.parametrize(
    ("match", "make"), list(refused()), ids=lambda x: x if isinstance(x, str) else ""
)
def test_refused_by_name(match, make):
    with pytest.raises(MeasurementError, match=match):
        make()
