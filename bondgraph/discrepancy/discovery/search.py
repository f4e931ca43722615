"""The search: screen, refit the best few, take the best, and again until noise is left."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ...errors import BondGraphError
from ...simulation import CompiledModel
from ..candidates import Effect
from ..latent.null import threshold
from ..latent.probes import probed
from ..latent.relax import Relaxed, relaxed
from ..latent.screen import Sketch, sketched
from .bench import Bench, Draft, Trial, near_noise
from .compare import delta_bic, preference
from .constants import Constant, constant_off
from .gaps import WHITE, sizes
from .outliers import without_outliers
from .propose import FITTED, MOST, WORTH, Tell, drafts_of, idle_pair
from .refine import settled, simplified, without_needless
from .trial import fitted_from, tried

LOST = 0.8  # of a signal's deviation
HOPELESS = 50.0  # behind one that reaches the noise, by twice the logarithm of the likelihood
OUTDONE = 3.0  # times as far from the data as the nearest, and less likely: worth a short fit only
ROUND = 2.0  # so many times a fit's limit may the fits of a round take, of processor time
ROUNDS = 6.0  # the same, after which no other round is begun; half of it where states jump
SAMPLE = 5e-4  # seconds that a fit may take for each sample of a long recording
SHORTEST, TIMES = 8.0, 3.0  # a fit may take so many seconds, or times as long as the base


@dataclass(frozen=True, eq=False)
class Found:
    """What a search has.

    Attributes
    ----------
    bench : Bench
        With recordings cleared of outliers, and where they start.
    base : Trial
        The model by itself.
    trials : tuple of Trial
        All that were fitted, the base aside.
    best : Trial
    sketches : tuple of Sketch
        Of each round.
    limits : tuple of float
        Gains that noise alone reaches once in a hundred searches, by round.
    warnings : tuple of str
    constant : Constant or None
        A number in a law that explains the data as well, if it is off.
    """

    bench: Bench
    base: Trial
    trials: tuple[Trial, ...]
    best: Trial
    sketches: tuple[Sketch, ...]
    limits: tuple[float, ...]
    warnings: tuple[str, ...]
    constant: Constant | None = None


def searched(bench: Bench, signals: Sequence[str], effects: Sequence[Effect], tell: Tell) -> Found:
    """Search for effects that are missing.

    Parameters
    ----------
    bench : Bench
    signals : sequence of str
        Measured in at least one recording.
    effects : sequence of Effect
    tell : callable
        Is told what is being done.

    Returns
    -------
    Found

    Raises
    ------
    BondGraphError
        Where not even the model by itself can be fitted.
    """
    tell("screening every effect at every site")
    sketch = _sketched(bench, bench.model, signals, effects, {})
    cleaned, said = without_outliers(sketch.relaxed, bench.recordings)
    if said:
        tell("screening again without outliers")
        bench = replace(bench, recordings=cleaned)
        sketch = _sketched(bench, bench.model, signals, effects, {})
    bench = replace(bench, starts=starts_of(sketch.relaxed, bench), ways=ways_of(sketch.relaxed))
    tell("fitting the model by itself")
    base = tried(bench, (), [bench.given])
    if isinstance(base, BondGraphError) or _lost(base, bench):
        tell("fitting the model by itself, in segments")
        other = tried(bench, (), [bench.given], segments="auto", steps=150)
        base = other if isinstance(base, BondGraphError) else _nearer(base, other)
    if isinstance(base, BondGraphError):
        raise base
    bench = replace(bench, seconds=_limit(bench, base))
    if near_noise(base, bench):
        # what is left is small beside what its own parameters being off would do
        tell("screening again with fitted parameters")
        guesses = [row.initial for row in base.measurements]
        sketch = _sketched(bench, bench.model, signals, effects, base.values, guesses)
        beside = None
    else:
        tell("scoring along the model's own run")
        beside = along_runs(bench, base, signals, effects)
    current, trials, warnings = base, list[Trial](), list(said)
    done: Trial | None = None
    began = time.process_time()
    sketches, limits = [], []
    while True:
        limit = threshold(sketch)
        sketches.append(sketch)
        limits.append(limit)
        drafts, first = drafts_of(bench, current, base, sketch, limit, trials, tell, beside)
        fresh = _refitted(bench, current, drafts, first, trials, tell)
        trials += fresh
        better = max(fresh, key=lambda trial: preference(current, trial), default=None)
        if better is None or delta_bic(current, better) < max(WORTH, limit):
            break
        current = better
        if not current.fit.outcome.ok:
            # what a fit has not come to yet looks like an effect that is missing
            current = done = settled(bench, current, trials, tell)
        if len(current.added) >= MOST or near_noise(current, bench) or white(current):
            break
        most = ROUNDS / 2 if current.model.switched else ROUNDS
        if bench.late or time.process_time() - began > most * bench.seconds:
            more = "raise time_budget" if bench.late else "fits take long here"
            warnings.append(f"the seconds allowed were used up: not all was tried; {more}")
            break
        tell(f"screening again beside {current.label}")
        try:
            guesses = [row.initial for row in current.measurements]
            sketch = _sketched(bench, current.model, signals, effects, current.values, guesses)
            beside = along_runs(bench, current, signals, effects)
        except BondGraphError as error:
            warnings.append(f"no second search: {error}")
            break
    current = without_needless(bench, base, current, trials, tell)
    current = simplified(bench, base, current, trials, effects, tell)
    if current.added and current is not done and not near_noise(current, bench):
        current = settled(bench, current, trials, tell)
    constant = constant_off(bench, base, current, tell) if current.added else None
    return Found(
        bench,
        base,
        tuple(trials),
        current,
        tuple(sketches),
        tuple(limits),
        tuple(warnings),
        constant,
    )


def _limit(bench: Bench, base: Trial) -> float:
    """Return the seconds that a fit may take."""
    samples = sum(len(row.plain) for row in bench.recordings)
    return max(SHORTEST, TIMES * base.fit.seconds, SAMPLE * samples)


def along_runs(
    bench: Bench, trial: Trial, signals: Sequence[str], effects: Sequence[Effect]
) -> Sketch | None:
    """Score effects along the runs of a fitted model, to first order.

    Where the states that the model has cannot follow the data at all, a smoother goes astray.
    """
    guesses = [row.initial for row in trial.measurements]
    try:
        return _sketched(bench, trial.model, signals, effects, trial.values, guesses, rounds=0)
    except BondGraphError:
        return None


def _lost(trial: Trial, bench: Bench) -> bool:
    """Whether a fit is hardly nearer to the data than their mean."""
    size = sizes(bench.recordings)
    return any(trial.rmse(name) > LOST * size[name] for name in trial.squares)


def _nearer(one: Trial, other: Trial | BondGraphError) -> Trial:
    if isinstance(other, BondGraphError) or delta_bic(one, other) < 0:
        return one
    return other


def white(trial: Trial) -> bool:
    """Whether what a fit leaves has no memory, so that no effect is left to be found in it."""
    return all(trial.effective[name] >= WHITE * count for name, count in trial.counts.items())


def _sketched(
    bench: Bench,
    runs: CompiledModel,
    signals: Sequence[str],
    effects: Sequence[Effect],
    values: Mapping[str, float],
    guesses: Sequence[Mapping[str, float]] = (),
    **options: int,
) -> Sketch:
    probes = probed(runs.equations.graph, effects, bench.graph)
    model = CompiledModel(probes.graph)
    found = relaxed(
        model,
        [
            replace(row.record(signals), guess=guess)
            for row, guess in zip(
                bench.recordings, guesses or [{}] * len(bench.recordings), strict=True
            )
        ],
        signals,
        [*bench.free, *(name for name in values if name not in bench.free)],
        [probe.parameter for probe in probes.probes],
        [probe.errs for probe in probes.probes],
        {**bench.given, **values},
        runs,
        **options,
    )
    return sketched(found, probes, effects)


def starts_of(found: Relaxed, bench: Bench) -> tuple[dict[str, float], ...]:
    """Return the states that the smoother begins with, by recording."""
    names = [state.name for state in found.functions.equations.states]
    first: dict[str, dict[str, float]] = {}
    for course in found.courses:
        first.setdefault(course.record.name, dict(zip(names, course.x[0].tolist(), strict=True)))
    return tuple(first[row.name] for row in bench.recordings)


def ways_of(found: Relaxed) -> dict[tuple[str, str], float]:
    """Return in which directions the model errs, by pairs of states."""
    names = [state.name for state in found.functions.equations.states]
    return {
        (one, other): float(found.ways[i, j])
        for i, one in enumerate(names)
        for j, other in enumerate(names)
    }


def _refitted(
    bench: Bench,
    current: Trial,
    drafts: Sequence[Draft],
    first: Sequence[str],
    known: Sequence[Trial],
    tell: Tell,
) -> list[Trial]:
    """Refit the best drafts, and in any case those whose labels are among the first.

    Easing a fit in takes little and tells which hypotheses are worth a fit by runs.
    """
    nearest = sorted(drafts, key=lambda draft: draft.off)
    wanted = {*first, *(draft.label for draft in nearest[:FITTED])}
    closest = nearest[0].off if nearest else math.inf
    useful = [draft for draft in drafts if not idle_pair(draft, drafts)]
    likeliest = min((draft.likelihood for draft in useful), default=math.inf)
    trials: list[Trial] = []
    reached, terms = math.inf, 0
    # runs that search their modes have slow derivatives: where one fit of them fails, others do
    impacts = not current.model.switched
    slow = impacts and any(t.model.switched and delta_bic(current, t) < 0 for t in known)
    useful.sort(key=lambda draft: (impacts and draft.model.switched, draft.likelihood))
    began = time.process_time()
    for place, draft in enumerate(useful):
        behind = math.isfinite(draft.likelihood) and draft.likelihood > reached + HOPELESS
        if behind and draft.terms >= terms:
            continue
        if place >= FITTED and draft.label not in wanted:
            continue
        if slow and draft.model.switched:
            continue
        over = time.process_time() - began > ROUND * bench.seconds
        if bench.late or (over and not (impacts and draft.model.switched)):
            break
        tell(f"fitting {draft.label}")
        outdone = draft.likelihood > likeliest + HOPELESS and draft.off > OUTDONE * closest
        share = 0.25 if outdone else 0.5
        if draft.model.switched:  # where impacts happen, a run tells little before a scan
            share = 2.0 if draft.off <= 2 * closest else 1.0
        trial = fitted_from(replace(bench, seconds=share * bench.seconds), draft)
        if impacts and draft.model.switched:
            slow = not isinstance(trial, Trial) or delta_bic(current, trial) < 0
        if isinstance(trial, Trial):
            trials.append(trial)
            if (near_noise(trial, bench) or white(trial)) and draft.likelihood < reached:
                reached, terms = draft.likelihood, draft.terms
    return trials
