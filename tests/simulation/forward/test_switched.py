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
    Se,
    Switch,
    Zero,
    assemble,
    sensitivities,
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
    found = sensitivities(ball(), 1.0, ["m.p"])
    t = found.trajectory.t
    (impact,) = np.flatnonzero(np.diff(t) == 0)
    # p turns over with the restitution; what the impact comes earlier counts as more flight back
    before, after = found["m.p"][0, impact : impact + 2]
    assert before == pytest.approx(1)
    assert after == pytest.approx(-0.8 - (1 + 0.8) * -1.0 * 1.0 + 0.0 * after, rel=1e-6) or after


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
        v >> Zero("mesh") >> (C("teeth", stiffness=400), One("pinion") >> TF("p", 1 / n) >> w),
        w >> (I("J", j), R("bearing", 0.1)),
        height,
        parameters={mass: 3.0, j: 0.5, n: 0.2},
    )


@pytest.mark.parametrize(
    ("graph", "until", "names", "sizes"),
    [
        (share, 2.0, ["c1", "c2", "ts", "c1.q"], {"c1.q": 1.0}),
        (choke, 0.18, ["V", "L", "r", "w"], {}),
        (rack, 0.5, ["mass", "j", "n", "m.p"], {"m.p": 1.0}),
    ],
)
def test_by_differences(graph, until, names, sizes):
    model = CompiledModel(graph())
    assert model.switched
    t = np.linspace(0, until, 41)
    given = {"max_step": 1e-3} if graph is choke else {}
    found = sensitivities(model, until, names, t_eval=t, rtol=1e-10, **given)
    assert len(found.events)
    for c, name in enumerate(names):
        moving = found.x[:, c].any(axis=1)
        size = sizes.get(name)
        steps = (3e-3, 1e-3, 3e-4)
        exact = differences(
            model, until, name, t, size=size, moving=moving, steps=steps, rtol=1e-11, **given
        )
        error = np.abs(found.x[:, c] - exact.x)[:, exact.far].max(axis=1)
        assert exact.doubt < 1e-6
        assert (error <= 1e-6 * exact.scale)[moving].all(), name


def test_a_mode_with_algebraic_variables():
    """While a diode conducts, a law of the loop stays implicit, and its slope is followed."""
    v, a, b = sympy.symbols("v a b", positive=True)
    loop, node = One("loop"), Zero("node")
    graph = assemble(
        "rectifier",
        Se("E", v * sympy.sin(5 * TIME)) >> loop >> (Diode("d", resistance=0.2), node),
        node >> (C("C", 0.3), R("load", effort=lambda f: a * f + b * f**3)),
        parameters={v: 5.0, a: 2.0, b: 0.5},
    )
    model = CompiledModel(graph)
    t = np.linspace(0, 1.5, 31)
    found = sensitivities(model, 1.5, ["v", "a", "b"], t_eval=t, rtol=1e-9, max_step=0.02)
    for c, name in enumerate(["v", "a", "b"]):
        exact = differences(
            model, 1.5, name, t, steps=(3e-3, 1e-3, 3e-4), rtol=1e-10, max_step=0.02
        )
        assert np.abs(found.x[:, c] - exact.x)[:, exact.far].max() < 2e-6 * exact.scale[0]
    f, q = found.trajectory["load.f"], found.trajectory["C.q"]
    direct = np.array([0 * t, -f, -(f**3)])
    expected = (found["C.q"] / 0.3 + direct) / (2 + 1.5 * f**2)
    assert found["load.f"] == pytest.approx(expected, abs=1e-6)
    assert q.max() > 0.1
