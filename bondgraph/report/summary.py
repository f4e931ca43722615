"""The result in a few words, for the top of a page and for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy

from ..stability import Edge, Effect, StabilityResult
from ..stability.advice import CHANGE

if TYPE_CHECKING:
    from ..attractors import Attractors

# How a vibration starts behind an edge; where the cubic term is zero it does not say.
ONSETS = {"soft": "soft", "hard": "hard", "degenerate": "onset undecided"}
# What moves the mode by less than this share of what the first parameter does is not worth a row.
WORTH_SAYING = 1e-3


def headline(result: StabilityResult, attractors: Attractors | None = None) -> str:
    """Return the verdict in a few words.

    Parameters
    ----------
    result : StabilityResult
    attractors : Attractors, optional
        Where a cycle lives beside the steady state, the word "stable" alone would mislead.

    Returns
    -------
    str

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> headline(assess(mass_on_belt.graph()))
    'Unstable'
    """
    if result.stable and attractors is not None and attractors.beside:
        return "Stable for small motions, with a vibration beside it"
    if result.stable:
        return "Stable"
    worst = max((mode.growth for mode in result.rows), default=0)
    return "Unstable" if worst > 0 else "Neither stable nor unstable"


def ranked(result: StabilityResult) -> tuple[Effect, ...]:
    """Return the parameters that move the critical mode, by falling effect on its growth rate.

    Parameters
    ----------
    result : StabilityResult

    Returns
    -------
    tuple of Effect
        Without what hardly counts, and without parameters that the table derives from others.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> ranked(assess(mass_on_belt.graph()))[0].parameter
    'mu_s'
    """
    if result.critical is None:
        return ()
    found = result.sensitivities.ranked(_index(result), derived=False, by="growth")
    largest = abs(found[0].growth(CHANGE)) if found else 0.0
    return tuple(item for item in found if abs(item.growth(CHANGE)) > WORTH_SAYING * largest)


def _index(result: StabilityResult) -> int:
    """Return the place of the critical mode; there is one."""
    return next(k for k, mode in enumerate(result.rows) if mode is result.critical)


def _slopes(result: StabilityResult) -> numpy.ndarray:
    """Return the derivatives of the critical eigenvalue."""
    if result.critical is None:
        return numpy.zeros(0)
    return numpy.asarray(result.sensitivities.derivatives[_index(result)])


def unmoved(result: StabilityResult) -> str:
    """Say why there is no parameter that moves the critical mode.

    Parameters
    ----------
    result : StabilityResult

    Returns
    -------
    str
        A sentence; empty where there is one.

    Examples
    --------
    >>> from bondgraph import C, I, One, assemble
    >>> from bondgraph.stability import assess
    >>> unmoved(assess(assemble("free", One("v") >> (I("m", 1), C("k", stiffness=4)))))
    'No parameter moves the growth rate of the critical mode.'
    """
    if ranked(result):
        return ""
    if not numpy.isfinite(_slopes(result)).all():
        return "How parameters move the critical mode cannot be told by slopes."
    return "No parameter moves the growth rate of the critical mode."


def onset_words(edge: Edge) -> str:
    """Say in a few words what begins at an edge.

    Parameters
    ----------
    edge : Edge

    Returns
    -------
    str

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import assess
    >>> onset_words(assess(bicycle_brake.graph(), vary=["V0=0.3:0.9:20"]).edges[0])
    '200.5 Hz begin, hard'
    """
    if edge.kind != "hopf":
        return "a drift without swinging begins"
    kind = "" if edge.onset is None else f", {ONSETS.get(edge.onset.kind, edge.onset.kind)}"
    return f"{edge.frequency_hz:.4g} Hz begin{kind}"
