"""Impacts at end stops against the mechanics of colliding bodies, in closed form."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    TF,
    TIME,
    C,
    EndStop,
    Friction,
    I,
    Integrator,
    One,
    Outcome,
    R,
    Se,
    Zero,
    assemble,
    simulate,
)
from bondgraph.errors import SimulationError

G = 9.81


def ball(restitution, rest=0, height=1.0):
    v = One("v")
    h = Integrator("h", -v.f, initial=height)
    floor = EndStop("floor", gap=h.y, restitution=restitution, rest=rest)
    return assemble("ball", Se("weight", 2 * G) >> v >> (I("m", 2), floor), h)


def pair(m1, m2, restitution, v1=2.0, v2=0.0):
    left, right, between = One("left"), One("right"), Zero("between")
    gap = Integrator("gap", right.f - left.f, initial=1)
    return assemble(
        "pair",
        left >> I("m1", m1, initial=m1 * v1),
        right >> I("m2", m2, initial=m2 * v2),
        left >> between >> right,
        between >> EndStop("stop", gap=gap.y, restitution=restitution),
        gap,
    )


class TestBouncingBall:
    @pytest.mark.parametrize("restitution", [0.3, 0.5, 0.9])
    def test_times_of_impact(self, restitution):
        fall = np.sqrt(2 / G)
        hops = 2 * fall * restitution ** np.arange(1, 6)
        run = simulate(ball(restitution), float(fall + hops[:5].sum() - 1e-6))
        assert run.outcome is Outcome.FINISHED
        times = [event.t for event in run.events]
        expected = fall + np.concatenate([[0.0], np.cumsum(hops)])[: len(times)]
        assert len(times) == 5
        assert times == pytest.approx(expected, rel=1e-9)
        assert {(event.from_mode, event.to_mode) for event in run.events} == {("free", "free")}

    @pytest.mark.parametrize("restitution", [0.5, 0.9])
    def test_bounces_that_pile_up_have_their_own_outcome(self, restitution):
        run = simulate(ball(restitution), 20.0)
        end = np.sqrt(2 / G) * (1 + restitution) / (1 - restitution)
        assert run.outcome is Outcome.ZENO
        assert run.t_end == pytest.approx(end, rel=1e-4)
        assert run.t_end < end
        assert "rest=" in run.outcome.advice
        assert np.isfinite(run.x).all()

    def test_below_the_rest_speed_it_stays(self):
        run = simulate(ball(0.5, rest=0.01), 3.0)
        assert run.outcome is Outcome.FINISHED
        assert run.events[-1].to_mode == "contact"
        assert run.final["m.p"] == pytest.approx(0, abs=1e-12)
        assert run.final["h.y"] == pytest.approx(0, abs=1e-12)
        assert run["floor.e"][-1] == pytest.approx(2 * G)
        assert run.energy.dissipated == pytest.approx(2 * G * 1.0, rel=1e-9)

    def test_an_elastic_ball_keeps_its_energy(self):
        run = simulate(ball(1.0), 20.0, rtol=1e-9)
        assert run.outcome is Outcome.FINISHED
        assert len(run.events) == int((20.0 / np.sqrt(2 / G) + 1) / 2)
        energy = run["m.p"] ** 2 / 4 + 2 * G * run["h.y"]
        assert np.ptp(energy) < 1e-7 * energy[0]

    def test_a_ball_at_rest_on_the_floor_stays_there(self):
        run = simulate(ball(0.5, height=0.0), 1.0)
        assert run.outcome is Outcome.FINISHED
        assert set(run.modes["floor"]) == {"contact"}
        assert run.final["m.p"] == 0

    def test_a_start_below_the_floor_is_refused(self):
        with pytest.raises(SimulationError, match=r"'floor'.*gap.*-0\.5"):
            simulate(ball(0.5, height=-0.5), 1.0)


class TestCollision:
    @pytest.mark.parametrize("restitution", [0, 0.4, 1])
    @pytest.mark.parametrize("masses", [(2, 3), (1, 10), (5, 1)])
    def test_two_bodies(self, masses, restitution):
        m1, m2 = masses
        run = simulate(pair(m1, m2, restitution), 2.0)
        common = m1 * 2.0 / (m1 + m2)
        after1 = common - restitution * m2 * 2.0 / (m1 + m2)
        after2 = common + restitution * m1 * 2.0 / (m1 + m2)
        assert run.events[0].t == pytest.approx(0.5, rel=1e-12)
        assert run.final["m1.p"] == pytest.approx(m1 * after1, rel=1e-12, abs=1e-12)
        assert run.final["m2.p"] == pytest.approx(m2 * after2, rel=1e-12)
        lost = (1 - restitution**2) * m1 * m2 / (m1 + m2) * 2.0**2 / 2
        assert run.energy.dissipated == pytest.approx(lost, rel=1e-9, abs=1e-12)
        assert run.energy.relative_residual == pytest.approx(0, abs=1e-12)

    def test_a_geared_body_counts_with_its_reflected_mass(self):
        n, m, j = 0.2, 3, 0.5
        v, w = One("v"), One("w")
        h = Integrator("h", -v.f, initial=0.1)
        graph = assemble(
            "rack",
            v >> (I("m", m, initial=m * 1.0), EndStop("stop", gap=h.y, restitution=0.5)),
            v >> TF("pinion", 1 / sympy.Rational(1, 5)) >> w >> I("J", sympy.Rational(1, 2)),
            h,
        )
        run = simulate(graph, 0.15)
        assert run.events[0].t == pytest.approx(0.1)
        assert run["v.f"][-1] == pytest.approx(-0.5)
        assert run["w.f"][-1] == pytest.approx(-0.5 / n)
        lost = 0.75 * (m + j / n**2) / 2
        assert run.energy.dissipated == pytest.approx(lost, rel=1e-9)

    def test_elastic_bodies_of_one_mass_change_their_speeds(self):
        bodies = [One(f"v{i}") for i in range(3)]
        joints = [Zero(f"z{i}") for i in range(2)]
        gaps = [
            Integrator(f"g{i}", bodies[i + 1].f - bodies[i].f, initial=gap)
            for i, gap in enumerate((1, 0.5))
        ]
        graph = assemble(
            "cradle",
            [body >> I(f"m{i}", 1, initial=int(i == 0)) for i, body in enumerate(bodies)],
            [bodies[i] >> joints[i] >> bodies[i + 1] for i in range(2)],
            [joints[i] >> EndStop(f"s{i}", gap=gaps[i].y, restitution=1) for i in range(2)],
            gaps,
        )
        run = simulate(graph, 5.0)
        assert [(event.element, round(event.t, 9)) for event in run.events] == [
            ("s0", 1.0),
            ("s1", 1.5),
        ]
        assert [run.final[f"m{i}.p"] for i in range(3)] == pytest.approx([0, 0, 1], abs=1e-12)


class TestContact:
    def test_it_lets_go_when_pulled(self):
        """A mass pressed to its stop by a force that turns: it leaves where the force does."""
        v = One("v")
        h = Integrator("h", -v.f)
        push = sympy.cos(TIME)
        graph = assemble(
            "pressed",
            Se("F", push) >> v >> (I("m", 1), EndStop("stop", gap=h.y, restitution=0)),
            h,
        )
        run = simulate(graph, 2.0, rtol=1e-9, max_step=0.05)
        (event,) = run.events
        assert (event.from_mode, event.to_mode) == ("contact", "free")
        assert event.t == pytest.approx(np.pi / 2, rel=1e-9)
        assert run.final["m.p"] == pytest.approx(np.sin(2.0) - 1, rel=1e-7)

    def test_an_impact_loosens_stuck_friction(self):
        """What dry friction holds is bounded, so it takes no impulse."""
        left, right, between = One("left"), One("right"), Zero("between")
        gap = Integrator("gap", right.f - left.f, initial=1)
        graph = assemble(
            "shove",
            left >> I("m1", 1, initial=1),
            right >> (I("m2", 1), Friction("floor", kinetic=lambda speed: 0.5)),
            left >> between >> right,
            between >> EndStop("stop", gap=gap.y, restitution=1),
            gap,
        )
        run = simulate(graph, 4.0)
        slides = [event for event in run.events if event.element == "floor"]
        assert slides[0].t == pytest.approx(1.0) and slides[0].to_mode == "slip+"
        assert slides[1].t == pytest.approx(1.0 + 1 / 0.5) and slides[1].to_mode == "stick"
        assert run.energy.dissipated == pytest.approx(0.5, rel=1e-9)

    def test_stop_and_friction_together(self):
        v, spring = One("v"), C("spring", stiffness=100)
        graph = assemble(
            "rattle",
            Se("F", 30 * sympy.sin(7 * TIME)) >> v,
            v >> (I("m", 1), spring, R("b", 0.2)),
            v >> Friction("rub", kinetic=lambda speed: 1, breakaway=1.5),
            v >> EndStop("stop", gap=0.3 - spring.q, restitution=0.7),
        )
        run = simulate(graph, 10.0, rtol=1e-8, max_step=0.05)
        assert run.outcome is Outcome.FINISHED
        assert run["spring.q"].max() <= 0.3 + 1e-12
        assert sum(event.element == "stop" for event in run.events) > 10
        assert abs(run.energy.relative_residual) < 1e-6
