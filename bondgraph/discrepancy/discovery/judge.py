"""Judgement: whether what was found may be named, and if not, why not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .bench import Trial, idle
from .compare import delta_bic, log_ratio
from .verdict import Verdict

HALF = 0.5  # of the held-out gap above the noise has to go
CLEAR = 6.0  # strong evidence (Kass, Raftery 1995), by which the criterion has to prefer the best to others
NEAR = 0.25  # of the gap before may be left, where the noise is not reached
NOISE = 1.5  # times the noise count as near it
ABOVE = 1.3  # times the noise are a gap


@dataclass(frozen=True, eq=False)
class Judgement:
    """What may be said.

    Attributes
    ----------
    verdict : Verdict
    members : tuple of Trial
        The best, and those that the data cannot tell from it.
    failed : tuple of str
        Why the best may not be named.
    """

    verdict: Verdict
    members: tuple[Trial, ...]
    failed: tuple[str, ...]


def judged(
    best: Trial,
    trials: Sequence[Trial],
    removed: float,
    near: float,
    above: bool,
    unsteady: Sequence[str] = (),
) -> Judgement:
    """Judge the best trial.

    Parameters
    ----------
    best : Trial
    trials : sequence of Trial
    removed : float
        Share of the held-out gap above the noise that is gone.
    near : float
        Largest gap after over the noise, of all signals.
    above : bool
        Whether the base leaves more than noise, for sure.
    unsteady : sequence of str
        Effects whose size is not the same all along, in words.

    Returns
    -------
    Judgement
    """
    if not best.added:
        return Judgement(Verdict.UNNAMED if above else Verdict.NONE, (best,), ())
    failed = []
    if not removed >= HALF:
        failed.append(f"only {max(removed, 0):.0%} of the held-out gap above the noise goes")
    if near > NOISE and not removed >= 1 - NEAR:
        failed.append(f"what is left is {near:.1f} times the noise")
    failed += _unphysical(best)
    failed += idle(best).values()
    failed += unsteady
    rivals = tuple(rival for rival in trials if _rivals(best, rival))
    if failed and not above and removed < HALF:
        return Judgement(Verdict.NONE, (best,), tuple(failed))
    if failed:
        return Judgement(Verdict.UNNAMED, (best, *rivals), tuple(failed))
    if rivals:
        return Judgement(Verdict.AMBIGUOUS, (best, *rivals), ())
    return Judgement(Verdict.NAMED, (best,), ())


def _rivals(best: Trial, other: Trial) -> bool:
    """Whether the data do not clearly prefer the best to another.

    One that has more coefficients for the same, such as friction with a Stribeck part that is
    hardly used, is no other explanation.
    """
    if other is best or len(other.added) != len(best.added) or not other.added:
        return False
    if delta_bic(other, best) >= CLEAR:
        return False
    more = other.terms > best.terms
    gain, _ = log_ratio(best, other)
    same_places = {item.site.name for item in best.added} == {
        item.site.name for item in other.added
    }
    return not (more and same_places and gain < CLEAR)


def _unphysical(best: Trial) -> list[str]:
    words = []
    for item, grafted in zip(best.added, best.grafts, strict=True):
        values = {key: best.values.get(name, 0.0) for key, name in grafted.parameters.items()}
        wrong = item.effect.physical(values)
        gone = [key for key, absent in item.effect.absent.items() if values[key] == absent]
        if wrong or (gone and len(gone) == len(item.effect.absent)):
            words.append(f"{', '.join(wrong or gone)} of {item.label} would have to be negative")
    return words
