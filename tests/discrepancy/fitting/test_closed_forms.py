"""Fits whose answer is a formula, or numpy's own least squares."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble, fit
from bondgraph.discrepancy import Measurement
from bondgraph.errors import BondGraphError

tau, a, b, e0, c = sympy.symbols("tau a b e0 c", positive=True)


def decay(initial=2):
    return assemble(
        "decay", One("loop") >> (R("r", tau), C("c", 1, initial=initial)), parameters={tau: 1}
    )


def line():
    """A capacity of 1 F filled by a + b u: q = q0 + a t + b U, linear in all three."""
    given = sympy.Symbol("given")
    return assemble(
        "line",
        Sf("feed", a + b * given) >> Zero("n") >> C("c", 1),
        parameters={a: 1, b: 1},
        inputs={given: "A"},
    )


def line_data(noise=0.05, seed=3, n=200):
    t = np.linspace(0, 2, n)
    u = np.cos(5 * t)
    area = np.concatenate([[0], np.cumsum((u[1:] + u[:-1]) / 2 * np.diff(t))])
    q = 0.3 + 0.7 * t + 2.5 * area + np.random.default_rng(seed).normal(0, noise, n)
    return t, u, area, q


def test_what_is_linear_is_numpys_least_squares():
    t, u, area, q = line_data()
    design = np.column_stack([t, area, np.ones_like(t)])
    answer, square, *_ = np.linalg.lstsq(design, q, rcond=None)
    covariance = np.linalg.inv(design.T @ design) * square[0] / (len(t) - 3)
    found = fit(line(), Measurement(t, {"given": u, "c.q": q}), ["a", "b", "states"], segments=None)
    assert found.outcome.ok
    values = [*found.values.values(), found.initial[0]["c.q"]]
    assert values == pytest.approx(answer, rel=1e-5)
    (channel,) = found.channels
    assert channel.effective == len(t)  # white
    assert found.covariance == pytest.approx(covariance, rel=1e-3)
    assert channel.rmse == pytest.approx((square[0] / len(t)) ** 0.5, rel=1e-6)
    assert found.names == ("a", "b", "c.q")
    std = np.sqrt(np.diag(covariance))
    assert found.correlation == pytest.approx(covariance / np.outer(std, std), abs=1e-4)


def test_segments_have_the_covariance_of_one_shot():
    t, u, _, q = line_data()
    rows = Measurement(t, {"given": u, "c.q": q})
    one = fit(line(), rows, ["a", "b", "c.q"], segments=None)
    many = fit(line(), rows, ["a", "b", "c.q"], segments=7)
    assert list(many.values.values()) == pytest.approx(list(one.values.values()), rel=1e-5)
    assert many.covariance == pytest.approx(one.covariance, rel=1e-3)


def test_step_of_an_rc():
    graph = assemble(
        "rc", Se("v", e0) >> One("loop") >> (R("r", 2), C("c", c)), parameters={e0: 1, c: 1}
    )
    t = np.linspace(0, 5, 101)
    q = 3 * 0.4 * (1 - np.exp(-t / (2 * 0.4)))
    found = fit(graph, Measurement(t, {"c.q": q * 1e3}, {"c.q": "mC"}), ["e0", "c"])
    assert found.values == pytest.approx({"e0": 3, "c": 0.4}, rel=1e-5)


def test_error_bars_are_those_of_the_scatter():
    """40 seeds: standard deviation of the estimates against that reported, to its own 11 %."""
    t = np.linspace(0, 2, 60)
    clean = 2 * np.exp(-t / 0.5)
    graph, estimates, told = decay(), [], []
    from bondgraph import CompiledModel

    model = CompiledModel(graph)
    for seed in range(40):
        noisy = clean + np.random.default_rng(seed).normal(0, 0.05, len(t))
        found = fit(model, Measurement(t, {"c.q": noisy}), ["tau"], noise={"c.q": 0.05})
        estimates.append(found.values["tau"])
        told.append(found.std["tau"])
    slope = 2 * t / 0.5**2 * np.exp(-t / 0.5)
    exact = 0.05 / np.sqrt(slope @ slope)
    assert np.mean(told) == pytest.approx(exact, rel=0.05)
    assert np.std(estimates, ddof=1) == pytest.approx(exact, rel=0.35)
    assert np.mean(estimates) == pytest.approx(0.5, abs=3 * exact / 40**0.5)


def test_a_prior_is_one_more_datum():
    t, u, _, q = line_data()
    rows = Measurement(t, {"given": u, "c.q": q})
    given = {"parameters": {"a": 0.7}, "initial": {"c.q": 0.3}, "noise": {"c.q": 0.05}}
    free = fit(line(), rows, ["b"], **given)
    std, value = free.std["b"], free.values["b"]
    same = fit(line(), rows, ["b"], **given, priors={"b": (value, std)})
    assert same.values == pytest.approx(free.values, rel=1e-6)
    assert same.std["b"] == pytest.approx(std / 2**0.5, rel=1e-3)
    lower = fit(line(), rows, ["b"], **given, priors={"b": (value - 2 * std, std)})
    assert lower.values["b"] == pytest.approx(value - std, abs=0.1 * std)


def test_bounds_hold_and_are_named():
    t = np.linspace(0, 2, 60)
    rows = Measurement(t, {"c.q": 2 * np.exp(-t / 0.5)})
    found = fit(decay(), rows, ["tau"], bounds={"tau": (0.8, (3000, "ms"))})
    assert found.values["tau"] == pytest.approx(0.8)
    assert found.at_bounds == ("tau",) and "at a bound: tau" in found.advice


@pytest.mark.parametrize("loss", ["huber", "cauchy"])
def test_outliers_are_held_back(loss):
    t = np.linspace(0, 2, 200)
    rng = np.random.default_rng(0)
    q = 2 * np.exp(-t / 0.5) + rng.normal(0, 0.01, len(t))
    q[::10] += 1.0
    rows = Measurement(t, {"c.q": q})
    plain, robust = (fit(decay(), rows, ["tau"], loss=kind) for kind in ("linear", loss))
    assert abs(plain.values["tau"] - 0.5) > 0.05
    assert robust.values["tau"] == pytest.approx(0.5, abs=0.005)
    assert robust.channels[0].noise < 0.03


def test_gaps_and_unequal_times():
    rng = np.random.default_rng(1)
    t = np.sort(rng.uniform(0, 2, 150))
    q = 2 * np.exp(-t / 0.5) + rng.normal(0, 0.01, len(t))
    q[40:90] = np.nan
    found = fit(decay(), Measurement(t - 0, {"c.q": q}), ["tau", "c.q"])
    assert found.channels[0].count == 100
    assert np.isnan(found.channels[0].residuals[40:90]).all()
    assert abs(found.values["tau"] - 0.5) < 4 * found.std["tau"] < 0.05


def test_several_recordings_have_their_own_starts():
    rng = np.random.default_rng(2)
    rows = []
    for q0, length in ((2.0, 3), (-1.0, 1), (0.5, 2)):
        t = np.linspace(0, length, 40 * length)
        noise = rng.normal(0, 0.01, len(t))
        rows.append(Measurement(t, {"c.q": q0 * np.exp(-t / 0.5) + noise}, name=f"run {q0}"))
    found = fit(decay(), rows, ["tau", "states"])
    assert abs(found.values["tau"] - 0.5) < 4 * found.std["tau"] < 0.05
    starts = [start["c.q"] for start in found.initial]
    assert starts == pytest.approx([2, -1, 0.5], abs=0.03)
    assert found.names[1:] == ("c.q [1: run 2.0]", "c.q [2: run -1.0]", "c.q [3: run 0.5]")
    known = [
        Measurement(r.t, dict(r.columns), initial={"c.q": q})
        for r, q in zip(rows, (2, -1, 0.5), strict=True)
    ]
    assert fit(decay(), known, ["tau"]).values["tau"] == pytest.approx(0.5, rel=0.02)


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_the_hold_of_an_input_is_that_declared(hold):
    t = np.linspace(0, 2, 41)
    u = np.random.default_rng(5).normal(0, 1, len(t))
    step = np.diff(t)
    rise = u[:-1] * step if hold == "zero" else (u[1:] + u[:-1]) / 2 * step
    q = 0.7 * t + 2.5 * np.concatenate([[0], np.cumsum(rise)])
    other = {"zero": "linear", "linear": "zero"}[hold]
    right, wrong = (
        fit(line(), Measurement(t, {"given": u, "c.q": q}, holds={"given": kind}), ["a", "b"])
        for kind in (hold, other)
    )
    assert right.values == pytest.approx({"a": 0.7, "b": 2.5}, rel=1e-5)
    assert right.channels[0].rmse < 1e-5 < 1e-2 < wrong.channels[0].rmse


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"free": ["tua"]}, "tau"),
        ({"free": []}, "free"),
        ({"free": ["tau", "tau"]}, "once"),
        ({"bounds": {"tau": (2, 1)}}, "bounds"),
        ({"bounds": {"tau": 2}}, "two numbers"),
        ({"bounds": {"c.q": (0, 1)}}, "not free"),
        ({"priors": {"tau": (1, 0)}}, "prior"),
        ({"noise": {"c.q": 0}}, "positive"),
        ({"noise": {"r.e": 1}}, "no measurement"),
        ({"loss": "square"}, "huber"),
        ({"segments": 0}, "segments"),
        ({"segments": "many"}, "segments"),
    ],
)
def test_bad_input_is_named(changes, word):
    rows = Measurement([0, 1], {"c.q": [2, 1]})
    options = {"free": ["tau"], **changes}
    with pytest.raises(BondGraphError, match=word):
        fit(decay(), rows, **options)


def test_columns_that_are_no_signals_are_named():
    with pytest.raises(BondGraphError, match="'height'"):
        fit(decay(), Measurement([0, 1], {"height": [2, 1]}), ["tau"])
    with pytest.raises(BondGraphError, match="measurement"):
        fit(decay(), [], ["tau"])


def test_progress_limits_and_inertia():
    m = sympy.Symbol("m", positive=True)
    graph = assemble("fall", Se("w", 10) >> One("v") >> I("body", m), parameters={m: 5})
    t = np.linspace(0, 1, 20)
    rows, seen = Measurement(t, {"body.f": 5 * t}), []
    found = fit(graph, rows, ["m"], progress=seen.append)
    assert found.values["m"] == pytest.approx(2, rel=1e-6)
    assert tuple(seen) == found.iterations and seen[0].stage == "start"
    short = fit(graph, rows, ["m"], max_iterations=2)
    assert short.outcome.value == "step limit" and "max_iterations" in short.advice
    late = fit(graph, rows, ["m"], time_budget=0)
    assert not late.outcome.ok
