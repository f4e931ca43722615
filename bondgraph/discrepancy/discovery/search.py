"""The search: screen, refit the best few, take the best, and again until noise is left."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy

from ...errors import BondGraphError
from ...simulation import CompiledModel
from ..candidates import Effect
from ..latent.null import threshold
from ..latent.probes import probed
from ..latent.relax import LONGEST, Relaxed, relaxed
from ..latent.screen import Hypothesis, Sketch, sketched
from .bench import Added, Bench, Draft, Trial, idle, label_of, near_noise
from .compare import delta_bic, preference
from .constants import Constant, constant_off
from .gaps import WHITE, sizes
from .outliers import without_outliers
from .trial import drafted, fitted_from, tried

Tell = Callable[[str], object]

MOST = 3  # effects
DRY = ("coulomb_friction", "stribeck_friction", "lugre_friction", "hysteresis")
LOST = 0.8  # of a signal's deviation
PROMISE = 0.7  # of what a refit has to bring, to be worth one
ALONG = 4  # of those that a score along the model's own run puts first
SETTLED, PATIENT = 150, 3.0  # steps of the last fit, and how many times longer it may take
SINGLES, PAIRS, HIDDEN = 10, 4, 3  # eased in each round
FIRST, FITTED = 2, 3  # of them fitted by runs: the first of the sketch, the best eased ones
HOPELESS = 50.0  # behind one that reaches the noise, by twice the logarithm of the likelihood
OUTDONE = 3.0  # times as far from the data as the nearest, and less likely: worth a short fit only
TRIES, ROUND = 1.5, 2.0  # so many times a fit's limit may the tries and the fits of a round take
ROUNDS = 3.0  # the same, after which no other round is begun
SAMPLE = 5e-4  # seconds that a fit may take for each sample of a long recording
SHORTEST, TIMES = 8.0, 3.0  # a fit may take so many seconds, or times as long as the base
WORTH = 10.0  # drop of the criterion that an effect has to bring: odds of 150 to 1


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
    settled: Trial | None = None
    began = time.monotonic()
    sketches, limits = [], []
    while True:
        limit = threshold(sketch)
        sketches.append(sketch)
        limits.append(limit)
        fresh = _refitted(bench, current, base, sketch, limit, trials, tell, beside)
        trials += fresh
        better = max(fresh, key=lambda trial: preference(current, trial), default=None)
        if better is None or delta_bic(current, better) < max(WORTH, limit):
            break
        current = better
        if not current.fit.outcome.ok:
            # what a fit has not come to yet looks like an effect that is missing
            current = settled = _settled(bench, current, trials, tell)
        if len(current.added) >= MOST or near_noise(current, bench) or white(current):
            break
        if bench.late or time.monotonic() - began > ROUNDS * bench.seconds:
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
    current = _without(bench, base, current, trials, tell)
    current = _simplified(bench, base, current, trials, effects, tell)
    if current.added and current is not settled and not near_noise(current, bench):
        current = _settled(bench, current, trials, tell)
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


def _settled(bench: Bench, trial: Trial, trials: list[Trial], tell: Tell) -> Trial:
    """Fit a trial once more, patiently; what is better takes its place among the trials."""
    tell(f"settling {trial.label}")
    patient = replace(bench, seconds=max(bench.seconds, PATIENT * trial.fit.seconds))
    found = tried(patient, _kept(trial, trial.added), [trial.values], steps=SETTLED)
    if isinstance(found, BondGraphError) or delta_bic(trial, found) <= 0:
        return trial
    trials[:] = [found if each is trial else each for each in trials]
    return found


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
    base: Trial,
    sketch: Sketch,
    limit: float,
    known: Sequence[Trial],
    tell: Tell,
    beside: Sketch | None,
) -> list[Trial]:
    """Refit the best hypotheses of a sketch, beside what is in the graph already.

    Easing a fit in takes little and tells which hypotheses are worth a fit by runs.
    """
    drafts, first = _drafts(bench, current, base, sketch, limit, known, tell, beside)
    nearest = sorted(drafts, key=lambda draft: draft.off)
    first += [draft.label for draft in nearest[:FITTED]]
    closest = nearest[0].off if nearest else math.inf
    drafts = [draft for draft in drafts if not _idle_pair(draft, drafts)]
    likeliest = min((draft.likelihood for draft in drafts), default=math.inf)
    trials: list[Trial] = []
    reached, terms = math.inf, 0
    # runs that search their modes have slow derivatives: where one fit of them fails, others do
    impacts = not current.model.switched
    slow = impacts and any(t.model.switched and delta_bic(current, t) < 0 for t in known)
    drafts.sort(key=lambda draft: (impacts and draft.model.switched, draft.likelihood))
    began = time.monotonic()
    for place, draft in enumerate(drafts):
        behind = math.isfinite(draft.likelihood) and draft.likelihood > reached + HOPELESS
        if behind and draft.terms >= terms:
            continue
        if place >= FITTED and draft.label not in first:
            continue
        if slow and draft.model.switched:
            continue
        over = time.monotonic() - began > ROUND * bench.seconds
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


def _idle_pair(draft: Draft, drafts: Sequence[Draft]) -> bool:
    """Whether a draft with fewer of the same effects is as likely."""
    own = {item.label for item in draft.added}
    return any(
        {item.label for item in other.added} < own and other.likelihood <= draft.likelihood + WORTH
        for other in drafts
    )


def _drafts(
    bench: Bench,
    current: Trial,
    base: Trial,
    sketch: Sketch,
    limit: float,
    known: Sequence[Trial],
    tell: Tell,
    beside: Sketch | None,
) -> tuple[list[Draft], list[str]]:
    """Return what a sketch says is worth a try, beside what is in the graph already.

    Also return the labels of those that are to be fitted in any case: the best of each kind.
    """
    done = {trial.label for trial in known}
    worth = [item for item in sketch.singles if item.gain > PROMISE * max(limit, WORTH)]
    if not near_noise(current, bench):
        # something is left: the best are tried, whatever they promise
        worth = worth or [item for item in sketch.singles if item.gain > 0][:FITTED]
    wanted = worth[:SINGLES]
    alone = wanted[0].gain if wanted else 0.0
    room = MOST - len(current.added)
    twos = _led(sketch, alone)
    hidden = _hidden(sketch)
    pairs = [*twos[:PAIRS], *hidden[:HIDDEN]] if room > 1 else []
    drafts: list[Draft] = []
    first: list[str] = []
    began = time.monotonic()
    others = [] if beside is None else beside.singles[:ALONG]
    items = [*wanted, *pairs, *(item for item in others if item.gain > WORTH)]
    for item in items:
        if len(item.candidates) > 1 and any(each.effect.impacts for each in item.candidates):
            continue  # runs with impacts take long: what is beside them is found in the next round
        added = (*current.added, *(_added(item, i) for i in range(len(item.candidates))))
        added = tuple({each.label: each for each in added}.values())
        label = label_of(added)
        if label in done or len(added) <= len(current.added) or _one_contact(added):
            continue
        done.add(label)
        if bench.late or time.monotonic() - began > TRIES * bench.seconds:
            break
        tell(f"trying {label}")
        own = [
            _own(beside if beside and item in others else sketch, item),
            current.values,
            base.values,
        ]
        draft = drafted(bench, _kept(current, added), own)
        if isinstance(draft, Draft):
            drafts.append(draft)
            if any(item is one for one in (*wanted[:FIRST], *twos[:1], *hidden[:1], *others[:1])):
                first.append(draft.label)
    return drafts, first


def _one_contact(added: Sequence[Added]) -> bool:
    """Whether two of the effects are descriptions of one and the same rubbing contact."""
    places = [item.site.name for item in added if item.effect.name in DRY]
    return len(set(places)) < len(places)


def _led(sketch: Sketch, alone: float) -> list[Hypothesis]:
    """Return the best pair that each of the best singles leads, where it brings more than that one.

    Pairs with one effect that seems to explain much would otherwise crowd out all others.
    """
    rank = {item.label: place for place, item in enumerate(sketch.singles)}
    found: dict[int, Hypothesis] = {}
    for item in sketch.pairs:
        places = [rank.get(member.label, len(rank)) for member in item.candidates]
        leader = min(places)
        worth = sketch.singles[leader].gain if leader < len(rank) else alone
        if item.gain > worth + WORTH and leader not in found:
            found[leader] = item
    return [found[place] for place in sorted(found)]


def _hidden(sketch: Sketch) -> list[Hypothesis]:
    """Return pairs that bring more than their members do by themselves, most of all first.

    Dry friction and air drag, say, beside a viscous bearing that stands for both.
    """
    alone = {item.label: max(item.gain, 0.0) for item in sketch.singles}

    def beyond(item: Hypothesis) -> float:
        return item.gain - sum(alone.get(member.label, 0.0) for member in item.candidates)

    return sorted((p for p in sketch.pairs if beyond(p) > WORTH), key=beyond, reverse=True)


def _kept(current: Trial, added: Sequence[Added]) -> tuple[Added, ...]:
    """Return effects with those that are in the graph already starting from their fitted values."""
    values = {}
    for item, grafted in zip(current.added, current.grafts, strict=True):
        values[item.label] = {
            key: current.values.get(name, item.starts[key])
            for key, name in grafted.parameters.items()
        }
    return tuple(
        replace(item, starts=values[item.label]) if item.label in values else item for item in added
    )


def _added(item: Hypothesis, number: int) -> Added:
    candidate = item.candidates[number]
    starts = candidate.effect.start(candidate.scale)
    starts |= candidate.starts(item.amounts[number].tolist())
    return Added(candidate.effect, candidate.site, starts, candidate.pair)


def _own(sketch: Sketch, item: Hypothesis) -> dict[str, float]:
    """Return the own parameters that go with a hypothesis, to first order."""
    table = sketch.relaxed.table
    longest = float(numpy.abs(item.own).max(initial=LONGEST))
    return table.given(sketch.relaxed.values + item.own * min(1.0, LONGEST / longest))


def _without(bench: Bench, base: Trial, current: Trial, trials: list[Trial], tell: Tell) -> Trial:
    """Drop effects that others have made needless."""
    while len(current.added) > 1:
        fewer = []
        for item in current.added:
            kept = _kept(current, current.added)
            rest = tuple(each for each in kept if each.label != item.label)
            label = label_of(rest)
            same = [trial for trial in trials if trial.label == label]
            # beside an effect that does nothing, the others may have come further
            if not same or item.label in idle(current):
                tell(f"fitting {label}")
                trial = tried(bench, rest, [current.values, base.values])
                fresh = [trial] if isinstance(trial, Trial) else []
                trials += fresh
                same = [*same, *fresh]
            fewer += same
        best = min(fewer, key=lambda trial: delta_bic(trial, current), default=None)
        if best is None or delta_bic(best, current) >= WORTH:
            break
        current = best
    return current


def _simplified(
    bench: Bench,
    base: Trial,
    current: Trial,
    trials: list[Trial],
    effects: Sequence[Effect],
    tell: Tell,
) -> Trial:
    """Put a simpler effect in the place of one that comes down to it, unless that loses something."""
    table = {effect.name: effect for effect in effects}
    while True:
        simpler = []
        kept = _kept(current, current.added)
        for place, item in enumerate(kept):
            for effect in (table[name] for name in item.effect.limits if name in table):
                starts = {key: item.starts[key] for key in effect.fitted}
                added = (
                    *kept[:place],
                    replace(item, effect=effect, starts=starts),
                    *kept[place + 1 :],
                )
                known = [trial for trial in trials if trial.label == label_of(added)]
                if not known:
                    tell(f"fitting {label_of(added)}")
                    trial = tried(bench, added, [current.values, base.values])
                    known = [trial] if isinstance(trial, Trial) else []
                    trials += known
                simpler += known
        best = min(simpler, key=lambda trial: delta_bic(trial, current), default=None)
        if best is None or delta_bic(best, current) >= 0:
            return current
        current = best
