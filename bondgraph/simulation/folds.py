"""Folds of the algebraic equations: rows made consistent, and whether they turned over.

Where the Jacobian of the residuals becomes singular, the algebraic variables are
no longer determined; its determinant changes sign where a solution is left for
another one beyond such a fold.
"""

from __future__ import annotations

import numpy

from .dae import SmoothFunctions, polish

Array = numpy.ndarray
ROUNDS = 3
CONVERGED = 1e-12


def polished(
    functions: SmoothFunctions, t: Array, x: Array, u: Array, p: Array, z: Array
) -> Array | None:
    """Solve the algebraic equations to rounding at many points, from near values.

    Parameters
    ----------
    functions : SmoothFunctions
    t : (k,) array
    x : (n, k) array
    u : (m, k) array
    p : (np,) array
    z : (nz, k) array

    Returns
    -------
    (nz, k) array or None
        None where the values of some point do not lead to a solution.
    """
    z = z.copy()
    for _ in range(ROUNDS):
        left, matrices, _ = _at(functions, t, x, u, p, z)
        try:
            step = numpy.linalg.solve(matrices, -left.T[:, :, None])[:, :, 0].T
        except numpy.linalg.LinAlgError:
            break
        if not numpy.isfinite(step).all():
            break
        z += step
        if (numpy.abs(step) <= CONVERGED * numpy.abs(z)).all():
            return z
    for column, time in enumerate(t):
        found = polish(functions, time, x[:, column], u[:, column], p, z[:, column])
        if found is None:
            return None
        z[:, column] = found
    return z


def turns(
    functions: SmoothFunctions, t: Array, x: Array, u: Array, p: Array, z: Array
) -> tuple[Array, Array]:
    """Return the sign of the Jacobian's determinant, and the Jacobian, at each point.

    Returns
    -------
    signs : (k,) array
    matrices : (k, nz, nz) array
    """
    matrices = _at(functions, t, x, u, p, z)[1]
    return numpy.linalg.slogdet(matrices)[0], matrices


def _at(
    functions: SmoothFunctions, t: Array, x: Array, u: Array, p: Array, z: Array
) -> tuple[Array, Array, Array]:
    k = len(t)
    left, matrix, terms = functions.residual(t[None], x, z, u, numpy.repeat(p[:, None], k, axis=1))
    stacked = matrix.full().reshape(functions.nz, k, functions.nz).transpose(1, 0, 2)
    return left.full(), stacked, terms.full()
