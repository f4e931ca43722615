"""Chatter of laws that jump: whether a run stopped where the motion reverses at a jump.

A law such as ``sign(v)`` drives a state back from both sides of its jump. No step of any smooth
integrator fits there; what the run then lacks is steps or seconds, but what it ends of is this.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy

Array = numpy.ndarray

# How near to the jump, in shares of the run, one has stopped that does not get on for it.
NEAR = 1e-3
LOOKS = 48
HALVINGS = 60


def reverses(rates: Callable[[float, Array], Array], t: float, x: Array, length: float) -> bool:
    """Whether a rate turns round, by a jump, just ahead of a point.

    Parameters
    ----------
    rates : callable
        ``(t, x)`` to dx/dt, shape (n,).
    t : float
    x : (n,) array
    length : float
        Of the run, s.

    Examples
    --------
    >>> bang = lambda t, x: -numpy.sign(x)
    >>> reverses(bang, 0.0, numpy.array([1e-9]), 1.0)
    True
    >>> reverses(bang, 0.0, numpy.array([0.5]), 1.0)
    False
    >>> reverses(lambda t, x: -1e9 * x, 0.0, numpy.array([1e-9]), 1.0)
    False
    """
    with numpy.errstate(all="ignore"):
        now = rates(t, x)
        if not numpy.isfinite(now).all():
            return False
        for ahead in length * NEAR * 0.5 ** numpy.arange(LOOKS):
            there = rates(t, x + ahead * now)
            turned = now * there < 0
            if turned.any() and _jumps(rates, t, x, now, ahead, turned):
                return True
    return False


def _jumps(
    rates: Callable[[float, Array], Array],
    t: float,
    x: Array,
    now: Array,
    ahead: float,
    turned: Array,
) -> bool:
    """Whether the turn between two points happens at one, and by how much it did between them."""
    low, high = 0.0, ahead
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if (now * rates(t, x + middle * now) < 0)[turned].any():
            high = middle
        else:
            low = middle
    before, after = rates(t, x + low * now), rates(t, x + high * now)
    change = numpy.abs(after - before)[turned]
    return bool((change > 0.5 * numpy.abs(now)[turned]).any())
