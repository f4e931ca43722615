"""A recording beside a model: which columns are its inputs, which its outputs, in SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy

from ...dimensions import infer
from ...equations import Equations, derive
from ...errors import MeasurementError, ParameterError, suggestion
from ...graph import BondGraph
from ...simulation.inputs import HOLDS, Samples
from ...units import check_compatible, si_unit
from ...values import algebraic_names
from .units import scaled
from .value import Array, Measurement


@dataclass(frozen=True, eq=False)
class Matched:
    """A recording in the terms of a model; all values in SI.

    Attributes
    ----------
    measurement : Measurement
    graph : BondGraph
    inputs : mapping of str to Samples
        What drove the system, as `bondgraph.simulate` takes it.
    outputs : mapping of str to (nt,) array
        At ``measurement.t``; NaN where there is no value.
    units : mapping of str to str
        SI unit of each input and output; empty where nobody says it.
    initial : mapping of str to float
        Initial states that are known, as `bondgraph.simulate` takes them.
    free : tuple of str
        States about whose start nothing is known: a fit may find it.
    unknown : tuple of str
        Columns that the model does not know.
    missing : tuple of str
        Inputs without a column; they count as zero.
    warnings : tuple of str
        All that was taken for granted, in words.
    """

    measurement: Measurement
    graph: BondGraph
    inputs: Mapping[str, Samples]
    outputs: Mapping[str, Array]
    units: Mapping[str, str]
    initial: Mapping[str, float]
    free: tuple[str, ...]
    unknown: tuple[str, ...]
    missing: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def t(self) -> Array:
        """Times, of shape (nt,), s."""
        times: Array = self.measurement.t
        return times

    @property
    def span(self) -> tuple[float, float]:
        """First and last time, s."""
        return float(self.t[0]), float(self.t[-1])


def matched(measurement: Measurement, graph: BondGraph) -> Matched:
    """Find a recording's columns in a model, convert them to SI and say what was taken for granted.

    Parameters
    ----------
    measurement : Measurement
        Columns are named like inputs and outputs of the model. One without a unit is in the
        model's own unit. A gap of an input is filled by its hold; by straight lines where the hold
        is ``band`` or not declared.
    graph : BondGraph

    Returns
    -------
    Matched

    Raises
    ------
    MeasurementError
        Where no column is an output of the model, units contradict the model's, a hold cannot be,
        an initial state is none.
    BondGraphError
        Where the model has no equations.

    Examples
    --------
    >>> from bondgraph.models import quarter_car
    >>> columns = {"v_road": [0, 0.1, 0.2], "tyre": [21, 22, 20], "roll": [0, 0, 1]}
    >>> run = Measurement([0, 0.1, 0.2], columns, {"tyre": "mm"}, {"v_road": "zero"}, name="run")
    >>> found = matched(run, quarter_car.graph())
    >>> list(found.inputs), found.outputs["tyre"].round(9).tolist(), found.unknown
    (['v_road'], [0.021, 0.022, 0.02], ('roll',))
    >>> for warning in found.warnings:
    ...     print(warning)
    run: column 'roll' is neither input nor output of 'quarter_car'
    """
    told: list[str] = []
    expected = _expected_units(graph)
    inputs = [symbol.name for symbol in graph.inputs]
    names = list(measurement.columns)
    known = [name for name in names if name in expected]
    outputs = [name for name in known if name not in inputs]
    if not outputs:
        raise MeasurementError(_nothing_in_common(measurement, graph))
    unknown = tuple(name for name in names if name not in expected)
    for name in unknown:
        near = suggestion(name, [other for other in expected if other not in known])
        told.append(
            f"column {name!r} is neither input nor output of {graph.name!r}{near and '; ' + near}"
        )
    values, units = {}, {}
    for name in known:
        values[name], units[name] = _in_si(measurement, name, expected[name], told)
    drives = {
        name: _samples(measurement, name, values[name], told) for name in inputs if name in known
    }
    missing = tuple(name for name in inputs if name not in known)
    told += [f"input {name!r} has no column and is taken as zero" for name in missing]
    for name in measurement.holds:
        if name not in drives:
            told.append(f"the hold of {name!r} is not used: it is no measured input")
    initial, free = _initial(measurement, graph)
    return Matched(
        measurement=measurement,
        graph=graph,
        inputs=MappingProxyType(drives),
        outputs=MappingProxyType({name: values[name] for name in outputs}),
        units=MappingProxyType(units),
        initial=MappingProxyType(initial),
        free=free,
        unknown=unknown,
        missing=missing,
        warnings=tuple(f"{measurement.name}: {text}" for text in told),
    )


def _expected_units(graph: BondGraph) -> dict[str, str]:
    """Return the unit of each input and output, declared or inferred; empty where not known."""
    inferred = infer(graph).units
    variables = {
        symbol: inferred.get(f"{name}.{key}")
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
    }
    found = {
        name: output.unit or variables.get(output.expression) or ""
        for name, output in graph.outputs.items()
    }
    return found | {symbol.name: unit for symbol, unit in graph.inputs.items()}


def _in_si(
    measurement: Measurement, name: str, expected: str, told: list[str]
) -> tuple[Array, str]:
    """Return a column and its unit in SI, after a look at what the model says."""
    column = measurement.columns[name]
    given = measurement.units.get(name)
    if given is None:
        if expected and si_unit(expected) != expected:
            told.append(f"column {name!r} has no unit and is taken in the model's, {expected}")
        return scaled(column, expected), si_unit(expected)
    unit = "" if given == "1" else given
    try:
        if expected:
            check_compatible(unit, expected)
        found = scaled(column, unit)
    except ParameterError as error:
        raise MeasurementError(
            f"{measurement.name}, column {name!r}: {error} (what the model has)"
        ) from None
    if not expected and unit:
        told.append(
            f"column {name!r} is in {given}; the model does not say its unit, so it is not checked"
        )
    return found, si_unit(expected or unit)


def _samples(measurement: Measurement, name: str, values: Array, told: list[str]) -> Samples:
    """Return an input as samples; what the hold makes of its gaps is told."""
    hold = measurement.holds.get(name)
    if hold is None:
        told.append(
            f"input {name!r} is taken as straight lines between samples; declare its hold: {', '.join(HOLDS)}"
        )
        hold = "linear"
    if hold not in HOLDS:
        raise MeasurementError(
            f"{measurement.name}, column {name!r}: hold {hold!r} is not known; use {', '.join(HOLDS)}"
        )
    t, present = measurement.t, ~numpy.isnan(values)
    gaps = int((~present).sum())
    if gaps:
        how = "its last value" if hold == "zero" else "straight lines"
        told.append(f"input {name!r} has {gaps} of {len(t)} samples missing, filled by {how}")
    if gaps and hold == "band":  # which wants uniform samples
        values = numpy.interp(t, t[present], values[present])
        present = numpy.ones(len(t), dtype=bool)
    try:
        return Samples(t[present], values[present], hold)
    except ParameterError as error:
        raise MeasurementError(f"{measurement.name}, column {name!r}: {error}") from None


def _initial(
    measurement: Measurement, graph: BondGraph
) -> tuple[dict[str, float], tuple[str, ...]]:
    """Return the initial values that are known, and the states left open."""
    equations = derive(graph)
    states = [symbol.name for symbol in equations.states]
    known = [*states, *equations.outputs, *algebraic_names(equations)]
    given: dict[str, float] = {}
    covered = set()
    for name, value in measurement.initial.items():
        where = f"{measurement.name}: initial state {name!r}"
        if name not in known:
            hint = suggestion(name, known) or f"there are {', '.join(states)}"
            raise MeasurementError(f"{where} is none of {graph.name!r}; {hint}")
        if not numpy.isfinite(value):
            raise MeasurementError(f"{where} is {value}, not a finite number")
        given[name] = float(value)
        covered |= {name} if name in states else _states_of(equations, name)
    return given, tuple(state for state in states if state not in covered)


def _states_of(equations: Equations, name: str) -> set[str]:
    """Return the states that an output is made of; none of an algebraic variable."""
    if name not in equations.outputs:
        return set()
    used = equations.substituted(equations.outputs[name]).free_symbols
    return {state.name for state in equations.states if state in used}


def _nothing_in_common(measurement: Measurement, graph: BondGraph) -> str:
    names = [name for name in measurement.columns if name not in graph.outputs]
    near = [f"{name!r}: {hint}" for name in names if (hint := suggestion(name, graph.outputs))]
    theirs = ", ".join(graph.outputs) or "none; give the graph outputs={...}"
    hints = f"; {'; '.join(near)}" if near else ""
    return (
        f"{measurement.name}: no column is an output of {graph.name!r}; its columns are "
        f"{', '.join(measurement.columns)}, the model's outputs are {theirs}{hints}; map names with "
        "rename={model: column}"
    )
