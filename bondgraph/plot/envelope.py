"""Long records as envelopes: what a plot can show of a hundred thousand samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy

Array = numpy.ndarray

BUCKETS = 400  # a panel is about as many points wide


@dataclass(frozen=True, eq=False)
class Envelope:
    """Least and largest values over times.

    Attributes
    ----------
    t : (n,) array, s
    low, high : (n,) arrays
        NaN where no sample has a value; equal where a sample stands for itself.
    whole : bool
        Whether every sample is there.
    """

    t: Array
    low: Array
    high: Array
    whole: bool


def envelope(t: Array, values: Array, buckets: int = BUCKETS) -> Envelope:
    """Return least and largest values in buckets of equally many samples.

    Parameters
    ----------
    t, values : (nt,) arrays
    buckets : int
        A record of no more than three samples a bucket stays as it is.

    Returns
    -------
    Envelope
        Extremes of the record are extremes of the envelope.

    Examples
    --------
    >>> t = numpy.arange(10000) / 1000
    >>> found = envelope(t, numpy.sin(2 * numpy.pi * 50 * t), buckets=5)
    >>> found.t.round(2).tolist(), found.high.round(3).tolist()
    ([1.0, 3.0, 5.0, 7.0, 9.0], [1.0, 1.0, 1.0, 1.0, 1.0])
    """
    t, values = numpy.asarray(t, dtype=float), numpy.asarray(values, dtype=float)
    if len(t) <= 3 * buckets:
        return Envelope(t, values, values, True)
    cuts = numpy.linspace(0, len(t), buckets + 1).astype(int)
    gone = numpy.isnan(values)
    low = numpy.minimum.reduceat(numpy.where(gone, numpy.inf, values), cuts[:-1])
    high = numpy.maximum.reduceat(numpy.where(gone, -numpy.inf, values), cuts[:-1])
    empty = low > high
    low[empty] = high[empty] = numpy.nan
    return Envelope((t[cuts[:-1]] + t[cuts[1:] - 1]) / 2, low, high, False)
