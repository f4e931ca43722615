"""Refinement: the best fit settled, needless effects dropped, simpler ones put in place of others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...errors import BondGraphError
from ..candidates import Effect
from .bench import Bench, Trial, idle, kept, label_of
from .compare import delta_bic
from .propose import WORTH, Tell
from .trial import tried

SETTLED, PATIENT = 150, 3.0  # steps of the last fit, and how many times longer it may take


def settled(bench: Bench, trial: Trial, trials: list[Trial], tell: Tell) -> Trial:
    """Fit a trial once more, patiently; what is better takes its place among the trials."""
    tell(f"settling {trial.label}")
    patient = replace(bench, seconds=max(bench.seconds, PATIENT * trial.fit.seconds))
    found = tried(patient, kept(trial, trial.added), [trial.values], steps=SETTLED)
    if isinstance(found, BondGraphError) or delta_bic(trial, found) <= 0:
        return trial
    trials[:] = [found if each is trial else each for each in trials]
    return found


def without_needless(
    bench: Bench, base: Trial, current: Trial, trials: list[Trial], tell: Tell
) -> Trial:
    """Drop effects that others have made needless."""
    while len(current.added) > 1:
        fewer = []
        own = kept(current, current.added)
        for item in current.added:
            rest = tuple(each for each in own if each.label != item.label)
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


def simplified(
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
        own = kept(current, current.added)
        for place, item in enumerate(own):
            for effect in (table[name] for name in item.effect.limits if name in table):
                starts = {key: item.starts[key] for key in effect.fitted}
                added = (
                    *own[:place],
                    replace(item, effect=effect, starts=starts),
                    *own[place + 1 :],
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
