"""The search: screen, refit the best few, take the best, and again until noise is left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy

from ...errors import BondGraphError, SimulationError
from ...simulation import CompiledModel
from ..candidates import Effect
from ..latent.null import threshold
from ..latent.probes import probed
from ..latent.relax import Relaxed, relaxed
from ..latent.screen import Hypothesis, Sketch, sketched
from .compare import delta_bic
from .trial import Added, Bench, Trial, tried

Array = numpy.ndarray
Tell = Callable[[str], object]

MOST = 3  # effects
SINGLES, PAIRS = 6, 2  # refitted in each round
SHORTEST, TIMES = 4.0, 8.0  # a fit may take so many seconds, or times as long as the base
WORTH = 10.0  # drop of the criterion that an effect has to bring: odds of 150 to 1


@dataclass(frozen=True, eq=False)
class Found:
    """What a search has.

    Attributes
    ----------
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
    """

    base: Trial
    trials: tuple[Trial, ...]
    best: Trial
    sketches: tuple[Sketch, ...]
    limits: tuple[float, ...]
    warnings: tuple[str, ...]


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
    sketch = _sketched(bench, bench.graph, signals, effects, {})
    bench = replace(bench, starts=starts_of(sketch.relaxed, bench), ways=ways_of(sketch.relaxed))
    tell("fitting the model by itself")
    base = tried(bench, (), [bench.given], segments="auto")
    if isinstance(base, BondGraphError):
        raise base
    bench = replace(bench, seconds=max(SHORTEST, TIMES * base.fit.seconds))
    current, trials, warnings = base, list[Trial](), list[str]()
    sketches, limits = [], []
    while True:
        limit = threshold(sketch)
        sketches.append(sketch)
        limits.append(limit)
        fresh = _refitted(bench, current, base, sketch, limit, trials, tell)
        trials += fresh
        better = max(fresh, key=lambda trial: delta_bic(current, trial), default=None)
        if better is None or delta_bic(current, better) < max(WORTH, limit):
            break
        current = better
        if len(current.added) >= MOST or near_noise(current, bench):
            break
        tell(f"screening again beside {current.label}")
        try:
            sketch = _sketched(bench, current.graph, signals, effects, current.values)
        except BondGraphError as error:
            warnings.append(f"no second search: {error}")
            break
    current = _without(bench, base, current, trials, tell)
    return Found(base, tuple(trials), current, tuple(sketches), tuple(limits), tuple(warnings))


def near_noise(trial: Trial, bench: Bench) -> bool:
    """Whether all that is left of every signal is noise."""
    for name, squares in trial.squares.items():
        noise = [row.noise[name] for row in bench.recordings if name in row.noise]
        sure = all(row.told.get(name, False) for row in bench.recordings if name in row.noise)
        floor = float(numpy.sqrt(numpy.mean(numpy.square(noise))))
        if not sure or (squares / trial.counts[name]) ** 0.5 > 1.03 * floor:
            return False
    return True


def _sketched(
    bench: Bench,
    graph: object,
    signals: Sequence[str],
    effects: Sequence[Effect],
    values: dict[str, float],
) -> Sketch:
    probes = probed(graph, effects)  # type: ignore[arg-type]
    model = CompiledModel(probes.graph)
    if model.equations.algebraic:
        raise SimulationError(
            f"model {bench.graph.name!r} keeps algebraic variables, which this search cannot follow; "
            "add a compliance or inertia where they arise"
        )
    found = relaxed(
        model,
        [row.record(signals) for row in bench.recordings],
        signals,
        [*bench.free, *(name for name in values if name not in bench.free)],
        [probe.parameter for probe in probes.probes],
        [probe.errs for probe in probes.probes],
        {**bench.given, **values},
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
) -> list[Trial]:
    """Refit the best hypotheses of a sketch, beside what is in the graph already."""
    done = {trial.label for trial in known}
    trials = []
    worth = [item for item in sketch.singles if item.gain > min(limit, WORTH)]
    wanted = worth[:SINGLES]
    alone = wanted[0].gain if wanted else 0.0
    room = MOST - len(current.added)
    twos = [item for item in sketch.pairs if item.gain > alone + WORTH and room > 1]
    for item in [*wanted, *twos[:PAIRS]]:
        added = (*current.added, *(_added(item, i) for i in range(len(item.candidates))))
        added = tuple({each.label: each for each in added}.values())
        label = " + ".join(sorted(each.label for each in added))
        if label in done or len(added) <= len(current.added):
            continue
        done.add(label)
        tell(f"fitting {label}")
        own = [_own(sketch, item), current.values, base.values]
        kept = _kept(current, added)
        trial = tried(bench, kept, own)
        if isinstance(trial, Trial):
            trials.append(trial)
    return trials


def _kept(current: Trial, added: Sequence[Added]) -> tuple[Added, ...]:
    """Return effects with those that are in the graph already starting from their fitted values."""
    values = {}
    for item, grafted in zip(current.added, current.grafts, strict=True):
        values[item.label] = {key: current.values[name] for key, name in grafted.parameters.items()}
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
    return table.given(sketch.relaxed.values + numpy.clip(item.own, -0.7, 0.7))


def _without(bench: Bench, base: Trial, current: Trial, trials: list[Trial], tell: Tell) -> Trial:
    """Drop effects that others have made needless."""
    while len(current.added) > 1:
        fewer = []
        for item in current.added:
            rest = tuple(each for each in _kept(current, current.added) if each is not item)
            rest = tuple(each for each in rest if each.label != item.label)
            label = " + ".join(sorted(each.label for each in rest))
            same = [trial for trial in trials if trial.label == label]
            if not same:
                tell(f"fitting {label}")
                trial = tried(bench, rest, [current.values, base.values])
                same = [trial] if isinstance(trial, Trial) else []
                trials += same
            fewer += same
        best = min(fewer, key=lambda trial: delta_bic(trial, current), default=None)
        if best is None or delta_bic(best, current) >= WORTH:
            break
        current = best
    return current
