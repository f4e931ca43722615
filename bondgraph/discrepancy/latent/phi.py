"""Exponentials of matrices, many at once: how linear systems move from one time to the next."""

from __future__ import annotations

import numpy

Array = numpy.ndarray

ORDER = 9  # of the Taylor series, exact to rounding up to a norm of a half


def phis(matrices: Array) -> tuple[Array, Array, Array]:
    """Return exp(Z) and the functions phi1(Z) = (exp(Z) - 1)/Z and phi2(Z) = (phi1(Z) - 1)/Z.

    Parameters
    ----------
    matrices : (m, n, n) array

    Returns
    -------
    three (m, n, n) arrays

    Notes
    -----
    Scaling and doubling [1]_, all matrices by the same number of doublings.

    References
    ----------
    .. [1] Hochbruck, Ostermann, Exponential integrators, Acta Numerica 19 (2010) 209-286.

    Examples
    --------
    >>> whole, first, second = phis(numpy.array([[[0.0]], [[1.0]]]))
    >>> whole.ravel().round(6).tolist(), second.ravel().round(6).tolist()
    ([1.0, 2.718282], [0.5, 0.718282])
    """
    one = numpy.eye(matrices.shape[-1])
    size = float(numpy.abs(matrices).sum(axis=-1).max(initial=0.0))
    doublings = max(0, int(numpy.ceil(numpy.log2(size))) + 1) if size > 0 else 0
    z = matrices / 2.0**doublings
    second = numpy.broadcast_to(one, z.shape).copy()
    for k in range(ORDER, 0, -1):  # phi2 = 1/2! + Z/3! + Z^2/4! ...
        second = one + z @ second / (k + 2)
    second = 0.5 * second
    first = one + z @ second
    whole = one + z @ first
    for _ in range(doublings):
        second = 0.25 * (first @ first + 2 * second)
        first = 0.5 * (whole @ first + first)
        whole = whole @ whole
    return whole, first, second
