"""Advice: what to change, in sentences made of sensitivities and margins."""

from __future__ import annotations

from collections.abc import Sequence

from ..linear import Mode
from .margins import Margin
from .sensitivity import Effect, Sensitivities
from .verdict import critical, crossing, is_stable, way

# The change that effects are told for.
CHANGE = 0.1
LEVERS = 4
MARGINS = 3
# Beside the strongest: a lever with less effect is not worth a sentence.
WORTH = 0.01


def levers(
    modes: Sequence[Mode], sensitivities: Sensitivities, most: int = LEVERS
) -> tuple[Effect, ...]:
    """Return the parameters that move the growth of the critical mode most, strongest first.

    Parameters
    ----------
    modes : sequence of Mode
        In the order of the eigenvalues that were differentiated.
    sensitivities : Sensitivities
    most : int

    Returns
    -------
    tuple of Effect
        Without those that the table derives from others.
    """
    if not modes:
        return ()
    index = list(modes).index(critical(modes))
    found = sensitivities.ranked(index, derived=False, by="growth")
    strongest = max((abs(item.growth(1.0)) for item in found), default=0.0)
    return tuple(item for item in found if abs(item.growth(1.0)) >= WORTH * strongest)[:most]


def advice(
    modes: Sequence[Mode], sensitivities: Sensitivities, margins: Sequence[Margin]
) -> tuple[str, ...]:
    """Say what to change: the strongest levers, and how far which parameter may go.

    Parameters
    ----------
    modes : sequence of Mode
    sensitivities : Sensitivities
    margins : sequence of Margin
        Nearest first.

    Returns
    -------
    tuple of str
        Sentences.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import assess
    >>> result = assess(bicycle_brake.graph(), {"v_s": 0.2})
    >>> for sentence in advice(result.rows, result.sensitivities, result.margins)[:1]:
    ...     print(sentence[:96])
    10 % less mu_s (static friction coefficient) lowers the growth rate of the 201.3 Hz mode by 57.5
    """
    if not modes:
        return ()
    mode = critical(modes)
    name = f"{mode.frequency_hz:.4g} Hz mode" if mode.eigenvalue.imag else "critical real mode"
    said = [_lever(item, name) for item in levers(modes, sensitivities)]
    until = "before it is unstable" if is_stable(modes) else "for it to be stable"
    for margin in [item for item in margins if item.nearest is not None][:MARGINS]:
        edge = margin.nearest
        assert edge is not None
        said.append(f"{way(margin, edge)} {until} ({crossing(edge)}).")
    return tuple(said)


def _lever(effect: Effect, mode: str) -> str:
    """Say what a change of one parameter in the direction that helps does."""
    sense = -1 if effect.growth(CHANGE) > 0 else 1
    words = "less" if sense < 0 else "more"
    meaning = f" ({effect.meaning})" if effect.meaning else ""
    drop = abs(effect.growth(CHANGE))
    moved = effect.frequency(sense * CHANGE)
    shift = f" and moves it by {moved:+.2g} Hz" if abs(moved) >= 0.05 else ""
    return (
        f"{CHANGE:.0%} {words} {effect.parameter}{meaning} lowers the growth rate of the {mode} by "
        f"{drop:.3g} 1/s{shift}."
    ).replace("%", " %", 1)
