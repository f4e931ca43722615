"""Attractors against the brake on plain scipy, closed forms, averaging and tables."""

import json
import math
import random

import numpy
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import (
    TIME,
    BondGraphError,
    C,
    CompiledModel,
    EndStop,
    Friction,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    find_attractors,
    linearize,
    steady_state,
)
from bondgraph.models import bicycle_brake, frame_brake, mass_on_belt, quarter_car

from ..cycles.graphs import SLIP, STICK, VAN_DER_POL_PERIOD, belt, belt_swing, van_der_pol
from . import brakes


@pytest.fixture(scope="module")
def brake():
    return CompiledModel(bicycle_brake.graph())


@pytest.fixture(scope="module")
def squeal(brake):
    return find_attractors(brake, {"mu_s": 0.5, "tau": 0.02})


def frequencies(found):
    return sorted(item.frequency_hz for item in found.cycles)


def oscillator(law, name="oscillator", momentum=0.0):
    parts = (I("L", 1, initial=momentum), C("c", 1), R("r", effort=law))
    return assemble(name, One("loop") >> parts)


def subcritical(f):
    return f * (0.1 - f**2 + 0.3 * f**4)


def two_on_a_belt():
    v1, v2, ring, road = One("v1"), One("v2"), Zero("ring"), One("road")
    belts = [Zero("d1"), Zero("d2")]
    rub = [
        Friction("f1", kinetic=lambda slip: 8, breakaway=12),
        Friction("f2", kinetic=lambda slip: 7 + 4 * sympy.exp(-10 * slip)),
    ]
    return assemble(
        "two",
        Sf("drive", 0.5) >> road,
        road >> belts[0] >> v1 >> (I("m1", 1), C("k1", stiffness=100)),
        road >> belts[1] >> v2 >> (I("m2", 1.2), C("k2", stiffness=130)),
        v1 >> ring >> v2,
        ring >> C("k3", stiffness=50),
        *(belt >> contact for belt, contact in zip(belts, rub, strict=True)),
    )


class TestBrake:
    def test_a_cycle_beside_stable_sliding(self, squeal):
        assert squeal.beside and squeal.coexist and squeal.point.stable
        own = squeal.own
        assert own.kind == "cycle" and own.stable
        assert own.frequency_hz == pytest.approx(143.318344, abs=1e-6)
        assert own.held["friction"] == pytest.approx(0.65, abs=0.005)
        assert own.events_per_period == 2 and own.sticks == ("friction",)
        swing = own.amplitudes["x_c"]
        assert (swing.least, swing.most) == pytest.approx((1.63360e-3, 3.66899e-3), abs=5e-9)
        assert own.units["x_c"] == "m"
        (steady,) = squeal.steady
        assert steady.amplitudes["slip"].mean == pytest.approx(0.9, rel=1e-9)
        assert any(name.endswith("slightly") for name in steady.starts)

    def test_the_other_cycle_is_that_of_scipy(self, squeal):
        p = brakes.brake()
        other = brakes.frequency(p, brakes.seized(p))
        assert other == pytest.approx(108.632305, abs=1e-5)
        assert brakes.frequency(p, brakes.stopped(p)) == pytest.approx(other, abs=1e-5)
        assert frequencies(squeal) == pytest.approx([other, 143.318344], abs=1e-5)
        ends = squeal.ends
        assert ends["held"] == ends["at rest"] != ends["own"]

    def test_where_sliding_is_unstable(self, brake):
        found = find_attractors(brake, {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2})
        assert not found.point.stable and not found.beside and not found.steady
        assert found.own.frequency_hz == pytest.approx(142.614178, abs=1e-6)
        assert found.edge is None and "not stable" in found.words

    @pytest.mark.parametrize("tau", [0.02, 0.03])
    def test_where_the_own_start_slides_on(self, brake, tau):
        found = find_attractors(brake, {"mu_s": 0.42, "tau": tau})
        assert found.own.kind == "steady" and found.beside
        p = brakes.brake(mu_s=0.42, tau=tau)
        assert brakes.frequency(p, brakes.own(p)) is None
        assert frequencies(found) == pytest.approx(
            [brakes.frequency(p, brakes.stopped(p))], abs=1e-5
        )

    @pytest.mark.parametrize("seed", range(4))
    def test_other_brakes_against_scipy(self, brake, seed):
        draw = random.Random(seed)
        given = {
            "mu_s": draw.uniform(0.43, 0.6),
            "v_s": draw.uniform(0.03, 0.1),
            "V0": draw.uniform(0.5, 1.3),
            "F_k": draw.uniform(500.0, 1200.0),
            "tau": draw.uniform(0.01, 0.05),
        }
        found = find_attractors(brake, given, edge=False)
        p = brakes.brake(**given)
        starts = {"own": brakes.own, "held": brakes.seized, "at rest": brakes.stopped}
        for name, start in starts.items():
            expected = brakes.frequency(p, start(p), 1.0)
            item = found.found[found.ends[name]]
            if expected is None:
                assert item.kind == "steady", (name, given)
            else:
                assert item.frequency_hz == pytest.approx(expected, rel=1e-5), (name, given)

    def test_the_verdict_is_that_of_linearize(self, brake, squeal):
        poles = linearize(brake.equations.graph, {"mu_s": 0.5, "tau": 0.02}).poles()
        own = numpy.array(squeal.point.eigenvalues)
        assert numpy.sort_complex(own) == pytest.approx(numpy.sort_complex(poles), rel=1e-9)

    def test_words(self, squeal):
        assert squeal.words.startswith("Steady sliding is stable for small motions, yet")
        assert "stick-slip cycles of 143.3 and 108.6 Hz live beside it" in squeal.words
        assert "The model's own start ends in that of 143.3 Hz." in squeal.words

    def test_json_is_plain(self, squeal):
        told = json.loads(json.dumps(squeal.to_json(), allow_nan=False))
        assert told["beside"] is True and len(told["attractors"]) == len(squeal.found)
        assert told["attractors"][0]["frequency_hz"] == pytest.approx(143.318344, abs=1e-6)
        assert told["attractors"][0]["amplitudes"]["x_c"]["unit"] == "m"
        assert told["ends"]["own"] == 0


class TestBasinEdge:
    def test_pushes_on_both_sides_of_it(self, brake, squeal):
        edge = squeal.edge
        assert 0 < edge.returns < edge.leaves < 1.03 * edge.returns
        p = brakes.brake()
        change = {name: edge.outputs[name] for name in ("omega_r", "theta_w", "V_c", "x_c")}
        for share, leaves in ((0.97, False), (1.0, True)):
            state = brakes.sliding(p)
            step = [change["omega_r"] * 0.08, -change["theta_w"] * 0.0]
            state[0] += share * step[0]
            state[1] += share * change["theta_w"] * 0.08
            state[2] += share * change["V_c"]
            state[3] += share * change["x_c"]
            assert (brakes.frequency(p, state) is not None) is leaves

    def test_its_energy_is_that_of_the_parts(self, squeal):
        p, change = brakes.brake(), squeal.edge.outputs
        energy = (
            p["m_w"] * (0.08 * change["omega_r"]) ** 2
            + p["k_w"] * (0.08 * change["theta_w"]) ** 2
            + p["m_f"] * change["V_c"] ** 2
            + p["k_f"] * change["x_c"] ** 2
        ) / 2
        assert squeal.edge.energy == pytest.approx(energy, rel=1e-6)

    def test_of_a_subcritical_oscillator(self):
        found = find_attractors(oscillator(subcritical))
        assert found.own.kind == "steady" and found.beside
        # the repelling cycle between, by scipy with time running backwards
        edge = found.edge

        def flow(t, y, sign=-1.0):
            q, p = y
            return [sign * p, sign * (-q - subcritical(p))]

        def upwards(t, y):
            return y[0]

        upwards.direction = -1
        run = solve_ivp(flow, (0, 300), [0.0, 0.4], events=upwards, rtol=1e-10, atol=1e-12)
        assert abs(run.y_events[0][-1][1]) == pytest.approx(0.3716, abs=0.003)  # as averaging says
        q, p = edge.outputs["c.q"], edge.outputs["L.p"]
        for share, dies in ((edge.returns / edge.leaves, True), (1.0, False)):
            late = solve_ivp(
                lambda t, y: flow(t, y, 1.0), (0, 300), [share * q, share * p], rtol=1e-9
            ).y[:, -1]
            assert bool(numpy.hypot(*late) < 0.1) is dies

    def test_along_a_given_direction(self, brake):
        # a blow on the caliper, against the pads' way: how fast it must become
        blow = {"rear.mass.p": 1.0}
        found = find_attractors(brake, {"mu_s": 0.5, "tau": 0.02}, edge=blow)
        edge, p = found.edge, brakes.brake()
        assert edge.outputs["V_c"] == pytest.approx(edge.leaves / p["m_f"])
        assert edge.outputs["omega_r"] == edge.outputs["x_c"] == 0.0
        for size, leaves in ((edge.returns, False), (edge.leaves, True)):
            state = brakes.sliding(p)
            state[2] += size / p["m_f"]
            assert (brakes.frequency(p, state) is not None) is leaves
        with pytest.raises(BondGraphError, match=r"rear\.mass\.x"):
            find_attractors(brake, {"mu_s": 0.42}, edge={"rear.mass.x": 1.0})
        with pytest.raises(BondGraphError, match="goes nowhere"):
            find_attractors(brake, {"mu_s": 0.42}, edge={"rear.mass.p": 0.0})

    def test_none_where_nothing_else_lives(self):
        assert find_attractors(quarter_car.graph()).edge is None


class TestClosedForms:
    def test_mass_on_belt(self):
        found = find_attractors(belt())
        (cycle,) = found.cycles
        assert cycle.period == pytest.approx(SLIP + STICK, rel=1e-9)
        assert cycle.held["contact"] == pytest.approx(STICK / (SLIP + STICK), rel=1e-6)
        least, most = belt_swing()
        swing = cycle.amplitudes["k.q"]
        assert (swing.least, swing.most) == pytest.approx((least, most), rel=1e-6)
        # sliding circles of any size lie inside: they neither attract nor repel
        assert found.point.stable is False and not found.beside

    def test_van_der_pol(self):
        found = find_attractors(van_der_pol())
        (cycle,) = found.found
        assert cycle.period == pytest.approx(VAN_DER_POL_PERIOD, rel=1e-9)
        assert cycle.amplitudes["L.p"].most == pytest.approx(2.0086, abs=5e-5)
        assert cycle.stable and cycle.events_per_period == 0
        assert any("pushed" in note for note in found.notes)  # the own start is the steady state

    def test_weakly_nonlinear_cycle_is_averagings(self):
        mu = 0.01
        found = find_attractors(oscillator(lambda f: mu * (f**3 / 3 - f)))
        (cycle,) = found.cycles
        assert cycle.amplitudes["L.p"].most == pytest.approx(2.0, rel=1e-4)
        assert cycle.frequency_hz == pytest.approx((1 - mu**2 / 16) / (2 * math.pi), rel=1e-8)

    def test_subcritical_amplitude_by_scipy(self):
        found = find_attractors(oscillator(subcritical), edge=False)
        (cycle,) = found.cycles
        run = solve_ivp(
            lambda t, y: [y[1], -y[0] - subcritical(y[1])],
            (0, 200),
            [0.0, 2.0],
            method="DOP853",
            rtol=1e-11,
            atol=1e-12,
            max_step=0.01,
        )
        late = run.y[1, run.t > 180]
        assert cycle.amplitudes["L.p"].most == pytest.approx(late.max(), rel=1e-4)
        # averaging: a - 3/4 b A^2 + 5/8 c A^4 = 0
        squares = numpy.roots([5 / 8 * 0.3, -3 / 4, 0.1])
        assert cycle.amplitudes["L.p"].most == pytest.approx(math.sqrt(squares.max()), rel=5e-3)

    def test_damped_oscillator_has_only_rest(self):
        found = find_attractors(oscillator(lambda f: f / 10, momentum=1.0))
        (item,) = found.found
        assert item.kind == "steady" and item.stable and not found.coexist
        assert set(item.starts) == set(found.ends)

    def test_lightly_damped_is_no_cycle(self):
        found = find_attractors(oscillator(lambda f: f / 1000, momentum=1.0))
        assert [item.kind for item in found.found] == ["steady"]

    def test_growth_without_end(self):
        found = find_attractors(oscillator(lambda f: -f / 10, momentum=1.0))
        assert found.own.kind == "unbounded" and "without bound" in found.words

    def test_undamped_oscillator_is_a_family(self):
        found = find_attractors(oscillator(lambda f: 0 * f, momentum=1.0))
        assert found.own.kind == "cycle" and not found.own.isolated and found.own.stable is None
        assert not found.cycles and not found.coexist and "any size" in found.words

    def test_double_well(self):
        law = {"effort": lambda q: q**3 - q}
        parts = (I("m", 1, initial=1), C("well", **law), R("b", 0.1))
        found = find_attractors(assemble("wells", One("v") >> parts))
        places = sorted(item.states["well.q"] for item in found.steady)
        assert places == pytest.approx([-1.0, 1.0], abs=1e-9)
        assert found.coexist and not found.beside and not found.point.stable


class TestOtherModels:
    def test_stop_and_negative_damping(self):
        spring = C("spring", stiffness=100)
        v = One("v")
        parts = (I("m", 1, initial=0.1), spring, R("b", effort=lambda f: -f))
        stop = EndStop("stop", gap=0.3 - spring.q, restitution=0.5)
        found = find_attractors(assemble("rattle", v >> parts, v >> stop), edge=False)
        (cycle,) = found.cycles
        # between impacts a growing sine; the impact halves and turns the speed
        decay, rate = -0.5, math.sqrt(100 - 0.25)

        def at(t, v0):
            x, u = 0.3, -0.5 * v0
            a, b = x, (u + decay * x) / rate
            wave = a * math.cos(rate * t) + b * math.sin(rate * t)
            slope = rate * (b * math.cos(rate * t) - a * math.sin(rate * t)) - decay * wave
            grow = math.exp(-decay * t)
            return grow * wave - 0.3, grow * slope

        from scipy.optimize import fsolve

        period, speed = fsolve(
            lambda z: [at(z[0], z[1])[0], at(z[0], z[1])[1] - z[1]],
            [cycle.period, cycle.amplitudes["m.p"].most],
            xtol=1e-13,
        )
        assert cycle.period == pytest.approx(period, rel=1e-8)
        between = numpy.array([at(t, speed) for t in numpy.linspace(0, period, 20_001)])
        assert cycle.amplitudes["spring.q"].least == pytest.approx(
            between[:, 0].min() + 0.3, rel=1e-6
        )
        assert cycle.amplitudes["m.p"].most == pytest.approx(between[:, 1].max(), rel=1e-6)
        assert cycle.events_per_period == 1

    def test_frame_brake(self):
        found = find_attractors(frame_brake.graph())
        assert found.own.kind == "steady" and found.beside

    def test_belt_of_the_library(self):
        found = find_attractors(mass_on_belt.graph())
        assert [item.kind for item in found.found] == ["cycle"]

    def test_at_rest_on_its_springs(self):
        found = find_attractors(quarter_car.graph())
        assert [item.kind for item in found.found] == ["steady"] and found.own.stable

    def test_no_states(self):
        found = find_attractors(assemble("wire", Se("E", 1) >> One("loop") >> R("r", 2)))
        assert [item.kind for item in found.found] == ["steady"]

    def test_a_stop_in_a_model_without_states(self):
        v = One("v")
        stop = EndStop("stop", gap=1, restitution=0)
        graph = assemble("pressed", Se("F", 3) >> v >> (R("b", 1), stop))
        assert steady_state(graph, modes={"stop": "contact"}).states == {}
        assert [item.kind for item in find_attractors(graph).found] == ["steady"]

    def test_one_state(self):
        found = find_attractors(assemble("rc", Se("E", 1) >> One("l") >> (R("r", 2), C("c", 3))))
        (item,) = found.found
        assert item.states["c.q"] == pytest.approx(3.0)

    def test_drifting_position_is_left_aside(self):
        parts = (I("m", 1), C("place", stiffness=0), R("b", 0.1))
        found = find_attractors(assemble("cart", Se("F", 1) >> One("v") >> parts))
        (item,) = found.found
        assert item.kind == "steady" and item.states["m.p"] == pytest.approx(10.0)
        assert "place.q" in found.notes[0] and "place.q" not in item.amplitudes

    def test_a_rotor_turns_or_hangs(self):
        # a pendulum pushed by a constant torque: it hangs aslant, or goes round and round
        parts = (I("J", 1, initial=3), C("g", effort=sympy.sin), R("b", 0.2))
        found = find_attractors(assemble("rotor", Se("T", 0.5) >> One("l") >> parts))
        run = solve_ivp(
            lambda t, y: [y[1], 0.5 - numpy.sin(y[0]) - 0.2 * y[1]],
            (0, 300),
            [0.0, 3.0],
            rtol=1e-10,
            atol=1e-12,
            events=lambda t, y: numpy.sin(y[0] / 2),
        )
        (cycle,) = found.cycles
        assert found.beside and found.own is cycle and "g.q" in cycle.notes[0]
        assert cycle.period == pytest.approx(run.t_events[0][-1] - run.t_events[0][-2], rel=1e-5)
        late = run.y[1, run.t > 280]
        swing = cycle.amplitudes["J.p"]
        assert (swing.least, swing.most) == pytest.approx((late.min(), late.max()), abs=2e-3)

    def test_creeping_heat_is_no_rotation(self):
        # the belt's stick-slip while something slow still fills: not yet a cycle, and none with a drift
        slow = One("slow"), C("tank", 1)
        graph = assemble("both", Se("E", 1) >> slow[0] >> (slow[1], R("leak", 1000)), belt())
        found = find_attractors(graph)
        item = found.found[found.ends["own"]]
        assert item.kind == "cycle" and item.states["tank.q"] == pytest.approx(1.0, abs=0.02)

    def test_algebraic_variables_kept(self):
        # a cubic resistance in series with a linear one: the current stays implicit
        loop = One("loop")
        graph = assemble(
            "implicit",
            Se("E", 2) >> loop >> (C("c", 1), R("a", effort=lambda f: f + f**3), R("b", 1)),
        )
        (item,) = find_attractors(graph).found
        assert item.kind == "steady" and item.states["c.q"] == pytest.approx(2.0)

    def test_inputs_are_constant(self):
        push = sympy.Symbol("push")
        parts = (I("m", 1), C("k", stiffness=4), R("b", 0.5))
        graph = assemble("pushed", Se("F", push) >> One("v") >> parts, inputs={push: "N"})
        (item,) = find_attractors(graph, inputs={"push": 2.0}).found
        assert item.states["k.q"] == pytest.approx(0.5)
        with pytest.raises(BondGraphError, match="finite number"):
            find_attractors(graph, inputs={"push": lambda t: t})

    def test_forced_models_are_refused(self):
        source = Sf("shaker", sympy.sin(TIME))
        graph = assemble("forced", source >> One("v") >> (I("m", 1), C("k", 1)))
        with pytest.raises(BondGraphError, match="depends on time"):
            find_attractors(graph)

    def test_springs_in_a_ring(self):
        # their deflections add up to what they were at the start: one multiplier more is one
        found = find_attractors(two_on_a_belt())
        (cycle,) = found.cycles
        assert cycle.stable is None and cycle.isolated and cycle.sticks == ("f1", "f2")
        assert found.point is None and "no linear verdict" in found.notes[0]


class TestOptions:
    def test_given_starts_come_in_by_name(self, brake):
        start = {"omega_r": 0.0, "V_c": 0.0}
        found = find_attractors(
            brake, {"mu_s": 0.5, "tau": 0.02}, starts={"braked": start}, edge=False
        )
        assert "braked" in found.ends and found.starts["braked"]["rear.mass.p"] == 0.0

    def test_budget_ends_with_a_note(self, brake):
        found = find_attractors(brake, {"mu_s": 0.5, "tau": 0.02}, budget=1e-9)
        assert not found.found and "raise budget" in " ".join(found.notes)

    def test_horizon_too_short_is_said(self):
        found = find_attractors(van_der_pol(), horizon=0.5)
        assert {item.kind for item in found.found} == {"unsettled"}
        assert "not settled" in found.words and "horizon" in found.notes[-1]

    def test_without_multipliers(self, brake):
        found = find_attractors(brake, {"mu_s": 0.5, "tau": 0.02}, floquet=False, edge=False)
        assert found.own.multipliers is None and found.own.stable is None
        assert found.own.frequency_hz == pytest.approx(143.318344, abs=1e-4)

    def test_unknown_start(self, brake):
        with pytest.raises(BondGraphError, match="nonsense"):
            find_attractors(brake, starts={"odd": {"nonsense": 1.0}})
