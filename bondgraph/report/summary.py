"""The result in a few words, for the top of a page and for a terminal."""

from __future__ import annotations

from ..stability import Edge, Effect, StabilityResult

# Effects are told for parameters that change by this share of themselves.
CHANGE = 0.1
# How a vibration starts behind an edge; where the cubic term is zero it does not say.
ONSETS = {"soft": "soft", "hard": "hard", "degenerate": "onset undecided"}
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
    """Part the verdict into two sentences that come first, and the rest.

    The first says whether it is stable; the second how far the nearest edge is, or where none
    is known what feeds and drains the critical mode.

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
    >>> opening(assess(mass_on_belt.graph()))[0][1]
    'contact feeds it with 1.67 1/s, damper takes 0.1 1/s out of it.'
    """
    sentences = result.verdict.splitlines()
    first, others = sentences[:1], sentences[1:]
    edges = [(locus, locus.nearest) for locus in result.loci]
    distances = {
        locus.name: _relative(edge.value, locus.at) for locus, edge in edges if edge is not None
    }
    second = others[:1]
    if distances:
        near = min(distances, key=distances.__getitem__)
        second = [item for item in others if item.startswith(f"Along {near} ")][:1]
    return first + second, [item for item in others if item not in second]


def _relative(value: float, at: float) -> float:
    return abs(value - at) / (abs(at) or abs(value) or 1.0)


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
    'N'
    """
    if result.critical is None:
        return ()
    index = next(k for k, mode in enumerate(result.rows) if mode is result.critical)
    found = result.sensitivities.ranked(index, derived=False, by="growth")
    largest = abs(found[0].growth(CHANGE)) if found else 0.0
    return tuple(item for item in found if abs(item.growth(CHANGE)) > WORTH_SAYING * largest)


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
    'The critical mode is calmed most by lowering mu_s (by ... 1/s for 10 %), then by ...'
    """
    told = [
        f"{'lowering' if item.growth(CHANGE) > 0 else 'raising'} {item.parameter} "
        f"(by {abs(item.growth(CHANGE)):.3g} 1/s for 10 %)"
        for item in ranked(result)[:3]
    ]
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
    '200.5 Hz, hard'
    """
    if edge.kind != "hopf":
        return "a drift without swinging"
    kind = "" if edge.onset is None else f", {ONSETS.get(edge.onset.kind, edge.onset.kind)}"
    return f"{edge.frequency_hz:.4g} Hz{kind}"
