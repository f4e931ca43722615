"""Folds of the algebraic equations: rows made consistent, and whether they turned over.

Where the Jacobian of the residuals becomes singular, the algebraic variables are
no longer determined; its determinant changes sign where a solution is left for
another one beyond such a fold.
"""

from __future__ import annotations

import numpy

from .functions import SmoothFunctions, polish

Array = numpy.ndarray
ROUNDS = 3
CONVERGED = 1e-12
# Beside the best so far, a smallest singular value below this share explains why a run stops.
SINGULAR = 1e-2


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
    assert functions.step is not None
    z = z.copy()
    everywhere = numpy.repeat(p[:, None], len(t), axis=1)
    for _ in range(ROUNDS):
        try:
            step = functions.step(t[None], x, z, u, everywhere).full()
        except RuntimeError:  # singular
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


class Folds:
    """Watch over the branch of the algebraic equations that a run is on.

    Parameters
    ----------
    functions : SmoothFunctions
    p : (np,) array

    Attributes
    ----------
    turned : bool
        Whether a point beyond a fold was met.
    """

    def __init__(self, functions: SmoothFunctions, p: Array) -> None:
        self.turned = False
        self._functions, self._p = functions, p
        self._sign = 0.0
        self._rows = numpy.ones(functions.nz)
        self._best = 0.0

    def enter(self, t: float, x: Array, u: Array, z: Array, size: Array) -> None:
        """Take the branch from a point; sizes are those of the algebraic variables."""
        if self._functions.nz:
            matrix = self._jacobian(t, x, u, z)
            self._sign = float(numpy.linalg.slogdet(matrix)[0])
            if not self._best:
                self.weigh(t, x, u, z, size)
            self._best = max(self._best, self._determined(matrix, size))

    def weigh(self, t: float, x: Array, u: Array, z: Array, size: Array) -> None:
        """Take from a point the scale of each residual and how well determined all are."""
        if self._functions.nz:
            matrix = self._jacobian(t, x, u, z)
            largest = numpy.abs(matrix * size).max(axis=1)
            self._rows = numpy.where(largest > 0, largest, 1.0)
            self._best = self._determined(matrix, size)

    def keeps(self, t: float, x: Array, u: Array, z: Array, size: Array) -> bool:
        """Whether a point to which the run has come is on the branch."""
        if not self._functions.nz:
            return True
        matrix = self._jacobian(t, x, u, z)
        sign = float(numpy.linalg.slogdet(matrix)[0])
        if sign * self._sign < 0:
            self.turned = True
            return False
        self._sign = self._sign or sign
        self._best = max(self._best, self._determined(matrix, size))
        return True

    def near(
        self, t: float, x: Array, u: Array, z: Array, size: Array, share: float = SINGULAR
    ) -> bool:
        """Whether the residuals hardly determine the algebraic variables at a point.

        Parameters
        ----------
        t, x, u, z, size
            The point, and the sizes of its algebraic variables.
        share : float
            Of how well they were determined at best.
        """
        if not self._functions.nz:
            return False
        return self._determined(self._jacobian(t, x, u, z), size) <= share * self._best

    def _jacobian(self, t: float, x: Array, u: Array, z: Array) -> Array:
        return self._functions.residual(t, x, z, u, self._p)[1].full()

    def _determined(self, matrix: Array, size: Array) -> float:
        """Return the smallest singular value of a Jacobian, in scaled rows and columns."""
        scaled = matrix * size / self._rows[:, None]
        if not numpy.isfinite(scaled).all():
            return 0.0
        return float(numpy.linalg.svd(scaled, compute_uv=False).min())
