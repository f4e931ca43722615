"""Paths: the branch of steady states through a point, along one parameter and round its folds."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy

from ...linear import growths
from ..edges import Edge
from ..family import Family
from .crossings import crossings
from .curve import Curve, Frame, follow

Array = numpy.ndarray

MOST_POINTS = 600
# Of the range: an eigenvalue that crosses and comes back within a step may be overlooked.
STEP = 0.02
NOT_ASKED = "not asked"


@dataclass(frozen=True, eq=False)
class Path:
    """Steady states along one parameter, in the order in which the branch runs through them.

    Attributes
    ----------
    parameter : str
    unit : str
        The parameter's own, for display.
    values : (m,) array
        Of the parameter, SI; they turn back at folds.
    states : (m, n + nz) array
    eigenvalues : (m, n) complex array
        By falling real part.
    here : int
        Which point is the operating point.
    edges : tuple of Edge
        All crossings of the imaginary axis, in the path's order.
    places : tuple of float
        Where these lie, as fractions of points: 2.5 is between the third and the fourth.
    ends : (str, str)
        Why the path ends, before and behind: ``"limit"`` of the range, ``"closed"``, ``"lost"``,
        ``"many points"``, ``"enough"``, ``"not asked"`` or which contact leaves its mode.
    """

    parameter: str
    unit: str
    values: Array
    states: Array
    eigenvalues: Array
    here: int
    edges: tuple[Edge, ...]
    places: tuple[float, ...]
    ends: tuple[str, str]

    @property
    def first(self) -> tuple[Edge | None, Edge | None]:
        """The edges of stability met first from the operating point, before and behind."""
        told = [
            (place, edge)
            for place, edge in zip(self.places, self.edges, strict=True)
            if edge.boundary
        ]
        before = [edge for place, edge in told if place <= self.here]
        behind = [edge for place, edge in told if place > self.here]
        return (before[-1] if before else None, behind[0] if behind else None)


def follow_path(
    family: Family,
    low: float,
    high: float,
    *,
    only_first: bool = False,
    senses: Collection[int] = (-1, 1),
    step: float = STEP,
) -> Path:
    """Follow the branch of steady states through the family's point.

    Parameters
    ----------
    family : Family
        With one free parameter.
    low, high : float
        Where to end, SI; the operating point may lie outside, from where the path goes towards
        the range and begins to count there.
    only_first : bool
        Stop at the first edge of stability each way.
    senses : collection of int
        Which ways to go: -1 towards smaller values, 1 towards larger ones.
    step : float
        Longest step, as a share of the range.

    Returns
    -------
    Path

    Examples
    --------
    >>> from bondgraph import steady_state
    >>> from bondgraph.models import bicycle_brake
    >>> graph = bicycle_brake.graph()
    >>> family = Family(graph, steady_state(graph), ["V0"])
    >>> path = follow_path(family, 0.25, 1.5)
    >>> [round(edge.value, 6) for edge in path.edges if edge.boundary], path.ends
    ([0.322324], ('limit', 'limit'))
    """
    low, high = min(low, high), max(low, high)
    start = family.start
    at = float(start[-1])
    frame = Frame(family.slopes, family.scale([(low, high)]))
    outer = min(low, at), max(high, at)
    reach = 1e-9 * (high - low)

    stop = _stopper(family) if only_first else None
    back, ahead = (
        _half(family, frame, sense, outer, step, stop) if sense in senses else _still(start, sense)
        for sense in (-1, 1)
    )
    points = numpy.vstack([back.points[:0:-1], ahead.points])
    here = len(back.points) - 1
    eigenvalues = numpy.array([family.eigenvalues(y) for y in points])
    eigenvalues = eigenvalues.reshape(len(points), family.smooth.order)
    found = crossings(family, frame, points, eigenvalues)
    inside = [(place, edge) for place, edge in found if low - reach <= edge.value <= high + reach]
    return Path(
        family.names[0],
        family.units[0],
        points[:, -1],
        points[:, :-1],
        eigenvalues,
        here,
        tuple(edge for _, edge in inside),
        tuple(place for place, _ in inside),
        (back.end, ahead.end),
    )


def _half(
    family: Family,
    frame: Frame,
    sense: int,
    outer: tuple[float, float],
    step: float,
    stop: Callable[[Array, Array], bool] | None,
) -> Curve:
    """Follow the branch one way, to a border, an end, or where it is enough."""
    return follow(
        frame,
        family.start,
        _along(family.start, sense),
        family.leaves,
        borders={-1: outer},
        longest=step,
        most=MOST_POINTS,
        enough=stop,
    )


def _still(start: Array, sense: int) -> Curve:
    """Return the curve of a way that is not asked for: its start."""
    return Curve(start[None, :], _along(start, sense)[None, :], NOT_ASKED)


def _along(start: Array, sense: int) -> Array:
    along = numpy.zeros(len(start))
    along[-1] = sense
    return along


def _stopper(family: Family) -> Callable[[Array, Array], bool]:
    """Return whether an edge of stability was passed on the way from the operating point."""
    unstable = bool((growths(family.eigenvalues(family.start)) > 0).any())

    def stop(_: Array, after: Array) -> bool:
        return bool((growths(family.eigenvalues(after)) > 0).any()) != unstable

    return stop
