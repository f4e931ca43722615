"""Curves: the solutions of n equations in n + 1 unknowns, followed by their arclength.

Arclength goes round folds, where a parameter turns back and a solution for given values of it
would be lost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy

from ...errors import BondGraphError

Array = numpy.ndarray

FIRST_STEP, LEAST_STEP, LONGEST_STEP = 0.01, 1e-8, 0.05
ITERATIONS = 8
# Directions of neighbours differ by less than this angle's cosine, about 20 degrees, or the step
# was too long: the next point might lie on another branch.
TURN = 0.94
GROWTH = 1.6
SINGULAR = 1e-12


class Problem(Protocol):
    """Equations whose solutions form a curve."""

    def __call__(self, y: Array, /) -> tuple[Array, Array]:
        """Return what is left of the equations, (n,), and its Jacobian, (n, n + 1)."""


@dataclass(frozen=True, eq=False)
class Frame:
    """Equations with the sizes that their unknowns are measured by.

    Attributes
    ----------
    problem : Problem
    scale : (n + 1,) array
        Sizes of the unknowns; lengths along the curve are measured in them.
    """

    problem: Problem
    scale: Array

    def tangent(self, y: Array, along: Array) -> Array | None:
        """Return the direction of the curve in scaled unknowns, with ``along`` rather than against."""
        return self._ahead(self.problem(y)[1] * self.scale, along)

    def _ahead(self, matrix: Array, along: Array) -> Array | None:
        if not numpy.isfinite(matrix).all():
            return None
        _, sizes, rows = numpy.linalg.svd(matrix / _rows(matrix))
        rank = int((sizes > SINGULAR * sizes.max(initial=0.0)).sum())
        # more than one direction: where a state is free, or branches cross; go straight on
        ahead = rows[rank:].T @ (rows[rank:] @ along)
        length = float(numpy.linalg.norm(ahead))
        return ahead / length if length > 0 else None

    def corrected(self, y: Array, row: Array) -> Array | None:
        """Return the point of the curve near y in the plane across a scaled direction; or None.

        Parameters
        ----------
        y : (n + 1,) array
        row : (n + 1,) array
            The plane's normal, in scaled unknowns.
        """
        return self.stepped(y, row)[0]

    def stepped(self, y: Array, row: Array) -> tuple[Array | None, Array | None]:
        """Return what `corrected` does, and the curve's direction there, with the normal.

        The direction is that of the last iterate but one, good to some seven digits.
        """
        start = y = numpy.array(y, dtype=float)
        done = False
        for _ in range(ITERATIONS):
            residual, jacobian = self.problem(y)
            matrix = jacobian * self.scale
            if not (numpy.isfinite(matrix).all() and numpy.isfinite(residual).all()):
                return None, None
            sizes = _rows(matrix)
            off = row @ ((y - start) / self.scale)
            whole = numpy.vstack([matrix / sizes, row])
            right = -numpy.append(residual / sizes[:, 0], off)
            step = numpy.linalg.lstsq(whole, right, rcond=SINGULAR)[0]
            y = y + step * self.scale
            size = numpy.abs(step).max()
            if not numpy.isfinite(size) or size > 1e3:
                return None, None
            if done:
                return y, self._ahead(matrix, row)
            # one more step doubles the digits once they are half there
            done = bool(size <= 1e-7 * (1 + numpy.abs(y / self.scale).max()))
        return None, None


def _rows(matrix: Array) -> Array:
    sizes = numpy.abs(matrix).max(axis=1, keepdims=True)
    sizes[sizes == 0] = 1.0
    return sizes


@dataclass(frozen=True, eq=False)
class Curve:
    """Points of a curve in order.

    Attributes
    ----------
    points : (m, n + 1) array
    tangents : (m, n + 1) array
        In scaled unknowns, pointing onwards.
    end : str
        Why the curve was not followed any farther.
    """

    points: Array
    tangents: Array
    end: str


LIMIT, CLOSED, LOST, MANY = "limit", "closed", "lost", "many points"


def follow(
    frame: Frame,
    start: Array,
    along: Array,
    within: Callable[[Array], str | None],
    *,
    borders: Mapping[int, tuple[float, float]] | None = None,
    longest: float = LONGEST_STEP,
    most: int = 2000,
    enough: Callable[[Array, Array], bool] | None = None,
) -> Curve:
    """Follow a curve from a point of it until it leaves what is allowed.

    Parameters
    ----------
    frame : Frame
    start : (n + 1,) array
        On the curve.
    along : (n + 1,) array
        First direction, in scaled unknowns; its sense counts.
    within : callable
        Returns None for an allowed point, else why it is not.
    borders : mapping of int to (float, float), optional
        Least and largest value of some unknowns, by their places. The curve ends on a border.
    longest : float
        Step in scaled unknowns.
    most : int
        Points.
    enough : callable, optional
        Of two neighbouring points: whether to stop at the second.

    Returns
    -------
    Curve
        Its `end` is what `within` said, ``"limit"`` on a border, ``"closed"`` where the curve comes
        back to its start, ``"lost"`` where no step is short enough, ``"many points"``.

    References
    ----------
    Keller, Numerical solution of bifurcation and nonlinear eigenvalue problems, in: Applications
    of Bifurcation Theory, Academic Press (1977) 359-384.

    Examples
    --------
    >>> def circle(y):
    ...     return numpy.array([y @ y - 1]), 2 * y[None, :]
    >>> frame = Frame(circle, numpy.ones(2))
    >>> found = follow(frame, numpy.array([1.0, 0]), numpy.array([0, 1.0]), lambda y: None)
    >>> found.end, bool(abs((found.points**2).sum(axis=1) - 1).max() < 1e-12)
    ('closed', True)
    """
    tangent = frame.tangent(start, along)
    if tangent is None:
        return Curve(start[None, :], along[None, :], LOST)
    points, tangents = [numpy.array(start, dtype=float)], [tangent]
    step, end = min(FIRST_STEP, longest), MANY
    refused: str | None = None
    while len(points) < most:
        trial, ahead = frame.stepped(points[-1] + step * frame.scale * tangents[-1], tangents[-1])
        if trial is not None and (crossed := _crossed(points[-1], trial, borders or {})):
            onto = _onto(frame, points[-1], trial, crossed)
            if onto is not None and within(onto) is None:
                row = frame.tangent(onto, tangents[-1])
                if onto is not points[-1] and row is not None:
                    points.append(onto)
                    tangents.append(row)
                end = LIMIT
                break
            trial = None
        near = ahead is not None and float(ahead @ tangents[-1]) >= TURN
        reason = within(trial) if trial is not None and near else None
        if trial is None or ahead is None or not near or reason is not None:
            refused = reason or refused
            step /= 2
            if step < LEAST_STEP:
                end = refused or LOST
                break
            continue
        points.append(trial)
        tangents.append(ahead)
        if enough is not None and enough(points[-2], points[-1]):
            end = "enough"
            break
        if _closed(frame, points, step):
            end = CLOSED
            break
        if refused is None:
            step = min(step * GROWTH, longest)
    return Curve(numpy.array(points), numpy.array(tangents), end)


def _crossed(
    last: Array, trial: Array, borders: Mapping[int, tuple[float, float]]
) -> tuple[int, float] | None:
    """Return which unknown leaves its borders first on a straight way, and at what value."""
    found = []
    for place, (low, high) in borders.items():
        value = trial[place]
        if not low <= value <= high:
            border = low if value < low else high
            found.append(((border - last[place]) / (value - last[place]), place, border))
    return min(found)[1:] if found else None


def _onto(frame: Frame, last: Array, trial: Array, crossed: tuple[int, float]) -> Array | None:
    """Return the point of the curve on a border between two others."""
    place, border = crossed
    share = (border - last[place]) / (trial[place] - last[place])
    if share <= 1e-9:
        return last
    guess = last + share * (trial - last)
    guess[place] = border
    row = numpy.zeros(len(last))
    row[place] = 1.0
    found = frame.corrected(guess, row)
    if found is None or numpy.abs((found - last) / frame.scale).max() > LONGEST_STEP * 4:
        return None
    found[place] = border
    return found


def _closed(frame: Frame, points: list[Array], step: float) -> bool:
    """Whether the last step has passed the start."""
    if len(points) < 5:
        return False
    before, after = ((points[0] - y) / frame.scale for y in points[-2:])
    chord = before - after
    length = numpy.linalg.norm(chord)
    if length == 0:
        return False
    off = before - chord * (before @ chord) / length**2
    between = 0 <= before @ chord <= length**2
    return bool(between and numpy.linalg.norm(off) <= 0.1 * step)


def between(frame: Frame, low: Array, high: Array, share: float) -> Array:
    """Return the point of the curve at a share of the chord between two neighbours.

    Raises
    ------
    BondGraphError
        Where the curve is lost on the way.
    """
    chord = (high - low) / frame.scale
    length = float(numpy.linalg.norm(chord))
    if length == 0:
        return low
    found = frame.corrected(low + share * (high - low), chord / length)
    if found is None:
        raise BondGraphError("the curve was lost between two of its points")
    return found
