"""Pieces of a run: between two knots of its inputs these are straight lines."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy

from ..inputs import at
from ..problem import InputTable

Array = numpy.ndarray
# Rows of a run without output times: equal intervals over its span, and intervals that double from
# the start and from each jump on, the first of them this many halvings of an equal one.
INTERVALS = 1000
HALVINGS = 20


@dataclass(frozen=True, eq=False)
class Piece:
    """A stretch of time on which the inputs are ``u + slope (t - start)``.

    Attributes
    ----------
    start, end : float
        Times, s.
    u, slope : (m,) array
    jumps : bool
        Whether an input jumps at the start; at the start of a run it always does.
    """

    start: float
    end: float
    u: Array
    slope: Array
    jumps: bool


def pieces(table: InputTable, span: tuple[float, float]) -> list[Piece]:
    """Cut a run at the knots where an input jumps or changes its slope.

    Parameters
    ----------
    table : InputTable
    span : (float, float)
        Start and end of the run, s.

    Returns
    -------
    list of Piece

    Examples
    --------
    >>> table = InputTable(numpy.array([0, 1, 2.0]), numpy.array([[0], [4], [4.0]]), numpy.array([1]))
    >>> [(piece.start, piece.end, piece.slope.tolist()) for piece in pieces(table, (0.5, 3))]
    [(0.5, 1.0, [4.0]), (1.0, 3.0, [0.0])]
    """
    inside = (span[0] < table.knots) & (table.knots < span[1])
    edges = numpy.concatenate([span[:1], table.knots[inside], span[1:]])
    values = at(table, edges[:-1])
    slopes = _slopes(table, edges[:-1])
    found: list[Piece] = []
    for index, (start, end) in enumerate(itertools.pairwise(edges)):
        u, slope = values[:, index], slopes[:, index]
        jumps = True
        if found:
            last = found[-1]
            arrived = last.u + last.slope * (start - last.start)
            jumps = not numpy.allclose(arrived, u, rtol=1e-12, atol=0.0)
            if not jumps and numpy.array_equal(slope, last.slope) and not slope.any():
                found[-1] = Piece(last.start, float(end), last.u, last.slope, last.jumps)
                continue
        found.append(Piece(float(start), float(end), u, slope, jumps))
    return found


def _slopes(table: InputTable, times: Array) -> Array:
    """Return the slopes of the inputs just after given times, shape (m, nt)."""
    rises = numpy.diff(table.values, axis=0) / numpy.diff(table.knots)[:, None]
    flat = numpy.zeros((1, len(table.hold)))
    rises = numpy.concatenate([flat, rises * (table.hold == 1), flat])
    return rises[numpy.searchsorted(table.knots, times, side="right")].T


def own_grid(parts: Sequence[Piece]) -> Array:
    """Return times that show a run: equally spaced, and dense after the start and jumps.

    Parameters
    ----------
    parts : sequence of Piece

    Returns
    -------
    (nt,) array
        Start and end of the run and of each piece are among them.

    Examples
    --------
    >>> piece = Piece(0.0, 1.0, numpy.zeros(0), numpy.zeros(0), True)
    >>> times = own_grid([piece])
    >>> len(times), float(times[-1]), bool(times[1] < 1e-8)
    (1021, 1.0, True)
    """
    start, end = parts[0].start, parts[-1].end
    edges = numpy.array([part.start for part in parts])
    times = [numpy.linspace(start, end, INTERVALS + 1), edges]
    even = (end - start) / INTERVALS
    count = min(HALVINGS, max(2, INTERVALS // len(parts)))
    for part in parts:
        if part.jumps:
            first = min(even, part.end - part.start)
            times.append(part.start + first * 0.5 ** numpy.arange(1, count + 1))
    return numpy.unique(numpy.concatenate(times))
