"""Measurements brought to what a fit needs: inputs as samples, outputs as data in SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ...errors import MeasurementError
from ...simulation import CompiledModel, Samples
from ..measurement import Measurement
from ..measurement.units import scaled

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Recording:
    """One recording as a fit uses it.

    Attributes
    ----------
    name : str
    t : (nt,) array, s
    data : mapping of str to (nt,) array
        By signal, SI; NaN marks a gap.
    inputs : mapping of str to Samples
    initial : mapping of str to float
        Initial states that are known.
    """

    name: str
    t: Array
    data: Mapping[str, Array]
    inputs: Mapping[str, Samples]
    initial: Mapping[str, Any]


def recorded(measurement: Measurement, model: CompiledModel) -> Recording:
    """Match the columns of a measurement with the inputs and signals of a model, by name.

    Parameters
    ----------
    measurement : Measurement
    model : CompiledModel

    Returns
    -------
    Recording

    Raises
    ------
    MeasurementError
        Where a column is no signal of the model, or none is one besides inputs.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> rows = Measurement([0, 1], {"x": [0.0, 20.0]}, {"x": "mm"})
    >>> recorded(rows, CompiledModel(mass_on_belt.graph())).data["x"].tolist()
    [0.0, 0.02]
    """
    inputs, data = {}, {}
    known = {symbol.name for symbol in model.equations.graph.inputs}
    signals = set(model.names)
    for name, column in measurement.columns.items():
        values = scaled(column, measurement.units.get(name, ""))
        if name in known:
            there = numpy.isfinite(values)
            hold = measurement.holds.get(name, "linear")
            inputs[name] = Samples(measurement.t[there], values[there], hold)
        elif name in signals:
            data[name] = values
        else:
            raise MeasurementError(
                f"{measurement.name}: column {name!r} is no input, output, state or port variable of "
                f"model {model.equations.name!r}; rename it, or leave it out"
            )
    if not data:
        raise MeasurementError(
            f"{measurement.name}: no column is an output of model {model.equations.name!r}, so there "
            f"is nothing to fit; it has {', '.join(model.equations.outputs) or 'none'}"
        )
    return Recording(measurement.name, measurement.t, data, inputs, dict(measurement.initial))
