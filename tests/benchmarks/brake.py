"""The brake race: one run of the framework against a hand-written C automaton and against smoothing.

The paper's limit cycle, 0.3 s at rtol 1e-6 with 6001 times of output (20 kHz). Contestants:

``C automaton``
    brake_automaton.c, gcc -O2 -march=native: about the least this computation can cost.
``halfarrow``
    `simulate` on a compiled model.
``halfarrow, new force``
    The same with another brake force each time, to named arrays of three outputs: what a slider
    has to wait for.
``LSODA, lambdified``
    What one would write instead: friction smoothed by ``tanh(v / 1e-3)``, the explicit equations
    from sympy by lambdify, scipy's solve_ivp. It is slower and, being another model, loses the
    trace; its error is printed beside its time.
``odeint, by hand``
    The quickest door to LSODA, on a plain Python right-hand side written by hand.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy.integrate import odeint, solve_ivp

from ..oracles import brake as oracle
from . import baseline
from .native import BaselineUnavailable
from .report import Limit, Report
from .timing import Timing, interleave

Array = NDArray[np.float64]

T_END = 0.3
RTOL = 1e-6
N_OUT = 6001
FIGURES = ("fig6", "fig7", "fig8", "fig9")
SMOOTHING = 1e-3

C_AUTOMATON = "C automaton"
OURS = "halfarrow"
CHANGED = "halfarrow, new force"
LAMBDIFIED = "LSODA, lambdified"
ODEINT = "odeint, by hand"


@dataclass(frozen=True)
class Answer:
    """What a contestant computed: states at the race's times, (N_OUT, 4), and times of sticking."""

    states: Array
    stick_times: Sequence[float]


@dataclass(frozen=True)
class Contestant:
    """A prepared run: `call` is what is timed, `answer` runs it once and reads the result."""

    name: str
    call: Callable[[], object]
    answer: Callable[[], Answer]


@dataclass(frozen=True)
class Row:
    """One line of the result.

    Attributes
    ----------
    figure, name : which behaviour of the paper, which contestant
    timing : CPU seconds a run; None where the contestant could not start, as `note` says
    ratio : CPU time over the C automaton's
    sticks, true_sticks : number of sticks found, and of the oracle
    error : greatest error of any state up to 60 ms and up to the end, over that state's range
    note : why there is no timing
    """

    figure: str
    name: str
    timing: Timing | None = None
    ratio: float = math.nan
    sticks: int = 0
    true_sticks: int = 0
    error: tuple[float, float] = (math.nan, math.nan)
    note: str = ""


def grid() -> Array:
    """Times of output, s."""
    return np.linspace(0, T_END, N_OUT)


def ours(brake: oracle.Brake) -> Contestant:
    """The framework's compiled simulation, prepared so that a call costs one run."""
    from bondgraph import CompiledModel, simulate
    from bondgraph.models import bicycle_brake

    model, times = CompiledModel(bicycle_brake.graph()), grid()
    model.compile()
    parameters = oracle.parameters(brake)

    def run() -> Any:
        return simulate(model, (0, T_END), parameters=parameters, t_eval=times, rtol=RTOL)

    def answer() -> Answer:
        trajectory = run()
        states = np.column_stack([trajectory[name] for name in oracle.STATES])
        return Answer(states, [e.t for e in trajectory.events if e.to_mode == "stick"])

    return Contestant(OURS, run, answer)


def changed(brake: oracle.Brake) -> Contestant:
    """The framework with a new brake force each time, read as named arrays."""
    from bondgraph import CompiledModel, simulate
    from bondgraph.models import bicycle_brake

    model, times = CompiledModel(bicycle_brake.graph()), grid()
    parameters = oracle.parameters(brake)
    forces = itertools.cycle(parameters["F_k"] * (1 + 1e-4 * np.arange(-5, 6)))

    def run(force: float | None = None) -> Any:
        given = parameters | {"F_k": next(forces) if force is None else force}
        trajectory = simulate(model, (0, T_END), parameters=given, t_eval=times, rtol=RTOL)
        return trajectory, [trajectory[name] for name in oracle.STATES[:3]]

    def answer() -> Answer:
        trajectory, _ = run(parameters["F_k"])
        states = np.column_stack([trajectory[name] for name in oracle.STATES])
        return Answer(states, [e.t for e in trajectory.events if e.to_mode == "stick"])

    return Contestant(CHANGED, run, answer)


def c_automaton(brake: oracle.Brake) -> Contestant:
    """The hand-written C automaton."""
    parameters = oracle.parameters(brake)

    def answer() -> Answer:
        run = baseline.run(parameters, T_END, rtol=RTOL, n_out=N_OUT)
        return Answer(run.states, run.stick_times)

    return Contestant(C_AUTOMATON, baseline.prepare(parameters, T_END, RTOL, N_OUT), answer)


def lambdified(brake: oracle.Brake) -> Contestant:
    """solve_ivp's LSODA on the explicit equations of the smoothed model, by sympy's lambdify."""
    from bondgraph import derive
    from bondgraph.models import bicycle_brake
    from bondgraph.modes import smoothed
    from bondgraph.values import initial_values, parameter_values

    equations = derive(smoothed(bicycle_brake.graph(), SMOOTHING))
    values = parameter_values(equations, oracle.parameters(brake))
    numbers = {symbol: values[symbol.name] for symbol in equations.parameters}
    explicit = [rate.subs(numbers) for rate in equations.explicit().values()]
    time = sympy.Symbol("t")
    rates = sympy.lambdify([time, equations.states], explicit)
    named = [equations.substituted(equations.outputs[name]).subs(numbers) for name in oracle.STATES]
    outputs = sympy.lambdify([equations.states], named)
    start, times = initial_values(equations, values), grid()

    def run() -> Array:
        tolerances = {"rtol": RTOL, "atol": 1e-3 * RTOL}
        solved = solve_ivp(rates, (0, T_END), start, "LSODA", times, **tolerances)
        return np.column_stack(outputs(solved.y))

    return Contestant(LAMBDIFIED, run, lambda: smooth_answer(brake, run()))


def smooth_answer(brake: oracle.Brake, states: Array) -> Answer:
    """Count the times slip enters the smoothed zone, and call it sticking: no event exists here."""
    inside = np.abs(brake.r_r * states[:, 0] - states[:, 1]) < SMOOTHING
    return Answer(states, grid()[1:][inside[1:] & ~inside[:-1]].tolist())


def by_hand(brake: oracle.Brake) -> Contestant:
    """scipy's LSODA through odeint, on friction smoothed by tanh."""
    p, times = brake, grid()
    r, j, m, k_t, k_f, b_t, b_f = p.r_r, p.J_r, p.m_f, p.k_t, p.k_f, p.b_t, p.b_f
    w_t, n0, tau, mu_k, excess, v_s = p.omega_t, p.N0, p.tau, p.mu_k, p.mu_s - p.mu_k, p.v_s

    def rates(t: float, y: Array) -> tuple[float, float, float, float]:
        w, v, th, x = y.tolist()
        slip = r * w - v
        mu = mu_k + excess * math.exp(-abs(slip) / v_s)
        force = n0 * (1 - math.exp(-t / tau)) * mu * math.tanh(slip / SMOOTHING)
        wind = w_t - w
        return (k_t * th + b_t * wind - r * force) / j, (force - k_f * x - b_f * v) / m, wind, v

    def run() -> Array:
        solved: Array = odeint(
            rates, p.start, times, tfirst=True, rtol=RTOL, atol=1e-3 * RTOL, mxstep=100_000
        )
        return solved

    return Contestant(ODEINT, run, lambda: smooth_answer(brake, run()))


def race(figures: Sequence[str] = ("fig8",), *, rounds: int = 9) -> list[Row]:
    """Time all contestants in turn on each figure and compare their answers with the oracle."""
    rows: list[Row] = []
    for name in figures:
        brake = oracle.figure(name)
        truth = oracle.solve(brake, T_END, t_eval=grid())
        entered: dict[str, Contestant] = {}
        for enter, label in ENTRANTS:
            try:
                entered[label] = enter(brake)
            except BaselineUnavailable as reason:
                rows.append(Row(name, label, note=str(reason)))
        timings = interleave({label: c.call for label, c in entered.items()}, rounds=rounds)
        unit = timings[C_AUTOMATON].median if C_AUTOMATON in timings else math.nan
        for label, contestant in entered.items():
            row = Row(name, label, timings[label], timings[label].median / unit)
            rows.append(_judged(row, contestant.answer(), truth))
    return rows


ENTRANTS: tuple[tuple[Callable[[oracle.Brake], Contestant], str], ...] = (
    (c_automaton, C_AUTOMATON),
    (ours, OURS),
    (changed, CHANGED),
    (lambdified, LAMBDIFIED),
    (by_hand, ODEINT),
)


def report(rounds: int, everything: bool) -> Report:
    """Race on the limit cycle, or on all four behaviours of the paper."""
    rows = race(FIGURES if everything else ("fig8",), rounds=rounds)
    started = {row.name: row for row in rows if row.figure == "fig8" and row.timing}
    limits = []
    if OURS in started and C_AUTOMATON in started:
        mine = started[OURS].ratio
        limits.append(Limit(f"{OURS} over {C_AUTOMATON}", mine, 3))
        limits.append(Limit(f"{CHANGED} over {C_AUTOMATON}", started[CHANGED].ratio, 6))
        limits.append(
            Limit(f"{LAMBDIFIED} over {OURS}", started[LAMBDIFIED].ratio / mine, 50, True)
        )
    headings = (
        "contestant",
        "figure",
        "CPU ms",
        "spread",
        "ratio",
        "sticks",
        "to 60 ms",
        "to the end",
    )
    return Report(
        "brake",
        headings,
        [_cells(row) for row in rows if row.timing],
        limits,
        [f"{row.name} did not start: {row.note}" for row in rows if not row.timing],
    )


def _cells(row: Row) -> list[str]:
    assert row.timing is not None
    median, low, high = row.timing
    return [
        row.name,
        row.figure,
        f"{1e3 * median:.3f}",
        f"{(high - low) / median:.0%}",
        f"{row.ratio:.2f}",
        f"{row.sticks} of {row.true_sticks}",
        *(f"{error:.0e}" for error in row.error),
    ]


def _judged(row: Row, answer: Answer, truth: oracle.Run) -> Row:
    span = np.ptp(truth.states, axis=0)
    error = (np.abs(answer.states - truth.states) / span).max(axis=1)
    return replace(
        row,
        sticks=len(answer.stick_times),
        true_sticks=len(truth.stick_times),
        error=(float(error[truth.t <= 0.06].max()), float(error.max())),
    )
