"""The brake race: the framework against a hand-written C automaton and against smoothing.

The paper's limit cycle, 0.5 s at rtol 1e-6 with 5001 times of output. Baselines:

``C automaton``
    brake_automaton.c, gcc -O2 -march=native: about the least this computation can cost.
``LSODA on tanh``
    scipy's LSODA on a plain Python right-hand side with the sign of slip smoothed by
    ``tanh(v / 1e-3)``: what one would write instead. It is slower and, being another model,
    loses the trace; its error is printed beside its time. ``odeint`` reaches LSODA three times
    quicker than ``solve_ivp`` does, so it is the one raced.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint

from ..oracles import brake as oracle
from . import baseline
from .timing import Timing, interleave

Array = NDArray[np.float64]

T_END = 0.5
RTOL = 1e-6
N_OUT = 5001
FIGURES = ("fig6", "fig7", "fig8", "fig9")
SMOOTHING = 1e-3
LIMIT = 6.0
"""Greatest ratio to the C automaton that the framework allows itself on the limit cycle."""

C_AUTOMATON = "C automaton"
LSODA_TANH = "LSODA on tanh"
OURS = "bondgraph"


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


def c_automaton(brake: oracle.Brake) -> Contestant:
    """The hand-written C automaton."""
    parameters = oracle.parameters(brake)

    def answer() -> Answer:
        run = baseline.run(parameters, T_END, rtol=RTOL, n_out=N_OUT)
        return Answer(run.states, run.stick_times)

    return Contestant(C_AUTOMATON, baseline.prepare(parameters, T_END, RTOL, N_OUT), answer)


def lsoda_tanh(brake: oracle.Brake) -> Contestant:
    """scipy's LSODA (through odeint, its quicker door) on friction smoothed by tanh."""
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

    def answer() -> Answer:
        states = run()
        # no event exists here; count the times slip enters the smoothed zone and calls it sticking
        inside = np.abs(r * states[:, 0] - states[:, 1]) < SMOOTHING
        return Answer(states, times[1:][inside[1:] & ~inside[:-1]].tolist())

    return Contestant(LSODA_TANH, run, answer)


def race(figures: Sequence[str] = ("fig8",), *, rounds: int = 9) -> list[Row]:
    """Time all contestants in turn on each figure and compare their answers with the oracle."""
    rows: list[Row] = []
    for name in figures:
        brake = oracle.figure(name)
        truth = oracle.solve(brake, T_END, t_eval=grid())
        entered: dict[str, Contestant] = {}
        for enter, label in ((c_automaton, C_AUTOMATON), (ours, OURS), (lsoda_tanh, LSODA_TANH)):
            try:
                entered[label] = enter(brake)
            except (ImportError, AttributeError, baseline.BaselineUnavailable) as reason:
                rows.append(Row(name, label, note=str(reason)))
        timings = interleave({label: c.call for label, c in entered.items()}, rounds=rounds)
        unit = timings[C_AUTOMATON].median if C_AUTOMATON in timings else math.nan
        for label, contestant in entered.items():
            row = Row(name, label, timings[label], timings[label].median / unit)
            rows.append(_judged(row, contestant.answer(), truth))
    return rows


def _judged(row: Row, answer: Answer, truth: oracle.Run) -> Row:
    span = np.ptp(truth.states, axis=0)
    error = (np.abs(answer.states - truth.states) / span).max(axis=1)
    return replace(
        row,
        sticks=len(answer.stick_times),
        true_sticks=len(truth.stick_times),
        error=(float(error[truth.t <= 0.06].max()), float(error.max())),
    )
