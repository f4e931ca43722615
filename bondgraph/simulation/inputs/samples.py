"""Sampled signals with a declared hold, from arrays and CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy

from ...errors import ParameterError
from ...units import to_si
from .curves import Curve, band_limited

HOLDS = {"zero": 0, "linear": 1, "band": 2}


@dataclass(frozen=True, eq=False)
class Samples:
    """A sampled signal and what it does between samples.

    Attributes
    ----------
    times : (n,) array
        Strictly increasing, s.
    values : (n,) array
        SI units.
    hold : {"linear", "zero", "band"}
        Straight lines, steps at each sample, or the band-limited signal through
        uniform samples (`curves.band_limited` says how near).
        Outside the samples the first and last value hold.
    curve : Curve or None
        Where hold is "band".

    Raises
    ------
    ParameterError
        For times that do not increase, values that are not finite, lengths
        that differ, and for hold "band" times that are not uniform.

    Examples
    --------
    >>> Samples([0, 1], [0, 5]).hold
    'linear'
    """

    times: Any
    values: Any
    hold: str = "linear"
    curve: Curve | None = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        times = numpy.array(self.times, dtype=float).ravel()
        values = numpy.array(self.values, dtype=float).ravel()
        if not times.size or times.size != values.size:
            raise ParameterError(
                f"samples need as many times as values, got {times.size} and {values.size}"
            )
        if not (numpy.isfinite(times).all() and numpy.isfinite(values).all()):
            raise ParameterError(
                "samples hold values that are not finite; remove or interpolate them"
            )
        if (numpy.diff(times) <= 0).any():
            row = int(numpy.argmax(numpy.diff(times) <= 0)) + 1
            raise ParameterError(
                f"sample times must increase; they do not at sample {row} (t = {times[row]:g} s)"
            )
        if self.hold not in HOLDS:
            raise ParameterError(f"hold {self.hold!r} is not known; use {', '.join(HOLDS)}")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)
        if self.hold == "band":
            object.__setattr__(self, "curve", band_limited(times, values))

    @classmethod
    def read(cls, path: str | Path, name: str, unit: str = "", hold: str = "linear") -> Samples:
        """Read one column of a CSV file with a header ``time [s],name [unit],...``.

        Parameters
        ----------
        path : str or Path
            ``#`` lines are comments.
        name : str
            Column to read; the second column if the file has just two.
        unit : str
            Unit the model expects; the column's unit is converted.
        hold : {"linear", "zero", "band"}

        Returns
        -------
        Samples

        Raises
        ------
        ParameterError
            Naming file, line and column.
        """
        rows = _rows(Path(path))
        _, header = next(rows, (0, []))
        if len(header) < 2:
            raise ParameterError(
                f"{path}: the first line must be a header such as 'time [s],{name} [{unit or '1'}]'"
            )
        labels = [_label(cell) for cell in header]
        names = [label for label, _ in labels]
        if name not in names and len(names) != 2:
            raise ParameterError(f"{path}: no column {name!r}; it has {', '.join(names)}")
        column = names.index(name) if name in names else 1
        times, values = [], []
        for line, row in rows:
            if len(row) <= column:
                raise ParameterError(
                    f"{path}, line {line}: {len(row)} cells where the header has {len(header)}"
                )
            if row[column].strip():
                times.append(_number(path, line, row[0]))
                values.append(_number(path, line, row[column]))
        if not times:
            raise ParameterError(f"{path}: no rows with a value for {name!r}")
        scale_t = _scale(path, labels[0], "s")
        scale_v = _scale(path, labels[column], unit)
        return cls([scale_t(time) for time in times], [scale_v(value) for value in values], hold)


def _rows(path: Path) -> Any:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise ParameterError(f"{path}: cannot be read: {error}") from None
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            yield number, next(csv.reader([line]))


def _label(cell: str) -> tuple[str, str | None]:
    name, bracket, unit = cell.partition("[")
    return name.strip(), unit.rstrip("] ") if bracket else None


def _number(path: str | Path, line: int, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise ParameterError(f"{path}, line {line}: {text!r} is no number") from None
    if not math.isfinite(value):
        raise ParameterError(
            f"{path}, line {line}: {text.strip()} is not a finite number; leave the cell empty for a gap"
        )
    return value


def _scale(
    path: str | Path, label: tuple[str, str | None], expected: str
) -> Callable[[float], float]:
    name, unit = label
    if unit is None:
        return float
    try:
        to_si(1.0, unit, expected=expected or None)
    except ParameterError as error:
        raise ParameterError(f"{path}, column {name!r}: {error}") from None
    return lambda value: to_si(value, unit)
