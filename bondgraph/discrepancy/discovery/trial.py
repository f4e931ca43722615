"""Trials: effects grown into the graph and fitted with the model's own parameters."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy

from ...errors import BondGraphError, ParameterError, SimulationError
from ...graph import BondGraph
from ...simulation import CompiledModel
from ..fitting import Fit, fit
from ..fitting.unknowns import own_parameters
from ..grafting import Grafted
from ..latent.relax import LOOSE, eased
from ..measurement import Measurement
from .begin import begun_at, fitted_by, grown, open_states, phases, started, ties_of
from .bench import Added, Bench, Draft, Trial, near_noise
from .compare import delta_bic
from .follow import far, misfit, nearest
from .horizon import grown_horizon
from .prepare import Prepared
from .scan import scanned

STEPS = 40
AGAIN = 2  # fits from other starts
PHASES = 12  # tried, where a recording begins in a period
HELD = 1e-9  # of a value that is known


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
        model = CompiledModel(graph) if added else bench.model
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
    starts = tuple(each for i, each in enumerate(starts) if each not in starts[:i])
    plain = Draft(tuple(added), grafts, graph, model, starts, bench.starts)
    if not (bench.ways and added):
        return plain
    draft = _eased(bench, plain)
    rows = tuple(
        started(recording.plain, start, grafts, bench.states)
        for recording, start in zip(bench.recordings, draft.begins, strict=True)
    )
    start, off = nearest(model, rows, bench, draft.starts)
    return replace(draft, starts=(start, *draft.starts), off=off)


def _eased(bench: Bench, draft: Draft) -> Draft:
    """Add where a fit comes to that lets the model err less and less; nothing where it fails."""
    signals = list(dict.fromkeys(name for row in bench.recordings for name in row.signals))
    free = [*bench.free, *fitted_by(draft.grafts)]
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
    """Fit a draft to the recordings by its runs; what goes wrong is an answer.

    A quick fit that does not come near the noise is tried from the draft's other starts as well:
    what repeats, or is hit, has many a minimum.
    """
    trial = _fitted(bench, draft, steps, segments)
    others = [start for start in draft.starts if start != draft.starts[0]] if draft.added else []
    for start in others[:AGAIN]:
        if isinstance(trial, BondGraphError) or bench.late:
            break
        if trial.fit.seconds > bench.seconds / 8 or near_noise(trial, bench, 1.5):
            break
        other = _fitted(bench, replace(draft, starts=(start,)), steps, segments)
        if isinstance(other, Trial) and delta_bic(trial, other) > 0:
            trial = other
    return trial


def _fitted(bench: Bench, draft: Draft, steps: int, segments: Any) -> Trial | BondGraphError:
    model, grafts = draft.model, draft.grafts
    try:
        rows = tuple(
            started(recording.plain, start, grafts, bench.states)
            for recording, start in zip(bench.recordings, draft.begins, strict=True)
        )
        start = draft.starts[0]
        if not math.isfinite(draft.off) and len(draft.starts) > 1:
            start, _ = nearest(model, rows, bench, draft.starts)
        ties = ties_of(grafts, model, start)
        begins = open_states(bench, model, ties, phases(bench, draft))
        free = [*bench.free, *fitted_by(grafts), *begins]
        until = time.monotonic() + min(bench.left, bench.seconds)
        half = min(bench.left, bench.seconds) / 2
        if any(item.effect.impacts for item in draft.added):
            start = scanned(model, rows, bench, draft, start, half)
        elif draft.added and far(model, rows, bench, start):
            told = {"priors": _priors(bench), "ties": ties}
            near = grown_horizon(model, rows, free, draft.starts[-1], half, **told)
            start, _ = nearest(model, rows, bench, [start, *([near] if near else [])])
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
            time_budget=max(until - time.monotonic(), bench.seconds / 8),
        )
        trial = trial_of(draft.added, grafts, draft.graph, model, found, rows, bench.given, ties)
        if isinstance(trial, BondGraphError):
            return trial
        return replace(trial, begins=len(set(begins) - set(bench.states)) * len(rows))
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
        row.changed(initial=begun_at(row.initial, found.initial[i] if found.initial else {}, ties))
        for i, row in enumerate(rows)
    )
    return Trial(added, grafts, graph, model, found, begun, squares, counts, effective, given)


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
    ties = ties_of(trial.grafts, trial.model, parameters)
    for recording, start in zip(recordings, starts, strict=True):
        unknown = recording.item.free
        row = started(recording.plain, start, trial.grafts, unknown)
        open_ = open_states(replace(bench, states=unknown), trial.model, ties)
        if not open_:
            found.append(dict(row.initial))
            continue
        row = _in_phase(bench, trial, recording, row, parameters, ties, open_)
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
            found.append(begun_at(row.initial, begun.initial[0], ties))
        except BondGraphError:
            found.append(dict(row.initial))
    return found


def _in_phase(
    bench: Bench,
    trial: Trial,
    recording: Prepared,
    row: Measurement,
    parameters: Mapping[str, float],
    ties: Mapping[str, Mapping[str, float]],
    sought: Sequence[str],
) -> Measurement:
    """Return a recording that begins in the phase of a periodic effect which runs nearest to it."""
    for item, grafted in zip(trial.added, trial.grafts, strict=True):
        order = parameters.get(grafted.parameters.get("order", ""), 0.0)
        if not (item.effect.periodic and order > 0):
            continue
        new = f"{grafted.name}.q"
        turned = [name for name in {new, *ties.get(new, {})} if name in sought]
        best = math.inf
        for part in range(PHASES) if turned else ():
            step = 2 * math.pi * part / (PHASES * order)
            moved = {name: row.initial.get(name, 0.0) + step for name in turned}
            trial_row = row.changed(initial=begun_at(row.initial, moved, ties))
            try:
                off = misfit(trial.model, recording, trial_row, parameters, bench.seconds / 8)
            except BondGraphError:
                continue
            if off < best:
                best, nearest_row = off, trial_row
        row = nearest_row if math.isfinite(best) else row
    return row
