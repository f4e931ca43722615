"""Cells as numbers and labels as names with units; what is wrong is told with line and column."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

import numpy

from ...errors import MeasurementError, ParameterError, suggestion
from ...units import check_compatible, parse_unit
from .text import Rows
from .units import scaled

Array = numpy.ndarray

_LABEL = re.compile(r"^(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?$")
_PURE = {"1", "-", ""}


def labels_of(rows: Rows) -> dict[str, str | None]:
    """Return name and unit of each column; None where there is no unit.

    Raises
    ------
    MeasurementError
        For columns without a name, two of one name, units that are none.
    """
    labels: dict[str, str | None] = {}
    for place, cell in enumerate(rows.header, 1):
        match = _LABEL.match(cell)
        if match is None or not match["name"]:
            raise MeasurementError(
                f"{rows.path}, column {place}: {cell!r} is no column's name; write it like 'v [m/s]'"
            )
        name, unit = match["name"], match["unit"]
        if name in labels:
            raise MeasurementError(
                f"{rows.path}: column {name!r} is there twice; names must differ"
            )
        labels[name] = None if unit is None else checked_unit(rows, name, unit)
    return labels


def checked_unit(rows: Rows, name: str, unit: str) -> str:
    """Return a unit that pint knows; "1" for a pure number.

    Raises
    ------
    MeasurementError
        Naming file and column.
    """
    unit = unit.strip()
    if unit in _PURE:
        return "1"
    try:
        parse_unit(unit)
    except ParameterError as error:
        raise MeasurementError(f"{rows.path}, column {name!r}: {error}") from None
    return unit


def times_of(rows: Rows, labels: Mapping[str, str | None], name: str) -> Array:
    """Return the times in seconds, of shape (nt,).

    Raises
    ------
    MeasurementError
        Where there is no such column, it has gaps, or its unit is none of time.
    """
    if name not in labels:
        hint = suggestion(name, labels) or f"its columns are {', '.join(labels)}"
        raise MeasurementError(
            f"{rows.path}: no column {name!r}; {hint}; say which column holds the times with time=..."
        )
    times = numbers_of(rows, labels, name)
    missing = numpy.isnan(times)
    if missing.any():
        line = rows.lines[int(numpy.argmax(missing))]
        raise MeasurementError(f"{rows.path}, line {line}, column {name!r}: a row without a time")
    unit = labels[name] or "s"
    try:
        check_compatible("" if unit == "1" else unit, "s")
    except ParameterError as error:
        raise MeasurementError(f"{rows.path}, column {name!r}: {error}") from None
    return scaled(times, unit)


def numbers_of(rows: Rows, labels: Mapping[str, str | None], name: str) -> Array:
    """Return a column as it stands, NaN where cells are empty, of shape (nt,).

    Raises
    ------
    MeasurementError
        For the first cell that is no finite number.
    """
    place = list(labels).index(name)
    if rows.table is not None:
        column: Array = rows.table[:, place]
        return column
    texts = [row[place] for row in rows.cells]
    try:
        values = numpy.array([float(text) if text else math.nan for text in texts])
    except ValueError:
        values = numpy.array([math.inf])
    # float() also takes "nan", "inf" and "1_000", which are looked at one by one
    if (~numpy.isfinite(values)).sum() == texts.count("") and "_" not in "".join(texts):
        return values
    return numpy.array(
        [_number(rows, row, name, text.strip()) for row, text in enumerate(texts)], dtype=float
    )


def _number(rows: Rows, row: int, name: str, text: str) -> float:
    if not text:
        return math.nan
    where = f"{rows.path}, line {rows.lines[row]}, column {name!r}"
    try:
        value = float(text.replace("_", "?"))
    except ValueError:
        hint = "leave the cell empty for a gap"
        if re.fullmatch(r"[-+]?\d+,\d+([eE][-+]?\d+)?", text):
            hint = f"write {text.replace(',', '.')}, with a decimal point"
        shown = text if len(text) <= 40 else f"{text[:37]}..."
        raise MeasurementError(f"{where}: {shown!r} is no number; {hint}") from None
    if not math.isfinite(value):
        raise MeasurementError(
            f"{where}: {text} is not a finite number; leave the cell empty for a gap"
        )
    return value
