"""Interleaved CPU timing: each round times every contestant once, in turn."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple


class Timing(NamedTuple):
    """CPU seconds of one call: median over the rounds, and the quartiles about it."""

    median: float
    low: float
    high: float


def interleave(
    contestants: Mapping[str, Callable[[], object]], *, rounds: int = 9, batch: float = 0.03
) -> dict[str, Timing]:
    """CPU time per call of each contestant, all threads of the process counted.

    Parameters
    ----------
    contestants : callables by name
    rounds : how often each is timed; A/B/A/B, so that a drifting clock speed meets all alike
    batch : CPU time a round spends on each, s, at least one call

    Returns
    -------
    timings : per contestant
    """
    repeats = {name: _repeats(call, batch) for name, call in contestants.items()}
    seconds: dict[str, list[float]] = {name: [] for name in contestants}
    collecting = gc.isenabled()
    gc.disable()
    try:
        for _ in range(rounds):
            for name, call in contestants.items():
                seconds[name].append(_seconds(call, repeats[name]))
            gc.collect()
    finally:
        if collecting:
            gc.enable()
    return {name: _summary(values) for name, values in seconds.items()}


def _seconds(call: Callable[[], object], repeats: int) -> float:
    start = time.process_time()
    for _ in range(repeats):
        call()
    return (time.process_time() - start) / repeats


def _repeats(call: Callable[[], object], batch: float) -> int:
    # the first call warms caches and is not believed
    call()
    return max(1, round(batch / max(_seconds(call, 1), 1e-6)))


def _summary(values: list[float]) -> Timing:
    low, median, high = statistics.quantiles(values, n=4, method="inclusive")
    return Timing(median, low, high)
