"""Eigenvalues of many small matrices: by compiled C where there is a compiler, else by LAPACK."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable
from importlib import resources

import numpy

from ...simulation.native import CompileError, load_shared

Array = numpy.ndarray

# Compiling takes as long as LAPACK takes for so many matrices of a few rows.
WORTHWHILE = 50_000
# On larger ones LAPACK is as fast.
LARGEST = 12


def eigvals(matrices: Array, compiled: bool = False) -> Array:
    """Return the eigenvalues of matrices, in no order but pairs together, positive part first.

    Parameters
    ----------
    matrices : (m, n, n) array
        Finite.
    compiled : bool
        Whether to use compiled code where that can be had.

    Returns
    -------
    (m, n) complex array

    Examples
    --------
    >>> eigvals(numpy.array([[[0.0, 1.0], [-4.0, 0.0]]])).round(12).tolist()
    [[2j, -2j]]
    """
    m, n, _ = matrices.shape
    function = _function() if compiled and n <= LARGEST else None
    if function is None:
        return numpy.linalg.eigvals(matrices).astype(complex)
    own = numpy.array(matrices, dtype=float, order="C")
    real, imaginary = numpy.empty((m, n)), numpy.empty((m, n))
    function(m, n, own.ctypes.data, real.ctypes.data, imaginary.ctypes.data)
    found = numpy.empty((m, n), dtype=complex)
    found.real, found.imag = real, imaginary
    lost = ~numpy.isfinite(real + imaginary).all(axis=1)
    if lost.any():
        found[lost] = numpy.linalg.eigvals(matrices[lost])
    return found


@functools.cache
def _function() -> Callable[[int, int, int, int, int], int] | None:
    """Return the compiled function; None where there is no compiler."""
    source = resources.files(__package__).joinpath("eigen.c").read_text(encoding="utf-8")
    try:
        function = load_shared(source, "eigenvalues").halfarrow_eigenvalues
    except CompileError:
        return None
    function.argtypes = [ctypes.c_long, ctypes.c_long, *[ctypes.c_void_p] * 3]
    function.restype = ctypes.c_long
    return function
