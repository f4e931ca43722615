"""Evenly spaced samples for spectra, from recordings that have gaps or jitter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ...errors import MeasurementError

Array = numpy.ndarray

JITTER = 1e-6
MOST_MISSING = 0.05
LONGEST_HOLE = 8  # steps: what a straight line is drawn across


@dataclass(frozen=True, eq=False)
class Evenly:
    """Columns on an even grid.

    Attributes
    ----------
    t : (nt,) array
        s.
    columns : (m, nt) array
    treatment : str
        What was done to get there, in words; empty where nothing was.
    """

    t: Array
    columns: Array
    treatment: str


def evenly(t: Any, columns: Any, name: str = "signal") -> Evenly:
    """Put columns on an even grid by straight lines, or refuse.

    Straight lines damp what is fast: by half at half the sampling frequency. Up to a twentieth of
    the samples may be missing, in holes of up to 8 steps; steps may differ up to twice their mean.

    Parameters
    ----------
    t : (nt,) array-like, s
    columns : (m, nt) array-like
        NaN where a value is missing.
    name : str
        For messages.

    Returns
    -------
    Evenly

    Raises
    ------
    MeasurementError
        For holes that are too long or too many, and steps that differ too much.

    Examples
    --------
    >>> found = evenly([0, 1, 2, 3.5, 4], [[0, 1, float("nan"), 3.5, 4]] * 2, "v")
    Traceback (most recent call last):
    ...
    bondgraph.errors.MeasurementError: v: 20 % of the samples are missing, 5 % may be; cut ...
    """
    t, columns = numpy.asarray(t, dtype=float), numpy.atleast_2d(numpy.asarray(columns, float))
    good = numpy.isfinite(columns)
    missing = 1 - float(good.mean(axis=1).min())
    if missing > MOST_MISSING:
        raise MeasurementError(
            f"{name}: {100 * missing:.3g} % of the samples are missing, "
            f"{100 * MOST_MISSING:g} % may be; cut the recording to where it is whole"
        )
    spacing = (t[-1] - t[0]) / (len(t) - 1)
    steps = numpy.diff(t)
    even = bool(numpy.abs(steps - spacing).max() <= JITTER * spacing)
    if not even and steps.max() > 2 * spacing:
        place = int(numpy.argmax(steps))
        raise MeasurementError(
            f"{name}: a step of {steps[place]:g} s at t = {t[place]:g} s, their mean is "
            f"{spacing:g} s; resample the recording, or cut it there"
        )
    for row in good:
        whole = t[row]
        holes = numpy.diff(numpy.concatenate([t[:1], whole, t[-1:]]))
        if holes.max() > (LONGEST_HOLE + 1) * spacing:
            raise MeasurementError(
                f"{name}: a hole of {holes.max():g} s; {LONGEST_HOLE * spacing:g} s may be bridged: "
                "cut the recording there"
            )
    said = []
    if missing > 0:
        said.append(f"{100 * missing:.2g} % missing samples bridged by straight lines")
    if not even:
        said.append("interpolated linearly onto even steps")
    grid = t if even else numpy.linspace(t[0], t[-1], len(t))
    if said:
        columns = numpy.array(
            [numpy.interp(grid, t[row], c[row]) for row, c in zip(good, columns, strict=True)]
        )
    return Evenly(grid, columns, "; ".join(said))
