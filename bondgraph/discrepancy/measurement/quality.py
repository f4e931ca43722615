"""What a sensor did to a column: limits, steps, outliers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy
from numpy.lib.stride_tricks import sliding_window_view

from ...errors import MeasurementError
from .value import Array, Measurement

LEAST_RUN = 3  # equal extreme values in a row that count as a run
NORMAL = 1.4826  # standard deviation of a normal distribution over its median absolute deviation
OFF_GRID = 0.1  # of a quantisation step: what values may lie off its multiples, as when rounded


@dataclass(frozen=True)
class Limit:
    """Runs of exactly equal extreme values.

    Attributes
    ----------
    level : float
        In the unit of the column.
    fraction : float
        Of the values that are there.
    longest : int
        Samples of the longest run.
    """

    level: float
    fraction: float
    longest: int


def saturation(measurement: Measurement, name: str) -> tuple[Limit | None, Limit | None]:
    """Look for runs of three and more equal values at the bottom and at the top of a column.

    Parameters
    ----------
    measurement : Measurement
    name : str

    Returns
    -------
    lowest, highest : Limit or None
        None where the extreme value comes in no run, and for a column that never changes. A system
        at rest at its extreme and coarse quantisation make runs too; see `quantisation`.

    Examples
    --------
    >>> saturation(Measurement(range(6), {"x": [0, 2, 5, 5, 5, 1]}), "x")
    (None, Limit(level=5.0, fraction=0.5, longest=3))
    """
    values = measurement.column(name)[measurement.present(name)]
    low, high = float(values.min()), float(values.max())
    if low == high:
        return None, None
    return _limit(values, low), _limit(values, high)


def _limit(values: Array, level: float) -> Limit | None:
    edges = numpy.diff(numpy.concatenate([[0], values == level, [0]]).astype(int))
    runs = numpy.flatnonzero(edges < 0) - numpy.flatnonzero(edges > 0)
    runs = runs[runs >= LEAST_RUN]
    if not runs.size:
        return None
    return Limit(level, float(runs.sum() / len(values)), int(runs.max()))


def quantisation(measurement: Measurement, name: str) -> float | None:
    """Return the step of which all differences between values are multiples.

    Parameters
    ----------
    measurement : Measurement
    name : str

    Returns
    -------
    float or None
        In the unit of the column; of a converter, or of the digits in the file. None where values
        lie on no grid, or are too few to tell (fewer than three levels, or no level met twice).

    Examples
    --------
    >>> quantisation(Measurement(range(5), {"x": [0.5, 0.0, 1.5, 1.0, 0.5]}), "x")
    0.5
    """
    values = measurement.column(name)[measurement.present(name)]
    levels = numpy.unique(values)
    # one level may be met as two floats
    close = numpy.diff(levels) > 1e-9 * numpy.abs(levels).max()
    levels = levels[numpy.concatenate([[True], close])]
    if not 3 <= len(levels) < len(values):
        return None
    steps = numpy.diff(levels)
    counts = numpy.round(steps / steps.min())
    step = float(steps.sum() / counts.sum())
    return step if (numpy.abs(steps - counts * step) <= OFF_GRID * step).all() else None


def outliers(
    measurement: Measurement, name: str, *, half: int = 5, threshold: float = 5.0
) -> Array:
    """Mark values far from the median of their neighbours; a Hampel test [1]_.

    Parameters
    ----------
    measurement : Measurement
    name : str
    half : int
        Neighbours on either side.
    threshold : float
        In robust standard deviations: the larger one of the neighbourhood's own and of what
        all values lie off their medians.

    Returns
    -------
    (nt,) array of bool
        Nothing is removed. Gaps are no outliers. Where the signal itself moves by more than an
        outlier's height within the neighbourhood, it is not seen.

    Raises
    ------
    MeasurementError
        For no neighbours, or a threshold that is not positive.

    References
    ----------
    .. [1] R. K. Pearson, Outliers in process modeling and identification, IEEE Trans. Control
       Systems Technology 10 (2002) 55-63.

    Examples
    --------
    >>> outliers(Measurement(range(7), {"x": [1, 2, 3, 90, 5, 6, 7]}), "x", half=2).nonzero()[0]
    array([3])
    """
    if half < 1 or not threshold > 0:
        raise MeasurementError(
            f"{measurement.name}, column {name!r}: an outlier test needs neighbours and a threshold > 0"
        )
    present = measurement.present(name)
    values = measurement.column(name)[present]
    around = sliding_window_view(numpy.pad(values, half, constant_values=numpy.nan), 2 * half + 1)
    middle = numpy.nanmedian(around, axis=1)
    own = NORMAL * numpy.nanmedian(numpy.abs(around - middle[:, None]), axis=1)
    off = numpy.abs(values - middle)
    common = NORMAL * float(numpy.median(off))
    least = (quantisation(measurement, name) or 0.0) / 2  # a step of a resting signal is none
    found = numpy.zeros(len(measurement), dtype=bool)
    found[present] = off > threshold * numpy.maximum(numpy.maximum(own, common), least)
    return found
