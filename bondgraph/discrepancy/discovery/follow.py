"""Runs beside recordings: how far a model is from them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy

from ...errors import BondGraphError
from ...simulation import CompiledModel, Trajectory, simulate
from ..measurement import Measurement
from .begin import states_of
from .bench import Bench
from .prepare import Prepared

Array = numpy.ndarray

FAR = 0.05  # of signals' variances


def nearest(
    model: CompiledModel,
    rows: Sequence[Measurement],
    bench: Bench,
    starts: Sequence[Mapping[str, float]],
) -> tuple[dict[str, float], float]:
    """Return the parameters whose run is nearest to the data, and how far it is."""
    best, nearest = dict(starts[0]), math.inf
    for each in starts:
        try:
            off = sum(
                misfit(model, prepared, row, each, bench.seconds / 8)
                for prepared, row in zip(bench.recordings, rows, strict=True)
            )
        except BondGraphError:
            continue
        if off < nearest:
            best, nearest = dict(each), off
    return best, nearest


def far(
    model: CompiledModel, rows: Sequence[Measurement], bench: Bench, start: Mapping[str, float]
) -> bool:
    """Whether a run is so far from the data that a fit may not find its way."""
    count, off = 0, 0.0
    for prepared, row in zip(bench.recordings, rows, strict=True):
        count += sum(int(numpy.isfinite(prepared.plain.columns[n]).sum()) for n in prepared.signals)
        try:
            off += misfit(model, prepared, row, start, bench.seconds / 8)
        except BondGraphError:
            return True
    return not off < FAR * count


def misfit(
    model: CompiledModel,
    recording: Prepared,
    row: Measurement,
    parameters: Mapping[str, float],
    seconds: float,
) -> float:
    """Return squares of residuals over each signal's variance; infinite where a run fails."""
    found = followed(model, recording, row.initial, parameters, seconds)
    total = 0.0
    for name in recording.signals:
        measured = recording.plain.columns[name]
        off = (found[name] - measured)[numpy.isfinite(measured)]
        total += float((off**2).sum()) / max(float(numpy.nanvar(measured)), 1e-300)
    return total if math.isfinite(total) else math.inf


def followed(
    model: CompiledModel,
    recording: Prepared,
    initial: Mapping[str, float],
    parameters: Mapping[str, float],
    seconds: float = math.inf,
) -> dict[str, Array]:
    """Return the measured signals as the model runs; NaN where the run did not reach."""
    t = recording.plain.t
    states = states_of(model)
    outputs = set(model.equations.outputs)
    known = {name: value for name, value in initial.items() if name in states | outputs}
    run = simulate(
        model,
        (t[0], t[-1]),
        parameters,
        known,
        recording.item.inputs,
        t_eval=t,
        time_budget=seconds,
    )
    return sampled(run, recording.signals, len(t))


def sampled(run: Trajectory, names: Iterable[str], count: int) -> dict[str, Array]:
    """Return signals at so many times; NaN at those that a run did not reach."""
    table = {}
    for name in names:
        values = numpy.full(count, numpy.nan)
        values[: len(run.t)] = run[name][:count]
        table[name] = values
    return table
