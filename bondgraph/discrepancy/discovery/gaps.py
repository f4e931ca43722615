"""Gaps: how far the model is from recordings, before and after, on data used and not used."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy

from ...errors import BondGraphError
from ...graph import BondGraph
from ...simulation import CompiledModel
from .bench import Bench, Trial
from .follow import followed
from .prepare import Prepared, floor
from .trial import again
from .value import Course, Gap

Array = numpy.ndarray
Runs = tuple[Mapping[str, Array], ...]

WHITE, HIGH = 0.7, 1.6
SCATTER = 2.0  # standard deviations of the mean square of noise
PATIENCE = 60.0  # seconds of one run


@dataclass(frozen=True, eq=False)
class Tested:
    """A trial beside recordings.

    Attributes
    ----------
    trial : Trial
    train, held : tuple of mapping of str to array
        The runs, by recording.
    """

    trial: Trial
    train: Runs
    held: Runs


def tested(
    bench: Bench,
    trial: Trial,
    held: Sequence[Prepared],
    starts: Sequence[Mapping[str, float]],
) -> Tested:
    """Run a trial over what it was fitted to and over what it was not.

    Of held-out recordings, start states that are not known are fitted; parameters are not.
    """
    parameters = {**bench.given, **trial.values}
    train = tuple(
        _run(trial.model, recording, row.initial, parameters)
        for recording, row in zip(bench.recordings, trial.measurements, strict=True)
    )
    begun = again(bench, trial, held, starts)
    other = tuple(
        _run(trial.model, recording, start, parameters)
        for recording, start in zip(held, begun, strict=True)
    )
    return Tested(trial, train, other)


def nominal(
    graph: BondGraph,
    recordings: Sequence[Prepared],
    given: Mapping[str, float],
    starts: Sequence[Mapping[str, float]],
) -> Runs:
    """Run the model as it was given, from where recordings start."""
    model = CompiledModel(graph)
    states = {state.name for state in model.equations.states}
    found = []
    for row, start in zip(recordings, starts, strict=True):
        known = {name: value for name, value in start.items() if name in states}
        found.append(_run(model, row, known | dict(row.plain.initial), given))
    return tuple(found)


def _run(
    model: CompiledModel,
    recording: Prepared,
    initial: Mapping[str, float],
    parameters: Mapping[str, float],
) -> dict[str, Array]:
    try:
        return followed(model, recording, initial, parameters, PATIENCE)
    except BondGraphError:
        return {name: numpy.full(len(recording.plain.t), numpy.nan) for name in recording.signals}


def rmse(recordings: Sequence[Prepared], runs: Runs, name: str) -> float:
    """Return the root mean square gap of a signal; NaN where a run does not reach all samples."""
    squares, count = 0.0, 0
    for recording, run in zip(recordings, runs, strict=True):
        if name in recording.signals:
            measured = recording.plain.columns[name]
            there = numpy.isfinite(measured)
            squares += float(((run[name] - measured)[there] ** 2).sum())
            count += int(there.sum())
    return math.sqrt(squares / count) if count else math.nan


def noises(recordings: Sequence[Prepared], best: Trial) -> dict[str, float]:
    """Return the noise of every signal.

    What a fit leaves is noise where it is white, as long as it is not far above what differences say.
    """
    found = {}
    for name in dict.fromkeys(name for row in recordings for name in row.signals):
        found[name] = low = floor(recordings, name)
        count = best.counts.get(name, 0)
        left = best.rmse(name) if count else math.nan
        white = best.effective.get(name, 0.0) >= WHITE * count
        if white and low < left < HIGH * low:
            found[name] = left
    return found


def gaps(
    recordings: Sequence[Prepared],
    given: Runs,
    before: Runs,
    after: Runs,
    units: Mapping[str, str],
    noise: Mapping[str, float],
) -> dict[str, Gap]:
    """Return the gap of every signal.

    A floor told by differences may be too high; no gap is below it.
    """
    found = {}
    for name in dict.fromkeys(name for row in recordings for name in row.signals):
        first, last = (rmse(recordings, runs, name) for runs in (before, after))
        known = (noise.get(name, math.nan), first, last)
        low = min(filter(math.isfinite, known), default=math.nan)
        found[name] = Gap(rmse(recordings, given, name), first, last, low, units.get(name, ""))
    return found


def removed(
    found: Mapping[str, Gap], sizes: Mapping[str, float], counts: Mapping[str, int] | None = None
) -> float:
    """Return the share of what lies above the floor that is gone, all signals together.

    Parameters
    ----------
    found : mapping of str to Gap
    sizes : mapping of str to float
        Of the signals, which they are measured by.
    counts : mapping of str to int, optional
        Samples by signal. With them, what is left is as good as gone where so many samples of the
        noise might as well leave it, and what went is more than that.
    """
    before = after = scatter = 0.0
    for name, gap in found.items():
        size = sizes.get(name) or 1.0
        noise = gap.noise_floor**2
        before += max(gap.before**2 - noise, 0.0) / size**2
        after += max(gap.after**2 - noise, 0.0) / size**2
        scatter += 2 * (noise / size**2) ** 2 / max((counts or {}).get(name, 0), 1)
    if not math.isfinite(after):
        return -math.inf
    if not math.isfinite(before):
        return 1.0
    chance = SCATTER * math.sqrt(scatter) if counts else 0.0
    if before - after > chance:
        after = max(after - chance, 0.0)
    return 1 - math.sqrt(after / before) if before > 0 else 0.0


def counted(recordings: Sequence[Prepared]) -> dict[str, int]:
    """Return how many samples each signal has."""
    found: dict[str, int] = {}
    for row in recordings:
        for name in row.signals:
            there = int(numpy.isfinite(row.plain.columns[name]).sum())
            found[name] = found.get(name, 0) + there
    return found


def sizes(recordings: Sequence[Prepared]) -> dict[str, float]:
    """Return the deviation of each signal."""
    found: dict[str, list[float]] = {}
    for row in recordings:
        for name in row.signals:
            found.setdefault(name, []).append(float(numpy.nanvar(row.plain.columns[name])))
    return {name: math.sqrt(sum(parts) / len(parts)) for name, parts in found.items()}


def courses(recordings: Sequence[Prepared], before: Runs, after: Runs) -> tuple[Course, ...]:
    """Return recordings with their runs."""
    return tuple(
        Course(
            row.name,
            row.plain.t,
            {name: row.item.outputs[name] for name in row.signals},
            first,
            last,
            row.noise,
            {name: row.item.units.get(name, "") for name in row.signals},
        )
        for row, first, last in zip(recordings, before, after, strict=True)
    )
