"""Grafted effects against closed forms and scipy's integrators, written without bond graphs."""

import numpy
import pytest
from scipy.integrate import solve_ivp
from sympy import sin

from bondgraph import TIME, C, I, One, R, Se, Sf, Zero, assemble, simulate
from bondgraph.discrepancy.grafting import graft


def mass(momentum=0.0, force=0):
    """A free mass of 2 kg with a drag of 0.5 N s/m."""
    v = One("v")
    body = I("m", 2, initial=momentum)
    return assemble("mass", Se("push", force) >> v >> (body, R("air", 0.5)), outputs={"v": v.f})


def oscillator():
    v = One("v")
    spring = C("k", stiffness=50, initial=0.4)
    return assemble(
        "oscillator", Se("push", 0) >> v >> (I("m", 2), spring), outputs={"v": v.f, "x": spring.q}
    )


def run(graph, until, **options):
    trajectory = simulate(graph, until, rtol=1e-9, atol=1e-12, **options)
    assert trajectory.outcome.value == "finished"
    return trajectory


def reference(rates, start, until, t, **options):
    solution = solve_ivp(
        rates, (0, until), start, method="BDF", rtol=1e-9, atol=1e-11, t_eval=t, **options
    )
    assert solution.success
    return solution.y


def test_coulomb_friction_halves_fall_by_a_fixed_step():
    """Each half swing of a spring with Coulomb friction loses 2 F / k; then it sticks."""
    k, level = 50.0, 3.0
    grown = graft(oscillator(), "coulomb_friction", "v", parameters={"level": level})
    trajectory = run(grown.graph, 6.0)
    turns = [event.t for event in trajectory.events]
    half = numpy.pi / numpy.sqrt(k / 2)
    assert turns[0] == pytest.approx(half, abs=1e-7)
    # 0.4 -> -0.28 -> 0.16 -> -0.04, inside the band of 0.06 that friction holds
    assert trajectory.final["k.q"] == pytest.approx(-0.04, abs=1e-7)
    assert trajectory.final["m.p"] == pytest.approx(0, abs=1e-9)


def test_quadratic_drag_alone_slows_as_one_over_t():
    v = One("v")
    bare = assemble("bare", Se("push", 0) >> v >> I("m", 2, initial=6))
    grown = graft(bare, "quadratic_drag", "v", parameters={"drag": 0.7})
    final = run(grown.graph, 5.0).final["m.p"] / 2
    assert final == pytest.approx(3 / (1 + 0.7 * 3 * 5 / 2), rel=1e-8)


def test_lugre_friction_against_bdf():
    p = {
        "level": 1.0,
        "excess": 0.5,
        "speed": 0.05,
        "stiffness": 400.0,
        "damping": 5.0,
        "viscous": 0.3,
    }
    grown = graft(mass(force=2), "lugre_friction", "v", parameters=p)
    t = numpy.linspace(0, 2, 41)
    trajectory = run(grown.graph, 2.0, t_eval=t)

    def rates(_, state):
        v, z = state
        bristle = v - 400 * abs(v) * z / (1.0 + 0.5 * numpy.exp(-((v / 0.05) ** 2)))
        return [(2 - 0.5 * v - 400 * z - 5 * bristle - 0.3 * v) / 2, bristle]

    expected = reference(rates, [0, 0], 2, t)
    assert numpy.allclose(trajectory["v"], expected[0], atol=2e-7)
    assert numpy.allclose(trajectory["lugre_friction_spring.q"], expected[1], atol=2e-8)


def test_bouc_wen_hysteresis_against_bdf():
    grown = graft(oscillator(), "hysteresis", "v", parameters={"level": 4.0, "width": 0.05})
    t = numpy.linspace(0, 3, 61)
    trajectory = run(grown.graph, 3.0, t_eval=t)

    def rates(_, state):
        v, x, y = state
        yielding = 0.5 * (1 + numpy.sign(v * y)) * y**2
        return [(-50 * x - 4.0 * y) / 2, v, v * (1 - yielding) / 0.05]

    expected = reference(rates, [0, 0.4, 0], 3, t, max_step=2e-3)
    assert numpy.allclose(trajectory["x"], expected[1], atol=1e-5)
    taken = trajectory["hysteresis.e"] * trajectory["hysteresis.f"]
    assert taken.min() >= -1e-12 and taken.max() > 0.1  # the slider never gives power
    assert abs(trajectory.energy.relative_residual) < 1e-6


def test_compliant_coupling_of_two_masses():
    """A mass behind a yielding bond swings against the other at the reduced mass's frequency."""
    v, w = One("v"), One("w")
    rigid = assemble(
        "rigid", Se("push", 3) >> v >> I("m1", 2), v >> w, w >> (I("m2", 1), Se("pull", 0))
    )
    grown = graft(
        rigid, "compliant_coupling", "bond v>w", parameters={"stiffness": 60, "damping": 0.4}
    )
    t = numpy.linspace(0, 2, 41)
    trajectory = run(grown.graph, 2.0, t_eval=t)

    def rates(_, state):
        v1, v2, q = state
        force = 60 * q + 0.4 * (v1 - v2)
        return [(3 - force) / 2, force, v1 - v2]

    expected = reference(rates, [0, 0, 0], 2, t)
    assert numpy.allclose(trajectory["m1.p"] / 2, expected[0], atol=1e-7)
    assert numpy.allclose(trajectory["m2.p"], expected[1], atol=1e-7)


def test_a_leaking_tank_empties_exponentially():
    tank = Zero("tank")
    full = assemble("full", Sf("tap", 0) >> tank >> C("store", 4, initial=8))
    grown = graft(full, "leakage", "tank", parameters={"conductance": 0.5})
    assert run(grown.graph, 6.0).final["store.q"] == pytest.approx(8 * numpy.exp(-0.5 * 6 / 4))


def test_overflow_settles_where_it_carries_the_inflow():
    tank = Zero("tank")
    filled = assemble("filled", Sf("tap", 2) >> tank >> C("store", 1))
    grown = graft(filled, "overflow", "tank", parameters={"conductance": 4, "threshold": 3})
    assert run(grown.graph, 12.0)["tank.e"][-1] == pytest.approx(3 + 2 / 4, rel=1e-8)


def test_a_delay_shifts_a_slow_sine():
    """Two Pade sections of a delay T err in phase by w^3 (T/2)^3 / 12 each."""
    v = One("v")
    graph = assemble("g", Sf("drive", sin(2 * TIME)) >> v >> R("r", 1), outputs={"v": v.f})
    grown = graft(graph, "transport_delay", "output v", parameters={"delay": 0.3})
    t = numpy.linspace(4, 8, 81)
    trajectory = run(grown.graph, 8.0, t_eval=t)
    assert numpy.allclose(trajectory["v"], numpy.sin(2 * (t - 0.3)), atol=2 * (0.3**3) / 12)


def test_fade_weakens_a_damper_by_the_heat_it_made():
    """Without cooling the damper's coefficient is exp(-fade x heat), heat the lost kinetic energy."""
    v = One("v")
    body = assemble("body", v >> (I("m", 2, initial=8), R("brake", 3)))
    grown = graft(
        body, "thermal_fade", "dissipator brake", parameters={"fade": 0.1, "cooling": 1e-12}
    )
    t = numpy.linspace(0, 3, 31)
    trajectory = run(grown.graph, 3.0, t_eval=t)

    def rates(_, state):
        return [-3 * numpy.exp(-0.1 * (4**2 - state[0] ** 2)) * state[0] / 2]

    assert numpy.allclose(trajectory["m.p"] / 2, reference(rates, [4], 3, t)[0], atol=1e-7)
    assert trajectory.energy.dissipated == pytest.approx(
        16 - trajectory["m.p"][-1] ** 2 / 4, rel=1e-6
    )


def test_added_inertia_joins_the_one_that_is_there():
    grown = graft(mass(force=2), "added_inertia", "v", parameters={"inertance": 3})
    speed = run(grown.graph, 4.0)["v"][-1]
    assert speed == pytest.approx(2 / 0.5 * (1 - numpy.exp(-0.5 * 4 / 5)), rel=1e-8)


def test_a_stop_turns_the_speed_round():
    v = One("v")
    flying = assemble("flying", v >> (I("m", 2, initial=2), Se("pull", 0)))
    p = {"upper": 0.5, "lower": 10, "restitution": 0.6, "rest": 1e-3}
    trajectory = run(graft(flying, "end_stop", "v", parameters=p).graph, 1.0)
    assert trajectory.final["m.p"] == pytest.approx(-2 * 0.6, abs=1e-9)
    assert trajectory.events[0].t == pytest.approx(0.5, abs=1e-9)
