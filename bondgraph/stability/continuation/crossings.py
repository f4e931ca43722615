"""Crossings: where eigenvalues cross the imaginary axis along a curve of steady states."""

from __future__ import annotations

import itertools

import numpy

from ...errors import BondGraphError
from ...linear import growths
from ..edges import Edge, described, same
from ..family import Family
from .curve import Frame, between

Array = numpy.ndarray
Ends = tuple[Array, Array]

# Of a unit tangent: a parameter that moves less turns back.
TURNS = 1e-4


def crossings(
    family: Family, frame: Frame, points: Array, eigenvalues: Array
) -> list[tuple[float, Edge]]:
    """Find all crossings of the imaginary axis along a curve.

    The real parts, sorted, are continuous along the curve, so that each change of sign between
    neighbours encloses a root whatever the order of the modes. Round a fold a real eigenvalue
    changes its sign smoothly as well. Where the greatest real part comes near zero without a
    change of sign it is asked whether it went through between the points.

    Parameters
    ----------
    family : Family
        With one free parameter.
    frame : Frame
    points : (m, n + nz + 1) array
    eigenvalues : (m, n) complex array
        Each row by falling real part.

    Returns
    -------
    list of (float, Edge)
        In order, each with its place as a fraction of points.
    """
    found: list[tuple[float, Edge]] = []
    signs = growths(eigenvalues)
    for order in range(eigenvalues.shape[1]):
        marked = [index for index in range(len(points)) if signs[index, order]]
        for left, right in itertools.pairwise(marked):
            if signs[left, order] != signs[right, order]:
                ends = points[left], points[right]
                found += _placed(_crossing(family, frame, ends, order), left, right)
    for index in range(1, len(points) - 1) if eigenvalues.shape[1] else ():
        trio = slice(index - 1, index + 2)
        if _dips(eigenvalues[trio, 0].real, signs[trio, 0]):
            found += _window(family, frame, points, index, int(signs[index, 0]))
    kept: list[tuple[float, Edge]] = []
    for place, edge in sorted(found, key=lambda item: item[0]):
        if not any(abs(place - other) < 1e-6 and same(edge, known) for other, known in kept):
            kept.append((place, edge))
    return kept


def _placed(
    crossing: tuple[float, Edge] | None, left: float, right: float
) -> list[tuple[float, Edge]]:
    return [] if crossing is None else [(left + crossing[0] * (right - left), crossing[1])]


def _crossing(family: Family, frame: Frame, ends: Ends, order: int) -> tuple[float, Edge] | None:
    """Return a crossing between two points, and at what share of the way it lies."""
    from scipy.optimize import brentq

    def height(share: float) -> float:
        return float(family.eigenvalues(between(frame, *ends, share))[order].real)

    try:
        share = float(brentq(height, 0.0, 1.0, xtol=1e-14, rtol=1e-14, maxiter=200))
        y = between(frame, *ends, share)
        rising = height(1.0) > 0
    except (BondGraphError, ValueError, RuntimeError):
        return None
    crossing = _which(family.eigenvalues(y), order, family.eigenvalues(ends[0]))
    ahead = frame.tangent(y, (ends[1] - ends[0]) / frame.scale)
    turns = ahead is None or (not crossing.imag and abs(ahead[-1]) < TURNS)
    upwards = bool(ends[1][-1] > ends[0][-1])
    above = None if turns else rising == upwards
    return share, described(family, y, crossing, above, frame.scale[:-1])


def _which(poles: Array, order: int, before: Array) -> complex:
    """Return the eigenvalue that crosses: not one that stood on the axis already."""
    left = list(poles)
    for still in before[growths(before) == 0]:
        left.pop(int(numpy.argmin(numpy.abs(numpy.array(left) - still))))
    return complex(
        min(left, key=lambda pole: abs(pole.real - poles[order].real), default=poles[order])
    )


def _dips(heights: Array, signs: Array) -> bool:
    """Whether three samples of one sign may hide a dip through zero."""
    if not (signs[0] != 0 and (signs == signs[0]).all()):
        return False
    before, at, after = numpy.abs(heights)
    return bool(at <= min(before, after) and at <= 2 * max(before - at, after - at))


def _window(
    family: Family, frame: Frame, points: Array, index: int, sign: int
) -> list[tuple[float, Edge]]:
    """Return the two crossings that a dip near a point hides, if it does."""
    from scipy.optimize import minimize_scalar

    found = []
    for left, right in ((index - 1, index), (index, index + 1)):
        ends = points[left], points[right]

        def height(share: float, ends: Ends = ends) -> float:
            return sign * float(family.eigenvalues(between(frame, *ends, share))[0].real)

        try:
            lowest = minimize_scalar(height, bounds=(0.0, 1.0), method="bounded")
            if lowest.fun >= 0:
                continue
            middle = between(frame, *ends, float(lowest.x))
        except BondGraphError:
            continue
        turn = left + float(lowest.x)
        found += _placed(_crossing(family, frame, (ends[0], middle), 0), left, turn)
        found += _placed(_crossing(family, frame, (middle, ends[1]), 0), turn, right)
    return found
