"""Boundaries on maps: as they were followed, and else as they run between the points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy

from ..units import from_si
from .style import in_own_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..stability import Boundary, EigenvalueMap

EDGE = "#1c2026"
# In cells: nearer than this a followed boundary is the edge that the points tell.
BESIDE = 1.0
BOUNDARY: dict[str, Any] = {"color": EDGE, "lw": 2.0}
KINDS: dict[str, dict[str, Any]] = {
    "boundary": BOUNDARY,
    "soft boundary": {"color": EDGE, "lw": 2.0, "ls": (0, (4, 2))},
    "further mode": {"color": EDGE, "lw": 1.0, "ls": ":"},
}


def draw_followed(
    ax: Axes, found: EigenvalueMap, boundaries: list[Boundary]
) -> dict[str, dict[str, Any]]:
    """Draw the curves that belong to these axes; return the kinds drawn, with their dress."""
    names, drawn = list(found.axes), {}
    for curve in boundaries:
        if sorted(curve.parameters) != sorted(names):
            continue
        columns = [
            in_own_unit(curve.values[:, curve.parameters.index(name)], found.units[name])
            for name in names
        ]
        for kind, here in _kinds(curve).items():
            if here.any():
                drawn[kind] = KINDS[kind]
                ax.plot(
                    *(numpy.where(here, c, numpy.nan) for c in columns), label="_b", **KINDS[kind]
                )
        for point in curve.special:
            place = [
                from_si(point.values[curve.parameters.index(name)], found.units[name])
                for name in names
            ]
            ax.plot(*place, "o", ms=6, color=EDGE, mfc="white", label="_special", zorder=4)
    return {kind: KINDS[kind] for kind in KINDS if kind in drawn}


def draw_between(
    ax: Axes, scales: list[numpy.ndarray], ratio: numpy.ndarray
) -> dict[str, dict[str, Any]]:
    """Draw the edge as the points tell it, where no boundary was followed along it."""
    contour = ax.contour(*scales, ratio, levels=[0.0])
    pieces = [numpy.asarray(piece) for piece in contour.allsegs[0] if len(piece) > 1]
    contour.remove()
    cell = numpy.array([numpy.ptp(scale) / (len(scale) - 1) for scale in scales])
    exact = [_dense(line.get_xydata() / cell) for line in ax.lines if line.get_label() == "_b"]
    told = numpy.concatenate(exact) if exact else numpy.empty((0, 2))
    drawn = False
    for piece in pieces:
        far = _far(piece / cell, told)
        if far.any():
            ax.plot(*numpy.where(far, piece.T, numpy.nan), label="_edge", **BOUNDARY)
            drawn = True
    return {"boundary": BOUNDARY} if drawn else {}


def _far(points: numpy.ndarray, told: numpy.ndarray) -> numpy.ndarray:
    """Say which points, in cells, have no followed boundary beside them."""
    if not len(told):
        return numpy.ones(len(points), dtype=bool)
    return numpy.array([((told - point) ** 2).sum(axis=1).min() > BESIDE**2 for point in points])


def _dense(points: numpy.ndarray) -> numpy.ndarray:
    """Return a line, in cells, with points at most half a cell apart."""
    points = points[numpy.isfinite(points).all(axis=1)]
    if len(points) < 2:
        return points
    steps = numpy.hypot(*numpy.diff(points, axis=0).T)
    along = numpy.concatenate([[0.0], numpy.cumsum(steps)])
    places = numpy.linspace(0, along[-1], int(2 * along[-1]) + 2)
    return numpy.column_stack([numpy.interp(places, along, column) for column in points.T])


def _kinds(curve: Boundary) -> dict[str, numpy.ndarray]:
    """Say of each kind of boundary where along a curve it is; pieces touch."""
    with numpy.errstate(invalid="ignore"):
        soft = curve.first_lyapunov < 0
    edge = numpy.asarray(curve.edge_of_stability)
    parts = {"boundary": edge & ~soft, "soft boundary": edge & soft, "further mode": ~edge}
    return {kind: here | numpy.roll(here, 1) & _inner(len(here)) for kind, here in parts.items()}


def _inner(count: int) -> numpy.ndarray:
    """All places but the first, which has none before it."""
    return numpy.arange(count) > 0
