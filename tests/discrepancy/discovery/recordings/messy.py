"""What loggers and sensors do to recordings."""

from __future__ import annotations

from collections.abc import Iterable

import numpy

from bondgraph.discrepancy.measurement import Measurement

Array = numpy.ndarray


def gaps(run: Measurement, names: Iterable[str], seed: int, share: float = 0.05) -> Measurement:
    """Empty cells: single ones and bursts of ten, together a share of each named column."""
    rng = numpy.random.default_rng(seed)
    columns = {key: numpy.array(value) for key, value in run.columns.items()}
    for name in names:
        rows = len(run)
        columns[name][rng.random(rows) < share / 2] = numpy.nan
        for begin in rng.integers(0, rows, max(int(share * rows / 20), 1)):
            columns[name][begin : begin + 10] = numpy.nan
    return run.changed(columns=columns)


def outliers(
    run: Measurement, names: Iterable[str], seed: int, share: float = 0.005, size: float = 8.0
) -> Measurement:
    """Single samples that are ``size`` standard deviations of their signal off, either way."""
    rng = numpy.random.default_rng(seed)
    columns = {key: numpy.array(value) for key, value in run.columns.items()}
    for name in names:
        struck = rng.random(len(run)) < share
        signs = rng.choice([-1.0, 1.0], len(run))
        columns[name] += struck * signs * size * numpy.nanstd(columns[name])
    return run.changed(columns=columns)


def unequal(run: Measurement, seed: int, share: float = 0.3) -> Measurement:
    """Rows that a logger dropped here and there; the first and the last are kept.

    An input that holds between samples is then known less often than it steps: honest where it
    changes seldom, wrong where it changes with every sample.
    """
    keep = numpy.random.default_rng(seed).random(len(run)) >= share
    keep[[0, -1]] = True
    columns = {name: values[keep] for name, values in run.columns.items()}
    return run.changed(t=run.t[keep], columns=columns)


def clipped(run: Measurement, name: str, share: float = 0.8) -> Measurement:
    """A sensor that ends at a share of the signal's largest magnitude, on either side."""
    values = run.columns[name]
    limit = share * numpy.nanmax(numpy.abs(values))
    return run.changed(columns={**run.columns, name: numpy.clip(values, -limit, limit)})


def unitless(run: Measurement, name: str) -> Measurement:
    """One column whose header has no unit."""
    return run.changed(units={key: unit for key, unit in run.units.items() if key != name})


def late(run: Measurement, name: str, delay: float) -> Measurement:
    """A column logged by a clock that is behind: what it shows happened ``delay`` s before."""
    values = run.columns[name]
    moved = numpy.interp(run.t - delay, run.t, values)
    return run.changed(columns={**run.columns, name: moved})


def silent(run: Measurement, *names: str) -> Measurement:
    """One of several signals was not logged."""
    return run.without(*names)
