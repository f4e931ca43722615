"""Recordings made ready: matched with the model, in SI, with their noise, some held out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy

from ...errors import MeasurementError
from ...graph import BondGraph
from ..latent.relax import Record
from ..measurement import Matched, Measurement, matched
from ..measurement.noise import noise_floor
from ..measurement.quality import outliers

Array = numpy.ndarray

HELD_OUT = 0.3  # of the only recording, at its end
FEW = 0.02  # outliers may be left out where they are no more than this share
LEAST = 1e-6  # of a signal's deviation: rounding is noise too


@dataclass(frozen=True, eq=False)
class Prepared:
    """One recording made ready.

    Attributes
    ----------
    item : Matched
    plain : Measurement
        The columns that count, in SI.
    noise : mapping of str to float
        Standard deviation by signal.
    told : mapping of str to bool
        Whether the noise could be told from the signal.
    """

    item: Matched
    plain: Measurement
    noise: dict[str, float]
    told: dict[str, bool]

    @property
    def name(self) -> str:
        """Of the recording."""
        return self.plain.name

    @property
    def signals(self) -> tuple[str, ...]:
        """Measured ones."""
        return tuple(self.item.outputs)

    def record(self, signals: Sequence[str]) -> Record:
        """Return it as the smoother takes it, with columns in a given order."""
        nothing = numpy.full(len(self.plain.t), numpy.nan)
        table = [self.plain.columns.get(name, nothing) for name in signals]
        noise = numpy.array([self.noise.get(name, 1.0) for name in signals])
        return Record(
            self.name,
            self.plain.t,
            numpy.column_stack(table),
            noise,
            self.item.inputs,
            self.item.initial,
        )


def prepared(measurement: Measurement, graph: BondGraph) -> tuple[Prepared, tuple[str, ...]]:
    """Make one recording ready; also return what was taken for granted.

    Parameters
    ----------
    measurement : Measurement
    graph : BondGraph

    Returns
    -------
    Prepared
    tuple of str

    Raises
    ------
    MeasurementError
        Where model and recording do not go together.
    """
    item = matched(measurement, graph)
    told = list(item.warnings)
    columns, noise, sure = {}, {}, {}
    for name, values in item.outputs.items():
        if numpy.isfinite(values).sum() < 10:
            raise MeasurementError(f"{measurement.name}, column {name!r}: fewer than ten values")
        kept = values.copy()
        alone = Measurement(item.t, {name: values}, name=measurement.name)
        marked = outliers(alone, name)
        if 0 < marked.sum() <= FEW * len(values):
            kept[marked] = numpy.nan
            told.append(
                f"{measurement.name}: {int(marked.sum())} outliers of {name!r} are left out"
            )
        floor = noise_floor(Measurement(item.t, {name: kept}, name=measurement.name), name)
        size = float(numpy.nanstd(kept)) or float(numpy.nanmax(numpy.abs(kept))) or 1.0
        noise[name], sure[name] = max(floor.std, LEAST * size), floor.reliable
        if not floor.reliable:
            told.append(f"{measurement.name}: the noise of {name!r} is uncertain, {floor.reason}")
        columns[name] = kept
    for name, samples in item.inputs.items():
        columns[name] = _spread(item.t, samples.times, samples.values)
    plain = Measurement(
        item.t,
        columns,
        holds={name: samples.hold for name, samples in item.inputs.items()},
        initial=dict(item.initial),
        name=measurement.name,
    )
    return Prepared(item, plain, noise, sure), tuple(told)


def _spread(t: Array, times: Array, values: Array) -> Array:
    """Return samples at all times of a recording, NaN where they have none."""
    found = numpy.full(len(t), numpy.nan)
    found[numpy.searchsorted(t, times)] = values
    return found


def distinct(measurements: Sequence[Measurement]) -> list[Measurement]:
    """Number recordings that share a name, which is what they are told apart by.

    Examples
    --------
    >>> rows = [Measurement([0, 1], {"v": [0, 1]}) for _ in range(2)]
    >>> [row.name for row in distinct(rows)]
    ['measurement 1', 'measurement 2']
    """
    names = [row.name for row in measurements]
    taken, found = set(names), []
    for row in measurements:
        if names.count(row.name) > 1:
            number = next(
                i for i in range(1, len(names) + len(taken) + 1) if f"{row.name} {i}" not in taken
            )
            taken.add(f"{row.name} {number}")
            row = row.changed(name=f"{row.name} {number}")
        found.append(row)
    return found


def held_out(
    measurements: Sequence[Measurement],
) -> tuple[list[Measurement], list[Measurement], str]:
    """Hold some of the recordings out: the last of several, or the end of the only one.

    Returns
    -------
    train, test : list of Measurement
    words : str
    """
    rows = list(measurements)
    if len(rows) > 1:
        return rows[:-1], rows[-1:], f"{rows[-1].name} is held out, as nothing was given to test on"
    first, last = rows[0].split(1 - HELD_OUT)
    words = (
        f"the last {HELD_OUT:.0%} of {rows[0].name} is held out, as nothing was given to test on"
    )
    return [first], [last], words


def floor(recordings: Sequence[Prepared], name: str) -> float:
    """Return the noise of a signal by differences, root mean square over recordings."""
    found = [row.noise[name] for row in recordings if name in row.noise]
    return float(numpy.sqrt(numpy.mean(numpy.square(found)))) if found else math.nan
