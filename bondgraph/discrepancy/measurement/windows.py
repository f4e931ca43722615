"""Parts of a recording: windows in time, held-out ends, fewer columns."""

from __future__ import annotations

from collections.abc import Iterable

import numpy

from ...errors import MeasurementError
from .value import Array, Measurement


def between(measurement: Measurement, t0: float, t1: float) -> Measurement:
    """Return the rows of t0 <= t <= t1; see `Measurement.between`.

    Examples
    --------
    >>> run = Measurement([0, 1, 2], {"x": [5, 6, 7]}, initial={"m.p": 0.0})
    >>> dict(between(run, 0, 1).initial), dict(between(run, 1, 2).initial)
    ({'m.p': 0.0}, {})
    """
    if not t0 < t1:
        raise MeasurementError(f"{measurement.name}: the window {t0:g} s to {t1:g} s is empty")
    return _rows(measurement, (measurement.t >= t0) & (measurement.t <= t1), f"{t0:g} to {t1:g} s")


def split(measurement: Measurement, fraction: float) -> tuple[Measurement, Measurement]:
    """Cut a recording in two in time.

    Parameters
    ----------
    measurement : Measurement
    fraction : float
        Of the time span that goes to the first part, between 0 and 1.

    Returns
    -------
    tuple of Measurement
        First and second part, with no row in common. The second keeps no initial states: what
        they were at its start is not known.

    Raises
    ------
    MeasurementError
        For another fraction, and where a part has fewer than two rows or a column without values.

    Examples
    --------
    >>> first, second = split(Measurement([0, 1, 2, 3], {"x": [5, 6, 7, 8]}), 0.5)
    >>> first.t.tolist(), second.t.tolist()
    ([0.0, 1.0], [2.0, 3.0])
    """
    if not 0 < fraction < 1:
        raise MeasurementError(
            f"{measurement.name}: a recording is split at a fraction between 0 and 1, not {fraction}"
        )
    t = measurement.t
    early = t <= t[0] + fraction * (t[-1] - t[0])
    return (
        _rows(measurement, early, f"the first {fraction:.3g}"),
        _rows(measurement, ~early, f"the last {1 - fraction:.3g}"),
    )


def without(measurement: Measurement, names: Iterable[str]) -> Measurement:
    """Return a recording without some columns; see `Measurement.without`."""
    out = set(names)
    for name in out:
        measurement.column(name)
    kept = {name: column for name, column in measurement.columns.items() if name not in out}
    if not kept:
        raise MeasurementError(f"{measurement.name}: no column would be left")
    return measurement.changed(
        columns=kept,
        units={name: unit for name, unit in measurement.units.items() if name in kept},
        holds={name: hold for name, hold in measurement.holds.items() if name in kept},
    )


def _rows(measurement: Measurement, mask: Array, part: str) -> Measurement:
    count = int(mask.sum())
    if count < 2:
        raise MeasurementError(
            f"{measurement.name}: {part} holds {count} row{'s' * (count != 1)}; a recording needs two"
        )
    columns = {name: column[mask] for name, column in measurement.columns.items()}
    for name, column in columns.items():
        if numpy.isnan(column).all():
            raise MeasurementError(
                f"{measurement.name}, column {name!r}: no value in {part}; leave it out with without()"
            )
    same_start = bool(mask[0])
    return measurement.changed(
        t=measurement.t[mask],
        columns=columns,
        initial=dict(measurement.initial) if same_start else {},
    )
