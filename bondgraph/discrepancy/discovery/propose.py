"""Proposals: what a sketch says is worth a try, grown in and eased."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy

from ..latent.relax import LONGEST
from ..latent.screen import Hypothesis, Sketch
from .bench import Added, Bench, Draft, Trial, kept, label_of, near_noise
from .trial import drafted

Tell = Callable[[str], object]

MOST = 3  # effects
DRY = ("coulomb_friction", "stribeck_friction", "lugre_friction", "hysteresis")
PROMISE = 0.7  # of what a refit has to bring, to be worth one
ALONG = 4  # of those that a score along the model's own run puts first
SINGLES, PAIRS, HIDDEN = 10, 4, 3  # eased in each round
FIRST, FITTED = 2, 3  # of them fitted by runs: the first of the sketch, the best eased ones
TRIES = 1.5  # so many times a fit's limit may the tries of a round take
WORTH = 10.0  # drop of the criterion that an effect has to bring: odds of 150 to 1


def drafts_of(
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
    began = time.process_time()
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
        if bench.late or time.process_time() - began > TRIES * bench.seconds:
            break
        tell(f"trying {label}")
        own = [
            _own(beside if beside and item in others else sketch, item),
            current.values,
            base.values,
        ]
        draft = drafted(bench, kept(current, added), own)
        if isinstance(draft, Draft):
            drafts.append(draft)
            if any(item is one for one in (*wanted[:FIRST], *twos[:1], *hidden[:1], *others[:1])):
                first.append(draft.label)
    return drafts, first


def idle_pair(draft: Draft, drafts: Sequence[Draft]) -> bool:
    """Whether a draft with fewer of the same effects is as likely."""
    own = {item.label for item in draft.added}
    return any(
        {item.label for item in other.added} < own and other.likelihood <= draft.likelihood + WORTH
        for other in drafts
    )


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
