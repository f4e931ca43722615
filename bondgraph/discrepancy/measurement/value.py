"""A recording as a frozen value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy

from ...errors import MeasurementError, suggestion

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
    >>> run.between(0.05, 0.2).t.tolist()
    [0.1, 0.2]
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
        return ~numpy.isnan(self.column(name))

    @property
    def start(self) -> float:
        """First time as recorded, s; a segment of a longer recording starts later than zero."""
        return float(self.t[0])

    def column(self, name: str) -> Array:
        """Return a column of shape (nt,).

        Raises
        ------
        MeasurementError
            Where there is none of this name.
        """
        if name not in self.columns:
            hint = suggestion(name, self.columns) or f"it has {', '.join(self.columns)}"
            raise MeasurementError(f"{self.name}: no column {name!r}; {hint}")
        values: Array = self.columns[name]
        return values

    def changed(self, **values: Any) -> Measurement:
        """Return the same recording with other fields, such as ``initial``."""
        return replace(self, **values)

    @classmethod
    def read(
        cls,
        path: str | Path,
        *,
        holds: Mapping[str, str] | None = None,
        rename: Mapping[str, str] | None = None,
        initial: Mapping[str, float] | None = None,
        name: str | None = None,
        units: Mapping[str, str] | None = None,
        time: str = "time",
    ) -> Measurement:
        r"""Read a CSV file with a header ``time [s],name [unit],...``.

        Parameters
        ----------
        path : str or Path
            UTF-8; ``#`` begins a comment line, an empty cell is a gap. Commas, semicolons or tabs
            separate cells, as in the header; decimals have a point.
        holds : mapping of str to str, optional
            What inputs do between samples, by name of the model.
        rename : mapping of str to str, optional
            Name of the model to column of the file, where they differ.
        initial : mapping of str to float, optional
            Initial states known for this recording, SI.
        name : str, optional
            The file's unless given.
        units : mapping of str to str, optional
            Of columns whose header has none, by name of the model.
        time : str
            The column of times, in any unit of time; without a unit in seconds.

        Returns
        -------
        Measurement

        Raises
        ------
        MeasurementError
            Naming file, line and column.

        Examples
        --------
        >>> import tempfile
        >>> path = Path(tempfile.mkdtemp()) / "run.csv"
        >>> _ = path.write_text("time [ms],speed [km/h]\n0,36\n10,\n20,34\n")
        >>> run = Measurement.read(path, rename={"v": "speed"})
        >>> run.t.tolist(), run.columns["v"].tolist(), dict(run.units)
        ([0.0, 0.01, 0.02], [36.0, nan, 34.0], {'v': 'km/h'})
        """
        from .reading import Wanted, read_one

        wanted = Wanted(holds or {}, rename or {}, units or {}, time)
        return read_one(path, wanted, initial or {}, name)

    def write(self, path: str | Path) -> Path:
        """Write a CSV file that `read` reads back to the bit; holds and initial states stay out.

        Raises
        ------
        MeasurementError
            For names that the format cannot hold, and files that cannot be written.
        """
        from .writing import write

        return write(self, path)

    def between(self, t0: float, t1: float) -> Measurement:
        """Return the rows of t0 <= t <= t1, s; known initial states only where t0 is the start's.

        Raises
        ------
        MeasurementError
            Where fewer than two rows are left, or a column has no value there.
        """
        from .windows import between

        return between(self, t0, t1)

    def split(self, fraction: float) -> tuple[Measurement, Measurement]:
        """Cut in two in time, such as for held-out data; see `windows.split`."""
        from .windows import split

        return split(self, fraction)

    def without(self, *names: str) -> Measurement:
        """Return the recording without some columns."""
        from .windows import without

        return without(self, names)
