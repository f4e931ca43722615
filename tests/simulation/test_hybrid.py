"""The event-driven integrator on models written by hand: no bond graph is involved."""

from __future__ import annotations

import itertools
import logging
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bondgraph.errors import SimulationError
from bondgraph.simulation.hybrid import integrate
from bondgraph.simulation.native import compiler
from bondgraph.simulation.outcome import Outcome
from bondgraph.simulation.problem import InputTable, Options, Problem
from bondgraph.simulation.table import ModeFunctions, ModeTable

COMPILER = compiler.find_compiler()
BACKENDS = ["native", "vm"] if COMPILER else ["vm"]
FAST = BACKENDS[0]


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory):
    """No test reads what another day's compiler left behind."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HALFARROW_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


# ---------------------------------------------------------------------- models


def table(n, m, k, count, rhs, guard=None):
    """Modes from ``rhs(mask, t, x, u, p, s)`` and ``guard`` alike, which give lists of numbers."""

    def provider(mask):
        provider.asked.append(mask)
        symbols = [ca.SX.sym(*of) for of in (("t",), ("x", n), ("u", m), ("p", count), ("s", k))]
        given = [symbols[0], *(ca.vertsplit(v) if v.numel() else [] for v in symbols[1:])]
        laws = [("rhs", rhs), ("guard", guard)] if guard else [("rhs", rhs)]
        return ModeFunctions(
            *(
                ca.Function(f"{name}{mask}", symbols, [ca.vertcat(*law(mask, *given))])
                for name, law in laws
            )
        )

    provider.asked = []
    modes = ModeTable(n, m, k, provider)
    modes.asked = provider.asked
    return modes


def scalar(law):
    """x' = law(t, x, u, p), without switches."""
    return table(1, 1, 0, 1, lambda mask, t, x, u, p, s: [law(t, x[0], u[0], p[0]), 0, 0])


def still(value=0.0):
    return InputTable([0.0], [[value]], [0])


def masses(k, moving=False):
    """Masses on belts, in a row of springs; per mass m, k, k_next, v_b, F_s, F_k, v_s, A, w, c.

    Pulled by A sin(w t); Stribeck's friction F_k + (F_s - F_k) exp(-v/v_s). With `moving`, the one
    input is added to the speed of every belt.
    """

    def parts(p):
        return [p[10 * i : 10 * i + 10] for i in range(k)]

    def pull(i, t, x, p):
        _, spring, after, *_, amplitude, omega, damping = p[i]
        force = amplitude * ca.sin(omega * t) - spring * x[i] - damping * x[k + i]
        if i + 1 < k:
            force += after * (x[i + 1] - x[i])
        return force + p[i - 1][2] * (x[i - 1] - x[i]) if i else force

    def belt(i, u, p):
        return p[i][3] + (u[0] if moving else 0)

    def rhs(mask, t, x, u, p, s):
        p, rates, supplied, dissipated = parts(p), [], 0, 0
        for i in range(k):
            m, _, _, _, static, kinetic, v_s, amplitude, omega, damping = p[i]
            slip, force = belt(i, u, p) - x[k + i], pull(i, t, x, p)
            friction = s[i] * (kinetic + (static - kinetic) * ca.exp(-s[i] * slip / v_s))
            friction = -force if mask >> i & 1 else friction
            rates.append((force + friction) / m)
            supplied += friction * belt(i, u, p) + amplitude * ca.sin(omega * t) * x[k + i]
            dissipated += friction * slip + damping * x[k + i] ** 2
        return [*x[k:], *rates, supplied, dissipated]

    def guard(mask, t, x, u, p, s):
        p, g, a = parts(p), [], []
        for i in range(k):
            slip, hold = belt(i, u, p) - x[k + i], -pull(i, t, x, p)
            stuck = mask >> i & 1
            a.append(hold if stuck else slip)
            g.append(p[i][4] - ca.fabs(hold) if stuck else s[i] * slip)
        return g + a

    return table(2 * k, int(moving), k, 10 * k, rhs, guard)


COULOMB = 1e12  # a v_s at which Stribeck's friction is F_s at every slip
BELT = (1, 100, 0.5, 12, 8)  # m, k, v_b, F_s, F_k of the belt with a closed form


def belt():
    """Mass on a belt with F_s > F_k as constants; m, k, v_b, F_s, F_k."""

    def rhs(mask, t, x, u, p, s):
        m, k, speed, _, kinetic = p
        friction = k * x[0] if mask else s[0] * kinetic
        return [x[1], (friction - k * x[0]) / m, friction * speed, friction * (speed - x[1])]

    def guard(mask, t, x, u, p, s):
        _, k, speed, static, _ = p
        return (
            [static - ca.fabs(k * x[0]), k * x[0]]
            if mask
            else [s[0] * (speed - x[1]), speed - x[1]]
        )

    return table(2, 0, 1, 5, rhs, guard)


def floor():
    """Mass m on the floor, pushed by an input and A sin(w t); m, F_s, F_k, A, w."""

    def push(t, u, p):
        return u[0] + p[3] * ca.sin(p[4] * t)

    def rhs(mask, t, x, u, p, s):
        friction = push(t, u, p) if mask else s[0] * p[2]
        return [x[1], (push(t, u, p) - friction) / p[0], push(t, u, p) * x[1], friction * x[1]]

    def guard(mask, t, x, u, p, s):
        hold = push(t, u, p)
        return [p[1] - ca.fabs(hold), hold] if mask else [s[0] * x[1], x[1]]

    return table(2, 1, 1, 5, rhs, guard)


NAMES = ("J", "m", "k_t", "k_f", "b_t", "b_f", "r", "w_t", "mu_s", "mu_k", "v_s", "N0", "tau")


def brake():
    """The bicycle brake of Procedia Engineering 72 (2014) 471; states w_r, V_c, theta_w, x_c, N."""

    def wheel_and_frame(x, q):
        torque = q["k_t"] * x[2] + q["b_t"] * (q["w_t"] - x[0])
        frame = q["k_f"] * x[3] + q["b_f"] * x[1]
        compliance = q["r"] ** 2 / q["J"] + 1 / q["m"]
        return torque, frame, (q["r"] * torque / q["J"] + frame / q["m"]) / compliance

    def rhs(mask, t, x, u, p, s):
        q = dict(zip(NAMES, p, strict=True))
        torque, frame, force = wheel_and_frame(x, q)
        slip, wind = q["r"] * x[0] - x[1], q["w_t"] - x[0]
        if not mask:
            mu = q["mu_k"] + (q["mu_s"] - q["mu_k"]) * ca.exp(-s[0] * slip / q["v_s"])
            force = s[0] * mu * x[4]
        lost = q["b_t"] * wind**2 + q["b_f"] * x[1] ** 2 + force * slip
        rates = [(torque - q["r"] * force) / q["J"], (force - frame) / q["m"], wind, x[1]]
        return [*rates, (q["N0"] - x[4]) / q["tau"], q["w_t"] * torque, lost]

    def guard(mask, t, x, u, p, s):
        q = dict(zip(NAMES, p, strict=True))
        force, slip = wheel_and_frame(x, q)[2], q["r"] * x[0] - x[1]
        return [q["mu_s"] * x[4] - ca.fabs(force), force] if mask else [s[0] * slip, slip]

    return table(5, 0, 1, len(NAMES), rhs, guard)


def brake_parameters(mu_s=0.5, tau=0.02, v_s=0.05):
    k_f, k_w, r = 350e3, 90e3, 0.08
    m, k_t = k_f / (2 * math.pi * 300) ** 2, k_w * r**2
    inertia = k_t / (2 * math.pi * 200) ** 2
    b_t, b_f = 0.1 * math.sqrt(k_t * inertia), 0.1 * math.sqrt(k_f * m)
    return np.array([inertia, m, k_t, k_f, b_t, b_f, r, 0.9 / r, mu_s, 0.4, v_s, 900 / 0.4, tau])


# Sticks, their first times and the state (w_r, V_c, theta_w, x_c) at 59 ms, computed apart from this
# project by scipy's DOP853 at rtol 1e-11 with events, checked by SUNDIALS CVODE.
BRAKES = {
    "fig6": ({"mu_s": 0.42, "tau": 0.03}, 0, [], []),
    "fig7": ({"mu_s": 0.42}, 1, [0.0016274028852364994], [0.0027225527605465143]),
    "fig8": (
        {},
        72,
        [0.0015846079832229933, 0.007442859466816512, 0.013511511604690383, 0.02023579243173415],
        [0.004242041567125545, 0.010733823222441118, 0.017573085291322434, 0.024418693691872922],
    ),
    "fig9": (
        {"tau": 0.06, "v_s": 0.2},
        64,
        [0.057210246502889806, 0.06243344535672365, 0.06899250298351686, 0.07539172867236696],
        [0.059549534015052655, 0.06631305368737019, 0.07281095509423552, 0.07973698244728762],
    ),
}
STATES = {
    "fig6": (10.686153590874916, 0.01216658371984444, 0.10755646275685729, 0.002211254237227984),
    "fig7": (10.920435547036215, 0.00682229891017553, 0.11856506583749239, 0.002436657918083188),
    "fig8": (7.430315424669667, 0.5944252339735792, 0.13551839210414848, 0.003364375909567262),
    "fig9": (2.7347519998408663, 0.21878015998727762, 0.09361281863480339, 0.0018567055499308718),
}


@pytest.fixture(scope="module")
def brake_modes():
    return brake()


@pytest.fixture(scope="module")
def belt_modes():
    return belt()


@pytest.fixture(scope="module")
def floor_modes():
    return floor()


def brake_problem(modes, until=0.5, **changes):
    p = brake_parameters(**changes)
    stiffness = np.array(
        [p[0], p[1], p[2], p[3], np.inf]
    )  # momenta would have 1/J; these are speeds
    return Problem(
        modes,
        p,
        [p[7], 0, 0, 0, 0],
        (0, until),
        weights=1 / np.sqrt(stiffness),
        energy0=0.5 * p[0] * p[7] ** 2,
    )


def stored(problem, x):
    return 0.5 * np.square(x)[..., :4] @ problem.parameters[:4]


def sticks(solution):
    return [event.t for event in solution.events if event.after == 0]


def log_of(solution):
    return [(event.switch, event.before, event.after) for event in solution.events]


def times_of(solution):
    return np.array([event.t for event in solution.events])


# ---------------------------------------------------------------------- the brake


@pytest.mark.parametrize("figure", BRAKES)
def test_brake_follows_the_paper(brake_modes, figure):
    changes, count, stick_times, slip_times = BRAKES[figure]
    problem = brake_problem(brake_modes, **changes)
    run = integrate(problem, Options(rtol=1e-9, backend=FAST))
    slips = [event.t for event in run.events if event.before == 0]
    assert run.outcome is Outcome.FINISHED and run.t_end == 0.5
    assert len(sticks(run)) == count
    assert sticks(run)[:4] == pytest.approx(stick_times, abs=1e-9)
    assert slips[:4] == pytest.approx(slip_times, abs=1e-9)
    rise = stored(problem, run.x_end) - stored(problem, problem.x0)
    assert abs(run.supplied_end - rise - run.dissipated_end) <= 1e-9 * run.supplied_end


@pytest.mark.parametrize("figure", BRAKES)
def test_brake_on_a_grid(brake_modes, figure):
    grid = np.linspace(0, 0.06, 61)
    problem = brake_problem(brake_modes, until=0.06, **BRAKES[figure][0])
    run = integrate(problem, Options(rtol=1e-9, t_eval=grid, backend=FAST))
    assert np.array_equal(run.t, grid)
    spans = np.ptp(run.x, axis=0)[:4]
    assert (np.abs(run.x[59, :4] - STATES[figure]) < 1e-7 * spans).all()


def test_brake_limit_cycle(brake_modes):
    times = sticks(integrate(brake_problem(brake_modes), Options(rtol=1e-9, backend=FAST)))
    assert 4 / (times[-1] - times[-5]) == pytest.approx(143.318344, abs=1e-5)


@pytest.mark.skipif(not COMPILER, reason="slow on the virtual machine")
@pytest.mark.parametrize("rtol", [1e-6, 1e-5, 1e-4])
def test_brake_sticks_as_often_at_loose_tolerances(brake_modes, rtol):
    for changes, count, *_ in BRAKES.values():
        run = integrate(brake_problem(brake_modes, **changes), Options(rtol=rtol, t_eval=[0.5]))
        assert len(sticks(run)) == count


def test_a_stuck_brake_does_not_creep(brake_modes):
    problem = brake_problem(brake_modes, until=0.1)
    run = integrate(problem, Options(backend=FAST, t_eval=np.linspace(0, 0.1, 2001)))
    slip = problem.parameters[6] * run.x[:, 0] - run.x[:, 1]
    stuck = run.codes[:, 0] == 0
    assert 500 < stuck.sum() < 1500
    assert np.abs(slip[stuck]).max() < 1e-12
    assert slip[~stuck].min() > -1e-9


# ---------------------------------------------------------------------- closed forms


def belt_times(until):
    """Times of the mass on the belt (m=1, k=100, v_b=.5, F_s=12, F_k=8) that starts at rest on it.

    Stuck, the spring grows as v_b t to F_s/k = .12. Slipping it swings about F_k/k = .08 with
    w = 10, from (.12, .5) round to (.04, .5), where speeds are equal again.
    """
    slip = (2 * math.pi - 2 * math.atan(0.8)) / 10
    stick = (0.12 - 0.04) / 0.5
    durations = itertools.chain([0.24], itertools.cycle([slip, stick]))
    times = itertools.accumulate(durations)
    return np.array(list(itertools.takewhile(lambda t: t < until, times)))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("rtol", "close"), [(1e-2, 2e-2), (1e-3, 2e-3), (1e-4, 2e-4), (1e-6, 1e-6), (1e-8, 1e-8)]
)
def test_mass_on_belt_meets_every_event(belt_modes, backend, rtol, close):
    problem = Problem(belt_modes, BELT, [0, 0.5], (0, 11.5))
    run = integrate(problem, Options(rtol=rtol, backend=backend))
    expected = belt_times(11.5)
    assert log_of(run) == [(0, 0, 1), (0, 1, 0)] * (len(expected) // 2) + [(0, 0, 1)] * (
        len(expected) % 2
    )
    assert times_of(run) == pytest.approx(expected, abs=close)
    if rtol == 1e-8:
        assert np.diff(times_of(run))[:2] == pytest.approx([0.493370342273, 0.16], abs=2e-9)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_oscillator_meets_its_closed_form_between_steps(backend, rtol):
    modes = table(2, 0, 0, 1, lambda mask, t, x, u, p, s: [x[1], -(p[0] ** 2) * x[0], 0, 0])
    grid = np.linspace(0, 1, 1001)
    run = integrate(
        Problem(modes, [30.0], [1, 0], (0, 1)), Options(rtol=rtol, t_eval=grid, backend=backend)
    )
    assert np.abs(run.x[:, 0] - np.cos(30 * grid)).max() < 30 * rtol
    assert np.abs(run.x[:, 1] + 30 * np.sin(30 * grid)).max() < 900 * rtol
    assert run.backend == backend and not run.events


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_braked_mass_stops_once_and_stays(floor_modes, backend):
    problem = Problem(floor_modes, [2, 4, 4, 0, 0], [0, 4.0], (0, 9), inputs=still())
    run = integrate(problem, Options(rtol=1e-8, backend=backend))
    assert log_of(run) == [(0, 1, 0)]
    assert run.events[0].t == pytest.approx(2.0, abs=1e-12)
    assert run.x_end == pytest.approx([4.0, 0.0], abs=1e-12)
    assert run.dissipated_end == pytest.approx(16.0, rel=1e-9)
    assert run.codes_end.tolist() == [0]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_large_drive_crosses_zero_slip_without_sticking(floor_modes, backend):
    """v' = 10 sin(2 t) - F_k sign(v), in closed form between two crossings."""
    problem = Problem(floor_modes, [1, 0.5, 0.5, 10, 2], [0, -1.0], (0, 10), inputs=still())
    run = integrate(problem, Options(rtol=1e-9, backend=backend))
    assert len(run.events) == 7
    assert all(event.after == -event.before for event in run.events)
    for first, then in itertools.pairwise(run.events):
        swing = 5 * (math.cos(2 * first.t) - math.cos(2 * then.t))
        assert swing == pytest.approx(0.5 * first.after * (then.t - first.t), abs=1e-7)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_push_that_depends_on_time_alone_is_not_jumped_over(floor_modes, backend):
    """Stuck, the state says nothing about the push; its peaks top the hold for 7 ms of 157 ms."""
    peak, omega = 1.01, 20
    problem = Problem(floor_modes, [1, 1, 0.9, peak, omega], [0, 0], (0, 6), inputs=still())
    run = integrate(problem, Options(rtol=1e-3, backend=backend))
    slips = [event.t for event in run.events if event.before == 0]
    expected = (math.asin(1 / peak) + math.pi * np.arange(40)) / omega
    assert slips == pytest.approx(expected[expected < 6], abs=1e-9)
    assert len(run.events) == 2 * len(slips)


# ---------------------------------------------------------------------- inputs


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("hold", [0, 1])
def test_inputs_are_held_as_declared(backend, hold):
    """x' = u - x, solved piece by piece: u = a + b (t - t_i)."""
    knots, values = [0.5, 1.0, 1.7, 3.0], [2.0, -1.0, 4.0, 0.5]
    modes = scalar(lambda t, x, u, p: u - x)
    inputs = InputTable(knots, np.array(values)[:, None], [hold])
    grid = np.linspace(0, 4, 41)
    problem = Problem(modes, [0.0], [1.0], (0, 4), inputs=inputs)
    run = integrate(problem, Options(rtol=1e-10, t_eval=grid, backend=backend))

    ends, x, expected = [0.0, *knots, 4.0], 1.0, {0.0: 1.0}
    for i, (start, end) in enumerate(itertools.pairwise(ends)):
        a = values[max(i - 1, 0)]
        b = (values[i] - a) / (end - start) if hold and 0 < i < len(values) else 0.0
        for t in [*grid[(grid > start) & (grid <= end)], end]:
            expected[t] = a + b * (t - start) - b + (x - a + b) * math.exp(start - t)
        x = expected[end]
    assert run.x[:, 0] == pytest.approx([expected[t] for t in grid], abs=1e-9)


def test_a_function_of_time_runs_on_the_virtual_machine():
    modes = scalar(lambda t, x, u, p: u - x)
    problem = Problem(modes, [0.0], [0.0], (0, 3), inputs=lambda t: [math.exp(-t)])
    run = integrate(problem, Options(rtol=1e-10))
    assert run.backend == "vm"
    assert run.x_end[0] == pytest.approx(3 * math.exp(-3), abs=1e-9)
    with pytest.raises(SimulationError, match="Python function"):
        integrate(problem, Options(backend="native"))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_ramped_push_breaks_away_at_the_hold(floor_modes, backend):
    ramp = InputTable([0, 1, 6], [[0], [0], [5]], [1])
    problem = Problem(floor_modes, [1, 2, 2, 0, 0], [0, 0], (0, 4), inputs=ramp)
    run = integrate(problem, Options(rtol=1e-9, backend=backend))
    assert log_of(run) == [(0, 0, 1)]
    assert run.events[0].t == pytest.approx(3.0, abs=1e-12)
    assert run.x_end == pytest.approx([1 / 6, 0.5], rel=1e-9)  # v' = t - 3


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_jump_of_the_push_releases_or_is_held(floor_modes, backend):
    steps = InputTable([0, 1, 2, 3], [[0.5], [-1.9], [3.0], [1.0]], [0])
    problem = Problem(floor_modes, [1, 2, 2, 0, 0], [0, 0], (0, 9), inputs=steps)
    run = integrate(problem, Options(rtol=1e-9, backend=backend))
    assert log_of(run) == [(0, 0, 1), (0, 1, 0)]
    assert times_of(run) == pytest.approx([2.0, 4.0], abs=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_jump_of_the_belt_tears_the_stick(backend):
    """The belt of a stuck mass doubles its speed: the mass slips, and sticks again at that speed."""
    modes = masses(1, moving=True)
    inputs = InputTable([0, 1], [[0.0], [0.5]], [0])
    p = (2, 0, 0, 0.5, 4, 4, COULOMB, 0, 0, 0)
    run = integrate(Problem(modes, p, [0, 0.5], (0, 3), inputs=inputs), Options(backend=backend))
    assert log_of(run) == [(0, 0, 1), (0, 1, 0)]
    assert times_of(run) == pytest.approx([1.0, 1.25], abs=1e-12)
    assert run.x_end[1] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.skipif(not COMPILER, reason="slow on the virtual machine")
def test_a_long_table_costs_about_a_step_a_knot():
    modes = scalar(lambda t, x, u, p: u - x)
    knots = np.linspace(0, 10, 100_001)
    for hold in (0, 1):
        inputs = InputTable(knots, np.sin(knots)[:, None], [hold])
        run = integrate(Problem(modes, [0.0], [0.5], (0, 10), inputs=inputs), Options(t_eval=[10]))
        exact = 0.5 * (math.sin(10) - math.cos(10)) + math.exp(-10)
        assert run.x_end[0] == pytest.approx(exact, abs=1e-3 if hold == 0 else 1e-8)
        assert run.steps < 100_050 and run.rhs_evals < 7.1 * run.steps


# ---------------------------------------------------------------------- several switches

PAIR = np.array(
    [[1.0, 80, 30, 0.3, 9, 6, 0.2, 0, 0, 0.4], [1.6, 120, 0, 0.45, 12, 7, 0.1, 0, 0, 0.2]]
)


def reference(p, x0, until):
    """The masses' events by scipy: DOP853, one call between events, the textbook's transitions."""
    k = len(p)
    m, ground, after, speed, static, kinetic, v_s, amplitude, omega, damping = p.T

    def pull(t, x):
        force = amplitude * np.sin(omega * t) - ground * x[:k] - damping * x[k:]
        stretch = after[:-1] * np.diff(x[:k])
        return force + np.append(stretch, 0) - np.append(0, stretch)

    def friction(t, x, code):
        slip = speed - x[k:]
        slipping = code * (
            kinetic + (static - kinetic) * np.exp(-np.maximum(code * slip / v_s, -5))
        )
        return np.where(code == 0, -pull(t, x), slipping)

    def crossing(i, code):
        def g(t, x):
            return code[i] * (speed - x[k:])[i] if code[i] else static[i] - abs(pull(t, x)[i])

        g.terminal, g.direction = True, -1
        return g

    t, x, log = 0.0, np.array(x0, dtype=float), []
    code = np.where(x[k:] == speed, 0, np.sign(speed - x[k:])).astype(int)
    while True:
        done = solve_ivp(
            lambda t, x, code=code: np.append(x[k:], (pull(t, x) + friction(t, x, code)) / m),
            (t, until),
            x,
            method="DOP853",
            rtol=1e-12,
            atol=1e-14,
            max_step=0.02,
            events=[crossing(i, code) for i in range(k)],
        )
        if done.status == 0:
            return log
        i = next(i for i, found in enumerate(done.t_events) if len(found))
        t, x, code = done.t[-1], done.y[:, -1].copy(), code.copy()
        before, hold = code[i], -pull(t, x)[i]
        if before:
            x[k + i] = speed[i]
        code[i] = 0 if before and abs(hold) <= static[i] else int(np.sign(hold))
        log.append((t, i, before, code[i]))


def test_two_frictions_agree_with_an_independent_solver():
    modes, x0 = masses(2), [0.01, -0.02, 0.3, 0.0]
    expected = reference(PAIR, x0, 5.0)
    run = integrate(Problem(modes, PAIR.ravel(), x0, (0, 5)), Options(rtol=1e-10, backend=FAST))
    assert len(expected) > 20 and {i for _, i, *_ in expected} == {0, 1}
    assert log_of(run) == [tuple(event[1:]) for event in expected]
    assert times_of(run) == pytest.approx([event[0] for event in expected], abs=1e-8)
    assert sorted(set(modes.asked)) == list(range(4)) and len(modes.asked) == 4


@pytest.mark.parametrize("backend", BACKENDS)
def test_events_at_the_same_instant_are_all_taken(backend):
    """Two equal masses side by side: everything happens twice."""
    modes = masses(2)
    p = np.array([[1, 100, 0, 0.5, 12, 8, 0.05, 0, 0, 0]] * 2, dtype=float)
    run = integrate(
        Problem(modes, p.ravel(), [0, 0, 0.5, 0.5], (0, 4)), Options(rtol=1e-7, backend=backend)
    )
    log = log_of(run)
    assert run.outcome.ok and len(log) >= 16
    for one, other in zip(log[::2], log[1::2], strict=True):
        assert {one[0], other[0]} == {0, 1} and one[1:] == other[1:]
    assert np.diff(times_of(run))[::2] == pytest.approx(0, abs=1e-12)


def random_masses(seed):
    rng = np.random.default_rng(seed)
    k = int(rng.integers(1, 4))
    p = []
    for _ in range(k):
        static = rng.uniform(5, 15)
        springs = rng.uniform(20, 200), rng.uniform(0, 100)
        friction = static, static * rng.uniform(0.4, 1), 10 ** rng.uniform(-2, 0)
        force = rng.uniform(0, 20) * rng.integers(2), rng.uniform(1, 30), rng.uniform(0, 3)
        p += [rng.uniform(0.5, 2), *springs, rng.uniform(-0.6, 0.6), *friction, *force]
    x0 = np.concatenate([rng.normal(size=k) * 0.05, rng.normal(size=k) * 0.3])
    return k, p, x0


@pytest.fixture(scope="module")
def rows_of_masses():
    return {k: masses(k) for k in (1, 2, 3)}


@pytest.mark.skipif(not COMPILER, reason="slow on the virtual machine")
def test_no_event_is_lost_on_random_rows_of_masses(rows_of_masses):
    found = 0
    for seed in range(40):
        k, p, x0 = random_masses(seed)
        problem = Problem(rows_of_masses[k], p, x0, (0, 6))
        careful = integrate(problem, Options(rtol=1e-10, max_step=0.004, t_eval=[6]))
        run = integrate(problem, Options(rtol=1e-7, t_eval=[6]))
        assert run.outcome.ok and log_of(run) == log_of(careful), seed
        if found := found + len(run.events):
            assert np.abs(times_of(run) - times_of(careful)).max(initial=0) < 1e-3, seed
    assert found > 1000


# ---------------------------------------------------------------------- the twins


@pytest.mark.skipif(not COMPILER, reason="nothing to compare with")
class TestTwins:
    """C and Python give the same bits: events, rows, counts of steps."""

    def agree(self, problem, **options):
        one, other = (integrate(problem, Options(backend=b, **options)) for b in ("native", "vm"))
        assert one.outcome is other.outcome
        assert log_of(one) == log_of(other)
        assert times_of(one).tolist() == times_of(other).tolist()
        for name in ("t", "x", "codes", "supplied", "dissipated", "x_end", "codes_end"):
            assert np.array_equal(getattr(one, name), getattr(other, name)), name
        for name in ("t_end", "supplied_end", "dissipated_end", "steps", "rejected", "rhs_evals"):
            assert getattr(one, name) == getattr(other, name), name
        return one

    def test_on_the_brake(self, brake_modes):
        for rtol in (1e-3, 1e-6, 1e-9):
            problem = brake_problem(brake_modes, until=0.05)
            run = self.agree(problem, rtol=rtol, t_eval=np.linspace(0, 0.05, 101))
            assert len(run.events) > 10

    def test_on_the_belt(self, belt_modes):
        self.agree(Problem(belt_modes, BELT, [0.03, 0.0], (0, 5)), rtol=1e-6)

    def test_on_random_rows_of_masses(self, rows_of_masses):
        for seed in range(100, 106):
            k, p, x0 = random_masses(seed)
            self.agree(Problem(rows_of_masses[k], p, x0, (0, 2)), rtol=1e-5, atol=1e-9)

    @pytest.mark.parametrize("hold", [0, 1])
    def test_on_noisy_inputs(self, floor_modes, hold):
        rng = np.random.default_rng(7)
        inputs = InputTable(np.linspace(0, 1, 301), rng.normal(size=(301, 1)) * 3, [hold])
        problem = Problem(floor_modes, [1, 1, 0.8, 0, 0], [0, 0], (0, 1), inputs=inputs)
        assert len(self.agree(problem, t_eval=[0.0, 1.0]).events) > 50

    def test_on_what_goes_wrong(self, belt_modes):
        self.agree(Problem(belt_modes, [1, 100, 0.5, 8, 12], [0, 0.5], (0, 1)))
        self.agree(Problem(belt_modes, BELT, [0, 0.5], (0, 9)), max_events=7)
        blow_up = scalar(lambda t, x, u, p: x**2)
        self.agree(Problem(blow_up, [0.0], [1.0], (0, 2), inputs=still()))


# ---------------------------------------------------------------------- outcomes


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("law", "x0", "outcomes", "t_end"),
    [
        (lambda t, x, u, p: x**2, 1.0, {"step underflow", "non-finite", "diverged"}, 1.0),
        (lambda t, x, u, p: 50 * x, 1.0, {"diverged"}, 100 * math.log(10) / 50),
        (lambda t, x, u, p: ca.sqrt(0.5 - t), 0.0, {"non-finite"}, 0.5),
        (lambda t, x, u, p: ca.log(-x), 1.0, {"non-finite"}, 0.0),
        (lambda t, x, u, p: -x, math.nan, {"non-finite"}, 0.0),
        (lambda t, x, u, p: ca.exp(ca.exp(ca.exp(x))), 0.0, {"step underflow", "non-finite"}, None),
    ],
)
def test_what_cannot_go_on_is_named(backend, law, x0, outcomes, t_end):
    problem = Problem(scalar(law), [0.0], [x0], (0, 20), inputs=still())
    run = integrate(problem, Options(backend=backend, time_budget=20))
    assert run.outcome.value in outcomes and not run.outcome.ok and run.outcome.advice
    assert t_end is None or run.t_end == pytest.approx(t_end, rel=1e-2)
    assert math.isnan(x0) or (np.isfinite(run.x_end).all() and np.isfinite(run.x).all())


@pytest.mark.parametrize("backend", BACKENDS)
def test_limits_are_named(belt_modes, backend):
    problem = Problem(belt_modes, BELT, [0, 0.5], (0, 1e7))
    events = integrate(problem, Options(max_events=5, backend=backend))
    assert events.outcome is Outcome.EVENT_LIMIT and len(events.events) == 5
    assert events.t_end == pytest.approx(belt_times(3)[5], rel=1e-5)
    steps = integrate(problem, Options(max_steps=50, backend=backend))
    assert steps.outcome is Outcome.STEP_LIMIT and steps.steps + steps.rejected == 50
    late = integrate(problem, Options(time_budget=0.2, t_eval=[0], backend=backend))
    assert late.outcome is Outcome.TIME_BUDGET and late.t_end > 1


@pytest.mark.parametrize("backend", BACKENDS)
def test_friction_that_contradicts_itself_chatters(belt_modes, backend):
    """Kinetic friction above the breakaway force: neither stick nor slip is possible."""
    problem = Problem(belt_modes, [1, 100, 0.5, 8, 12], [0, 0.5], (0, 5))
    run = integrate(problem, Options(backend=backend))
    assert run.outcome is Outcome.CHATTERING
    assert run.t_end == pytest.approx(0.16, abs=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_overflow_in_a_step_past_an_event_is_harmless(backend):
    """exp(-v/v_s) overflows at once when a trial step carries v below zero."""
    steep = (1, 100, 0, 0.5, 12, 8, 1e-5, 0, 0, 0)
    run = integrate(Problem(masses(1), steep, [0.0, 0.5], (0, 3)), Options(backend=backend))
    assert run.outcome.ok
    assert times_of(run) == pytest.approx(belt_times(3), abs=2e-3)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_slip_that_only_touches_zero_goes_on(floor_modes, belt_modes, backend):
    """Amplitude such that the mass just reaches the belt's speed, without friction to speak of."""
    touch = integrate(
        Problem(belt_modes, [1, 100, 0.5, 0, 0], [0, 0.5], (0, 20)), Options(backend=backend)
    )
    assert touch.outcome.ok
    assert touch.x_end[0] == pytest.approx(0.05 * math.sin(200), abs=1e-4)
    rest = integrate(
        Problem(floor_modes, [1, 0, 0, 0, 0], [0, 0], (0, 1), inputs=still()),
        Options(backend=backend),
    )
    assert rest.outcome.ok and not rest.events


def test_outcomes_are_named_and_advised():
    assert Outcome("finished").ok and [o for o in Outcome if o.ok] == [Outcome.FINISHED]
    assert all(o.advice and o.advice[0].islower() and "\n" not in o.advice for o in Outcome)


# ---------------------------------------------------------------------- rows


@pytest.mark.parametrize("backend", BACKENDS)
def test_rows_are_steps_and_both_sides_of_events(belt_modes, backend):
    run = integrate(Problem(belt_modes, BELT, [0, 0.5], (0, 1)), Options(backend=backend))
    assert run.t[0] == 0 and run.t[-1] == 1 and (np.diff(run.t) >= 0).all()
    assert len(run.t) == 1 + run.steps + len(run.events)
    for event in run.events:
        before, after = np.flatnonzero(run.t == event.t)
        assert run.codes[before, 0] == event.before and run.codes[after, 0] == event.after
        assert np.array_equal(run.x[before], event.x) and np.array_equal(run.x[after], event.x)
        assert run.supplied[after] == event.supplied and run.dissipated[after] == event.dissipated


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_row_at_an_event_holds_the_codes_after_it(belt_modes, backend):
    problem = Problem(belt_modes, BELT, [0, 0.5], (0, 1))
    exact = times_of(integrate(problem, Options(backend=backend)))
    grid = np.sort(np.concatenate([[0, 1], exact, np.nextafter(exact, 0)]))
    run = integrate(problem, Options(backend=backend, t_eval=grid))
    assert np.array_equal(run.t, grid)
    assert run.codes[:, 0].tolist() == [0, 0, 1, 1, 0, 0, 1, 1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_rows_grow_beyond_the_first_buffer(backend):
    modes = table(1, 0, 0, 1, lambda mask, t, x, u, p, s: [-p[0] * x[0], 0, 0])
    problem = Problem(modes, [1.0], [1.0], (0, 1))
    run = integrate(problem, Options(backend=backend, max_step=1 / 9000, rtol=1e-9))
    assert len(run.t) == 9001 or len(run.t) == 9002
    assert run.x[:, 0] == pytest.approx(np.exp(-run.t), rel=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_empty_span_has_its_start(belt_modes, backend):
    problem = Problem(belt_modes, BELT, [0.01, 0.5], (2, 2))
    for t_eval, rows in ((None, 1), ([2.0], 1), ([], 0)):
        run = integrate(problem, Options(backend=backend, t_eval=t_eval))
        assert run.outcome.ok and len(run.t) == rows and run.x.shape == (rows, 2)


# ---------------------------------------------------------------------- borders


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"x0": [0.0]}, "2 initial states"),
        ({"t_span": (1, 0)}, "run forward"),
        ({"t_span": (0, math.inf)}, "finite"),
        ({"weights": [1.0]}, "2 weights"),
    ],
)
def test_bad_problems_are_refused(belt_modes, change, words):
    good = Problem(belt_modes, BELT, [0, 0.5], (0, 1))
    with pytest.raises(SimulationError, match=words):
        replace(good, **change)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rtol": 0}, "rtol"),
        ({"atol": -1.0}, "atol"),
        ({"max_step": 0}, "max_step"),
        ({"backend": "gpu"}, "backend"),
        ({"t_eval": [1, 0]}, "t_eval"),
    ],
)
def test_bad_options_are_refused(options, words):
    with pytest.raises(SimulationError, match=words):
        Options(**options)


def test_bad_combinations_are_refused(belt_modes):
    problem = Problem(belt_modes, BELT, [0, 0.5], (0, 1))
    with pytest.raises(SimulationError, match="leaves the time span"):
        integrate(problem, Options(t_eval=[0, 2]))
    with pytest.raises(SimulationError, match="2 numbers"):
        integrate(problem, Options(atol=np.ones(3)))
    with pytest.raises(SimulationError, match="1 inputs"):
        Problem(scalar(lambda t, x, u, p: u), [0.0], [0.0], (0, 1))
    with pytest.raises(SimulationError, match="must take"):
        short = table(2, 0, 0, 0, lambda mask, t, x, u, p, s: [x[0]])
        integrate(Problem(short, [], [0, 0], (0, 1)))


@pytest.mark.parametrize(
    ("knots", "values", "hold", "words"),
    [
        ([0, 0], [[1], [2]], [0], "increase"),
        ([0, 1], [[1]], [0], "needs"),
        ([0], [[math.nan]], [0], "finite"),
        ([0], [[1]], [3], "zero order"),
        ([0, 1], [[1], [2]], [2], "coefficients"),
        ([], np.zeros((0, 1)), [0], "needs"),
    ],
)
def test_bad_tables_are_refused(knots, values, hold, words):
    with pytest.raises(SimulationError, match=words):
        InputTable(knots, values, hold)


def test_plain_python_functions_serve_as_a_model():
    mode = ModeFunctions(lambda t, x, u, p, s: np.array([-x[0], 0.0, 0.0]))
    run = integrate(
        Problem(ModeTable(1, 0, 0, lambda mask: mode), [], [1.0], (0, 1)), Options(rtol=1e-9)
    )
    assert run.backend == "vm" and run.x_end[0] == pytest.approx(math.exp(-1), rel=1e-9)


def test_results_with_structural_zeros_are_filled(tmp_path):
    x, rest = ca.SX.sym("x", 2), [ca.SX.sym("u", 0), ca.SX.sym("p", 0), ca.SX.sym("s", 0)]
    rates = ca.SX(4, 1)
    rates[1] = 3
    mode = ModeFunctions(ca.Function("sparse", [ca.SX.sym("t"), x, *rest], [rates]))
    modes = ModeTable(2, 0, 0, lambda mask: mode)
    for backend in BACKENDS:
        run = integrate(Problem(modes, [], [1, 1], (0, 2)), Options(backend=backend))
        assert run.x_end == pytest.approx([1, 7])


# ---------------------------------------------------------------------- compiled code


@pytest.mark.skipif(not COMPILER, reason="no compiler")
class TestCompiled:
    """Threads; the cache has tests of its own."""

    def test_one_table_serves_threads(self, belt_modes):
        speeds = np.linspace(0.2, 0.8, 24)

        def run(speed):
            return integrate(Problem(belt_modes, [1, 100, speed, 12, 8], [0, 0], (0, 20)))

        alone = [run(speed) for speed in speeds]
        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(run, speeds))
        for one, other in zip(alone, together, strict=True):
            assert (
                np.array_equal(one.x, other.x)
                and times_of(one).tolist() == times_of(other).tolist()
            )


def test_without_a_compiler_it_runs_slower_and_says_so(monkeypatch, caplog):
    monkeypatch.setenv("HALFARROW_NO_COMPILER", "1")
    problem = Problem(belt(), BELT, [0, 0.5], (0, 2))
    with caplog.at_level(logging.WARNING):
        run = integrate(problem)
    assert run.backend == "vm" and "slower" in caplog.text
    assert times_of(run) == pytest.approx(belt_times(2), abs=1e-6)
    with pytest.raises(SimulationError, match="no C compiler"):
        integrate(problem, Options(backend="native"))
