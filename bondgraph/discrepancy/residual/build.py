"""From a model or its run, and a recording, to residuals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy

from ...causality import CausalGraph
from ...errors import MeasurementError
from ...graph import BondGraph
from ...simulation import CompiledModel, Samples, Trajectory, simulate
from ...units import to_si
from ..measurement import Measurement
from .value import Residuals

Array = numpy.ndarray

SAME_TIME = 1e-9  # of the recording's length


def residuals(
    source: Trajectory | BondGraph | CausalGraph | CompiledModel | Mapping[str, Any],
    measurement: Measurement,
    signals: Iterable[str] | None = None,
    **options: Any,
) -> Residuals:
    """Compare a model with a recording.

    Parameters
    ----------
    source : Trajectory, BondGraph, CausalGraph, CompiledModel, or mapping of str to (nt,) array
        A run that has rows at all times of the recording; a model, which is simulated with the
        recording's inputs, holds and initial states; or simulated signals at these times, in the
        recording's units.
    measurement : Measurement
        Columns with a unit are converted to SI where a model is compared.
    signals : iterable of str, optional
        What to compare; every column that the model has and that is no input unless given.
    **options
        Of `simulate`, such as ``parameters`` or ``rtol``, where a model is given.

    Returns
    -------
    Residuals

    Raises
    ------
    MeasurementError
        For signals the model or the recording does not have, an input with gaps, a run without
        rows at the recording's times or that ended early.

    Examples
    --------
    >>> from bondgraph import simulate
    >>> from bondgraph.models import mass_on_belt
    >>> t = numpy.linspace(0, 1, 101)
    >>> run = simulate(mass_on_belt.graph(), 1.0, t_eval=t)
    >>> found = residuals(run, Measurement(t, {"x": run["x"] + 0.001}))
    >>> found.signals, round(float(found.gap("x")[7]), 6), found.unit("x")
    (('x',), 0.001, 'm')
    """
    if isinstance(source, Mapping):
        return _from_arrays(source, measurement, signals)
    if not isinstance(source, Trajectory):
        source = _simulated(source, measurement, options)
    elif options:
        raise MeasurementError(f"a run is there already: {', '.join(options)} would do nothing")
    return _from_run(source, measurement, signals)


def _from_arrays(
    source: Mapping[str, Any], measurement: Measurement, signals: Iterable[str] | None
) -> Residuals:
    chosen = _chosen(measurement, signals, set(source), set())
    others = {name: v for name, v in measurement.columns.items() if name not in chosen}
    return Residuals(
        measurement.t,
        {name: measurement.columns[name] for name in chosen},
        {name: source[name] for name in chosen},
        dict(measurement.units),
        inputs=others,
        states={name: v for name, v in source.items() if name not in chosen},
        name=measurement.name,
    )


def _from_run(
    run: Trajectory, measurement: Measurement, signals: Iterable[str] | None
) -> Residuals:
    rows = _rows(run, measurement)
    inputs = {symbol.name for symbol in run.model.equations.graph.inputs}
    chosen = _chosen(measurement, signals, set(run.names), inputs)
    columns = {name: values[rows] for name, values in run.columns().items()}
    units = {name: run.unit(name) for name in (*columns, *chosen)}
    return Residuals(
        measurement.t,
        {name: _si(measurement, name, units[name]) for name in chosen},
        {name: run[name][rows] for name in chosen},
        units,
        inputs={name: columns[name] for name in columns if name in inputs},
        states={k: v for k, v in columns.items() if k not in inputs and k not in chosen},
        name=measurement.name,
    )


def _simulated(model: Any, measurement: Measurement, options: dict[str, Any]) -> Trajectory:
    """Run a model along a recording."""
    graph = (
        model.equations.graph
        if isinstance(model, CompiledModel)
        else getattr(model, "graph", model)
    )
    inputs = {}
    for symbol, unit in graph.inputs.items():
        if symbol.name in measurement.columns and symbol.name not in options.get("inputs", {}):
            values = _si(measurement, symbol.name, unit)
            if numpy.isnan(values).any():
                raise MeasurementError(
                    f"{measurement.name}: input {symbol.name!r} has gaps; mend them first",
                    elements=(symbol.name,),
                )
            hold = measurement.holds.get(symbol.name, "linear")
            inputs[symbol.name] = Samples(measurement.t, values, hold)
    t = measurement.t
    return simulate(
        model,
        (float(t[0]), float(t[-1])),
        t_eval=t,
        **{
            **options,
            "inputs": {**inputs, **options.get("inputs", {})},
            "initial": {**measurement.initial, **options.get("initial", {})},
        },
    )


def _rows(run: Trajectory, measurement: Measurement) -> Array:
    """Return where a run has the times of a recording."""
    t = measurement.t
    if not run.outcome.ok and run.t_end < t[-1]:
        raise MeasurementError(
            f"{measurement.name}: the run ended at {run.t_end:g} s, the recording at {t[-1]:g} s: "
            f"{run.advice}"
        )
    rows = numpy.clip(numpy.searchsorted(run.t, t - SAME_TIME * (t[-1] - t[0])), 0, len(run.t) - 1)
    missing = numpy.abs(run.t[rows] - t) > SAME_TIME * (t[-1] - t[0])
    if missing.any():
        raise MeasurementError(
            f"{measurement.name}: the run has no row at t = {t[numpy.argmax(missing)]:g} s; "
            "simulate with t_eval=measurement.t"
        )
    return rows


def _chosen(
    measurement: Measurement, signals: Iterable[str] | None, known: set[str], inputs: set[str]
) -> tuple[str, ...]:
    if signals is None:
        chosen = tuple(k for k in measurement.columns if k in known and k not in inputs)
        wanted = "of the recording's columns"
    else:
        chosen = (signals,) if isinstance(signals, str) else tuple(signals)
        wanted = f"of {', '.join(chosen)}"
    lacking = [k for k in chosen if k not in known or k not in measurement.columns]
    if lacking or not chosen:
        raise MeasurementError(
            f"{measurement.name}: {', '.join(lacking) or 'none ' + wanted} both measured and in "
            f"the model; measured: {', '.join(measurement.columns)}",
            elements=tuple(lacking),
        )
    return chosen


def _si(measurement: Measurement, name: str, unit: str) -> Array:
    """Return a column in SI; affine, as degrees Celsius are."""
    own = measurement.units.get(name, "")
    values = measurement.columns[name]
    if not own:
        return values
    zero, one = to_si(0.0, own, unit or None), to_si(1.0, own, unit or None)
    return zero + (one - zero) * values
