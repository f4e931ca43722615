"""Two parameters at a time: where the steady state is stable, and how fast it oscillates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy

from ..errors import ParameterError
from ..plot import damping_map, least_damping, pretty, stability_map
from ..stability import EigenvalueMap, PointOutcome, StabilityResult, Vary, eigenvalue_map
from ..units import from_si
from .blocks import Bullets, Figure, Panel, Section, Text
from .words import coherent, number, slug

# More points along an axis than a page can show.
MOST = 200


def plane(
    result: StabilityResult, across: Vary, upwards: Vary, modes: Mapping[str, str] | None = None
) -> EigenvalueMap:
    """Map the eigenvalues of a model over two ranges, all else as in a result.

    Parameters
    ----------
    result : StabilityResult
    across, upwards : Vary
        The axes; of each no more than 200 points are taken.
    modes : mapping of str to str, optional
        Modes of contacts that are held; the others find theirs, point by point.

    Returns
    -------
    EigenvalueMap

    Raises
    ------
    ParameterError
        For one name twice, an unknown name, and a wrong unit.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> result = assess(mass_on_belt.graph())
    >>> plane(result, Vary("v_b", 0.1, 0.5, 10), Vary("v_s", 0.05, 0.2, 8)).shape
    (10, 8)
    """
    if across.name == upwards.name:
        raise ParameterError(f"map {across.name!r}: a map needs two different names")
    axes = {
        item.name: (numpy.linspace(item.lo, item.hi, min(item.n, MOST)), item.unit)
        for item in (across, upwards)
    }
    given, point = result.overrides, result.point
    return eigenvalue_map(result.graph, axes, given, point.inputs, modes, product=True)


def stability_maps(
    result: StabilityResult,
    pairs: Sequence[tuple[Vary, Vary]],
    modes: Mapping[str, str] | None = None,
) -> tuple[EigenvalueMap, ...]:
    """Map several pairs of ranges, see `plane`."""
    return tuple(plane(result, across, upwards, modes) for across, upwards in pairs)


def map_section(result: StabilityResult, maps: Sequence[EigenvalueMap]) -> Section | None:
    """Show each map twice: by the least damping ratio, and by the leading frequency."""
    if not maps:
        return None
    blocks: list[object] = [
        Text(
            "Two parameters vary at a time, all others stay as in the table of parameters. Each "
            "point of a map has a steady state and modes of its own. First plot: the damping ratio "
            "of its least damped mode. Blue: small motions die away; orange: they grow. "
            "The black line is the edge between them, the cross is the operating point. Second "
            "plot: the frequency of the oscillation with the largest growth rate; the unstable "
            "part is hatched."
        )
    ]
    for found in maps:
        blocks += [_figure(result, found), *_failures(found)]
    return Section("Maps", tuple(blocks))


def _figure(result: StabilityResult, found: EigenvalueMap) -> Figure:
    names = list(found.axes)
    here = {**result.point.inputs, **result.point.parameters}
    at = {name: float(here[name]) for name in names if name in here}
    marked = at if len(at) == len(names) else None
    name = "-".join(map(slug, names))
    title = f"{names[1]} over {names[0]}"
    numbers = _numbers(found)
    boundaries = getattr(result, "boundaries", ())
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
    return Figure(
        f"{title}.",
        (
            Panel(
                f"map-{name}-damping",
                damping_map(found, at=marked, boundaries=boundaries),
                f"Least damping ratio, {title}; {stable} of {solved} points stable",
                numbers,
            ),
            Panel(
                f"map-{name}",
                stability_map(found, at=marked, boundaries=boundaries),
                f"Frequency of the leading mode and unstable region, {title}",
                numbers,
            ),
        ),
        told,
    )


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


def _failures(found: EigenvalueMap) -> list[object]:
    """Say at how many points there is no result, and why at the first of them."""
    counts = found.counts()
    told = tuple(
        f"{counts[outcome.label]} points: {outcome.label}; the first: {reason}"
        for outcome, reason in found.reasons.items()
    )
    return [Text("Grey points have no result:"), Bullets(told)] if told else []
