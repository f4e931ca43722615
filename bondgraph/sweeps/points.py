"""Points of a sweep: a full grid, or samples, of named values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy

from ..errors import SweepError

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Points:
    """Where a model is run.

    Attributes
    ----------
    columns : mapping of str to (np,) array
        Values by name, in their unit.
    units : mapping of str to str
        Units of the values; SI where empty.
    dims : tuple of str
        Dimensions of the result: the names of a grid's axes, else ``("point",)``.
    axes : mapping of str to (n,) array
        Coordinates of a grid's dimensions; empty for samples.

    Examples
    --------
    >>> grid(m=[1, 2], k=([1, 2, 3], "N/mm")).shape
    (2, 3)
    """

    columns: Mapping[str, Array]
    units: Mapping[str, str]
    dims: tuple[str, ...] = ("point",)
    axes: Mapping[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.columns or not len(self):
            raise SweepError(
                "a sweep needs at least one point; give names with values, such as grid(V0=[0.8, 1.0])"
            )

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the dimensions."""
        return tuple(len(axis) for axis in self.axes.values()) or (len(self),)


def grid(axes: Mapping[str, Any] | None = None, /, **named: Any) -> Points:
    """Return all combinations of the values of some axes.

    Parameters
    ----------
    axes : mapping of str to array-like or (array-like, str), optional
        For names that are no Python words, such as ``"rear.mass.p"``.
    **named : array-like or (array-like, str)
        Values in SI, or ``(values, unit)``. The last axis varies fastest.

    Returns
    -------
    Points
        With one dimension an axis.

    Raises
    ------
    SweepError
        For an axis without values, or whose values are no numbers.

    Examples
    --------
    >>> grid(V0=[0.8, 1.0], F_k=[600, 900]).columns["F_k"].tolist()
    [600.0, 900.0, 600.0, 900.0]
    """
    given = {str(name): _values(name, value) for name, value in {**(axes or {}), **named}.items()}
    values = {name: column for name, (column, _) in given.items()}
    full = numpy.meshgrid(*values.values(), indexing="ij") if values else []
    return Points(
        {name: mesh.ravel() for name, mesh in zip(values, full, strict=True)},
        {name: unit for name, (_, unit) in given.items()},
        tuple(values),
        values,
    )


def samples(rows: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> Points:
    """Return points that are given one by one.

    Parameters
    ----------
    rows : mapping of str to (np,) array-like, or sequence of mappings
        Columns by name, each as values in SI or ``(values, unit)``; or one
        mapping a point, all with the same names.

    Returns
    -------
    Points
        With the dimension ``point``.

    Raises
    ------
    SweepError
        For columns of different lengths, rows of different names, values that
        are no numbers.

    Examples
    --------
    >>> len(samples({"m": [1, 2, 3], "k": [5, 5, 6]})), len(samples([{"m": 1}, {"m": 2}]))
    (3, 2)
    """
    columns = dict(rows) if isinstance(rows, Mapping) else _transposed(rows)
    given = {str(name): _values(name, value) for name, value in columns.items()}
    lengths = {name: len(column) for name, (column, _) in given.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise SweepError(
            f"the columns of samples differ in length: {told}; give each one value a point"
        )
    return Points(
        {name: column for name, (column, _) in given.items()},
        {name: unit for name, (_, unit) in given.items()},
    )


def as_points(given: Any) -> Points:
    """Return points from any of their accepted forms.

    Examples
    --------
    >>> as_points([{"m": 1.0}, {"m": 2.0}]).columns["m"].tolist()
    [1.0, 2.0]
    """
    if isinstance(given, Points):
        return given
    if isinstance(given, Mapping):
        raise SweepError(
            "points given as a mapping may be a grid or samples; write grid({...}) or samples({...})"
        )
    if isinstance(given, Sequence) and all(isinstance(row, Mapping) for row in given):
        return samples(given)
    raise SweepError(f"points are grid(...), samples(...) or a list of mappings, got {given!r:.80}")


def _values(name: Any, given: Any) -> tuple[Array, str]:
    """Return a column and its unit."""
    values, unit = given, ""
    if isinstance(given, tuple) and len(given) == 2 and isinstance(given[1], str):
        values, unit = given
    try:
        column = numpy.array(values, dtype=float)
    except (TypeError, ValueError):
        raise SweepError(f"values of {str(name)!r} must be numbers, got {values!r:.80}") from None
    if column.ndim > 1:
        raise SweepError(
            f"values of {str(name)!r} must stand in one row, not in shape {column.shape}"
        )
    return column.reshape(-1), unit


def _transposed(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return columns of rows; a name has one unit throughout."""
    names = {str(name): None for row in rows for name in row}
    columns: dict[str, Any] = {}
    for name in names:
        missing = [index for index, row in enumerate(rows) if name not in row]
        if missing:
            raise SweepError(
                f"point {missing[0]} has no {name!r}, which others have; give it to all"
            )
        pairs = [row[name] if isinstance(row[name], tuple) else (row[name], "") for row in rows]
        units = {unit for _, unit in pairs}
        if len(units) > 1:
            raise SweepError(f"{name!r} is given in {len(units)} units; give one unit throughout")
        columns[name] = ([value for value, _ in pairs], units.pop())
    return columns
