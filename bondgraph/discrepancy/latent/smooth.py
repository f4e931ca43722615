"""Smoothing: states that are near the data and nearly obey the model.

The model's own error is white: a rate of which each time has its own. All states of a recording
are found at once, as least squares with a banded matrix; so are the responses of candidates, with
the states moving along. This is the fixed-interval smoother in information form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from ...errors import SimulationError
from .linear import Along

Array = numpy.ndarray

JITTERS = (0.0, 1e-16, 1e-15, 1e-14, 1e-13)  # of the largest diagonal entry


@dataclass(frozen=True, eq=False)
class Weights:
    """How well model, data and start are trusted.

    Attributes
    ----------
    model : (n, n) array
        Covariance that the error of the states gains in a second.
    noise : (ny,) array
        Standard deviation of each signal.
    start : (n,) array
        Standard deviation of the start; infinite where nothing is known.
    """

    model: Array
    noise: Array
    start: Array


@dataclass(frozen=True, eq=False)
class Smoothed:
    """What is left once the states have moved as well as they can.

    Attributes
    ----------
    rows : (m, q + 1) array
        Weighted: responses of the q columns, then the residual; changes c leave the residual
        less the responses times c.
    moves : (nt, n, q + 1) array
        How the states move by each change, and without any.
    log_det : float
        Of the covariance of all data, but for a constant.
    count : int
        Data.
    """

    rows: Array
    moves: Array
    log_det: float
    count: int


def smoothed(course: Along, h: Array, at: Array, weights: Weights, off: Array) -> Smoothed:
    """Let the states move.

    Parameters
    ----------
    course : Along
    h : (nt - 1,) array
        Steps, s.
    at : (ns,) array of int
        Points of the samples.
    weights : Weights
    off : (n,) array
        The start that is believed, less that of the course.

    Returns
    -------
    Smoothed

    Raises
    ------
    SimulationError
        Where the equations are too badly conditioned to be solved.
    """
    nt, n = len(h) + 1, course.onward.shape[1]
    scale = _scales(course, h)
    onward = course.onward * scale[None, None, :] / scale[None, :, None]
    whiten, log_det = _whitened(onward, h, weights.model / numpy.outer(scale, scale))
    there = numpy.isfinite(course.missed)
    each = there / weights.noise
    seen = course.seen * scale * each[..., None]
    told = numpy.concatenate(
        [
            course.felt * each[..., None],
            numpy.where(there, course.missed, 0.0)[..., None] * each[..., None],
        ],
        axis=2,
    )
    steps = -numpy.concatenate([course.forced, course.broken[..., None]], axis=2)
    steps = whiten @ (steps / scale[None, :, None])
    moved = whiten @ onward
    known = numpy.where(numpy.isfinite(weights.start), scale / weights.start, 1e-6)
    begun = numpy.zeros((n, steps.shape[2]))
    begun[:, -1] = known * off / scale
    band = numpy.zeros((2 * n, nt, n))
    blocks = numpy.zeros((nt, n, n))
    blocks[0] += numpy.diag(known**2)
    blocks[:-1] += moved.transpose(0, 2, 1) @ moved
    blocks[1:] += whiten.transpose(0, 2, 1) @ whiten
    numpy.add.at(blocks, at, seen.transpose(0, 2, 1) @ seen)
    beside = -whiten.transpose(0, 2, 1) @ moved
    for a in range(n):
        for b in range(n):
            if a >= b:
                band[a - b, :, b] = blocks[:, a, b]
            band[n + a - b, :-1, b] = beside[:, a, b]
    right = numpy.zeros((nt, n, steps.shape[2]))
    right[0] += known[:, None] * begun
    right[1:] += whiten.transpose(0, 2, 1) @ steps
    right[:-1] -= moved.transpose(0, 2, 1) @ steps
    numpy.add.at(right, at, seen.transpose(0, 2, 1) @ told)
    factor = _factor(band.reshape(2 * n, nt * n))
    moves = cho_solve_banded((factor, True), right.reshape(nt * n, -1), check_finite=False)
    moves = moves.reshape(nt, n, -1)
    left = [
        (begun - known[:, None] * moves[0]),
        (steps - whiten @ moves[1:] + moved @ moves[:-1]).reshape(-1, steps.shape[2]),
        (told - seen @ moves[at])[there],
    ]
    log_det += 2 * float(numpy.log(factor[0]).sum()) - 2 * float(numpy.log(known).sum())
    log_det += 2 * float((there * numpy.log(weights.noise)).sum())
    moves = moves * scale[None, :, None]
    moves[..., :-1] *= -1
    return Smoothed(numpy.concatenate(left), moves, log_det, int(there.sum()))


def _factor(band: Array) -> Array:
    """Factorise; what nothing tells of is held where it is where rounding hides that it is free."""
    if not numpy.isfinite(band).all():
        raise SimulationError("the states cannot be smoothed: the model is not finite along them")
    for share in JITTERS:
        held = band.copy()
        held[0] += share * band[0].max()
        try:
            return numpy.asarray(cholesky_banded(held, lower=True, check_finite=False))
        except LinAlgError:
            continue
    raise SimulationError("the states cannot be smoothed: badly conditioned")


def _scales(course: Along, h: Array) -> Array:
    size = numpy.sqrt((course.rates**2).mean(axis=0)) * float(h.mean())
    least = 1e-12 * float(size.max(initial=0.0)) or 1.0
    return numpy.maximum(size, least)


def _whitened(onward: Array, h: Array, model: Array) -> tuple[Array, float]:
    """Return what makes errors of each step white, and the log determinant of their covariance."""
    spread = model + onward @ model @ onward.transpose(0, 2, 1)
    spread = 0.5 * (spread + spread.transpose(0, 2, 1)) * h[:, None, None]
    n = model.shape[0]
    size = numpy.trace(spread, axis1=1, axis2=2)[:, None, None] / n
    lower = numpy.linalg.cholesky(0.5 * spread + 1e-12 * size * numpy.eye(n))
    whiten = numpy.linalg.inv(lower)
    diagonal = numpy.diagonal(lower, axis1=1, axis2=2)
    return whiten, 2 * float(numpy.log(diagonal).sum())
