"""Trials: effects grown into the graph and fitted with the model's own parameters."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy

from ...errors import BondGraphError, ParameterError, SimulationError
from ...graph import BondGraph
from ...simulation import CompiledModel, simulate
from ..candidates import Effect
from ..fitting import Fit, fit
from ..grafting import Grafted, Site, graft
from ..latent.relax import eased
from ..measurement import Measurement
from ..screening.run import own_parameters
from .horizon import grown_horizon
from .prepare import Prepared

Array = numpy.ndarray

STEPS = 40
FAR = 0.05  # of signals' variances
HELD = 1e-9  # of a value that is known
LOOSE = 0.4  # standard deviation of the logarithm of own parameters about what was given


@dataclass(frozen=True, eq=False)
class Added:
    """One effect to be grown into a graph, and where its coefficients start.

    Attributes
    ----------
    effect : Effect
    site : Site
    starts : mapping of str to float
    pair : tuple of str
        The two junctions between which the site is, where it is such a place.
    """

    effect: Effect
    site: Site
    starts: Mapping[str, float]
    pair: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """``effect at site``."""
        return f"{self.effect.name} at {self.site.name}"


@dataclass(frozen=True, eq=False)
class Trial:
    """A graph with effects, fitted.

    Attributes
    ----------
    added : tuple of Added
    grafts : tuple of Grafted
    graph : BondGraph
    model : CompiledModel
    fit : Fit
    measurements : tuple of Measurement
        With the start states found.
    squares, counts, effective : mapping of str to number
        By signal: sum of squared residuals, samples, and how many independent ones they are worth.
    given : mapping of str to float
        Own parameters before the fit.
    """

    added: tuple[Added, ...]
    grafts: tuple[Grafted, ...]
    graph: BondGraph
    model: CompiledModel
    fit: Fit
    measurements: tuple[Measurement, ...]
    squares: Mapping[str, float]
    counts: Mapping[str, int]
    effective: Mapping[str, float]
    given: Mapping[str, float]

    @property
    def label(self) -> str:
        """Effects and sites, in one order."""
        return " + ".join(sorted(item.label for item in self.added))

    @property
    def terms(self) -> int:
        """Coefficients that the effects brought."""
        return sum(len(item.effect.fitted) for item in self.added)

    @property
    def strain(self) -> float:
        """How far own parameters are from what was given, in squares of what is likely.

        An element may turn out not to be there at all: zero is not infinitely far.
        """
        total = 0.0
        for name, given in self.given.items():
            if name in self.fit.values and given:
                ratio = self.fit.values[name] / given
                off = abs(ratio - 1)
                total += (min(off, abs(math.log(ratio))) if ratio > 0 else off) ** 2
        return total / LOOSE**2

    @property
    def values(self) -> dict[str, float]:
        """All fitted parameters, SI."""
        return dict(self.fit.values)


@dataclass(frozen=True, eq=False)
class Bench:
    """What all trials share.

    Attributes
    ----------
    graph : BondGraph
    model : CompiledModel
        Of the graph.
    recordings : tuple of Prepared
    free : tuple of str
        Own parameters.
    states : tuple of str
        Whose start is sought.
    given : mapping of str to float
        Parameters as they are given, SI.
    deadline : float
        Of `time.monotonic`.
    starts : tuple of mapping of str to float
        Where the smoother says that each recording begins.
    ways : mapping of (str, str) to float
        In which the model may err, see `bondgraph.discrepancy.latent.eased`.
    seconds : float
        Limit of one fit.
    """

    graph: BondGraph
    model: CompiledModel
    recordings: tuple[Prepared, ...]
    free: tuple[str, ...]
    states: tuple[str, ...]
    given: Mapping[str, float]
    deadline: float
    starts: tuple[Mapping[str, float], ...] = field(default=())
    ways: Mapping[tuple[str, str], float] = field(default_factory=dict)
    seconds: float = math.inf

    @property
    def left(self) -> float:
        """Seconds."""
        return max(self.deadline - time.monotonic(), 1.0)

    @property
    def late(self) -> bool:
        """Whether no more is to be begun."""
        return time.monotonic() > self.deadline


@dataclass(frozen=True, eq=False)
class Draft:
    """Effects grown into the graph, and where a fit may start.

    Attributes
    ----------
    added : tuple of Added
    grafts : tuple of Grafted
    graph : BondGraph
    model : CompiledModel
    starts : tuple of mapping of str to float
        Parameters, the best guess first.
    begins : tuple of mapping of str to float
        Start states by recording.
    likelihood : float
        Twice the negative logarithm where the model hardly errs, to compare drafts by; infinite
        where that did not come to an end.
    off : float
        How far the run from the best start is from the data, see `misfit`.
    """

    added: tuple[Added, ...]
    grafts: tuple[Grafted, ...]
    graph: BondGraph
    model: CompiledModel
    starts: tuple[Mapping[str, float], ...]
    begins: tuple[Mapping[str, float], ...]
    likelihood: float = math.inf
    off: float = math.inf

    @property
    def label(self) -> str:
        """Effects and sites, in one order."""
        return " + ".join(sorted(item.label for item in self.added))

    @property
    def terms(self) -> int:
        """Coefficients that the effects brought."""
        return sum(len(item.effect.fitted) for item in self.added)


def tried(
    bench: Bench,
    added: Sequence[Added],
    own: Sequence[Mapping[str, float]],
    *,
    steps: int = STEPS,
    segments: Any = None,
) -> Trial | BondGraphError:
    """Grow effects into the graph and fit; what goes wrong is an answer.

    Parameters
    ----------
    bench : Bench
    added : sequence of Added
        Empty for the model by itself.
    own : sequence of mapping
        Own parameters to start from; of several the one that runs nearest to the data.
    steps : int
        Of the fit.
    segments : as for `fit`
    """
    draft = drafted(bench, added, own)
    if isinstance(draft, BondGraphError):
        return draft
    return fitted_from(bench, draft, steps=steps, segments=segments)


def drafted(
    bench: Bench, added: Sequence[Added], own: Sequence[Mapping[str, float]]
) -> Draft | BondGraphError:
    """Grow effects into the graph and ease a fit in; what goes wrong is an answer."""
    try:
        graph, grafts = grown(bench.graph, added)
        model = CompiledModel(graph)
    except BondGraphError as error:
        return error
    if model.equations.algebraic and model.equations.contacts:
        # a slip that efforts decide at once has no run, or several; to find that out takes long
        return SimulationError("it leaves a contact whose slip follows from efforts at once")
    new = {
        graft_.parameters[key]: float(value)
        for graft_, item in zip(grafts, added, strict=True)
        for key, value in item.starts.items()
    }
    starts = tuple({**bench.given, **each, **new} for each in own)
    plain = Draft(tuple(added), grafts, graph, model, starts, bench.starts)
    if not (bench.ways and added):
        return plain
    draft = _eased(bench, plain)
    rows = tuple(
        _started(recording.plain, start, grafts, bench.states)
        for recording, start in zip(bench.recordings, draft.begins, strict=True)
    )
    start, off = _nearest(model, rows, bench, draft.starts)
    return replace(draft, starts=(start, *draft.starts), off=off)


def _eased(bench: Bench, draft: Draft) -> Draft:
    """Add where a fit comes to that lets the model err less and less; nothing where it fails."""
    signals = list(dict.fromkeys(name for row in bench.recordings for name in row.signals))
    free = [*bench.free, *_fitted(draft.grafts)]
    try:
        with numpy.errstate(all="ignore"):
            found = eased(
                draft.model,
                [
                    replace(row.record(signals), guess=guess)
                    for row, guess in zip(bench.recordings, bench.starts, strict=True)
                ],
                signals,
                free,
                draft.starts[0],
                bench.ways,
            )
            values = found.table.given(found.values)
    except (BondGraphError, ValueError, numpy.linalg.LinAlgError):
        return draft
    if not all(map(math.isfinite, values.values())):
        return draft
    return replace(draft, starts=(values, *draft.starts), likelihood=found.likelihood)


def fitted_from(
    bench: Bench, draft: Draft, *, steps: int = STEPS, segments: Any = None
) -> Trial | BondGraphError:
    """Fit a draft to the recordings by its runs; what goes wrong is an answer."""
    model, grafts = draft.model, draft.grafts
    try:
        rows = tuple(
            _started(recording.plain, start, grafts, bench.states)
            for recording, start in zip(bench.recordings, draft.begins, strict=True)
        )
        start = draft.starts[0]
        if not math.isfinite(draft.off) and len(draft.starts) > 1:
            start, _ = _nearest(model, rows, bench, draft.starts)
        ties = _ties(grafts, model, start)
        free = [*bench.free, *_fitted(grafts), *_open(bench, model, ties)]
        if draft.added and _far(model, rows, bench, start):
            told = {"priors": _priors(bench), "ties": ties}
            seconds = min(bench.left, bench.seconds)
            near = grown_horizon(model, rows, free, draft.starts[-1], seconds, **told)
            start, _ = _nearest(model, rows, bench, [start, *([near] if near else [])])
        priors = _priors(bench)
        if not free:  # all is known, and a fit wants an unknown: one that may not move
            held = next(iter(own_parameters(model)), None)
            if held is None:
                return ParameterError(
                    f"graph {bench.graph.name!r} has no parameters, and all start states are known: "
                    "there is nothing to fit; give its numbers as parameters"
                )
            free, priors = [held], {held: (start[held], HELD * (abs(start[held]) or 1.0))}
        found = fit(
            model,
            rows,
            free,
            parameters=start,
            priors=priors,
            ties=ties,
            segments=segments,
            loss="linear",
            max_iterations=steps,
            time_budget=min(bench.left, bench.seconds),
        )
        return trial_of(draft.added, grafts, draft.graph, model, found, rows, bench.given, ties)
    except BondGraphError as error:
        return error


def trial_of(
    added: tuple[Added, ...],
    grafts: tuple[Grafted, ...],
    graph: BondGraph,
    model: CompiledModel,
    found: Fit,
    rows: tuple[Measurement, ...],
    given: Mapping[str, float],
    ties: Mapping[str, Mapping[str, float]],
) -> Trial | BondGraphError:
    """Return a fit with what comparisons need."""
    squares: dict[str, float] = {}
    counts: dict[str, int] = {}
    effective: dict[str, float] = {}
    for channel in found.channels:
        there = numpy.isfinite(channel.residuals)
        squares[channel.signal] = squares.get(channel.signal, 0.0) + float(
            (channel.residuals[there] ** 2).sum()
        )
        counts[channel.signal] = counts.get(channel.signal, 0) + int(there.sum())
        effective[channel.signal] = effective.get(channel.signal, 0.0) + channel.effective
    if not squares or not all(math.isfinite(value) for value in squares.values()):
        return BondGraphError(f"the fit did not run: {found.advice}")
    begun = tuple(
        row.changed(initial=_begun(row.initial, found.initial[i] if found.initial else {}, ties))
        for i, row in enumerate(rows)
    )
    return Trial(added, grafts, graph, model, found, begun, squares, counts, effective, given)


def grown(graph: BondGraph, added: Sequence[Added]) -> tuple[BondGraph, tuple[Grafted, ...]]:
    """Grow effects into a graph one after the other."""
    grafts = []
    for item in added:
        found = graft(graph, item.effect, item.site, parameters=dict(item.starts))
        grafts.append(found)
        graph = found.graph
    return graph, tuple(grafts)


def _ties(
    grafts: Sequence[Grafted], model: CompiledModel, parameters: Mapping[str, float]
) -> dict[str, dict[str, float]]:
    """Return how starts of new elements follow those of the states that were there before them."""
    found: dict[str, dict[str, float]] = {}
    states = [state.name for state in model.equations.states]
    new = {state for item in grafts for state in item.starts}
    for item in grafts:
        known = {key: value for key, value in parameters.items() if key in _names(item.graph)}
        found |= item.ties([name for name in states if name not in new], known)
    return found


def _begun(
    initial: Mapping[str, float],
    found: Mapping[str, float],
    ties: Mapping[str, Mapping[str, float]],
) -> dict[str, float]:
    """Return where a recording begins, with what a fit found and what follows from it."""
    known = {**initial, **found}
    following = {
        name: sum(factor * known.get(other, 0.0) for other, factor in shares.items())
        for name, shares in ties.items()
    }
    return known | following


def _fitted(grafts: Sequence[Grafted]) -> list[str]:
    """Return the parameters of effects that data tell."""
    return [
        name
        for item in grafts
        for key, name in item.parameters.items()
        if key in item.effect.fitted
    ]


def _open(bench: Bench, model: CompiledModel, ties: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Return the states whose start is sought: those not known, and new ones that follow none."""
    before = {state.name for state in bench.model.equations.states}
    names = [state.name for state in model.equations.states]
    return [
        name for name in names if name in bench.states or (name not in before and name not in ties)
    ]


def _names(graph: BondGraph) -> set[str]:
    return {symbol.name for symbol in graph.parameters}


def _states(model: CompiledModel) -> set[str]:
    return {state.name for state in model.equations.states}


def _started(
    row: Measurement,
    start: Mapping[str, float],
    grafts: Sequence[Grafted],
    sought: Sequence[str],
) -> Measurement:
    """Return a recording that begins where the smoother says, new springs beside old ones."""
    known = {**row.initial, **{name: start[name] for name in sought if name in start}}
    for item in grafts:
        known = item.initial(known)
    return row.changed(initial=known)


def _nearest(
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


def _far(
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
    states = _states(model)
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
    table = {}
    for name in recording.signals:
        values = numpy.full(len(t), numpy.nan)
        values[: len(run.t)] = run[name][: len(t)]
        table[name] = values
    return table


def _priors(bench: Bench) -> dict[str, tuple[float, float]]:
    """Hold what the data do not tell near what was given, loosely."""
    return {
        name: (bench.given[name], LOOSE * abs(bench.given[name]))
        for name in bench.free
        if bench.given.get(name)
    }


def again(
    bench: Bench,
    trial: Trial,
    recordings: Sequence[Prepared],
    starts: Sequence[Mapping[str, float]],
) -> list[dict[str, float]]:
    """Find where other recordings start, with the parameters of a trial.

    Returns
    -------
    list of dict of str to float
        Start states by recording.
    """
    found = []
    parameters = {**bench.given, **trial.values}
    ties = _ties(trial.grafts, trial.model, parameters)
    for recording, start in zip(recordings, starts, strict=True):
        unknown = recording.item.free
        row = _started(recording.plain, start, trial.grafts, unknown)
        open_ = _open(replace(bench, states=unknown), trial.model, ties)
        if not open_:
            found.append(dict(row.initial))
            continue
        try:
            begun = fit(
                trial.model,
                row,
                open_,
                parameters=parameters,
                ties=ties,
                segments=None,
                max_iterations=STEPS,
                time_budget=min(bench.left, bench.seconds),
            )
            found.append(_begun(row.initial, begun.initial[0], ties))
        except BondGraphError:
            found.append(dict(row.initial))
    return found
