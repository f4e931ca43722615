"""Planes: all boundaries that edges along two parameters lead to, each once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy

from ...errors import BondGraphError
from ...graph import BondGraph
from ..edges import Edge
from ..vary import Vary
from .boundary import Boundary, follow_edge

# Of the ranges: an edge nearer to a curve than this lies on it.
NEAR = 1e-3


def boundaries(
    graph: BondGraph,
    edges: Mapping[str, Iterable[Edge]],
    plane: tuple[Vary, Vary],
    parameters: Mapping[Any, Any] | None = None,
) -> tuple[tuple[Boundary, ...], tuple[str, ...]]:
    """Follow the edges found along two parameters in the plane of both.

    Boundaries that no edge along either parameter lies on are not found this way.

    Parameters
    ----------
    graph : BondGraph
    edges : mapping of str to iterable of Edge
        By the parameter that they were found along.
    plane : (Vary, Vary)
        In SI.
    parameters : mapping, optional
        Those that the edges were found with.

    Returns
    -------
    found : tuple of Boundary
        With the plane's parameters in its order.
    notes : tuple of str
        Edges that could not be followed.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import Vary, assess
    >>> graph = bicycle_brake.graph()
    >>> plane = (Vary("V0", 0.25, 1.5, 20), Vary("v_s", 0.03, 0.3, 20))
    >>> result = assess(graph, vary=plane)
    >>> found, notes = boundaries(graph, {locus.name: locus.edges for locus in result.loci}, plane)
    >>> [curve.kind for curve in found], notes
    (['hopf'], ())
    """
    across, along = plane
    widths = numpy.array([abs(item.hi - item.lo) for item in plane])
    found: list[Boundary] = []
    notes: list[str] = []
    for first, second in ((across, along), (along, across)):
        for edge in edges.get(first.name, ()):
            other = edge.point.parameters.get(second.name, edge.point.inputs.get(second.name))
            if other is None:
                continue
            at = (edge.value, other) if first is across else (other, edge.value)
            if any(curve.kind == edge.kind and _on(curve, at, widths) for curve in found):
                continue
            try:
                curve = follow_edge(graph, edge, first, second, parameters)
            except BondGraphError as error:
                notes.append(f"{edge.kind} at {first.name} = {edge.value:.6g}: {error}")
                continue
            found.append(curve if first is across else curve.swapped())
    return tuple(found), tuple(notes)


def _on(curve: Boundary, at: tuple[float, float], widths: numpy.ndarray) -> bool:
    """Whether a point lies on a curve, as nearly as its straight pieces tell."""
    points = curve.values / widths
    if len(points) < 2:
        return False
    point = numpy.array(at) / widths
    starts, pieces = points[:-1], numpy.diff(points, axis=0)
    lengths = numpy.maximum((pieces**2).sum(axis=1), 1e-300)
    shares = numpy.clip(((point - starts) * pieces).sum(axis=1) / lengths, 0, 1)
    nearest = starts + shares[:, None] * pieces
    return bool(numpy.sqrt(((nearest - point) ** 2).sum(axis=1)).min() < NEAR)
