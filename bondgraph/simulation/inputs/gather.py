"""Inputs over time: constants, samples and callables brought to one table or function."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ...equations import Equations
from ...errors import ParameterError
from ...parameters import unknown_name
from .curves import Curve, fitted, rate
from .samples import HOLDS, Samples
from .table import InputTable


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
) -> InputTable | Functions:
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
    InputTable or Functions
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
    if any(callable(signal) for signal in signals.values()):
        return Functions(equations, signals, switched)
    return _table(equations, signals, switched)


@dataclass(frozen=True, eq=False)
class Functions:
    """Inputs of which some are functions of time; called with a time, it gives all, shape (m,).

    Attributes
    ----------
    equations : Equations
    signals : mapping of str to float, Samples or callable
    switched : bool
        Whether rates are appended, by differences.
    """

    equations: Equations
    signals: Mapping[str, Any]
    switched: bool = False

    @property
    def needs_rate(self) -> bool:
        """Whether rates of inputs are needed that differences are too coarse for."""
        return bool(self.equations.input_rates) and not self.switched

    def table(self, span: tuple[float, float], tolerance: float) -> InputTable:
        """Return a table of cubics that follows the functions over a span.

        Parameters
        ----------
        span : (float, float)
            Start and end, s.
        tolerance : float
            In shares of each function's largest magnitude.

        Raises
        ------
        SimulationError
            Naming the input and the time near which it cannot be followed.
        """
        curves = {
            name: fitted(signal, span, tolerance, name) if callable(signal) else signal
            for name, signal in self.signals.items()
        }
        return _table(self.equations, curves, self.switched)

    @functools.cached_property
    def _parts(self) -> list[Callable[[float], float]]:
        return [
            signal if callable(signal) else _sampled(signal) for signal in self.signals.values()
        ]

    def _values(self, time: float) -> numpy.ndarray:
        return numpy.array([part(time) for part in self._parts], dtype=float)

    def __call__(self, time: float) -> numpy.ndarray:
        """Return all inputs at a time, shape (m,)."""
        if not self.switched:
            return self._values(time)
        step = 1e-6 * max(abs(time), 1e-3)
        slopes = (self._values(time + step) - self._values(time - step)) / (2 * step)
        return numpy.concatenate([self._values(time), slopes[self._order]])

    @functools.cached_property
    def _order(self) -> list[int]:
        names = list(self.signals)
        rates = self.equations.input_rates
        return [names.index(symbol.name) for symbol in rates if symbol.name in names]


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


def _sampled(signal: Any) -> Callable[[float], float]:
    if isinstance(signal, Samples):
        if signal.curve is not None:
            signal = signal.curve
        elif HOLDS[signal.hold]:
            return lambda time: float(numpy.interp(time, signal.times, signal.values))
        else:
            return lambda time: float(
                signal.values[max(0, numpy.searchsorted(signal.times, time, side="right") - 1)]
            )
    if isinstance(signal, Curve):
        return lambda time: float(signal.at(numpy.array([time]))[0, 0])
    return lambda time: signal


def _table(equations: Equations, signals: Mapping[str, Any], switched: bool) -> InputTable:
    """Bring signals to common knots; each column is its hold and cubics, shape (4, nk)."""
    signals = {
        name: signal.curve if isinstance(signal, Samples) and signal.curve is not None else signal
        for name, signal in signals.items()
    }
    times = [
        signal.times if isinstance(signal, Samples) else signal.knots
        for signal in signals.values()
        if isinstance(signal, Samples | Curve)
    ]
    knots = numpy.unique(numpy.concatenate(times)) if times else numpy.zeros(1)
    if times and equations.input_rates:  # till the first sample, rates are zero
        knots = numpy.append(knots[0] - max(1.0, abs(knots[0])), knots)
    columns: dict[str, tuple[int, numpy.ndarray]] = {
        name: _column(signal, knots) for name, signal in signals.items()
    }
    _rates(equations, knots, signals, columns, switched)
    order = [symbol.name for symbol in equations.inputs]
    hold = numpy.array([columns[name][0] for name in order])
    cubics = numpy.array([columns[name][1] for name in order]).reshape(len(order), 4, len(knots))
    values = numpy.ascontiguousarray(cubics[:, 0].T)
    if not (hold == HOLDS["band"]).any():
        return InputTable(knots, values, hold)
    return InputTable(knots, values, hold, cubics[:, 1:].transpose(2, 1, 0))


def _column(signal: Any, knots: numpy.ndarray) -> tuple[int, numpy.ndarray]:
    if isinstance(signal, Curve):
        return HOLDS["band"], signal.at(knots)
    found = numpy.zeros((4, len(knots)))
    if not isinstance(signal, Samples):
        found[0] = signal
        return 0, found
    if HOLDS[signal.hold]:
        found[0] = numpy.interp(knots, signal.times, signal.values)
    else:
        index = numpy.searchsorted(signal.times, knots, side="right") - 1
        found[0] = signal.values[numpy.maximum(index, 0)]
    return HOLDS[signal.hold], found


def _rates(
    equations: Equations,
    knots: numpy.ndarray,
    signals: Mapping[str, Any],
    columns: dict[str, tuple[int, numpy.ndarray]],
    switched: bool,
) -> None:
    """Add the rates of inputs that the equations use: slopes of lines and of cubics."""
    for symbol, rate_symbol in equations.input_rates.items():
        if symbol.name not in columns or symbol not in equations.graph.inputs:
            raise ParameterError(
                f"the second rate of an input is needed ({rate_symbol.name}); samples cannot give it: "
                f"add a compliance or inertia behind the source"
            )
        signal = signals[symbol.name]
        hold, found = columns[symbol.name]
        if isinstance(signal, Curve):
            columns[rate_symbol.name] = (
                hold,
                numpy.where(knots < signal.knots[0], 0.0, rate(signal).at(knots)),
            )
            continue
        rates = numpy.zeros((4, len(knots)))
        steps = not hold and len(numpy.unique(found[0])) > 1
        if steps and not switched:
            raise ParameterError(
                f"input {symbol.name!r} drives a dependent storage, which steps cannot; use Samples "
                f"with hold='linear' or 'band'"
            )
        if not steps and len(knots) > 1:
            rates[0, :-1] = numpy.diff(found[0]) / numpy.diff(knots)
        columns[rate_symbol.name] = 0, rates
