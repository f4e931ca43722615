"""Sentences: what a discovery says to a reader."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..fitting import Fit
from ..latent.steady import Steadiness
from .value import Gap, NamedEffect
from .verdict import Verdict


def verdict_words(
    model: str,
    verdict: Verdict,
    effects: Sequence[NamedEffect],
    failed: Sequence[str],
    gaps: Mapping[str, Gap],
    removed: float,
) -> tuple[str, ...]:
    """Return the verdict in two sentences.

    Parameters
    ----------
    model : str
    verdict : Verdict
    effects : sequence of NamedEffect
    failed : sequence of str
        Why nothing is named.
    gaps : mapping of str to Gap
        On held-out data.
    removed : float
        Share of the gap above the noise that is gone there.
    """
    listed = _and([f"{effect.name.replace('_', ' ')} at {effect.site}" for effect in effects])
    if verdict is Verdict.NAMED:
        return f"'{model}' lacks {listed}.", _shrinks(gaps, removed)
    if verdict is Verdict.AMBIGUOUS:
        either = " or ".join(dict.fromkeys(effect.label for effect in effects))
        return (
            f"'{model}' lacks something, and the data cannot tell what: {either}.",
            _shrinks(gaps, removed),
        )
    if verdict is Verdict.UNNAMED:
        near = f"; the nearest is {listed}" if effects else ""
        why = f", but {_and(failed)}" if failed and effects else ""
        return (
            f"'{model}' lacks something that none of the known effects explains{near}{why}.",
            _shrinks(gaps, removed) if effects else _left(gaps),
        )
    but = f", but {failed[0]}" if failed and not effects and "number" in failed[0] else ""
    return f"The data show nothing that '{model}' lacks{but}.", _left(gaps)


def _shrinks(gaps: Mapping[str, Gap], removed: float) -> str:
    name, gap = max(gaps.items(), key=lambda pair: _above(pair[1]))
    share = f"{max(removed, 0.0):.0%}" if math.isfinite(removed) else "an unknown share"
    return (
        f"On data it was not fitted to, the gap of {name} goes from {gap.before:.3g} to "
        f"{gap.after:.3g} {gap.unit} with noise of {gap.noise_floor:.2g}: {share} of what lies above "
        f"the noise, all signals together."
    ).replace("  ", " ")


def _left(gaps: Mapping[str, Gap]) -> str:
    name, gap = max(gaps.items(), key=lambda pair: _above(pair[1]))
    return (
        f"With its own parameters fitted, the largest gap on data it was not fitted to is that of "
        f"{name}: {gap.before:.3g} {gap.unit} where the noise is {gap.noise_floor:.2g}."
    ).replace("  ", " ")


def _above(gap: Gap) -> float:
    if not gap.noise_floor > 0 or not math.isfinite(gap.before):
        return 0.0
    return gap.before / gap.noise_floor


def _and(parts: Sequence[str]) -> str:
    return " and ".join(parts)


def unseen_words(fit: Fit) -> tuple[str, ...]:
    """Return what the data do not tell of the parameters."""
    return tuple(direction.words for direction in fit.unidentified)


def unsteady_words(found: Sequence[Steadiness]) -> list[str]:
    """Say which effects are not as large in one part of the recordings as in another."""
    return [
        f"in part {part + 1} of {len(item.sizes)} of the recordings {item.label} is {size:.2g} times "
        "as large as in all of them"
        for item in found
        for part, size in item.unsteady.items()
    ]
