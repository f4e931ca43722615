"""A recording as a frozen value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy

from ...errors import MeasurementError

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Measurement:
    """One recording: columns over common times.

    Parameters
    ----------
    t : (nt,) array-like, s
        Strictly increasing; unequal steps are allowed.
    columns : mapping of str to (nt,) array-like
        By name of the model's inputs and outputs; NaN marks a gap.
    units : mapping of str to str, optional
        Of the columns; a column without one is in the unit of the model.
    holds : mapping of str to str, optional
        What inputs do between samples: ``"zero"``, ``"linear"`` (unless said otherwise) or
        ``"band"``; see `bondgraph.Samples`.
    initial : mapping of str to float, optional
        Initial states known for this recording, as for `bondgraph.simulate`.
    name : str
        For messages and reports.

    Raises
    ------
    MeasurementError
        For times that do not increase, columns of other lengths, no finite value at all.

    Examples
    --------
    >>> run = Measurement([0, 0.1, 0.2], {"v": [0.0, 0.5, float("nan")]}, {"v": "m/s"}, name="run 1")
    >>> len(run), run.present("v").tolist()
    (3, [True, True, False])
    """

    t: Any
    columns: Mapping[str, Any]
    units: Mapping[str, str] = field(default_factory=dict)
    holds: Mapping[str, str] = field(default_factory=dict)
    initial: Mapping[str, float] = field(default_factory=dict)
    name: str = "measurement"

    def __post_init__(self) -> None:
        t = numpy.array(self.t, dtype=float).ravel()
        if len(t) < 2 or not numpy.isfinite(t).all():
            raise MeasurementError(f"{self.name}: a recording needs two finite times or more")
        if (numpy.diff(t) <= 0).any():
            row = int(numpy.argmax(numpy.diff(t) <= 0)) + 1
            raise MeasurementError(
                f"{self.name}: times must increase; they do not at row {row} (t = {t[row]:g} s)"
            )
        columns = {}
        for name, values in self.columns.items():
            column = numpy.array(values, dtype=float).ravel()
            if len(column) != len(t):
                raise MeasurementError(
                    f"{self.name}, column {name!r}: {len(column)} values for {len(t)} times"
                )
            if not numpy.isfinite(column).any():
                raise MeasurementError(f"{self.name}, column {name!r}: no finite value")
            column[~numpy.isfinite(column)] = numpy.nan
            columns[name] = column
        if not columns:
            raise MeasurementError(f"{self.name}: no column beside time")
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "columns", MappingProxyType(columns))

    def __len__(self) -> int:
        return len(self.t)

    def present(self, name: str) -> Array:
        """Return where a column has a value, of shape (nt,)."""
        return ~numpy.isnan(self.columns[name])
