"""How far a sweep is, told to whoever asked."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """How far a sweep is.

    Attributes
    ----------
    done, total : int
        Points.
    failed : int
        Points done that have no values.
    resumed : int
        Points done that were found on disk.
    seconds : float
        Since the sweep began.
    rate : float
        Points computed a second; 0 before the first.
    left : float or None
        Seconds to go at this rate; None before the first.

    Examples
    --------
    >>> Progress(10, 100, 0, 0, 2.0).rate, Progress(10, 100, 0, 0, 2.0).left
    (5.0, 18.0)
    """

    done: int
    total: int
    failed: int
    resumed: int
    seconds: float

    @property
    def rate(self) -> float:
        """Points computed a second."""
        computed = self.done - self.resumed
        return computed / self.seconds if computed and self.seconds > 0 else 0.0

    @property
    def left(self) -> float | None:
        """Seconds to go."""
        return (self.total - self.done) / self.rate if self.rate else None


class Teller:
    """Counts points and tells a listener.

    Parameters
    ----------
    listener : callable or None
        Takes a `Progress`.
    total : int
    """

    def __init__(self, listener: Callable[[Progress], object] | None, total: int) -> None:
        self._listener, self._total = listener, total
        self._begun = time.monotonic()
        self._done = self._failed = self._resumed = 0

    def add(self, done: int, failed: int, *, resumed: bool = False) -> None:
        """Count points and tell."""
        self._done += done
        self._failed += failed
        self._resumed += done if resumed else 0
        if self._listener is not None:
            self._listener(self.now())

    def now(self) -> Progress:
        """Return how far it is."""
        seconds = time.monotonic() - self._begun
        return Progress(self._done, self._total, self._failed, self._resumed, seconds)
