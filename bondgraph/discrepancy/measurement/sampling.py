"""How a recording was sampled: interval, jitter, gaps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy

from .value import Array, Measurement

UNIFORM = 1e-3  # of an interval: what rounded times may be off, as for band-limited inputs
LONG = 1.5  # intervals: a longer step is a gap


@dataclass(frozen=True)
class Sampling:
    """Facts about the times of a recording.

    Attributes
    ----------
    interval : float
        Median step, s.
    jitter : float
        Largest step off the interval, of those that are no gaps, in intervals.
    gaps : tuple of (float, float)
        Times before and after steps longer than one and a half intervals, s.
    uniform : bool
        Whether all steps are the interval to a thousandth, but for rounding.
    """

    interval: float
    jitter: float
    gaps: tuple[tuple[float, float], ...]
    uniform: bool


def sampling(measurement: Measurement) -> Sampling:
    """Look at the times of a recording.

    Examples
    --------
    >>> found = sampling(Measurement([0, 1, 2, 3, 7], {"x": [1, 1, 1, 1, 1]}))
    >>> found.interval, found.gaps, found.uniform
    (1.0, ((3.0, 7.0),), False)
    """
    steps = numpy.diff(measurement.t)
    interval = float(numpy.median(steps))
    long = steps > LONG * interval
    off = numpy.abs(steps[~long] / interval - 1)
    jitter = float(off.max()) if off.size else 0.0
    return Sampling(
        interval=interval,
        jitter=jitter,
        gaps=_pairs(measurement.t, numpy.flatnonzero(long)),
        uniform=not long.any() and jitter <= UNIFORM,
    )


def gaps(measurement: Measurement, name: str) -> tuple[tuple[float, float], ...]:
    """Return where a column has nothing to say.

    Returns
    -------
    tuple of (float, float)
        Times of the last value before and the first after, s, for steps longer than one and a
        half intervals of the recording; the recording's own end where no value follows.

    Examples
    --------
    >>> gaps(Measurement([0, 1, 2, 3], {"x": [1, float("nan"), 2, float("nan")]}), "x")
    ((0.0, 2.0), (2.0, 3.0))
    """
    present = measurement.present(name)
    t = measurement.t
    known = numpy.unique(numpy.concatenate([t[:1], t[present], t[-1:]]))
    interval = float(numpy.median(numpy.diff(t)))
    found = _pairs(known, numpy.flatnonzero(numpy.diff(known) > LONG * interval))
    ends = {
        (known[i], known[i + 1]) for i, end in ((0, 0), (len(known) - 2, -1)) if not present[end]
    }
    return tuple(sorted({*found, *((float(a), float(b)) for a, b in ends)}))


def _pairs(times: Array, places: Array) -> tuple[tuple[float, float], ...]:
    return tuple((float(times[i]), float(times[i + 1])) for i in places)
