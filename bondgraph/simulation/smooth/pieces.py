"""Pieces of a run: between two knots each of its inputs is a cubic, mostly a straight line."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy

from ..inputs.table import SEAM, InputTable

Array = numpy.ndarray
# Rows of a run without output times: equal intervals over its span, and intervals that double from
# the start and from each jump on, the first of them this many halvings of an equal one.
INTERVALS = 1000
HALVINGS = 20


@dataclass(frozen=True, eq=False)
class Piece:
    """A stretch of time on which the inputs are cubics.

    Attributes
    ----------
    start, end : float
        Times, s.
    curve : (4, m) array
        Coefficients of the powers 0 to 3 of the time since the start.
    jumps : bool
        Whether an input jumps at the start; at the start of a run it always does.
    """

    start: float
    end: float
    curve: Array
    jumps: bool

    def at(self, t: float) -> Array:
        """Return the inputs at a time, shape (m,)."""
        s = t - self.start
        u, slope, bend, twist = self.curve
        return u + s * (slope + s * (bend + s * twist))

    def along(self, times: Array) -> Array:
        """Return the inputs at times, shape (m, nt)."""
        s = times - self.start
        u, slope, bend, twist = self.curve[:, :, None]
        return u + s * (slope + s * (bend + s * twist))

    def since(self, t: float) -> Array:
        """Return the coefficients for the time since another start, shape (4, m)."""
        return shifted(self.curve, t - self.start)


def shifted(curve: Array, by: float | Array) -> Array:
    """Return the coefficients of cubics about a point further on.

    Parameters
    ----------
    curve : (4, ...) array
        Of the powers 0 to 3.
    by : float or (...) array

    Returns
    -------
    (4, ...) array

    Examples
    --------
    >>> shifted(numpy.array([[0.0], [0], [0], [1]]), 2.0).ravel().tolist()
    [8.0, 12.0, 6.0, 1.0]
    """
    u, slope, bend, twist = curve
    return numpy.array(
        [
            u + by * (slope + by * (bend + by * twist)),
            slope + by * (2 * bend + by * 3 * twist),
            bend + 3 * by * twist,
            twist + 0 * by,
        ]
    )


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
    >>> [(piece.start, piece.end, piece.curve[1].tolist()) for piece in pieces(table, (0.5, 3))]
    [(0.5, 1.0, [4.0]), (1.0, 3.0, [0.0])]
    """
    inside = (span[0] < table.knots) & (table.knots < span[1])
    edges = numpy.concatenate([span[:1], table.knots[inside], span[1:]])
    curves = _curves(table, edges[:-1])
    seam = SEAM * numpy.ptp(table.values, axis=0)
    found: list[Piece] = []
    for curve, (start, end) in zip(curves, itertools.pairwise(edges), strict=True):
        jumps = True
        if found:
            last = found[-1]
            jumps = not (numpy.abs(last.at(start) - curve[0]) <= seam).all()
            if not jumps and not (last.curve[1:].any() or curve[1:].any()):
                found[-1] = Piece(last.start, float(end), last.curve, last.jumps)
                continue
        found.append(Piece(float(start), float(end), curve, jumps))
    return found


def _curves(table: InputTable, times: Array) -> Array:
    """Return the cubics of the inputs just after given times, shape (nt, 4, m)."""
    index = numpy.searchsorted(table.knots, times, side="right") - 1
    before, index = index < 0, numpy.maximum(index, 0)
    shapes = numpy.where(before[:, None, None], 0.0, table.shapes[index])
    curves = numpy.concatenate([table.values[index][:, None], shapes], axis=1)
    passed = numpy.where(before, 0.0, times - table.knots[index])
    return shifted(curves.transpose(1, 0, 2), passed[:, None]).transpose(1, 0, 2)


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
    >>> piece = Piece(0.0, 1.0, numpy.zeros((4, 0)), True)
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
