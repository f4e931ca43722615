"""Diodes and switches against closed forms and exact solutions between switching instants."""

import numpy as np
import pytest
import sympy
from scipy.linalg import expm
from scipy.optimize import brentq

from bondgraph import (
    TIME,
    C,
    CheckValve,
    Clutch,
    Diode,
    Friction,
    I,
    Integrator,
    One,
    Outcome,
    R,
    Samples,
    Se,
    Sf,
    Switch,
    Zero,
    assemble,
    simulate,
)
from bondgraph.errors import BondGraphError

W = 100.0
SINE = 10 * sympy.sin(100 * TIME)


class TestHalfWave:
    def test_with_a_coil_the_current_goes_on_past_the_voltage(self):
        r, coil = 10.0, 0.1
        loop = One("loop")
        graph = assemble(
            "rl",
            Se("E", SINE) >> loop >> (Diode("d"), I("L", 0.1), R("r", 10)),
            outputs={"i": loop.f},
        )
        run = simulate(graph, 0.06, rtol=1e-9, max_step=1e-3)
        phase, z = np.arctan2(W * coil, r), np.hypot(r, W * coil)

        def current(t):
            return 10 / z * (np.sin(W * t - phase) + np.sin(phase) * np.exp(-r * t / coil))

        off = brentq(current, 0.02, 0.06)
        first = run.events[0]
        assert (first.from_mode, first.to_mode) == ("conducting", "blocking")
        assert first.t == pytest.approx(off, rel=1e-8)
        on = run.t < off
        assert run["i"][on] == pytest.approx(current(run.t[on]), abs=1e-7)
        assert run["i"][run.modes["d"] == "blocking"] == pytest.approx(0, abs=1e-14)

    def test_an_ideal_diode_ties_the_capacitor_to_the_source(self):
        """No resistance: conducting, the capacitor has no state of its own."""
        c, r = 0.01, 10.0
        loop, out = One("loop"), Zero("out")
        graph = assemble(
            "rc", Se("E", SINE) >> loop >> Diode("d"), loop >> out >> (C("c", 0.01), R("r", 10))
        )
        run = simulate(graph, 0.2, rtol=1e-9, max_step=1e-3)
        off = (np.pi - np.arctan(W * r * c)) / W
        peak = 10 * np.sin(W * off)
        on = brentq(
            lambda t: 10 * np.sin(W * t) - peak * np.exp(-(t - off) / (r * c)), 0.063, 0.0785
        )
        assert [event.t for event in run.events[:2]] == pytest.approx([off, on], rel=1e-8)
        here = run.modes["d"] == "conducting"
        assert run["out.e"][here] == pytest.approx(10 * np.sin(W * run.t[here]), abs=1e-7)
        decay = (run.t > off) & (run.t < on)
        expected = peak * np.exp(-(run.t[decay] - off) / (r * c))
        assert run["out.e"][decay] == pytest.approx(expected, abs=1e-6)
        assert abs(run.energy.relative_residual) < 1e-7

    def test_drop_and_resistance(self):
        loop = One("loop")
        graph = assemble(
            "drop",
            Se("E", SINE) >> loop >> (Diode("d", drop=2, resistance=3), R("r", 5)),
            outputs={"i": loop.f},
        )
        run = simulate(graph, 0.05, t_eval=np.linspace(0, 0.05, 501))
        expected = np.maximum(10 * np.sin(W * run.t) - 2, 0) / 8
        assert run["i"] == pytest.approx(expected, abs=1e-12)


class TestBridge:
    def graph(self):
        p, a, b, src = Zero("p"), Zero("a"), Zero("b"), One("src")
        ways = [One(f"j{i}") for i in range(4)]
        diodes = [Diode(f"d{i}") for i in range(4)]
        return assemble(
            "bridge",
            Se("E", SINE) >> src >> R("rs", 0.5),
            src >> a,
            b >> src,
            [a >> ways[0] >> p, b >> ways[1] >> p, ways[2] >> a, ways[3] >> b],
            [way >> diode for way, diode in zip(ways, diodes, strict=True)],
            p >> (C("c", 0.01), R("load", 10)),
        )

    def test_it_rectifies_both_halves(self):
        """Outside: dv/dt = (max(|E| - v, 0)/rs - v/R)/C, integrated by scipy."""
        from scipy.integrate import solve_ivp

        def rate(t, v):
            return (max(abs(10 * np.sin(W * t)) - v[0], 0) / 0.5 - v[0] / 10) / 0.01

        grid = np.linspace(0, 0.15, 301)
        true = solve_ivp(rate, (0, 0.15), [0.0], t_eval=grid, rtol=1e-10, atol=1e-12, max_step=1e-4)
        run = simulate(self.graph(), 0.15, rtol=1e-9, max_step=1e-3, t_eval=grid)
        assert run.outcome is Outcome.FINISHED
        assert run["p.e"] == pytest.approx(true.y[0], abs=2e-6)
        assert abs(run.energy.relative_residual) < 1e-7


class TestSixPulseRectifier:
    """Three phases with inductance: the current goes over from diode to diode while both conduct.

    Source: Mohan, Undeland, Robbins, Power Electronics, ch. 5: the mean voltage is
    3 sqrt(3)/pi V less 3 w L/pi times the current.
    """

    def graph(self):
        p, n, load = Zero("p"), Zero("n"), One("load")
        parts = [p >> load >> n, load >> (I("L", 0.2), R("R", 10))]
        for k in range(3):
            phase, node = One(f"phase{k}"), Zero(f"node{k}")
            up, down = One(f"up{k}"), One(f"down{k}")
            source = 100 * sympy.sin(314 * TIME - 2 * sympy.pi * k / 3)
            parts += [
                Se(f"E{k}", source) >> phase >> I(f"L{k}", 0.001),
                phase >> node >> up >> p,
                n >> down >> node,
                up >> Diode(f"p{k}"),
                down >> Diode(f"m{k}"),
            ]
        return assemble("six", parts, outputs={"i": load.f})

    def test_the_mean_current(self):
        period = 2 * np.pi / 314
        end = 8 * period
        grid = np.linspace(end - period, end, 601)
        run = simulate(self.graph(), end, rtol=1e-7, max_step=5e-4, t_eval=grid)
        assert run.outcome is Outcome.FINISHED
        mean = np.trapezoid(run["i"], grid) / period
        expected = 3 * np.sqrt(3) * 100 / np.pi / (10 + 3 * 314 * 0.001 / np.pi)
        reached = 1 - np.exp(-end * 10 / 0.202)
        assert mean == pytest.approx(expected * reached, rel=2e-3)
        assert abs(run.energy.relative_residual) < 1e-6

    def test_two_diodes_conduct_while_the_current_goes_over(self):
        run = simulate(self.graph(), 0.03, max_step=5e-4)
        upper = sum((run.modes[f"p{k}"] == "conducting").astype(int) for k in range(3))
        settled = run.t > 0.01
        assert set(upper[settled]) == {1, 2}


class TestBuckConverter:
    """Source, switch, freewheeling diode, coil, capacitor, load."""

    def graph(self, load):
        top, node, choke, out, wheel = One("top"), Zero("node"), One("choke"), Zero("out"), One("w")
        clock = sympy.sin(2 * sympy.pi * 1000 * TIME) + sympy.Rational(1, 5)
        return assemble(
            "buck",
            Se("E", 12) >> top >> Switch("s", closed=clock),
            top >> node,
            wheel >> node,
            wheel >> Diode("d"),
            node >> choke >> I("L", 0.001),
            choke >> out >> (C("c", 0.0001), R("load", load)),
        )

    @pytest.mark.parametrize("load", [2, 50])  # the coil's current lasts, or runs out
    def test_against_matrix_exponentials(self, load):
        t_end = 0.01
        run = simulate(self.graph(load), t_end, rtol=1e-10)
        assert run.outcome is Outcome.FINISHED
        x = np.zeros(2)
        times = np.arange(0, t_end + 1e-3, 1e-3)
        first = np.arcsin(0.2) / (2 * np.pi * 1000)  # closed from -first to half a period + first
        t, closed = 0.0, True
        for edge in sorted([*(times + 5e-4 + first), *(times[1:] - first)]):
            x = self.advance(x, min(edge, t_end) - t, 12.0 if closed else 0.0, load)
            t, closed = edge, not closed
            if t >= t_end:
                break
        assert run.final["L.p"] / 1e-3 == pytest.approx(x[0], abs=1e-7)
        assert run.final["c.q"] / 1e-4 == pytest.approx(x[1], abs=1e-7)
        assert abs(run.energy.relative_residual) < 1e-8

    def advance(self, x, h, source, load):
        """Exact solution of di/dt = (E - v)/L, dv/dt = (i - v/R)/C; i stays at 0 where it falls there."""
        a = np.array([[0.0, -1e3, 1e3 * source], [1e4, -1e4 / load, 0.0], [0.0, 0.0, 0.0]])

        def at(part):
            return (expm(a * part) @ [*x, 1.0])[:2]

        if x[0] <= 1e-13 and source == 0:
            return np.array([0.0, x[1] * np.exp(-1e4 / load * h)])
        grid = np.linspace(0, h, 400)[1:]
        below = [part for part in grid if at(part)[0] < 0]
        if source or not below:
            return at(h)
        zero = brentq(lambda part: at(part)[0], below[0] - grid[0], below[0])
        return np.array([0.0, at(zero)[1] * np.exp(-1e4 / load * (h - zero))])

    def test_the_diode_takes_over_at_the_very_instant(self):
        run = simulate(self.graph(2), 0.002)
        opens = [e.t for e in run.events if e.element == "s" and e.to_mode == "open"]
        conducts = [e.t for e in run.events if e.element == "d" and e.to_mode == "conducting"]
        assert set(opens) <= set(conducts)


class TestSwitch:
    def test_closing_between_capacitors_shares_the_charge(self):
        way, a, b = One("way"), Zero("a"), Zero("b")
        graph = assemble(
            "share",
            a >> C("c1", 1, initial=2),
            b >> C("c2", 3),
            a >> way >> b,
            way >> Switch("s", closed=TIME - 1),
        )
        run = simulate(graph, 2.0)
        assert run.final == pytest.approx({"c1.q": 0.5, "c2.q": 1.5})
        assert run.energy.dissipated == pytest.approx(0.5 * 3 / 4 * 2**2, rel=1e-12)

    def test_opening_a_coil_without_another_way_loses_its_energy_in_the_switch(self):
        loop = One("loop")
        graph = assemble(
            "arc",
            Se("E", 6) >> loop >> (I("L", 2, initial=4), R("r", 3), Switch("s", closed=1 - TIME)),
        )
        run = simulate(graph, 2.0)
        assert run.final["L.p"] == 0
        assert run.energy.dissipated == pytest.approx(run.energy.supplied + 4.0, rel=1e-9)

    def test_an_input_may_command_it(self):
        u = sympy.Symbol("u")
        loop = One("loop")
        graph = assemble(
            "relay",
            Se("E", 1) >> loop >> (R("r", 1), C("c", 1), Switch("s", closed=u - 0.5)),
            inputs=[u],
        )
        run = simulate(
            graph, 3.0, inputs={"u": Samples([0, 1, 2], [0, 1, 0], hold="zero")}, rtol=1e-9
        )
        assert [(e.t, e.to_mode) for e in run.events] == [(1.0, "closed"), (2.0, "open")]
        assert run.final["c.q"] == pytest.approx(1 - np.exp(-1), rel=1e-8)

    def test_a_source_short_circuited_is_named(self):
        loop, node = One("loop"), Zero("node")
        graph = assemble(
            "short",
            Se("E", 1) >> node >> R("r", 1),
            node >> loop >> Switch("s", closed=TIME - 1),
        )
        run = simulate(graph, 2.0)
        assert run.outcome is Outcome.NO_MODE
        assert run.t_end == pytest.approx(1.0)

    def test_no_set_of_modes_at_all(self):
        loop = One("loop")
        graph = assemble(
            "never", Sf("i", 1) >> loop >> (R("r", 1), Switch("s", closed=sympy.Integer(-1)))
        )
        run = simulate(graph, 1.0)
        assert run.outcome is Outcome.NO_MODE

    def test_the_compiled_path_is_refused_by_name(self):
        loop = One("loop")
        graph = assemble("rd", Se("E", SINE) >> loop >> (R("r", 1), Diode("d")))
        with pytest.raises(BondGraphError, match="virtual machine"):
            simulate(graph, 1.0, backend="native")


class TestClutch:
    def test_it_locks_where_the_speeds_meet(self):
        one, two, plates = One("one"), One("two"), Zero("plates")
        torque = sympy.Piecewise((0, TIME < 1), (2 * (TIME - 1), True))
        graph = assemble(
            "clutch",
            one >> I("J1", 1, initial=10),
            two >> I("J2", 2),
            one >> plates >> two,
            plates >> Clutch("c", torque),
        )
        run = simulate(graph, 10.0, rtol=1e-9)
        (event,) = run.events
        assert event.to_mode == "stick"
        assert event.t == pytest.approx(1 + np.sqrt(20 / 3), rel=1e-7)
        assert run.final == pytest.approx({"J1.p": 10 / 3, "J2.p": 20 / 3})
        assert run.energy.dissipated == pytest.approx(0.5 * 2 / 3 * 100, rel=1e-8)


class TestSliderAndSpring:
    def test_the_loop_of_a_spring_that_yields(self):
        """Series of spring k and slider F, moved by X sin t: area 4 F (X - F/k) a cycle."""
        force, k, x = 1.0, 4.0, 2.0
        joint = Zero("joint")
        graph = assemble(
            "jenkins",
            Sf("v", 2 * sympy.cos(TIME)) >> joint,
            joint >> (C("k", stiffness=4), Friction("s", kinetic=lambda speed: 1)),
        )
        start = simulate(graph, 2 * np.pi, rtol=1e-9, max_step=0.1)
        run = simulate(
            graph,
            (2 * np.pi, 4 * np.pi),
            rtol=1e-9,
            max_step=0.1,
            initial={"k.q": start.final["k.q"]},
        )
        assert np.abs(run["joint.e"]).max() == pytest.approx(force, abs=1e-9)
        assert run.energy.dissipated == pytest.approx(4 * force * (x - force / k), rel=1e-6)


class TestPump:
    def test_check_valves_let_the_piston_lift_the_tank(self):
        """Each stroke moves its volume, less what the chamber's compliance holds back."""
        chamber, suck, push, tank = Zero("chamber"), One("suck"), One("push"), Zero("tank")
        moved = Integrator("moved", push.f)
        graph = assemble(
            "pump",
            Sf("piston", sympy.sin(20 * TIME)) >> chamber >> C("fluid", 0.001),
            suck >> (CheckValve("inlet"), R("ri", 0.1)),
            suck >> chamber >> push >> (CheckValve("outlet"), R("ro", 0.1)),
            push >> tank >> C("air", 1),
            moved,
        )
        strokes = 3
        run = simulate(graph, 2 * np.pi / 20 * strokes, rtol=1e-8, max_step=0.01)
        assert run.outcome is Outcome.FINISHED
        assert run.final["moved.y"] == pytest.approx(strokes * 2 / 20, rel=0.03)
        assert (np.diff(run["moved.y"]) > -1e-9).all()
