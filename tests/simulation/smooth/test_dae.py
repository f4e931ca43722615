"""Smooth models by implicit solvers: closed forms, and equations written down by hand.

The hand-written ones are integrated by scipy's Radau, with brentq or Newton for the algebraic part.
"""

import itertools
import math
import threading

import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from bondgraph import (
    TF,
    TIME,
    C,
    I,
    One,
    Outcome,
    R,
    Samples,
    Se,
    Zero,
    assemble,
    derive,
    linearize,
    models,
    simulate,
)
from bondgraph.errors import BondGraphError, ParameterError, SimulationError
from bondgraph.simulation import CompiledModel

IMPLICIT = ("rosenbrock", "idas")
STIFF = ("rosenbrock", "idas", "cvodes")
U = sympy.Symbol("U", real=True)


def cubic(f):
    return f**3 + f


def cubic_inverse(e):
    return brentq(lambda f: cubic(f) - e, -10, 10, xtol=1e-15, rtol=1e-14)


def charging(effort=2, law=cubic):
    """A capacitor charged through a resistor whose law is an effort in terms of the flow."""
    parts = (R("r", effort=law), C("c", 0.5))
    return assemble(
        "charging", Se("E", effort) >> One("v") >> parts, inputs=[U] if effort == U else []
    )


def radau(rates, span, x0, times, rtol=1e-11, atol=1e-14, **options):
    found = solve_ivp(
        rates, span, x0, method="Radau", t_eval=times, rtol=rtol, atol=atol, **options
    )
    assert found.success
    return found.y


@pytest.mark.parametrize("solver", IMPLICIT)
def test_discharge_through_a_cubic_resistor_in_closed_form(solver):
    """q/c = f + f^3 and dq/dt = -f give c (ln(f0/f) + 3/2 (f0^2 - f^2)) = t."""
    graph = assemble("g", Zero("u") >> (C("c", 0.5, initial=1), R("r", effort=cubic)))
    run = simulate(graph, 3.0, rtol=1e-9, solver=solver, t_eval=np.linspace(0, 3, 31))
    flow = run["r.f"]
    spent = 0.5 * (np.log(flow[0] / flow) + 1.5 * (flow[0] ** 2 - flow**2))
    assert run.outcome is Outcome.FINISHED and run.solver == solver
    assert np.abs(spent - run.t).max() < 1e-8
    assert np.abs(run["c.q"] / 0.5 - cubic(flow)).max() < 1e-12
    assert flow[0] == pytest.approx(1, abs=1e-14)


@pytest.mark.parametrize("solver", ["auto", *IMPLICIT])
def test_charging_against_scipy(solver):
    run = simulate(charging(), 2.0, rtol=1e-8, solver=solver)
    (charge,) = radau(lambda t, q: [cubic_inverse(2 - q[0] / 0.5)], (0, 2), [0], run.t)
    assert np.abs(run["c.q"] - charge).max() < 1e-8
    flows = [cubic_inverse(2 - q / 0.5) for q in charge]
    assert np.abs(run["r.f"] - flows).max() < 1e-7
    assert np.abs(run["E.e"] - run["r.e"] - run["c.e"]).max() < 1e-12


@pytest.mark.parametrize("solver", IMPLICIT)
def test_energy_is_audited(solver):
    run = simulate(charging(), 2.0, rtol=1e-8, solver=solver)
    charge = run["c.q"][-1]
    assert run.energy.supplied == pytest.approx(2 * charge, rel=1e-7)
    assert run.energy.stored == pytest.approx(charge**2, rel=1e-12)
    assert abs(run.energy.relative_residual) < 1e-6


@pytest.mark.parametrize("solver", IMPLICIT)
def test_two_resistors_in_one_loop(solver):
    """Two cubic resistors and a mass between them: two algebraic variables, one inside the other."""
    a, n, m = One("a"), Zero("n"), One("m")
    graph = assemble(
        "ladder",
        Se("E", 3) >> a >> (R("r1", effort=cubic), n),
        n >> (R("r2", effort=lambda f: f + 2 * f**3), m),
        m >> (R("r3", 0.5), C("c", 0.2)),
    )
    assert derive(graph).algebraic
    run = simulate(graph, 1.0, rtol=1e-8, solver=solver)

    def node(q):
        def balance(e):
            second = brentq(lambda f: f + 2 * f**3 - e, -9, 9, xtol=1e-15, rtol=1e-14)
            return cubic_inverse(3 - e) - second - (e - q / 0.2) / 0.5

        return brentq(balance, -9, 9, xtol=1e-14, rtol=1e-14)

    (charge,) = radau(lambda t, q: [(node(q[0]) - q[0] / 0.2) / 0.5], (0, 1), [0], run.t)
    assert np.abs(run["c.q"] - charge).max() < 1e-7
    assert run["n.e"][-1] == pytest.approx(node(charge[-1]), abs=1e-7)


def diode(e):
    return 1e-9 * (sympy.exp(40 * e) - 1) + e / sympy.Integer(10**6)


def diode_number(e):
    return 1e-9 * (np.exp(40 * e) - 1) + e / 1e6


def test_diode_clipper():
    """3 V at 50 Hz on 100 ohm and two antiparallel diodes, behind them 1 kohm and 1 uF."""
    n, o = Zero("n"), One("o")
    graph = assemble(
        "clipper",
        Se("E", 3 * sympy.sin(100 * sympy.pi * TIME)) >> One("a") >> (R("rs", 100), n),
        n >> (R("d", flow=lambda e: diode(e) - diode(-e)), o),
        o >> (R("r2", 1000), C("c", 1e-6)),
    )

    def node(t, v):
        def balance(e):
            shunt = diode_number(e) - diode_number(-e) + (e - v) / 1000
            return (3 * math.sin(100 * math.pi * t) - e) / 100 - shunt

        return brentq(balance, -4, 4, xtol=1e-14, rtol=1e-14)

    times = np.linspace(0, 0.03, 301)
    (volts,) = radau(
        lambda t, v: [(node(t, v[0]) - v[0]) / 1e-3],
        (0, 0.03),
        [0],
        times,
        rtol=1e-10,
        max_step=1e-4,
    )
    nodes = [node(t, v) for t, v in zip(times, volts, strict=True)]
    assert max(nodes) < 0.5
    for solver in IMPLICIT:
        run = simulate(graph, 0.03, rtol=1e-8, solver=solver, t_eval=times)
        assert np.abs(run["c.e"] - volts).max() < 1e-7
        assert np.abs(run["n.e"] - nodes).max() < 1e-7


def test_diode_bridge():
    """A floating source of 10 ohm on four diodes; a load of 1 kohm and 10 uF."""
    na, nb, nc, source, load = Zero("na"), Zero("nb"), Zero("nc"), One("source"), One("load")
    graph = assemble(
        "bridge",
        Se("E", 3 * sympy.sin(100 * sympy.pi * TIME)) >> source >> (R("rs", 10), na),
        nb >> source,
        na >> One("ac") >> (R("d1", flow=diode), nc),
        nb >> One("bc") >> (R("d2", flow=diode), nc),
        na >> TF("ta", -1) >> R("d3", flow=diode),
        nb >> TF("tb", -1) >> R("d4", flow=diode),
        nc >> load >> (R("rl", 1000), C("c", 1e-5)),
    )
    assert len(derive(graph).algebraic) > 1
    np.zeros(3)

    def nodes(t, v):
        """Newton on the three nodes' currents, in steps of at most 50 mV."""
        across = np.array([[1, 0, -1], [0, 1, -1], [-1, 0, 0], [0, -1, 0]])
        resistors = np.array([[0.1, -0.1, 0], [-0.1, 0.1, 0], [0, 0, 1e-3]])
        fed = np.array([0.3, -0.3, 0]) * math.sin(100 * math.pi * t) + [0, 0, v / 1000]
        e = np.zeros(3)
        for _ in range(500):
            drops = across @ e
            slopes = 4e-8 * np.exp(40 * drops) + 1e-6
            left = fed - resistors @ e - across.T @ diode_number(drops)
            step = np.linalg.solve(resistors + across.T @ (slopes[:, None] * across), left)
            e += step / max(1, np.abs(step).max() / 0.05)
            if np.abs(step).max() < 1e-13:
                return e
        raise AssertionError("the nodes were not found")

    times = np.linspace(0, 0.015, 51)
    (volts,) = radau(
        lambda t, v: [(nodes(t, v[0])[2] - v[0]) / 1e-2],
        (0, 0.015),
        [0],
        times,
        rtol=1e-8,
        atol=1e-9,
        max_step=2e-4,
    )
    for solver in IMPLICIT:
        run = simulate(graph, 0.015, rtol=1e-9, solver=solver, t_eval=times)
        assert run.outcome is Outcome.FINISHED
        assert np.abs(run["c.e"] - volts).max() < 1e-7


def stribeck(f):
    """Effort that falls between 0.2 and 2, and rises elsewhere."""
    return sympy.tanh(10 * f) * (1 + 2 * sympy.exp(-(f**2))) + f / 5


def stribeck_number(f):
    return math.tanh(10 * f) * (1 + 2 * math.exp(-(f**2))) + f / 5


def stribeck_slope(f):
    peak = math.exp(-(f**2))
    steep = 10 / math.cosh(10 * f) ** 2
    return steep * (1 + 2 * peak) - math.tanh(10 * f) * 4 * f * peak + 0.2


class TestFold:
    """Se >> 1 >> (C, R) with a law that falls and rises: e(f) = E - q, dq/dt = f."""

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_the_run_stops_where_its_branch_ends(self, solver):
        """On the fast branch dt = -e'(f)/f df, from the root of e(f) = 4 to where e' is zero."""
        graph = charging(4, stribeck)
        run = simulate(graph, 10, {}, {"c.q": 0}, rtol=1e-8, solver=solver)
        first = brentq(lambda f: stribeck_number(f) - 4, 3, 30, xtol=1e-14)
        fold = brentq(stribeck_slope, 1, 3, xtol=1e-14)
        wanted = quad(lambda f: -0.5 * stribeck_slope(f) / f, first, fold, epsabs=1e-13)[0]
        assert run.outcome is Outcome.SINGULAR and "fold" in run.outcome.advice
        assert run.t_end == pytest.approx(wanted, rel=1e-6)
        assert run["r.f"][0] == pytest.approx(first, abs=1e-10)
        assert np.isfinite(run.x).all() and np.isfinite(run.z).all()
        assert (run["r.f"] > fold).all()
        assert 4 - run.final["c.q"] / 0.5 == pytest.approx(stribeck_number(fold), abs=1e-6)

    @pytest.mark.parametrize("solver", IMPLICIT)
    @pytest.mark.parametrize(("guess", "inside"), [({}, (0, 0.2)), ({"r.f": 5}, (2, 9))])
    def test_the_guess_chooses_the_branch(self, solver, guess, inside):
        run = simulate(charging(2.5, stribeck), 0.05, initial=guess, solver=solver)
        assert run.outcome.ok
        assert (run["r.f"] > inside[0]).all() and (run["r.f"] < inside[1]).all()
        left = [stribeck_number(f) for f in run["r.f"]] - (2.5 - run["c.q"] / 0.5)
        assert np.abs(left).max() < 1e-12

    def test_a_guess_by_the_name_of_what_is_solved_for(self):
        graph = charging(2.5, stribeck)
        (variable,) = derive(graph).algebraic
        for key in (variable, variable.name, "v.f", "c.f"):
            assert simulate(graph, 0.01, initial={key: 5})["r.f"][0] > 2

    def test_a_law_without_slope_at_the_start_is_named(self):
        run = simulate(charging(sympy.sin(TIME), lambda f: f**3 + f**5), 1)
        assert run.outcome is Outcome.SINGULAR and run.t_end == 0


class TestInputs:
    @pytest.mark.parametrize("solver", IMPLICIT)
    @pytest.mark.parametrize("given", [True, False])
    def test_jumps(self, solver, given):
        """Charged to a voltage, then another: each piece of the closed form starts anew."""
        knots, levels = [0, 0.4, 1.0], [2.0, -1.0, 0.5]
        times = np.linspace(0, 1.5, 151) if given else None
        run = simulate(
            charging(U),
            1.5,
            inputs={"U": Samples(knots, levels, "zero")},
            t_eval=times,
            rtol=1e-8,
            solver=solver,
        )
        start = 0.0
        for begin, end, level in zip(knots, [*knots[1:], 1.5], levels, strict=True):
            here = (run.t >= begin) & (run.t < end)
            (charge,) = radau(
                lambda t, q, level=level: [cubic_inverse(level - q[0] / 0.5)],
                (begin, end),
                [start],
                [*run.t[here], end],
            )
            assert np.abs(run["c.q"][here] - charge[:-1]).max() < 1e-7
            flows = [cubic_inverse(level - q / 0.5) for q in charge[:-1]]
            assert np.abs(run["r.f"][here] - flows).max() < 1e-7
            start = charge[-1]
        assert {0.4, 1.0} <= set(run.t)
        assert abs(run.energy.relative_residual) < 1e-6

    def test_a_jump_at_the_very_end(self):
        inputs = {"U": Samples([0, 1], [2.0, -1.0], "zero")}
        run = simulate(charging(U), 1, inputs=inputs, rtol=1e-8)
        flow = cubic_inverse(-1 - run["c.q"][-1] / 0.5)
        assert run["U"][-1] == -1 and run["r.f"][-1] == pytest.approx(flow, abs=1e-10)

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_straight_lines(self, solver):
        """A pulse much shorter than the steps around it is not stepped over."""
        knots, levels = [0, 1.0, 1.001, 1.002, 1.5], [0, 0, 500.0, 0, 0]
        inputs = {"U": Samples(knots, levels)}
        run = simulate(charging(U), 1.5, inputs=inputs, rtol=1e-8, solver=solver)

        def rate(t, q):
            return [cubic_inverse(np.interp(t, knots, levels) - q[0] / 0.5)]

        charge = 0.0
        for begin, end in itertools.pairwise(knots[1:]):
            charge = radau(rate, (begin, end), [charge], [end])[0, -1]
        assert charge > 1e-5
        assert run["c.q"][-1] == pytest.approx(charge, rel=1e-6)

    def test_functions_that_jump_are_refused_with_the_way_out(self):
        with pytest.raises(SimulationError, match=r"'U'.*t = 0\.4.*Samples"):
            simulate(charging(U), 1, inputs={"U": lambda t: float(t > 0.4)})

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_functions_are_followed(self, solver):
        times = np.linspace(0, 3, 31)
        run = simulate(
            charging(U), 3.0, inputs={"U": math.sin}, t_eval=times, rtol=1e-8, solver=solver
        )
        (charge,) = radau(
            lambda t, q: [cubic_inverse(math.sin(t) - q[0] / 0.5)], (0, 3), [0], times
        )
        assert np.abs(run["c.q"] - charge).max() < 1e-8
        assert np.abs(run["U"] - np.sin(times)).max() < 1e-9

    def test_times_that_do_not_start_at_zero(self):
        graph = charging(sympy.sin(TIME))
        run = simulate(graph, (-2, -1), rtol=1e-9, t_eval=[-1.7, -1.2])
        assert run.t.tolist() == [-1.7, -1.2] and run.t_end == -1
        (charge,) = radau(
            lambda t, q: [cubic_inverse(math.sin(t) - q[0] / 0.5)],
            (-2, -1),
            [0],
            [-1.7, -1.2, -1],
        )
        assert np.abs(run["c.q"] - charge[:2]).max() < 1e-8
        assert run.final["c.q"] == pytest.approx(charge[2], abs=1e-8)


class TestStiff:
    """Ordinary equations by the implicit solvers."""

    @pytest.mark.parametrize("solver", STIFF)
    def test_a_stiff_ladder(self, solver):
        """Time constants from 1e-6 s to 1 s, against the matrix exponential."""
        u, v, w = Zero("u"), Zero("v"), Zero("w")
        x, y = One("x"), One("y")
        graph = assemble(
            "ladder",
            u >> (C("a", 1e-3, initial=1e-3), x),
            x >> (R("r", 1e-3), v),
            v >> (C("b", 1e-3), y),
            y >> (R("s", 1e3), w),
            w >> (C("d", 1e-3), R("leak", 1e3)),
        )
        matrix = linearize(graph, at={}).A
        by_hand = np.array([[-1e6, 1e6, 0], [1e6, -1e6 - 1, 1], [0, 1, -2]])
        assert matrix == pytest.approx(by_hand, rel=1e-12, abs=1e-9)
        run = simulate(graph, 2.0, solver=solver, rtol=1e-8)
        assert run.solver == solver and run.steps < 3000
        for index in (5, 20, 300, 1020):
            exact = expm(by_hand * run.t[index]) @ [1e-3, 0, 0]
            assert np.abs(run.x[:, index] - exact).max() < 1e-10

    @pytest.mark.parametrize("solver", STIFF)
    def test_agrees_with_the_explicit_solver(self, solver):
        graph = models.quarter_car.graph()
        inputs = {"v_road": Samples([0, 0.1, 0.1001, 1], [0, 1, 0, 0])}
        times = np.linspace(0, 1, 101)
        usual = simulate(graph, 1.0, inputs=inputs, t_eval=times, rtol=1e-9)
        other = simulate(graph, 1.0, inputs=inputs, t_eval=times, rtol=1e-9, solver=solver)
        assert usual.solver == "dopri5"
        scale = np.abs(usual.x).max(axis=1, keepdims=True)
        assert np.abs((usual.x - other.x) / scale).max() < 1e-7
        assert other.energy.supplied == pytest.approx(usual.energy.supplied, rel=1e-6)

    def test_the_longest_step_is_kept(self):
        free = simulate(charging(), 1.0, t_eval=[1.0])
        bound = simulate(charging(), 1.0, t_eval=[1.0], max_step=1e-3)
        assert free.steps < 200 and bound.steps >= 1000
        assert bound.final["c.q"] == pytest.approx(free.final["c.q"], rel=1e-5)


class TestSizes:
    """No absolute tolerance is asked for: it follows from how large things become."""

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_other_units_give_the_same_numbers(self, solver):
        def run(unit):
            law = R("r", effort=lambda f: cubic(f * unit))
            source = Se("E", sympy.sin(TIME))
            graph = assemble("g", source >> One("v") >> (law, C("c", sympy.Rational(1, unit))))
            return unit * simulate(graph, 1, solver=solver, t_eval=[0.1, 1])["c.q"]

        assert run(10**12) == pytest.approx(run(1), rel=1e-12)

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_what_is_driven_by_a_square(self, solver):
        """At rest the second circuit is not coupled to the first; its charge is near 1e-14."""
        first = C("c1", 1)
        weak = Se("E", sympy.sin(TIME) / 10**6) >> One("v") >> (R("r", effort=cubic), first)
        second = Se("S", first.q**2) >> One("w") >> (R("r2", 1), C("c2", 1))
        run = simulate(assemble("g", weak, second), 1, solver=solver, rtol=1e-8, t_eval=[0.5, 1])
        charges = radau(
            lambda t, q: [cubic_inverse(1e-6 * math.sin(t) - q[0]), q[0] ** 2 - q[1]],
            (0, 1),
            [0, 0],
            [0.5, 1],
            atol=1e-25,
        )
        assert run.x == pytest.approx(charges, rel=1e-6, abs=0)

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_an_estimate_that_is_far_too_large(self, solver):
        """The rate at the start is 1e9 /s; the cubic law ends the motion at e = 1."""
        leak = R("leak", flow=lambda e: 10**9 * (e**3 - 1))
        graph = assemble("g", Zero("u") >> (C("c", 1), leak, R("r", effort=cubic)))
        run = simulate(graph, 1, solver=solver, t_eval=[2e-10, 5e-10, 1])
        (charge,) = radau(lambda t, q: [1e9 * (1 - q[0] ** 3)], (0, 5e-10), [0], [2e-10, 5e-10])
        assert run["c.q"][:2] == pytest.approx(charge, rel=1e-5)
        assert run["c.q"][2] == pytest.approx(1, abs=1e-8)


class TestOutcomes:
    @pytest.mark.parametrize("solver", STIFF)
    def test_escape_in_finite_time(self, solver, capfd):
        """q' = q^2 from 1 is infinite at t = 1."""
        graph = assemble("g", Zero("u") >> (C("c", 1, initial=1), R("r", flow=lambda e: -(e**2))))
        run = simulate(graph, 2, solver=solver)
        assert run.outcome in (Outcome.STEP_UNDERFLOW, Outcome.DIVERGED, Outcome.NON_FINITE)
        assert run.t_end == pytest.approx(1, abs=1e-5)
        assert np.isfinite(run.x).all() and run.final["c.q"] > 1e5
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize("solver", STIFF)
    def test_growth_without_bound(self, solver, capfd):
        graph = assemble("g", Zero("u") >> (C("c", 1, initial=1), R("r", -1e-3)))
        run = simulate(graph, 2, solver=solver)
        assert run.outcome is Outcome.DIVERGED
        assert run.t_end == pytest.approx(math.log(1e100) / 1e3, rel=1e-4)
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_a_root_of_a_negative_number(self, solver, capfd):
        graph = charging(sympy.sqrt(sympy.Rational(1, 2) - TIME))
        run = simulate(graph, 2, solver=solver)
        assert run.outcome is Outcome.NON_FINITE
        assert run.t_end == pytest.approx(0.5, abs=1e-9)
        assert math.isfinite(run.final["c.q"]) and np.isfinite(run.z).all()
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize("solver", IMPLICIT)
    def test_limits(self, solver, capfd):
        graph = charging(sympy.sin(10**7 * TIME))
        steps = simulate(graph, 1, solver=solver, max_steps=20_000)
        assert steps.outcome is Outcome.STEP_LIMIT and 0 < steps.t_end < 1
        clock = simulate(graph, 1, solver=solver, time_budget=0.05)
        assert clock.outcome is Outcome.TIME_BUDGET and clock.t_end < 1
        assert clock.t[-1] <= clock.t_end
        assert capfd.readouterr() == ("", "")

    def test_no_consistent_start(self):
        """exp(f) = -1 - q/c has no solution."""
        with pytest.raises(SimulationError, match=r"v\.f.*initial=\{'v\.f'") as caught:
            simulate(charging(-1, sympy.exp), 1)
        assert caught.value.elements == ("v.f",)


class TestChoice:
    def test_contacts_take_the_explicit_solver(self):
        graph = models.mass_on_belt.graph()
        assert simulate(graph, 0.1).solver == "dopri5"
        for solver in STIFF:
            with pytest.raises(SimulationError, match=r"contact.*dopri5"):
                simulate(graph, 0.1, solver=solver)

    @pytest.mark.parametrize("solver", ["dopri5", "cvodes"])
    def test_algebraic_variables_take_an_implicit_solver(self, solver):
        with pytest.raises(SimulationError, match=r"v\.f.*rosenbrock"):
            simulate(charging(), 1, solver=solver)

    def test_other_refusals(self):
        with pytest.raises(SimulationError, match="'radau' is not known"):
            simulate(charging(), 1, solver="radau")
        with pytest.raises(SimulationError, match="backend"):
            simulate(charging(), 1, backend="native")
        with pytest.raises(ParameterError, match=r"'r\.q' is not known"):
            simulate(charging(), 1, initial={"r.q": 1})
        with pytest.raises(SimulationError, match="max_step"):
            simulate(charging(), 1, max_step=-1)

    def test_what_has_no_numeric_form_is_named(self):
        for graph in (
            charging(2, sympy.gamma),
            assemble("g", One("v") >> (I("m", flow=sympy.gamma), R("b", 1))),
        ):
            with pytest.raises(BondGraphError, match="gamma"):
                simulate(graph, 1)
            with pytest.raises(BondGraphError, match="gamma"):
                linearize(graph, at={})


def test_the_trajectory_knows_all_signals(tmp_path):
    run = simulate(charging(), 1, t_eval=np.linspace(0, 1, 5))
    for name in run.names:
        assert run[name].shape == (5,) and np.isfinite(run[name]).all()
    assert run.z.shape == (1, 5) and np.array_equal(run.z[0], run["v.f"])
    data = run.to_xarray(("c.q", "r.f"))
    assert data.attrs["solver"] == "rosenbrock" and np.array_equal(data["r.f"], run["r.f"])
    assert run.save(tmp_path / "run.csv").read_text().count("\n") == 7
    assert run.to_dataframe().shape == (5, 1)


def test_a_model_without_states():
    graph = assemble("g", Se("E", 2) >> One("v") >> (R("r", 1), R("s", effort=cubic)))
    run = simulate(graph, 1)
    flow = brentq(lambda f: f**3 + 2 * f - 2, 0, 2, xtol=1e-15)
    assert run["s.f"][[0, -1]] == pytest.approx(flow, abs=1e-12)
    assert run.energy.dissipated == pytest.approx(2 * flow, rel=1e-9)


def test_one_compiled_model_serves_threads(capfd):
    """Also while SUNDIALS complains in some of them."""
    model = CompiledModel(charging(U))
    levels = np.linspace(-3, 3, 4)
    found = {}

    def work(level):
        found[level] = simulate(model, 1, inputs={"U": level}, solver="idas").final["c.q"]

    def fail():
        simulate(charging(sympy.sqrt(sympy.Rational(1, 2) - TIME)), 1, solver="idas")

    threads = [threading.Thread(target=work, args=(level,)) for level in levels]
    threads.append(threading.Thread(target=fail))
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    alone = [simulate(model, 1, inputs={"U": x}, solver="idas").final["c.q"] for x in levels]
    assert [found[level] for level in levels] == alone
    assert capfd.readouterr() == ("", "")
