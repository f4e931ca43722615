"""Starts off by a factor of three; the data are scipy's, from equations written here by hand."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import C, I, One, R, Se, assemble, fit
from bondgraph.discrepancy import Measurement
from bondgraph.models import mass_on_belt, quarter_car

m, k, b, a = sympy.symbols("m k b a", positive=True)


def solved(rates, until, start, t):
    found = solve_ivp(rates, (0, until), start, t_eval=t, rtol=1e-9, atol=1e-11, max_step=0.02)
    assert found.success
    return found.y


@pytest.mark.parametrize("factor", [3, 1 / 3])
def test_damped_oscillator(factor):
    graph = assemble(
        "oscillator",
        One("v") >> (I("mass", 1), C("spring", stiffness=k, initial=0.1), R("damper", b)),
        parameters={k: 100, b: 0.5},
    )
    t = np.linspace(0, 5, 501)
    x, _ = solved(lambda t, y: [y[1], -100 * y[0] - 0.5 * y[1]], 5, [0.1, 0], t)
    noisy = x + np.random.default_rng(0).normal(0, 1e-3, len(t))
    starts = {"k": 100 * factor, "b": 0.5 / factor}
    found = fit(graph, Measurement(t, {"spring.q": noisy}), ["k", "b"], parameters=starts)
    assert found.outcome.ok and found.gap == 0
    assert abs(found.values["k"] - 100) < 4 * found.std["k"] < 1
    assert abs(found.values["b"] - 0.5) < 4 * found.std["b"] < 0.05
    assert found.channels[0].rmse == pytest.approx(1e-3, rel=0.15)


@pytest.mark.parametrize("factor", [3, 1 / 3])
def test_quarter_car_on_a_sampled_road(factor):
    truth = {"m_s": 300.0, "k_s": 20e3, "k_t": 180e3, "b_s": 1200.0}
    t = np.linspace(0, 4, 1001)
    road = np.random.default_rng(1).normal(0, 0.3, len(t))

    def rates(now, y):
        tyre, wheel, spring, body = y
        strut = truth["k_s"] * spring + truth["b_s"] * (wheel - body)
        return [
            np.interp(now, t, road) - wheel,
            (truth["k_t"] * tyre - strut) / 40,
            wheel - body,
            strut / truth["m_s"],
        ]

    _, _, spring, body = solved(rates, 4, [0, 0, 0, 0], t)
    rng = np.random.default_rng(2)
    data = {
        "v_body": body + rng.normal(0, 2e-3, len(t)),
        "suspension": spring + 300 * 9.81 / 20e3 + rng.normal(0, 2e-4, len(t)),
        "v_road": road,
    }
    starts = {name: value * factor for name, value in truth.items()}
    found = fit(quarter_car.graph(), Measurement(t, data), list(truth), parameters=starts)
    assert found.outcome.ok
    for name, value in truth.items():
        assert abs(found.values[name] - value) < 4 * found.std[name] < 0.05 * value


def belt(t, v_b=0.15, normal=10.0, mu_s=0.4, mu_k=0.25, v_s=0.1):
    """Stick and slip by scipy's located events: the mass at rest on a relaxed spring of 100 N/m."""

    def friction(slip):
        return normal * (mu_k + (mu_s - mu_k) * np.exp(-abs(slip) / v_s))

    def sliding(now, y, sign):
        return [y[1], sign * friction(v_b - y[1]) - 100 * y[0] - 0.2 * y[1]]

    def stops(now, y, sign):
        return v_b - y[1]

    def slips(now, y):
        return normal * mu_s - (100 * y[0] + 0.2 * v_b)

    stops.terminal, stops.direction, slips.terminal = True, -1, True
    now, y, stuck, parts = 0.0, [0.0, 0.0], False, []
    while now < t[-1]:
        options = {"rtol": 1e-9, "atol": 1e-11, "dense_output": True}
        if stuck:
            run = solve_ivp(lambda s, y: [v_b, 0], (now, t[-1]), y, events=slips, **options)
        else:
            run = solve_ivp(sliding, (now, t[-1]), y, events=stops, args=(1,), **options)
        here = (t >= now) & (t <= run.t[-1])
        parts.append(run.sol(t[here])[:, : here.sum()])
        now, y = run.t[-1], run.y[:, -1].copy()
        stuck = not stuck
        if stuck:
            y[1] = v_b
        else:
            y[1] -= 1e-9
        if run.status == 0:
            break
    return np.concatenate(parts, axis=1)


@pytest.mark.parametrize("factor", [3, 1 / 3])
def test_stick_slip_in_segments(factor):
    t = np.linspace(0, 8, 1201)
    x, v = belt(t)
    rng = np.random.default_rng(3)
    data = {"x": x + rng.normal(0, 1e-3, len(t)), "v": v + rng.normal(0, 5e-3, len(t))}
    starts = {"k": 100 * factor, "mu_s": 0.4 * factor, "mu_k": 0.25 * factor}
    found = fit(
        mass_on_belt.graph(), Measurement(t, data), ["k", "mu_s", "mu_k", "N"], parameters=starts
    )
    assert found.outcome.ok and found.gap == 0  # a single shot follows in the end
    assert any(step.stage.startswith("joints") for step in found.iterations)
    assert found.values["k"] == pytest.approx(100, rel=0.01)
    assert found.values["N"] * found.values["mu_s"] == pytest.approx(4, rel=0.01)
    assert found.values["N"] * found.values["mu_k"] == pytest.approx(2.5, rel=0.02)
    assert [channel.rmse for channel in found.channels] == pytest.approx([1e-3, 5e-3], rel=0.1)
    words = found.unidentified[0].words
    assert "N*mu_s" in words and "N*mu_k" in words


def test_a_model_that_blows_up_at_the_start_values():
    """x' = x^3/a - x escapes in finite time where x0^2 > a: at the start values, not at the truth."""
    graph = assemble(
        "escape",
        One("loop") >> (C("c", effort=lambda q: q - q**3 / a, initial=1), R("r", 1)),
        parameters={a: 0.3},
    )
    t = np.linspace(0, 3, 200)
    x = solved(lambda t, y: [y[0] ** 3 / 2 - y[0]], 3, [1], t)[0]
    noisy = x + np.random.default_rng(4).normal(0, 1e-3, len(t))
    found = fit(graph, Measurement(t, {"c.q": noisy}), ["a"])
    assert found.iterations[0].why  # the start itself failed
    assert found.outcome.ok
    assert abs(found.values["a"] - 2) < 4 * found.std["a"] < 0.2


def test_an_unstable_model_needs_segments():
    """A pendulum on its head under a known push: a single shot grows by e^12."""
    graph = assemble(
        "upside down",
        Se("push", sympy.Symbol("push"))
        >> One("v")
        >> (I("mass", 1), C("fall", effort=lambda q: -k * q)),
        parameters={k: 4},
        inputs={sympy.Symbol("push"): "N"},
    )
    t = np.linspace(0, 4, 801)
    # data that stay near the top, as a controller would hold them: the push is what it takes
    x, w = 0.1 * np.sin(3 * t), 3.0
    push = -(w**2) * x - 9 * x
    noisy = x + np.random.default_rng(5).normal(0, 1e-3, len(t))
    rows = Measurement(t, {"push": push, "fall.q": noisy})
    found = fit(graph, rows, ["k", "states"], parameters={"k": 4}, segments=12)
    assert found.values["k"] == pytest.approx(9, rel=0.02)


def test_a_start_that_cannot_be_is_an_outcome():
    graph = assemble(
        "hopeless",
        One("loop") >> (C("c", effort=lambda q: -a * (1 + q**2), initial=1), R("r", 1)),
        parameters={a: 50},
    )
    rows = Measurement(np.linspace(0, 1, 5), {"c.q": [1, 1, 1, 1, 1]})
    found = fit(graph, rows, ["a"], bounds={"a": (40, 60)})
    assert found.outcome.value == "no start" and "start values" in found.advice
    assert found.std["a"] == np.inf and found.values["a"] == pytest.approx(50)
    assert found.trajectories == () and found.channels == ()
