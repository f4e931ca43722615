"""A campaign of random graphs: each named by its seed, timed, and counted by what came of it."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial

from .draws import Menu, draw, labels
from .plans import Plan
from .shrink import shrunken

# A graph that takes longer is a failure. CPU time, so that a busy machine changes nothing.
LIMIT = 10.0
SEED = 20240607


class TooLongError(AssertionError):
    """A graph took more than `LIMIT`."""


def _alarm(*_: object) -> None:
    raise TooLongError(f"not done after {LIMIT:g} s of CPU time")


@contextlib.contextmanager
def watchdog() -> Iterator[None]:
    """Raise in the midst of what takes longer than `LIMIT`."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(
        signal, "setitimer"
    ):
        yield
        return
    before = signal.signal(signal.SIGVTALRM, _alarm)
    signal.setitimer(signal.ITIMER_VIRTUAL, LIMIT)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def base_seed() -> int:
    """Return the seed of the run: fixed, or new ones where the tests are told to explore."""
    if os.environ.get("HYPOTHESIS_PROFILE") == "explore":
        return random.SystemRandom().randrange(10**9)
    return int(os.environ.get("RANDOM_GRAPHS_SEED", SEED))


class Tally:
    """Counts of what came of each graph."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.slowest = 0.0

    def __getitem__(self, label: str) -> int:
        return self.counts[label]

    def __str__(self) -> str:
        told = ", ".join(f"{label} {count}" for label, count in sorted(self.counts.items()))
        return f"{told}; slowest {self.slowest:.2f} s"


def _alike(
    check: Callable[[Plan, int], list[str]], seed: int, first: Exception, plan: Plan
) -> bool:
    """Whether a plan fails as the first one did, by the kind of its error and how that begins."""
    try:
        with watchdog():
            check(plan, seed)
    except Exception as error:
        return type(error) is type(first) and str(error)[:12] == str(first)[:12]
    return False


def campaign(name: str, menu: Menu, count: int, check: Callable[[Plan, int], list[str]]) -> Tally:
    """Draw so many plans and check each.

    Parameters
    ----------
    name : str
        Names the campaign, and makes its seeds its own.
    menu : Menu
    count : int
    check : callable
        Takes a plan and a seed, gives labels to count by.

    Returns
    -------
    Tally
        Printed as well: pytest shows it where a test fails.
    """
    base, tally = base_seed(), Tally()
    for index in range(count):
        seed = f"{name}-{base}-{index}"
        plan = draw(random.Random(seed), menu)
        begin = time.process_time()
        try:
            with watchdog():
                found = check(plan, index)
        except Exception as error:
            small = shrunken(plan, partial(_alike, check, index, error))
            raise AssertionError(f"random graph {seed!r}: {error!r}\n{small}") from error
        taken = time.process_time() - begin
        assert taken <= LIMIT, f"random graph {seed!r} took {taken:.1f} s\n{plan}"
        tally.slowest = max(tally.slowest, taken)
        tally.counts.update(["graphs", *labels(plan), *found])
    print(f"{name} (seed {base}): {tally}")
    return tally
