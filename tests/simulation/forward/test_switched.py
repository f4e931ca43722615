"""Sensitivities through impacts and commutations, in closed form and against differences."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

from bondgraph import (
    TIME,
    C,
    CompiledModel,
    Diode,
    EndStop,
    I,
    Integrator,
    One,
    R,
    Samples,
    Se,
    Switch,
    Zero,
    assemble,
    sensitivities,
    simulate,
)
from tests.differences import differences

g, h0, e, m = sympy.symbols("g h0 e m", positive=True)


def ball():
    v = One("v")
    height = Integrator("h", -v.f, initial=h0)
    floor = EndStop("floor", gap=height.y, restitution=e)
    return assemble(
        "ball",
        Se("weight", m * g) >> v >> (I("m", m), floor),
        height,
        parameters={g: 9.81, h0: 1.0, e: 0.8, m: 2.0},
    )


def test_a_bouncing_ball():
    """Impacts at sqrt(2 h/g) (1 + 2 e + 2 e^2 + ...); between them it flies."""
    names = ["g", "h0", "e", "m"]
    found = sensitivities(ball(), 2.2, names, rtol=1e-10)
    values = {g: 9.81, h0: 1.0, e: 0.8, m: 2.0}
    fall = sympy.sqrt(2 * h0 / g)
    assert len(found.events) == 3
    for count, row in enumerate(found.events):
        impact = fall * (1 + 2 * sum(e**i for i in range(1, count + 1)))
        expected = [float(sympy.diff(impact, s).subs(values)) for s in (g, h0, e, m)]
        assert row == pytest.approx(expected, abs=1e-9)
    t = found.trajectory.t
    last = t > found.trajectory.events[-1].t
    since = TIME - fall * (1 + 2 * e + 2 * e**2)
    flight = e**3 * g * fall * since - g * since**2 / 2
    for row, symbol in zip(found["h.y"], (g, h0, e, m), strict=True):
        slope = sympy.lambdify(TIME, sympy.diff(flight, symbol).subs(values))
        assert row[last] == pytest.approx(slope(t[last]) + 0 * t[last], abs=1e-8)


def test_rows_stand_before_and_after_each_impact():
    """Thrown down with p0 it comes p0/(m g) earlier, and meets the floor no faster, at first order."""
    found = sensitivities(ball(), 1.0, ["m.p"])
    (impact,) = np.flatnonzero(np.diff(found.trajectory.t) == 0)
    weight = 2.0 * 9.81
    assert found.events == pytest.approx(np.array([[-1 / weight]]))
    before, after = found["m.p"][0, impact : impact + 2]
    assert before == pytest.approx(1)
    # at a fixed time after it, the way back has gone on longer
    assert after == pytest.approx(weight * 1 / weight)


def share():
    c1, c2, ts = sympy.symbols("c1 c2 ts", positive=True)
    way, a, b = One("way"), Zero("a"), Zero("b")
    return assemble(
        "share",
        a >> (C("c1", c1, initial=2), R("leak", 5)),
        b >> C("c2", c2),
        a >> way >> b,
        way >> Switch("s", closed=TIME - ts),
        parameters={c1: 1.0, c2: 3.0, ts: 1.0},
    )


def choke():
    v, inductance, r, w = sympy.symbols("V L r w", positive=True)
    loop = One("loop")
    return assemble(
        "choke",
        Se("E", v * sympy.sin(w * TIME)) >> loop >> (Diode("d"), I("L", inductance), R("r", r)),
        parameters={v: 10.0, w: 100.0, inductance: 0.1, r: 10.0},
    )


def rack():
    """A mass and a flywheel behind a pinion meet a stop: the jump goes through both."""
    mass, j, n = sympy.symbols("mass j n", positive=True)
    from bondgraph import TF

    v, w = One("v"), One("w")
    height = Integrator("h", -v.f, initial=0.1)
    return assemble(
        "rack",
        v >> (I("m", mass, initial=3), EndStop("stop", gap=height.y, restitution=0.5)),
        v >> Zero("mesh") >> (C("teeth", stiffness=40), One("pinion") >> TF("p", 1 / n) >> w),
        w >> (I("J", j), R("bearing", 0.1)),
        height,
        parameters={mass: 3.0, j: 0.5, n: 0.2},
    )


@pytest.mark.parametrize(
    ("graph", "until", "names", "sizes"),
    [
        (share, 2.0, ["c1", "c2", "ts", "c1.q"], {"c1.q": 1.0}),
        (choke, 0.1, ["V", "L", "w"], {}),
        pytest.param(rack, 0.14, ["mass"], {}, marks=pytest.mark.slow),
    ],
)
def test_by_differences(graph, until, names, sizes):
    model = CompiledModel(graph())
    assert model.switched
    t = np.linspace(0, until, 41)
    given = {"max_step": 1e-3} if graph is choke else {}
    found = sensitivities(model, until, names, t_eval=t, rtol=1e-9, **given)
    assert len(found.events)
    for c, name in enumerate(names):
        moving = found.x[:, c].any(axis=1)
        size = sizes.get(name)
        steps = (1e-3, 3e-4)
        exact = differences(
            model, until, name, t, size=size, moving=moving, steps=steps, rtol=1e-10, **given
        )
        error = np.abs(found.x[:, c] - exact.x)[:, exact.far].max(axis=1)
        assert exact.doubt < 1e-6
        assert (error <= 1e-6 * exact.scale)[moving].all(), name


def rectifier():
    """While the diode conducts, a law of the loop stays implicit."""
    v, a, b = sympy.symbols("v a b", positive=True)
    loop, node = One("loop"), Zero("node")
    return assemble(
        "rectifier",
        Se("E", v * sympy.sin(9 * TIME)) >> loop >> (Diode("d", resistance=0.2), node),
        node >> (C("C", 0.3), R("load", effort=lambda f: a * f + b * f**3)),
        parameters={v: 5.0, a: 2.0, b: 0.5},
    )


def test_signals_where_a_mode_has_algebraic_variables():
    """Along q(t): a f + b f^3 = q/0.3."""
    t = np.linspace(0, 0.4, 9)
    found = sensitivities(rectifier(), 0.4, ["v", "b"], t_eval=t, rtol=1e-5, max_step=0.05)
    assert [event.to_mode for event in found.trajectory.events] == ["blocking"]
    f = found.trajectory["load.f"]
    direct = np.array([0 * t, -(f**3)])
    expected = (found["C.q"] / 0.3 + direct) / (2 + 1.5 * f**2)
    assert found["load.f"] == pytest.approx(expected, abs=1e-9)
    assert np.abs(found["load.f"]).max() > 0.01


@pytest.mark.slow
def test_modes_with_algebraic_variables_by_differences():
    model, t = CompiledModel(rectifier()), np.linspace(0, 0.4, 9)
    found = sensitivities(model, 0.4, ["v", "b"], t_eval=t, rtol=1e-8, max_step=0.05)
    for c, name in enumerate(["v", "b"]):
        exact = differences(model, 0.4, name, t, steps=(3e-3, 1e-3), rtol=1e-9, max_step=0.05)
        error = np.abs(found.x[:, c] - exact.x)[:, exact.far].max()
        assert error < 1e-6 * exact.scale[0]


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_an_input_with_knots_leaves_free_modes_alone(hold):
    """A mass pushed by a table hits its stops; knots between impacts jump nothing."""
    k, push, gap = sympy.Symbol("k", positive=True), sympy.Symbol("push"), sympy.Symbol("gap")
    v = One("v")
    way = Integrator("way", v.f)
    stop = EndStop("stop", gap=gap - way.y, restitution=0.6)
    graph = assemble(
        "pushed",
        Se("motor", push) >> v >> (I("m", 1.0), C("k", stiffness=k), R("b", 0.3), stop),
        way,
        parameters={k: 20.0, gap: 0.25},
        inputs=[push],
    )
    t = np.linspace(0, 3, 61)
    inputs = {"push": Samples(t, 6 * np.sin(5 * t), hold)}
    found = sensitivities(graph, 3.0, ["k", "gap"], inputs=inputs, t_eval=t, rtol=1e-10)
    assert len(found.events) >= 2
    for row, name in zip(found["m.p"], ("k", "gap"), strict=True):
        h = 1e-6
        up, down = (
            simulate(
                graph,
                3.0,
                {name: {"k": 20.0, "gap": 0.25}[name] + sign * h},
                inputs=inputs,
                t_eval=t,
                rtol=1e-11,
            )["m.p"]
            for sign in (1, -1)
        )
        clear = np.array([min(abs(s - e.t) for e in found.trajectory.events) > 1e-3 for s in t])
        quotient = (up - down) / (2 * h)
        assert row[clear] == pytest.approx(
            quotient[clear], rel=1e-4, abs=1e-5 * abs(quotient[clear]).max()
        )
