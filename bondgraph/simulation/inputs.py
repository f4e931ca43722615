"""Inputs over time: constants, samples with a declared hold, callables, CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy

from ..equations import Equations
from ..errors import ParameterError
from ..parameters import unknown_name
from ..units import to_si
from .problem import InputTable

HOLDS = {"zero": 0, "linear": 1}


@dataclass(frozen=True, eq=False)
class Samples:
    """A sampled signal and what it does between samples.

    Attributes
    ----------
    times : (n,) array
        Strictly increasing, s.
    values : (n,) array
        SI units.
    hold : {"linear", "zero"}
        Straight lines, or steps at each sample. Outside the samples the first
        and last value hold.

    Raises
    ------
    ParameterError
        For times that do not increase, values that are not finite, lengths
        that differ.

    Examples
    --------
    >>> Samples([0, 1], [0, 5]).hold
    'linear'
    """

    times: Any
    values: Any
    hold: str = "linear"

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
            raise ParameterError(f"hold {self.hold!r} is not known; use {' or '.join(HOLDS)}")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

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
        hold : {"linear", "zero"}

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


def at(
    inputs: InputTable | Callable[[float], numpy.ndarray], times: numpy.ndarray
) -> numpy.ndarray:
    """Evaluate inputs at times.

    Parameters
    ----------
    inputs : InputTable or callable
    times : (nt,) array

    Returns
    -------
    (m, nt) array

    Examples
    --------
    >>> table = InputTable(numpy.array([0.0, 1.0]), numpy.array([[0.0], [4.0]]), numpy.array([1]))
    >>> at(table, numpy.array([0.25])).tolist()
    [[1.0]]
    """
    if not isinstance(inputs, InputTable):
        return numpy.array([inputs(time) for time in times]).reshape(len(times), -1).T
    last = len(inputs.knots) - 1
    segment = numpy.clip(numpy.searchsorted(inputs.knots, times, side="right") - 1, 0, last)
    if last == 0:
        return inputs.values[segment].T
    s = numpy.maximum(times - inputs.knots[segment], 0.0)[:, None]
    slope, bend, twist = (inputs.shapes[segment, i] for i in range(3))
    return (inputs.values[segment] + s * (slope + s * (bend + s * twist))).T


def gather(
    equations: Equations, given: Mapping[Any, Any] | None, switched: bool = False
) -> InputTable | Callable[[float], numpy.ndarray]:
    """Bring all inputs to one table or function.

    Parameters
    ----------
    equations : Equations
    given : mapping, optional
        Input name or symbol to a number, `Samples`, ``(times, values)`` or a
        callable of time. Inputs not given are zero.
    switched : bool
        Whether rates of inputs stand in the equations because some mode may
        need them: steps then count as jumps, and functions are differenced.

    Returns
    -------
    InputTable or callable
        A callable ``t -> (m,) array`` where an input is one; else one table.

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import quarter_car
    >>> gather(derive(quarter_car.graph()), {"v_road": 0.1}).values.tolist()
    [[0.1]]
    """
    names = [symbol.name for symbol in equations.graph.inputs]
    signals: dict[str, Any] = dict.fromkeys(names, 0.0)
    for key, value in (given or {}).items():
        name = key if isinstance(key, str) else getattr(key, "name", str(key))
        if name not in signals:
            raise unknown_name("input", name, names)
        signals[name] = _signal(name, value)
    needs_rate = {symbol.name for symbol in equations.input_rates}
    if any(callable(signal) for signal in signals.values()):
        if switched:
            return _with_rates(_function(signals, set()), equations)
        return _function(signals, needs_rate)
    return _table(equations, signals, switched)


def _signal(name: str, value: Any) -> Any:
    if isinstance(value, Samples) or callable(value):
        return value
    if isinstance(value, tuple) and len(value) == 2:
        return Samples(*value)
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ParameterError(
            f"input {name!r}: expected a number, (times, values), Samples or a function of time, got {value!r}"
        ) from None
    if not math.isfinite(number):
        raise ParameterError(f"input {name!r} is {number}; it must be finite")
    return number


def _function(signals: Mapping[str, Any], needs_rate: set[str]) -> Callable[[float], numpy.ndarray]:
    if needs_rate:
        raise ParameterError(
            f"input {min(needs_rate)!r} drives a dependent storage, so its rate is needed; "
            f"give Samples instead of a function"
        )
    parts = [signal if callable(signal) else _sampled(signal) for signal in signals.values()]

    def function(time: float) -> numpy.ndarray:
        return numpy.array([part(time) for part in parts], dtype=float)

    return function


def _with_rates(
    function: Callable[[float], numpy.ndarray], equations: Equations
) -> Callable[[float], numpy.ndarray]:
    """Add the rates of inputs by central differences."""
    names = [symbol.name for symbol in equations.graph.inputs]
    order = [names.index(symbol.name) for symbol in equations.input_rates if symbol.name in names]

    def extended(time: float) -> numpy.ndarray:
        step = 1e-6 * max(abs(time), 1e-3)
        slopes = (function(time + step) - function(time - step)) / (2 * step)
        return numpy.concatenate([function(time), slopes[order]])

    return extended


def _sampled(signal: Any) -> Callable[[float], float]:
    if not isinstance(signal, Samples):
        return lambda time: signal
    if HOLDS[signal.hold]:
        return lambda time: float(numpy.interp(time, signal.times, signal.values))
    return lambda time: float(
        signal.values[max(0, numpy.searchsorted(signal.times, time, side="right") - 1)]
    )


def _table(equations: Equations, signals: Mapping[str, Any], switched: bool) -> InputTable:
    sampled = [signal for signal in signals.values() if isinstance(signal, Samples)]
    knots = (
        numpy.unique(numpy.concatenate([signal.times for signal in sampled]))
        if sampled
        else numpy.zeros(1)
    )
    columns: dict[str, numpy.ndarray] = {}
    holds: dict[str, int] = {}
    for name, signal in signals.items():
        evaluate = _sampled(signal)
        columns[name] = numpy.array([evaluate(time) for time in knots], dtype=float)
        holds[name] = HOLDS[signal.hold] if isinstance(signal, Samples) else 0
    _rates(equations, knots, columns, holds, switched)
    order = [symbol.name for symbol in equations.inputs]
    values = numpy.array([columns[name] for name in order]).reshape(len(order), len(knots)).T
    return InputTable(knots, values, numpy.array([holds[name] for name in order]))


def _rates(
    equations: Equations,
    knots: numpy.ndarray,
    columns: dict[str, numpy.ndarray],
    holds: dict[str, int],
    switched: bool,
) -> None:
    """Add the rates of inputs that the equations use: slopes of straight lines."""
    for symbol, rate in equations.input_rates.items():
        if symbol.name not in columns or symbol not in equations.graph.inputs:
            raise ParameterError(
                f"the second rate of an input is needed ({rate.name}); samples cannot give it: "
                f"add a compliance or inertia behind the source"
            )
        values = columns[symbol.name]
        steps = not holds[symbol.name] and len(numpy.unique(values)) > 1
        if steps and switched:
            columns[rate.name], holds[rate.name] = numpy.zeros(len(knots)), 0
            continue
        if steps:
            raise ParameterError(
                f"input {symbol.name!r} drives a dependent storage, which steps cannot; use Samples with hold='linear'"
            )
        slopes = numpy.diff(values) / numpy.diff(knots) if len(knots) > 1 else numpy.zeros(0)
        columns[rate.name] = numpy.append(slopes, 0.0)
        holds[rate.name] = 0
