"""CSV files as recordings: one a file, one a segment, or all of a folder."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy

from ...errors import MeasurementError, suggestion
from ...simulation.inputs import HOLDS
from .cells import checked_unit, labels_of, numbers_of, times_of
from .text import Rows, rows_of
from .value import Measurement

Array = numpy.ndarray

Paths = str | Path | Iterable[str | Path]


@dataclass(frozen=True)
class Wanted:
    """What is said about files beside what stands in them; see `read_all` for each."""

    holds: Mapping[str, str] = field(default_factory=dict)
    rename: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    time: str = "time"
    segment: tuple[str, ...] = ()


def read_all(
    paths: Paths,
    *,
    segment: str | Sequence[str] = (),
    holds: Mapping[str, str] | None = None,
    rename: Mapping[str, str] | None = None,
    initial: Mapping[str, Mapping[str, float]] | None = None,
    units: Mapping[str, str] | None = None,
    time: str = "time",
) -> tuple[Measurement, ...]:
    r"""Read several recordings, each with its own inputs and initial states.

    Parameters
    ----------
    paths : path or iterable of paths
        CSV files, and folders, whose ``*.csv`` are read in the order of their names.
    segment : str or sequence of str
        Columns whose text says which recording a row belongs to, where a file holds several.
    holds, rename, units, time
        As for `Measurement.read`; the same for all.
    initial : mapping of str to mapping, optional
        Initial states by the recording's name: the file's, with ``:segment`` where it has some.

    Returns
    -------
    tuple of Measurement
        Times are as recorded: a segment starts where it started in the file (`Measurement.start`).

    Raises
    ------
    MeasurementError
        Naming file, line and column.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> text = "drop,time [ms],x [mm]\na,0,5\na,10,4\nb,20,5\nb,30,3\n"
    >>> _ = (folder / "drops.csv").write_text(text)
    >>> [(run.name, run.start) for run in read_all(folder, segment="drop")]
    [('drops.csv:a', 0.0), ('drops.csv:b', 0.02)]
    """
    names = (segment,) if isinstance(segment, str) else tuple(segment)
    wanted = Wanted(holds or {}, rename or {}, units or {}, time, names)
    runs: list[tuple[str, Measurement]] = []
    for path in _files(paths):
        rows = rows_of(path, as_text=bool(names))
        runs += [
            (label, _measurement(part, wanted, label, {}))
            for label, part in _segments(rows, wanted.segment)
        ]
    given = dict(initial or {})
    labels = [label for label, _ in runs]
    for name in given:
        if name not in labels:
            hint = suggestion(name, labels) or f"there are {', '.join(labels)}"
            raise MeasurementError(f"initial states of {name!r}: no such recording; {hint}")
    return tuple(
        run.changed(initial=dict(given[label])) if label in given else run for label, run in runs
    )


def read_one(
    path: str | Path, wanted: Wanted, initial: Mapping[str, float], name: str | None
) -> Measurement:
    """Read a file that holds one recording; see `Measurement.read`."""
    rows = rows_of(path)
    return _measurement(rows, wanted, Path(path).name if name is None else name, initial)


def _files(paths: Paths) -> list[Path]:
    found: list[Path] = []
    for path in [paths] if isinstance(paths, (str, Path)) else list(paths):
        path = Path(path)
        if path.is_dir():
            inside = sorted(path.glob("*.csv"))
            if not inside:
                raise MeasurementError(f"{path}: the folder holds no .csv file")
            found += inside
        else:
            found.append(path)
    if not found:
        raise MeasurementError("no file to read was given")
    return found


def _segments(rows: Rows, columns: tuple[str, ...]) -> list[tuple[str, Rows]]:
    """Sort rows by what stands in some columns, which are then left out."""
    if not columns:
        return [(rows.path.name, rows)]
    for name in columns:
        if name not in rows.header:
            hint = suggestion(name, rows.header) or f"its columns are {', '.join(rows.header)}"
            raise MeasurementError(f"{rows.path}: no column {name!r} to tell segments by; {hint}")
    keys = [rows.header.index(name) for name in columns]
    keep = [place for place in range(len(rows.header)) if place not in keys]
    members: dict[str, list[int]] = {}
    for index, row in enumerate(rows.cells):
        label = ":".join(row[place].strip() for place in keys)
        members.setdefault(label, []).append(index)
    return [
        (
            f"{rows.path.name}:{label}",
            Rows(
                rows.path,
                tuple(rows.header[place] for place in keep),
                [rows.lines[index] for index in indices],
                [[rows.cells[index][place] for place in keep] for index in indices],
            ),
        )
        for label, indices in members.items()
    ]


def _measurement(
    rows: Rows, wanted: Wanted, name: str, initial: Mapping[str, float]
) -> Measurement:
    labels = labels_of(rows)
    t = times_of(rows, labels, wanted.time)
    _check_order(rows, t, wanted.time)
    called = _renamed(rows, [label for label in labels if label != wanted.time], wanted.rename)
    _check_known(rows, "hold", wanted.holds, called.values())
    _check_known(rows, "unit", wanted.units, called.values())
    for column, hold in wanted.holds.items():
        if hold not in HOLDS:
            raise MeasurementError(
                f"{rows.path}, column {column!r}: hold {hold!r} is not known; use {', '.join(HOLDS)}"
            )
    columns, units = {}, {}
    for label, column in called.items():
        values = numbers_of(rows, labels, label)
        if numpy.isnan(values).all():
            raise MeasurementError(f"{rows.path}, column {label!r}: no value in any row of {name}")
        columns[column] = values
        unit = _unit(rows, label, labels[label], wanted.units.get(column))
        if unit is not None:
            units[column] = unit
    if not columns:
        raise MeasurementError(f"{rows.path}: no column beside time")
    if len(t) < 2:
        raise MeasurementError(
            f"{rows.path}, line {rows.lines[0]}: {name} has one row; a recording needs two or more"
        )
    return Measurement(t, columns, units, dict(wanted.holds), dict(initial), name)


def _unit(rows: Rows, label: str, own: str | None, told: str | None) -> str | None:
    """Return a column's unit, from the file or from outside, but not two."""
    if told is None:
        return own
    told = checked_unit(rows, label, told)
    if own is not None and own != told:
        raise MeasurementError(
            f"{rows.path}, column {label!r}: is in {own}, but units= says {told}; leave one out"
        )
    return told


def _check_order(rows: Rows, t: Array, name: str) -> None:
    steps = numpy.diff(t)
    if (steps <= 0).any():
        row = int(numpy.argmax(steps <= 0)) + 1
        how = "stands still" if steps[row - 1] == 0 else "runs backwards"
        raise MeasurementError(
            f"{rows.path}, line {rows.lines[row]}, column {name!r}: time {how} "
            f"({t[row - 1]:.9g} s, then {t[row]:.9g} s); several recordings in one file are told "
            "apart with segment=..."
        )


def _renamed(rows: Rows, labels: list[str], rename: Mapping[str, str]) -> dict[str, str]:
    """Return the name that each column goes by."""
    called = {label: label for label in labels}
    for name, label in rename.items():
        if label not in called:
            hint = suggestion(label, labels) or f"its columns are {', '.join(labels)}"
            raise MeasurementError(f"{rows.path}: no column {label!r} to take as {name!r}; {hint}")
        if called[label] != label:
            raise MeasurementError(
                f"{rows.path}: column {label!r} is taken as {called[label]!r} and as {name!r}"
            )
        called[label] = name
    names = list(called.values())
    for label, name in called.items():
        if names.count(name) > 1:
            raise MeasurementError(
                f"{rows.path}: column {label!r} would be a second {name!r}; leave one unmapped or rename it"
            )
    return called


def _check_known(rows: Rows, what: str, given: Iterable[str], names: Iterable[str]) -> None:
    known = list(names)
    for name in given:
        if name not in known:
            hint = suggestion(name, known) or f"there are {', '.join(known)}"
            raise MeasurementError(
                f"{rows.path}: a {what} is given for {name!r}, no column; {hint}"
            )
