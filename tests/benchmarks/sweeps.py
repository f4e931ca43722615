"""The sweep race: ten thousand runs of the brake over speed and force.

Each point asks for the state at 0.3 s and how often rotor and pads stuck. Contestants:

``C loop``, ``C loop, 2 threads``
    brake_automaton.c called from a loop in C, on one core and on two: the gain of the second
    thread is what the machine can give.
``halfarrow, 1 worker``, ``halfarrow, 2 workers``
    `sweep` in one thread and in two.
``halfarrow, 2 strangers``
    Two processes that know nothing of each other, each with one worker and half of the points:
    what the second core can give to this code. Where cores share units on the host, that is less
    than it gives to the C loop, which mostly waits for its own last result.
``scipy``
    What one would write instead, a Python loop over odeint on the smoothed model: timed on a few
    points, for it takes minutes otherwise.

CPU time tells what a run costs a core; the gain of the second worker is in wall time.
"""

from __future__ import annotations

import math
import os
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
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
ROUNDS = 5


def points(count: int = POINTS) -> dict[str, Array]:
    """Speeds and brake forces on a grid, in which runs of every kind lie."""
    side = round(count**0.5)
    speed, force = np.meshgrid(np.linspace(0.4, 1.6, side), np.linspace(300, 1200, side))
    return {"V0": speed.ravel(), "F_k": force.ravel()}


def report(rounds: int, everything: bool) -> Report:
    """Race over all points, three times at most."""
    base, where = oracle.parameters(oracle.figure("fig8")), points()
    sets = [base | {"V0": v, "F_k": f} for v, f in zip(*where.values(), strict=True)]
    ours = _prepared(slice(None))
    try:
        _, sticks = baseline.sweep(sets, T_END, RTOL)
    except BaselineUnavailable as reason:
        return Report("sweep", ("contestant",), [], notes=[f"C loop did not start: {reason}"])
    found = ours(1)
    same = np.mean(found["count:friction:stick"].values == sticks)
    calls: dict[str, Callable[[], object]] = {
        "C loop": lambda: baseline.sweep(sets, T_END, RTOL),
        "C loop, 2 threads": lambda: _in_two(sets),
        "halfarrow, 1 worker": lambda: ours(1),
        "halfarrow, 2 workers": lambda: ours(2),
    }
    with _Strangers() as strangers:
        calls["halfarrow, 2 strangers"] = strangers.run
        times = _interleaved(calls, rounds)
    times["halfarrow, 2 strangers"] = math.nan, times["halfarrow, 2 strangers"][1]
    few = _interleaved({"scipy": lambda: [_smooth(p) for p in sets[:: POINTS // FEW][:FEW]]}, 3)
    times["scipy"] = tuple(value * POINTS / FEW for value in few["scipy"])  # type: ignore[assignment]
    unit = times["C loop"][0]
    rows = [
        [name, *(_cell(POINTS / x, "{:.0f}") for x in (cpu, wall)), _cell(unit / cpu, "{:.0%}")]
        for name, (cpu, wall) in times.items()
    ]
    one, two = times["halfarrow, 1 worker"], times["halfarrow, 2 workers"]
    apart = times["halfarrow, 2 strangers"]
    limits = [
        Limit("1 worker's rate over the C loop's, per core", unit / one[0], 0.4, True),
        Limit("points with the C loop's number of sticks", float(same), 0.99, True),
    ]
    if (os.cpu_count() or 1) > 1:
        limits.append(Limit("2 workers' rate over 1 worker's", one[1] / two[1], 1.8, True))
        limits.append(Limit("2 workers' rate over 2 strangers'", apart[1] / two[1], 0.9, True))
    return Report("sweep", ("contestant", "points a CPU s", "points a s", "of C"), rows, limits)


def _cell(value: float, form: str) -> str:
    return "" if math.isnan(value) else form.format(value)


def _prepared(part: slice) -> Callable[[int], Any]:
    """The sweep over a part of the points, ready to run with some workers."""
    from bondgraph import CompiledModel
    from bondgraph.models import bicycle_brake
    from bondgraph.sweeps import Count, Final, samples, sweep

    model = CompiledModel(bicycle_brake.graph())
    model.compile()
    asked = (*map(Final, oracle.STATES), Count("friction", "stick"))
    where = samples({name: column[part] for name, column in points().items()})
    base = oracle.parameters(oracle.figure("fig8"))

    def run(workers: int) -> Any:
        return sweep(
            model, where, asked, t_span=(0, T_END), parameters=base, rtol=RTOL, workers=workers
        )

    return run


class _Strangers:
    """Two processes that each do half of the points whenever they are told."""

    def __enter__(self) -> _Strangers:
        root = Path(__file__).parents[2]
        command = [sys.executable, "-m", __name__]
        self.processes = [
            subprocess.Popen(
                [*command, str(part)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                cwd=root,
            )
            for part in range(2)
        ]
        self.run()  # imports, the model, and the first run, which is not believed
        return self

    def run(self) -> None:
        """Tell both to begin, and wait for both."""
        for process in self.processes:
            assert process.stdin is not None
            process.stdin.write("go\n")
            process.stdin.flush()
        for process in self.processes:
            assert process.stdout is not None
            if process.stdout.readline() != "done\n":
                raise RuntimeError("a process of the sweep race has ended")

    def __exit__(self, *_: object) -> None:
        for process in self.processes:
            process.kill()
            process.wait()


def _stranger(part: int) -> None:
    run = _prepared(slice(part, None, 2))
    for _ in sys.stdin:
        run(1)
        print("done", flush=True)


def _interleaved(
    calls: dict[str, Callable[[], object]], rounds: int
) -> dict[str, tuple[float, float]]:
    """Median CPU and wall seconds; each round times every call once, in turn."""
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
    for _ in range(min(rounds, ROUNDS)):
        for name, call in calls.items():
            cpu, wall = time.process_time(), time.perf_counter()
            call()
            found[name].append((time.process_time() - cpu, time.perf_counter() - wall))
    return {
        name: (statistics.median(c for c, _ in each), statistics.median(w for _, w in each))
        for name, each in found.items()
    }


def _in_two(sets: list[dict[str, float]]) -> None:
    work = [
        threading.Thread(target=baseline.sweep, args=(sets[part::2], T_END, RTOL))
        for part in range(2)
    ]
    for thread in work:
        thread.start()
    for thread in work:
        thread.join()


def _smooth(parameters: dict[str, float]) -> object:
    return brake.by_hand(oracle.Brake(**parameters)).call()


if __name__ == "__main__":
    _stranger(int(sys.argv[1]))
