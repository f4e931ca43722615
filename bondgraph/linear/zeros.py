"""Invariant zeros by orthogonal reduction of the system pencil.

References
----------
Emami-Naeini, Van Dooren, Computation of zeros of linear multivariable systems,
Automatica 18 (1982) 415-430.
"""

from __future__ import annotations

import numpy

from .gain import deflated
from .ranks import compressed
from .realisation import EPS, Realisation

Array = numpy.ndarray
# Of the filters that make a transfer proper, in the unit of frequency: no zero of a model.
FILTER = 2.1235
WELL = 1e8  # condition up to which a pencil is turned into a matrix
FAINT = 1e-3  # of the largest: a root that is not seen to be zero by its size is not one


def invariant_zeros(given: Realisation) -> Array:
    """Return the finite invariant zeros: where the system pencil loses rank.

    These are the transmission zeros, and modes that no input moves or no output
    shows. The pencil need not be square nor of full rank.

    Parameters
    ----------
    given : Realisation

    Returns
    -------
    (z,) complex array
        1/s, largest real part first.

    Examples
    --------
    >>> lead = Realisation(*(numpy.array([[x]]) for x in (-2.0, 1.0, -1.0)), (numpy.eye(1),))
    >>> invariant_zeros(lead).real.tolist()
    [-1.0]
    """
    scaled = given.scaled()
    return ordered(zeros_of_like_size(scaled.plant) * scaled.rate)


def zeros_of_like_size(plant: Realisation) -> Array:
    """Return the invariant zeros of a realisation that is scaled already, in no order."""
    import scipy.linalg

    proper = plant.filtered(FILTER)
    (d,) = proper.direct
    tolerance = 20 * EPS * (len(proper.A) + sum(d.shape))
    a, b, c, d = _row_reduced(proper.A, proper.B, proper.C, d, tolerance)
    a, c, b, d = (part.T for part in _row_reduced(a.T, c.T, b.T, d.T, tolerance))
    n = len(a)
    if not n:
        return numpy.zeros(0, dtype=complex)
    # columns are turned so that [C D] W = [0 F]: what is left of [A - s I, B] W is a regular pencil
    turned = numpy.linalg.svd(numpy.hstack([c, d]))[2].T[:, ::-1]
    kept = turned[:, :n]
    pencil = numpy.hstack([a, b]) @ kept, kept[:n]
    found = scipy.linalg.eigvals(*pencil)
    if numpy.linalg.cond(pencil[1]) < WELL:
        found = cleared(found, numpy.linalg.solve(pencil[1], pencil[0]))
    return found[numpy.isfinite(found)].astype(complex)


def cleared(roots: Array, matrix: Array) -> Array:
    """Put the eigenvalues that ranks say are zero at zero: several would be off by far more than rounding.

    Parameters
    ----------
    roots : (n,) complex array
        Eigenvalues of the matrix.
    matrix : (n, n) array
        In units of frequency in which the model's rates are about one.

    Returns
    -------
    (n,) complex array
    """
    sizes = numpy.abs(roots)
    smallest = numpy.argsort(sizes)[: deflated(matrix, 1.0)[1]]
    found = roots.astype(complex)
    found[smallest[sizes[smallest] < FAINT * sizes.max(initial=1.0)]] = 0.0
    return found


def ordered(values: Array) -> Array:
    """Order roots: largest real part first, of a pair the one above first."""
    return values[numpy.lexsort((-values.imag, numpy.round(-values.real, 9)))].astype(complex)


def _row_reduced(
    a: Array, b: Array, c: Array, d: Array, tolerance: float
) -> tuple[Array, Array, Array, Array]:
    """Return matrices with the same finite zeros whose D has full row rank."""
    while True:
        turn, rank = compressed(d, tolerance)
        c, d = turn.T @ c, turn.T @ d
        bare, c, d = c[rank:], c[:rank], d[:rank]
        if not len(bare):
            return a, b, c, d
        turn, held = compressed(bare.T, tolerance)
        if not held:
            return a, b, c, d
        # states that the outputs hold at zero come last; their rates are outputs held at zero
        v = numpy.hstack([turn[:, held:], turn[:, :held]])
        a, b, c = v.T @ a @ v, v.T @ b, c @ v
        free = len(a) - held
        c, d = (
            numpy.vstack([c[:, :free], a[free:, :free]]),
            numpy.vstack([d, b[free:]]),
        )
        a, b = a[:free, :free], b[:free]
