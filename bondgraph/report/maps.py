"""Two parameters at a time: where the steady state is stable, and how fast it oscillates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy

from ..errors import ParameterError
from ..plot import damping_map, least_damping, pretty, stability_map
from ..stability import (
    Boundary,
    Edge,
    EigenvalueMap,
    PointOutcome,
    StabilityResult,
    Vary,
    eigenvalue_map,
)
from ..stability.continuation import boundaries
from ..units import from_si
from .blocks import Bullets, Figure, Panel, Section, Text
from .words import coherent, number, slug

# More points along an axis than a page can show.
MOST = 200


@dataclass(frozen=True, eq=False)
class Plane:
    """What is known over two parameters.

    Attributes
    ----------
    points : EigenvalueMap
        Of a product of both ranges.
    boundaries : tuple of Boundary
        Edges of stability followed through the plane.
    notes : tuple of str
        Edges that could not be followed.
    """

    points: EigenvalueMap
    boundaries: tuple[Boundary, ...]
    notes: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The parameter across, and the one upwards."""
        return tuple(self.points.axes)


def plane(
    result: StabilityResult, across: Vary, upwards: Vary, modes: Mapping[str, str] | None = None
) -> Plane:
    """Map the eigenvalues of a model over two ranges, and follow the edges through them.

    All else is as in the result. Edges are those that it followed in this plane, else they are
    followed from where they stand along both parameters, through the operating point.

    Parameters
    ----------
    result : StabilityResult
    across, upwards : Vary
        The axes; of each no more than 200 points are taken.
    modes : mapping of str to str, optional
        Modes of contacts that are held; the others find theirs, point by point.

    Returns
    -------
    Plane

    Raises
    ------
    ParameterError
        For one name twice, an unknown name, and a wrong unit.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> result = assess(mass_on_belt.graph())
    >>> found = plane(result, Vary("v_b", 0.1, 0.5, 10), Vary("v_s", 0.05, 0.2, 8))
    >>> found.points.shape, [curve.kind for curve in found.boundaries]
    ((10, 8), ['hopf'])
    """
    if across.name == upwards.name:
        raise ParameterError(f"map {across.name!r}: a map needs two different names")
    axes = {
        item.name: (numpy.linspace(item.lo, item.hi, min(item.n, MOST)), item.unit)
        for item in (across, upwards)
    }
    given, point = result.overrides, result.point
    found = eigenvalue_map(result.graph, axes, given, point.inputs, modes, product=True)
    known = [curve for curve in result.boundaries if curve.parameters == tuple(found.axes)]
    if known:
        return Plane(found, tuple(known), ())
    ranges = (across.in_si(found.units[across.name]), upwards.in_si(found.units[upwards.name]))
    edges = {item.name: _edges(result, item) for item in ranges}
    curves, notes = boundaries(result.graph, edges, ranges, given)
    return Plane(found, curves, notes)


def _edges(result: StabilityResult, over: Vary) -> list[Edge]:
    """Return the edges along one parameter, through the operating point, as far as they are known."""
    for locus in result.loci:
        if locus.name == over.name:
            return list(locus.edges)
    low, high = sorted((over.lo, over.hi))
    sides = [(item.below, item.above) for item in result.margins if item.parameter == over.name]
    return [edge for pair in sides for edge in pair if edge is not None and low < edge.value < high]


def stability_planes(
    result: StabilityResult,
    pairs: Sequence[tuple[Vary, Vary]],
    modes: Mapping[str, str] | None = None,
) -> tuple[Plane, ...]:
    """Map several pairs of ranges, see `plane`.

    Parameters
    ----------
    result : StabilityResult
    pairs : sequence of (Vary, Vary)
    modes : mapping of str to str, optional

    Returns
    -------
    tuple of Plane
    """
    return tuple(plane(result, across, upwards, modes) for across, upwards in pairs)


def map_section(result: StabilityResult, maps: Sequence[Plane]) -> Section | None:
    """Show each map twice: by the least damping ratio, and by the leading frequency."""
    if not maps:
        return None
    blocks: list[object] = [
        Text(
            "Two parameters vary at a time, all others stay as in the table of parameters. Each "
            "point of a map has a steady state and modes of its own. First plot: the damping ratio "
            "of its least damped mode. Blue: small motions die away; orange: they grow. "
            "The black line is the edge between them (dashed where the vibration behind it "
            "starts softly, dotted where a further mode changes while another grows already), the "
            "cross is the operating point. Second "
            "plot: the frequency of the oscillation with the largest growth rate; the unstable "
            "part is hatched, and where nothing oscillates it is white."
        )
    ]
    for item in maps:
        blocks += [_figure(result, item), *_failures(item)]
    return Section("Maps", tuple(blocks))


def _figure(result: StabilityResult, shown: Plane) -> Figure:
    found = shown.points
    names = list(found.axes)
    here = {**result.point.inputs, **result.point.parameters}
    at = {name: float(here[name]) for name in names if name in here}
    marked = at if len(at) == len(names) else None
    name = "-".join(map(slug, names))
    title = f"{names[1]} over {names[0]}"
    numbers = _numbers(found)
    stable, solved = int(found.stable.sum()), int(found.ok.sum())
    where = ", ".join(
        f"{key} = {number(from_si(value, found.units[key]))} {pretty(found.units[key])}".strip()
        for key, value in at.items()
    )
    told = (
        f"{found.shape[0]} x {found.shape[1]} points, {solved} with a steady state, {stable} of "
        f"them stable ({stable / max(solved, 1):.0%}). Operating point: {where}"
    )
    inside = marked is not None and all(
        found.axes[key].min() <= value <= found.axes[key].max() for key, value in marked.items()
    )
    told += "." if inside else ", beyond the frame."
    told += "".join(f" {words}" for words in _specials(shown))
    panels = [
        Panel(
            f"map-{name}-damping",
            damping_map(found, at=marked, boundaries=shown.boundaries),
            f"Least damping ratio, {title}; {stable} of {solved} points stable",
            numbers,
        )
    ]
    if numpy.isfinite(found.frequency_hz).any():
        panels.append(
            Panel(
                f"map-{name}",
                stability_map(found, at=marked, boundaries=shown.boundaries),
                f"Frequency of the leading mode and unstable region, {title}",
                numbers,
            )
        )
    else:
        told += " Nothing oscillates, so there is no plot of frequencies."
    return Figure(f"{title}.", tuple(panels), told)


SPECIALS = {
    "bautin": "the onset changes between soft and hard",
    "bogdanov-takens": "the frequency falls to zero",
    "cusp": "two folds meet",
}


def _specials(shown: Plane) -> list[str]:
    """Say what the rings on a map are."""
    told = []
    for curve in shown.boundaries:
        for point in curve.special:
            where = ", ".join(
                f"{name} = {number(from_si(value, unit), 4)} {pretty(unit)}".strip()
                for name, value, unit in zip(
                    curve.parameters, point.values, curve.units, strict=True
                )
            )
            told.append(f"Ring at {where}: {SPECIALS.get(point.kind, point.kind)}.")
    return told


def _numbers(found: EigenvalueMap) -> dict[str, numpy.ndarray]:
    """Return a row for each point: where it is, what was found, and how that ended."""
    labels = {int(outcome): outcome.label for outcome in PointOutcome}
    columns = {
        f"{name} [{coherent(found.units[name])}]": values for name, values in found.points.items()
    }
    return columns | {
        "growth rate [1/s]": found.growth,
        "frequency [Hz]": found.frequency_hz,
        "damping ratio [1]": found.damping_ratio,
        "least damping ratio [1]": least_damping(found),
        "outcome": numpy.array([labels[int(code)] for code in found.outcomes]),
    }


def _failures(shown: Plane) -> list[object]:
    """Say at how many points there is no result, why at the first, and what was not followed."""
    found = shown.points
    counts = found.counts()
    told = tuple(
        f"{counts[outcome.label]} points: {outcome.label}; the first: {reason}"
        for outcome, reason in found.reasons.items()
    )
    blocks: list[object] = [Text("Grey points have no result:"), Bullets(told)] if told else []
    if shown.notes:
        blocks += [Text("Boundaries that could not be followed:"), Bullets(shown.notes)]
    return blocks
