"""Sensitivities of smooth models, explicit and with algebraic variables."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

from bondgraph import (
    C,
    CompiledModel,
    I,
    One,
    R,
    Samples,
    Se,
    Zero,
    assemble,
    sensitivities,
    simulate,
)
from bondgraph.models import quarter_car
from tests.differences import differences

E, c, a, b, r = sympy.symbols("E c a b r", positive=True)


def loop_with_a_law():
    """A source and a resistance r charge c, beside a law e = a f + b f^3 that stays implicit."""
    charge, node = One("charge"), Zero("node")
    return assemble(
        "law",
        Se("E", E) >> charge >> (R("r", r), node),
        node >> (C("C", c), R("leak", effort=lambda flow: a * flow + b * flow**3)),
        parameters={E: 3.0, c: 0.5, a: 2.0, b: 0.7, r: 1.5},
    )


@pytest.mark.parametrize("solver", ["rosenbrock", "idas"])
def test_a_dae(solver):
    model = CompiledModel(loop_with_a_law())
    assert len(model.equations.algebraic) == 1
    t = np.linspace(0, 2, 41)
    names = ["E", "c", "a", "b", "r", "C.q"]
    found = sensitivities(model, 2.0, names, t_eval=t, solver=solver, rtol=1e-9)
    assert found.z.shape == (1, 6, 41)
    for i, name in enumerate(names):
        size = 0.5 if name == "C.q" else None
        exact = differences(model, 2.0, name, t, size=size, solver=solver, rtol=1e-11)
        assert exact.doubt < 1e-6
        assert np.abs(found.x[:, i] - exact.x).max() < 2e-6 * exact.scale[0]


def test_its_algebraic_variables_and_what_is_read_off_them():
    """Along q(t): a f + b f^3 = q/c, so (a + 3 b f^2) df = dq/c - q/c^2 dc - f da - f^3 db."""
    t = np.linspace(0, 2, 41)
    names = ["E", "c", "a", "b"]
    found = sensitivities(loop_with_a_law(), 2.0, names, t_eval=t, rtol=1e-9)
    f, q = found.trajectory["leak.f"], found.trajectory["C.q"]
    direct = np.array([0 * t, -q / 0.25, -f, -(f**3)])
    expected = (found["C.q"] / 0.5 + direct) / (2 + 3 * 0.7 * f**2)
    assert found["leak.f"] == pytest.approx(expected, abs=1e-7)
    assert found["leak.e"] == pytest.approx(found["C.q"] / 0.5 + direct * [[0], [1], [0], [0]])


@pytest.mark.parametrize("solver", ["cvodes", "idas", "rosenbrock"])
def test_a_stiff_solver_gives_what_dopri5_gives(solver):
    """Inputs that step: the road of a quarter car."""
    road = {"v_road": Samples(np.linspace(0, 1, 6), [0.3, -1, 0.5, 0, 1, 0], "zero")}
    model = CompiledModel(quarter_car.graph())
    t = np.linspace(0, 1.3, 27)
    given = {"inputs": road, "t_eval": t}
    names = ["m_s", "k_t", "b_s", "tyre.q"]
    one = sensitivities(model, 1.3, names, rtol=1e-10, **given)
    other = sensitivities(model, 1.3, names, rtol=1e-9, solver=solver, **given)
    assert other.trajectory.solver == solver
    scale = np.abs(one.x).max(axis=2, keepdims=True)
    assert (np.abs(other.x - one.x) <= 1e-6 * scale).all()
    run = simulate(model, 1.3, rtol=1e-9, solver=solver, **given)
    assert np.array_equal(run.x, other.trajectory.x)


def test_its_own_output_times():
    body = One("body")
    graph = assemble("stop", body >> (I("m", 2, initial=4), R("r", a)), parameters={a: 3.0})
    found = sensitivities(graph, 1.0, ["a", "m.p"], solver="rosenbrock", rtol=1e-9)
    t = found.trajectory.t
    decay = np.exp(-1.5 * t)
    assert found["m.p"] == pytest.approx(np.array([-2 * t * decay, decay]), abs=1e-7)
    assert found.x_end[0] == pytest.approx([-2 * np.exp(-1.5), np.exp(-1.5)], abs=1e-7)
