"""Least squares of chained segments, by orthogonal elimination from the last to the first.

Segment k has start states s_k of its own; all share the parameters z. Data give rows over (s_k, z),
continuity gives rows over (s_k, s_k+1, z). Each s_k is eliminated by a QR decomposition of a few rows,
so that neither memory nor time grows faster than the number of segments, and normal equations, which
square the condition, are never formed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Link:
    """Rows of one segment, linearised where it stands; residuals last.

    Attributes
    ----------
    own : int
        How many start states it has.
    data : (m, own + q + 1) array
        Over own start states and parameters.
    onward : (n, own + q + 1) array or None
        Of its end, less the start of the next segment; None for the last one.
    onward_next : (n,) array
        Weights with which the next segment's start stands in `onward`, negative.
    """

    own: int
    data: Array
    onward: Array | None
    onward_next: Array


@dataclass(frozen=True, eq=False)
class Back:
    """An eliminated block: triangle @ s_k + rest @ (s_k-1, z, 1) = 0."""

    triangle: Array
    rest: Array


def compressed(rows: Array) -> Array:
    """Return rows of equal normal equations, at most as many as columns.

    Examples
    --------
    >>> numpy.abs(compressed(numpy.array([[3.0], [4.0]]))).tolist()
    [[5.0]]
    """
    if len(rows) <= rows.shape[1]:
        return rows
    return triangle(rows)


def triangle(rows: Array) -> Array:
    """Return R of a QR decomposition.

    Examples
    --------
    >>> numpy.abs(triangle(numpy.array([[3.0], [4.0]]))).tolist()
    [[5.0]]
    """
    return numpy.asarray(numpy.linalg.qr(rows, mode="r"))


def eliminated(links: Sequence[Link], q: int, damping: float = 0.0) -> tuple[Array, list[Back]]:
    """Eliminate the start states of all segments but the first.

    Parameters
    ----------
    links : sequence of Link
    q : int
    damping : float
        Added to each eliminated block in shares of its own columns' norms.

    Returns
    -------
    (m, own + q + 1) array
        Rows over the first segment's start states, parameters and one.
    list of Back
        From the last segment to the second.

    Examples
    --------
    >>> one = Link(0, numpy.array([[1.0, -2.0]]), None, numpy.zeros(0))
    >>> eliminated([one], 1)[0].tolist()
    [[1.0, -2.0]]
    """
    carry, backs = links[-1].data, []
    for k in range(len(links) - 1, 0, -1):
        before, n = links[k - 1], links[k].own
        assert before.onward is not None
        width = n + before.own + q + 1
        held = numpy.zeros((len(carry), width))
        held[:, :n], held[:, n + before.own :] = carry[:, :n], carry[:, n:]
        joint = numpy.zeros((n, width))
        joint[:, :n], joint[:, n:] = numpy.diag(before.onward_next), before.onward
        stack = numpy.concatenate([held, joint])
        size = numpy.sqrt((stack[:, :n] ** 2).sum(axis=0))
        damped = numpy.zeros((n, width))
        damped[:, :n] = numpy.diag(damping**0.5 * size)
        r = triangle(numpy.concatenate([stack, damped]))
        backs.append(Back(r[:n, :n], r[:n, n:]))
        carry = compressed(numpy.concatenate([before.data, r[n:, n:]]))
    return carry, backs


def followed(backs: Sequence[Back], own: Array, step: Array) -> list[Array]:
    """Return the steps of the eliminated start states, second segment first.

    Parameters
    ----------
    backs : sequence of Back
        As `eliminated` gives them.
    own : (n0,) array
        Step of the first segment's start states.
    step : (q,) array
        Of the parameters.

    Returns
    -------
    list of (n,) array

    Examples
    --------
    >>> back = Back(numpy.array([[2.0]]), numpy.array([[1.0, -3.0]]))
    >>> followed([back], numpy.zeros(0), numpy.array([1.0]))[0].tolist()
    [1.0]
    """
    steps = []
    for back in reversed(backs):
        right = -back.rest @ numpy.concatenate([own, step, [1.0]])
        own = numpy.linalg.lstsq(back.triangle, right, rcond=1e-14)[0]
        steps.append(own)
    return steps


def lengths(links: Sequence[Link], steps: Sequence[Array], step: Array) -> float:
    """Return the sum of squares that the linear rows have after a step.

    Parameters
    ----------
    links : sequence of Link
    steps : sequence of array
        Of the start states of each segment.
    step : (q,) array

    Returns
    -------
    float

    Examples
    --------
    >>> one = Link(0, numpy.array([[1.0, -2.0]]), None, numpy.zeros(0))
    >>> lengths([one], [numpy.zeros(0)], numpy.array([2.0]))
    0.0
    """
    total = 0.0
    for k, link in enumerate(links):
        place = numpy.concatenate([steps[k], step, [1.0]])
        rows = link.data @ place
        total += float(rows @ rows)
        if link.onward is not None:
            gap = link.onward @ place + link.onward_next * steps[k + 1]
            total += float(gap @ gap)
    return total
