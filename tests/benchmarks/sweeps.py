"""The sweep race: ten thousand runs of the brake over speed and force.

Each point asks for the state at 0.3 s and how often rotor and pads stuck. Contestants:

``C loop``
    brake_automaton.c called from a loop in C, on one core.
``halfarrow, 1 worker``, ``halfarrow, 2 workers``
    `sweep` in one thread and in two.
``scipy``
    What one would write instead, a Python loop over odeint on the smoothed model: timed on a few
    points, for it takes minutes otherwise.

CPU time tells what a run costs a core; the gain of the second worker is in wall time.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..oracles import brake as oracle
from . import baseline, brake
from .native import BaselineUnavailable
from .report import Limit, Report

Array = NDArray[np.float64]

POINTS = 10_000
FEW = 20
T_END = 0.3
RTOL = 1e-6
ROUNDS = 3


def points(count: int = POINTS) -> dict[str, Array]:
    """Speeds and brake forces on a grid, in which runs of every kind lie."""
    side = round(count**0.5)
    speed, force = np.meshgrid(np.linspace(0.4, 1.6, side), np.linspace(300, 1200, side))
    return {"V0": speed.ravel(), "F_k": force.ravel()}


def report(rounds: int, everything: bool) -> Report:
    """Race over all points, three times at most."""
    from bondgraph import CompiledModel
    from bondgraph.models import bicycle_brake
    from bondgraph.sweeps import Count, Final, samples, sweep

    base, where = oracle.parameters(oracle.figure("fig8")), points()
    sets = [base | {"V0": v, "F_k": f} for v, f in zip(*where.values(), strict=True)]
    model = CompiledModel(bicycle_brake.graph())
    asked = (*map(Final, oracle.STATES), Count("friction", "stick"))

    def ours(workers: int) -> Any:
        return sweep(
            model,
            samples(where),
            asked,
            t_span=(0, T_END),
            parameters=base,
            rtol=RTOL,
            workers=workers,
        )

    try:
        _, sticks = baseline.sweep(sets, T_END, RTOL)
    except BaselineUnavailable as reason:
        return Report("sweep", ("contestant",), [], notes=[f"C loop did not start: {reason}"])
    found = ours(1)
    same = np.mean(found["count:friction:stick"].values == sticks)
    times = {
        "C loop": _timed(lambda: baseline.sweep(sets, T_END, RTOL), rounds),
        "halfarrow, 1 worker": _timed(lambda: ours(1), rounds),
        "halfarrow, 2 workers": _timed(lambda: ours(2), rounds),
    }
    few = _timed(lambda: [_smooth(p) for p in sets[:: POINTS // FEW][:FEW]], 2)
    times["scipy"] = few[0] * POINTS / FEW, few[1] * POINTS / FEW
    unit = times["C loop"][0]
    rows = [
        [name, f"{POINTS / cpu:.0f}", f"{POINTS / wall:.0f}", f"{unit / cpu:.0%}"]
        for name, (cpu, wall) in times.items()
    ]
    one, two = times["halfarrow, 1 worker"], times["halfarrow, 2 workers"]
    limits = [
        Limit("1 worker's rate over the C loop's, per core", unit / one[0], 0.4, True),
        Limit("points with the C loop's number of sticks", float(same), 0.99, True),
    ]
    if (os.cpu_count() or 1) > 1:
        limits.append(Limit("2 workers' rate over 1 worker's", one[1] / two[1], 1.8, True))
    return Report("sweep", ("contestant", "points a CPU s", "points a s", "of C"), rows, limits)


def _timed(call: Callable[[], object], rounds: int) -> tuple[float, float]:
    """Median CPU and wall seconds."""
    found = []
    for _ in range(min(rounds, ROUNDS)):
        cpu, wall = time.process_time(), time.perf_counter()
        call()
        found.append((time.process_time() - cpu, time.perf_counter() - wall))
    return statistics.median(c for c, _ in found), statistics.median(w for _, w in found)


def _smooth(parameters: dict[str, float]) -> object:
    return brake.by_hand(oracle.Brake(**parameters)).call()
