"""Switching elements beside laws that keep algebraic variables: solved for in every mode."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from bondgraph import (
    TIME,
    C,
    CompiledModel,
    Diode,
    Friction,
    I,
    One,
    Outcome,
    R,
    Se,
    Zero,
    assemble,
    derive,
    in_mode,
    simulate,
)


def cubic(name):
    """A law that is not inverted in closed form: e = f + f^3."""
    return R(name, effort=lambda f: f + f**3)


def current(e):
    """Solve i + i^3 = e."""
    return brentq(lambda i: i + i**3 - e, -10, 10, xtol=1e-14)


def test_a_rectifier_with_a_cubic_resistor():
    loop, out = One("loop"), Zero("out")
    graph = assemble(
        "rectifier",
        Se("E", 5 * sympy.sin(10 * TIME)) >> loop >> (cubic("r"), Diode("d")),
        loop >> out >> (C("c", 0.5), R("load", 4)),
    )
    assert derive(in_mode(graph, {"d": "conducting"})).algebraic

    def rate(t, v):
        over = 5 * np.sin(10 * t) - v[0]
        return ((current(over) if over > 0 else 0.0) - v[0] / 4) / 0.5

    grid = np.linspace(0, 2, 201)
    true = solve_ivp(rate, (0, 2), [0.0], t_eval=grid, rtol=1e-10, atol=1e-12, max_step=1e-2)
    run = simulate(graph, 2.0, t_eval=grid, rtol=1e-9, max_step=0.02)
    assert run.outcome is Outcome.FINISHED
    assert run["out.e"] == pytest.approx(true.y[0], abs=1e-6)
    flow = run["loop.f"]
    assert run["r.e"] == pytest.approx(flow + flow**3, abs=1e-9)
    assert (flow > -1e-12).all() and flow.max() > 0.5
    assert abs(run.energy.relative_residual) < 1e-7


def test_friction_beside_a_nonlinear_loop():
    loop, v = One("loop"), One("v")
    charge = C("c", 1)
    graph = assemble(
        "both",
        Se("E", 1) >> loop >> (charge, cubic("odd")),
        v >> (I("m", 1, initial=1), Friction("rub", kinetic=lambda speed: 0.5 + charge.q)),
    )
    run = simulate(graph, 3.0, rtol=1e-9)
    true = solve_ivp(
        lambda t, x: [current(1 - x[0]), -0.5 - x[0]],
        (0, 3),
        [0.0, 1.0],
        rtol=1e-11,
        atol=1e-13,
        events=lambda t, x: x[1],
    )
    (event,) = run.events
    assert event.to_mode == "stick"
    assert event.t == pytest.approx(true.t_events[0][0], rel=1e-7)
    assert run.final["c.q"] == pytest.approx(true.y[0, -1], rel=1e-7)


def test_a_run_does_not_hang_on_the_run_before():
    loop, out = One("loop"), Zero("out")
    graph = assemble(
        "twice",
        Se("E", 5 * sympy.sin(10 * TIME)) >> loop >> (cubic("r"), Diode("d")),
        loop >> out >> (C("c", 0.5), R("load", 4)),
    )
    model = CompiledModel(graph)
    first, second = (simulate(model, 0.4, max_step=0.02) for _ in range(2))
    assert (first.x == second.x).all() and (first["r.e"] == second["r.e"]).all()
