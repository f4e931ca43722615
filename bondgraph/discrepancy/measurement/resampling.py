"""Fewer or equal steps, with what the new steps cannot show filtered out first."""

from __future__ import annotations

import math

import numpy

from ...errors import MeasurementError
from .sampling import sampling
from .value import Array, Measurement

REACH = 10  # new intervals on either side that the filter looks at
CUT = 0.8  # of the new Nyquist frequency
FAR = 2.5  # old intervals: values farther apart have a gap between them


def decimated(measurement: Measurement, n: int) -> Measurement:
    """Keep every n-th row, after an anti-aliasing filter.

    Parameters
    ----------
    measurement : Measurement
        Uniformly sampled.
    n : int

    Returns
    -------
    Measurement
        Gaps stay gaps. The same filter has gone over all columns, so that linear relations
        between them still hold; jumps are smeared over an interval. Held inputs (``zero``) are no
        steps any more: their hold is ``linear`` now. Known initial states are dropped, since
        the filter looks at what lies before and after.

    Raises
    ------
    MeasurementError
        For unequal steps, too few rows, and n that is no positive whole number.

    Notes
    -----
    A zero-phase windowed sinc (Hamming), reaching ten new intervals to either side: what lies below
    0.6 of the new Nyquist frequency passes within 0.3 per cent, what lies above the Nyquist
    frequency falls below 0.3 per cent. Ends are continued point-symmetrically.

    Examples
    --------
    >>> t = numpy.arange(200) / 100
    >>> slow = decimated(Measurement(t, {"x": 1 + 3 * t}), 4)
    >>> slow.t[:3].round(9).tolist(), slow.columns["x"][:3].round(9).tolist()
    ([0.0, 0.04, 0.08], [1.0, 1.12, 1.24])
    """
    if n != int(n) or n < 1:
        raise MeasurementError(f"{measurement.name}: decimated by {n}, which is no count")
    n = int(n)
    if n == 1:
        return measurement
    if not sampling(measurement).uniform:
        raise MeasurementError(
            f"{measurement.name}: steps are not equal, so it cannot be decimated; resample it first"
        )
    if len(measurement) <= REACH * n:
        raise MeasurementError(
            f"{measurement.name}: {len(measurement)} rows are too few to be decimated by {n}; "
            f"it takes more than {REACH * n}"
        )
    held = {name for name, hold in measurement.holds.items() if hold == "zero"}
    columns = {
        name: _filtered(measurement.t, column, n, name in held)
        for name, column in measurement.columns.items()
    }
    return _changed(measurement, measurement.t[::n], columns)


def resampled(measurement: Measurement, interval: float) -> Measurement:
    """Bring a recording to equal steps, after an anti-aliasing filter where they are coarser.

    Parameters
    ----------
    measurement : Measurement
    interval : float
        The new step, s; times start where the recording does.

    Returns
    -------
    Measurement
        By straight lines between samples, held values where a column's hold is ``zero``; then as
        by `decimated`. Where values are more than two and a half old intervals apart there is a gap.

    Raises
    ------
    MeasurementError
        For an interval that is not positive, or so long that two rows do not fit.

    Examples
    --------
    >>> run = Measurement([0, 1.1, 1.9, 3], {"x": [0, 11, 19, 30]})
    >>> resampled(run, 0.5).columns["x"].round(9).tolist()
    [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0]
    """
    t = measurement.t
    if not (interval > 0 and interval <= t[-1] - t[0]):
        raise MeasurementError(
            f"{measurement.name}: an interval of {interval:g} s does not fit into {t[-1] - t[0]:g} s"
        )
    step = float(numpy.median(numpy.diff(t)))
    n = max(1, math.ceil(interval / step - 1e-9))
    count = math.floor((t[-1] - t[0]) / interval * n + 1e-9) + 1
    grid = numpy.minimum(t[0] + numpy.arange(count) * (interval / n), t[-1])
    columns = {
        name: _onto(grid, t, column, FAR * step, measurement.holds.get(name) == "zero")
        for name, column in measurement.columns.items()
    }
    for name, column in columns.items():
        if numpy.isnan(column).all():
            raise MeasurementError(
                f"{measurement.name}, column {name!r}: its values are too far apart to be resampled"
            )
    fine = measurement.changed(t=grid, columns=columns)
    return decimated(fine, n) if n > 1 else fine


def _onto(grid: Array, t: Array, column: Array, far: float, held: bool) -> Array:
    """Return a column at new times, NaN within gaps."""
    present = ~numpy.isnan(column)
    times, values = t[present], column[present]
    after = numpy.searchsorted(times, grid, side="left").clip(0, len(times) - 1)
    before = (numpy.searchsorted(times, grid, side="right") - 1).clip(0)
    found = values[before] if held else numpy.interp(grid, times, values)
    lost = (times[after] - times[before] > far) | (grid < times[0]) | (grid > times[-1])
    return numpy.where(lost, numpy.nan, found)


def _filtered(t: Array, column: Array, n: int, held: bool) -> Array:
    from scipy.signal import fftconvolve, firwin

    present = ~numpy.isnan(column)
    values = numpy.interp(t, t[present], column[present])
    if held:  # at a step's time stands the mean of both sides, else the signal comes early
        values[1:] = (values[1:] + values[:-1]) / 2
    reach = REACH * n
    before = 2 * values[0] - values[reach:0:-1]
    after = 2 * values[-1] - values[-2 : -reach - 2 : -1]
    longer = numpy.concatenate([before, values, after])
    smooth = fftconvolve(longer, firwin(2 * reach + 1, CUT / n), mode="valid")
    found: Array = numpy.where(present, smooth, numpy.nan)[::n]
    return found


def _changed(measurement: Measurement, t: Array, columns: dict[str, Array]) -> Measurement:
    for name, column in columns.items():
        if numpy.isnan(column).all():
            raise MeasurementError(
                f"{measurement.name}, column {name!r}: no value is left; leave it out with without()"
            )
    holds = {n: "linear" if hold == "zero" else hold for n, hold in measurement.holds.items()}
    return measurement.changed(t=t, columns=columns, holds=holds, initial={})
