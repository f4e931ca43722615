"""Into how many segments a recording is cut, and where they start."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy

from .problem import Misfit, Point, Problem
from .recordings import Recording
from .shots import Segment, Shot, cut

Array = numpy.ndarray

# What a single shot bears: beyond it, its misfit has too many minima
EVENTS, GROWTH, UNEXPLAINED = 6, 1e3, 0.3


def cycles(column: Array) -> int:
    """Return how often a signal swings about its mean, by crossings with a dead band.

    Examples
    --------
    >>> cycles(numpy.sin(numpy.linspace(0, 20 * numpy.pi, 1000)))
    10
    """
    there = column[numpy.isfinite(column)]
    centred = there - there.mean()
    far = numpy.sign(centred) * (abs(centred) > 0.5 * centred.std())
    signs = far[far != 0]
    return (int((numpy.diff(signs) != 0).sum()) + 1) // 2


def parts_for(recording: Recording, states: int) -> int:
    """Return a number of segments: two a cycle, each with samples enough for its states.

    Parameters
    ----------
    recording : Recording
    states : int

    Returns
    -------
    int

    Examples
    --------
    >>> t = numpy.linspace(0, 1, 2000)
    >>> parts_for(Recording("r", t, {"x": numpy.sin(100 * t)}, {}, {}), 2)
    32
    """
    swings = max(cycles(column) for column in recording.data.values())
    most = max(1, len(recording.t) // max(8, 4 * states))
    return int(min(max(8, 2 * swings), 60, most))


def too_wild(misfit: Misfit, problem: Problem) -> bool:
    """Whether single shots fail, switch often or forget where they started."""
    if not math.isfinite(misfit.cost):
        return True
    for row in misfit.shots:
        for shot in row:
            if len(shot.trajectory.events) > EVENTS:
                return True
            size = numpy.abs(shot.trajectory.x).max(axis=1, initial=0.0) + 1e-300
            own = problem.unknowns.states
            places = [problem.states.index(name) for name in own]
            grown = abs(shot.s_end[:, : len(own)]) * size[places] / size[:, None]
            if grown.max(initial=0.0) > GROWTH:
                return True
    return False


def unexplained(misfit: Misfit, problem: Problem) -> float:
    """Return the largest residual of a channel over its deviation, both root mean squares.

    Outliers count as little as the loss lets them.
    """
    worst = 0.0
    for row, recording in zip(misfit.shots, problem.gun.recordings, strict=True):
        for name, column in recording.data.items():
            parts = [shot.residuals[name] for shot in row if name in shot.residuals]
            joint = numpy.concatenate(parts)
            residual = joint[numpy.isfinite(joint)]
            _, weight = problem.loss(residual / problem.sigma[name])
            left = (weight @ residual**2 / weight.sum()) ** 0.5
            worst = max(worst, float(left / max(numpy.nanstd(column), 1e-300)))
    return worst


@dataclass(frozen=True, eq=False)
class Joined:
    """Segments with start states that the data gave.

    Attributes
    ----------
    problem : Problem
    point : Point
    why : str
        Why there is none; empty where all segments run.
    """

    problem: Problem
    point: Point
    why: str = ""


def joined(problem: Problem, z: Array, parts: Sequence[int]) -> Joined:
    """Cut all recordings and look for the start state of each segment, one after the other.

    Each begins where the one before it ended, and a few Gauss-Newton steps bring it to its own
    data with the parameters as they are.

    Parameters
    ----------
    problem : Problem
    z : (q,) array
    parts : sequence of int
        By recording.

    Returns
    -------
    Joined
    """
    z = z.copy()
    segments = tuple(
        cut(recording, place, count)
        for place, (recording, count) in enumerate(zip(problem.gun.recordings, parts, strict=True))
    )
    n = len(problem.states)
    starts: list[Array] = []
    squares, count = numpy.zeros(n), 0
    for place, row in enumerate(segments):
        own = problem.unknowns.own(place)
        found = numpy.zeros((len(row) - 1, n))
        state, shot, begun = z[own], None, False
        for k, segment in enumerate(row):
            ranges = numpy.sqrt(squares / count) if count else numpy.zeros(n)
            one = problem.with_(segments=segments, scale=ranges)
            state, shot = _settled(one, z, segment, k, state)
            if isinstance(shot, str):
                return Joined(one, Point(z, tuple(starts)), shot)
            if k:
                found[k - 1] = state
            else:
                z[own] = numpy.clip(state, problem.unknowns.lower[own], problem.unknowns.upper[own])
            squares += (shot.trajectory.x**2).mean(axis=1)
            count, begun, state = count + 1, True, shot.x_end
        assert begun
        starts.append(found)
    scale = numpy.sqrt(squares / count)
    scale[scale == 0] = 1.0
    return Joined(problem.with_(segments=segments, scale=scale), Point(z, tuple(starts)))


def _settled(
    problem: Problem, z: Array, segment: Segment, k: int, state: Array
) -> tuple[Array, Shot | str]:
    """Bring the start states of one segment to its own data.

    What the data leave open stays near where the segment before ended.
    """
    first, held = state, numpy.zeros((0, len(state) + 1))
    if k and problem.scale.all():
        held = numpy.column_stack([numpy.diag(1 / problem.scale), numpy.zeros(len(state))])

    def shoot(at: Array) -> tuple[Shot | str, float, Array]:
        starts = tuple(numpy.zeros((len(row) - 1, len(at))) for row in problem.segments)
        here = z.copy()
        if k:
            starts[segment.recording][k - 1] = at
        else:
            here[problem.unknowns.own(segment.recording)] = at
        point = Point(here, starts)
        shot = problem.shoot(point, segment, k)
        if isinstance(shot, str):
            return shot, math.inf, numpy.zeros((0, len(at) + 1))
        link, cost, _ = problem._link(point, shot, k, None)
        rows = numpy.concatenate([link.data[:, [*range(len(at)), -1]], held])
        rows[len(link.data) :, -1] = held[:, :-1] @ (at - first)
        return shot, cost + float((rows[len(link.data) :, -1] ** 2).sum()), rows

    shot, cost, rows = shoot(state)
    lam, tries = 1e-4, 0
    while len(state) and not isinstance(shot, str) and tries < 8:
        size = numpy.sqrt((rows[:, :-1] ** 2).sum(axis=0))
        size[size == 0] = 1.0
        left = numpy.concatenate([rows[:, :-1] / size, numpy.eye(len(state)) * lam**0.5])
        right = numpy.append(-rows[:, -1], numpy.zeros(len(state)))
        step = numpy.linalg.lstsq(left, right, rcond=None)[0] / size
        trial, lower, found = shoot(state + step)
        tries += 1
        if lower < cost:
            small = cost - lower < 0.02 * cost
            state, shot, cost, rows, lam = state + step, trial, lower, found, lam / 5
            if small:
                break
        else:
            lam *= 30
    return state, shot
