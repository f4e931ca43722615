"""The result in a few words, for the top of a page and for a terminal."""

from __future__ import annotations

import numpy

from ..plot import pretty
from ..stability import Edge, Effect, StabilityResult
from ..units import from_si
from .words import number

# Effects are told for parameters that change by this share of themselves.
CHANGE = 0.1
# How a vibration starts behind an edge; where the cubic term is zero it does not say.
ONSETS = {"soft": "soft", "hard": "hard", "degenerate": "onset undecided"}
# Factors up to this are told in percent.
FAR = 3.0
# What moves the mode by less than this share of what the first parameter does is not worth a row.
WORTH_SAYING = 1e-3


def headline(result: StabilityResult) -> str:
    """Return the verdict in a word or four.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> headline(assess(mass_on_belt.graph()))
    'Unstable'
    """
    if result.stable:
        return "Stable"
    worst = max((mode.growth for mode in result.rows), default=0)
    return "Unstable" if worst > 0 else "Neither stable nor unstable"


def opening(result: StabilityResult) -> tuple[list[str], list[str]]:
    """Return two sentences that come first, and what the verdict says besides.

    The first says whether it is stable; the second which smallest change of one parameter leads
    to the edge of stability, or where none is known what feeds and drains the critical mode.

    Parameters
    ----------
    result : StabilityResult

    Returns
    -------
    shown, rest : list of str

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> shown, rest = opening(assess(mass_on_belt.graph()))
    >>> shown[1], rest
    ('It becomes stable when mu_s is lowered by 35.3 % to 0.258963.', ['contact feeds it ...'])
    """
    sentences = result.verdict.splitlines()
    if result.margins:
        return [*sentences[:1], nearest_edge(result)], sentences[1:]
    return sentences[:2], sentences[2:]


def nearest_edge(result: StabilityResult) -> str:
    """Say which smallest change of one parameter leads to the edge of stability.

    Parameters
    ----------
    result : StabilityResult

    Returns
    -------
    str
        A sentence; empty where margins were not asked for.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import assess
    >>> nearest_edge(assess(bicycle_brake.graph()))
    'The nearest edge of stability: V0 lowered by 64.2 % to 0.322324 m/s; there 200.5 Hz begin, hard.'
    """
    if not result.margins:
        return ""
    margin = result.margins[0]
    edge, factor = margin.nearest, margin.factor
    if edge is None or factor is None:
        return "No parameter has an edge of stability between a tenth and ten times its value."
    unit = f" {pretty(margin.unit)}" if margin.unit else ""
    value = f"{number(from_si(edge.value, margin.unit))}{unit}"
    change = f"{margin.parameter} {'lowered' if factor < 1 else 'raised'} {_by(factor)} to {value}"
    if result.stable:
        return f"The nearest edge of stability: {change}; there {onset_words(edge)}."
    if max(mode.growth for mode in result.rows) > 0:
        return f"It becomes stable when {change.replace(' ', ' is ', 1)}."
    return f"The nearest edge of stability: {change}."


def _by(factor: float) -> str:
    """Write a factor as a change: in percent while that is easy to grasp."""
    if 1 / FAR <= factor <= FAR:
        return f"by {abs(factor - 1):.1%}".replace("%", " %")
    return f"{1 / factor if factor < 1 else factor:.3g} times"


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


def advice(result: StabilityResult) -> str:
    """Say which parameters calm the critical mode most, in one sentence.

    Parameters
    ----------
    result : StabilityResult

    Returns
    -------
    str

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> advice(assess(mass_on_belt.graph()))
    'The critical mode is calmed most by lowering mu_s (0.446 1/s less for 10 %), then by ...'
    """
    told = [
        f"{'lowering' if item.growth(CHANGE) > 0 else 'raising'} {item.parameter} "
        f"({abs(item.growth(CHANGE)):.3g} 1/s less for 10 %)"
        for item in ranked(result)[:3]
    ]
    if not told and not numpy.isfinite(_slopes(result)).all():
        return "How parameters move the critical mode cannot be told by slopes."
    if not told:
        return "No parameter moves the growth rate of the critical mode."
    return f"The critical mode is calmed most by {', then by '.join(told)}."


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
