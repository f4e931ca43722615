"""Spectral matrices by Welch's method: coherence of one signal with several others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

Array = numpy.ndarray

DEPENDENT = 1e-9  # of the reciprocal condition: below it, causes tell nothing apart


@dataclass(frozen=True, eq=False)
class Coherence:
    """Coherence of a gap with what it may depend on.

    Attributes
    ----------
    frequency : (nf,) array
        Hz.
    ordinary : mapping of str to (nf,) array
        0 to 1, with each cause alone.
    partial : mapping of str to (nf,) array
        With each cause once the others' linear share is taken off both; NaN where causes depend
        on one another.
    multiple : (nf,) array
        With all causes together.
    limit, limit_partial, limit_multiple : float
        What unrelated signals exceed at one line with chance `alpha`.
    alpha : float
    """

    frequency: Array
    ordinary: dict[str, Array]
    partial: dict[str, Array]
    multiple: Array
    limit: float
    limit_partial: float
    limit_multiple: float
    alpha: float


def spectral_matrix(columns: Any, count: int, step: int, weights: Any) -> Array:
    """Return cross spectra of columns, averaged over segments.

    Parameters
    ----------
    columns : (m, nt) array-like
        Evenly spaced.
    count, step : int
        Samples of a segment, and from one to the next.
    weights : (count,) array-like
        Of the window.

    Returns
    -------
    (nf, m, m) complex array
        ``conj(X_i) X_j``, not scaled.

    Examples
    --------
    >>> matrix = spectral_matrix(numpy.eye(2, 16), 8, 4, numpy.ones(8))
    >>> matrix.shape
    (5, 2, 2)
    """
    columns = numpy.asarray(columns, dtype=float)
    total: Any = 0.0
    for start in range(0, columns.shape[1] - count + 1, step):
        part = columns[:, start : start + count]
        lines = numpy.fft.rfft((part - part.mean(axis=1, keepdims=True)) * weights, axis=1)
        total = total + numpy.einsum("if,jf->fij", lines.conj(), lines)
    return total


def coherence(
    matrix: Array, frequency: Array, names: tuple[str, ...], averages: float, alpha: float
) -> Coherence:
    """Read coherences from a spectral matrix whose first column is the gap.

    Parameters
    ----------
    matrix : (nf, 1 + m, 1 + m) complex array
    frequency : (nf,) array
        Hz.
    names : tuple of str
        Of the m causes.
    averages : float
        Independent segments.
    alpha : float

    Returns
    -------
    Coherence

    References
    ----------
    Bendat, Piersol, Random Data, 4th ed., Wiley 2010, chapters 7 and 9; Carter, Coherence and
    time delay estimation, Proc. IEEE 75 (1987) 236-255 (limits).
    """
    size = numpy.einsum("fii->fi", matrix).real
    scale = numpy.sqrt(numpy.maximum(size, numpy.finfo(float).tiny))
    unit = matrix / (scale[:, :, None] * scale[:, None, :])
    causes = len(names)
    ordinary = {name: numpy.abs(unit[:, 0, 1 + k]) ** 2 for k, name in enumerate(names)}
    known = numpy.linalg.cond(unit[:, 1:, 1:]) * DEPENDENT < 1
    partial = {name: numpy.full(len(frequency), numpy.nan) for name in names}
    multiple = numpy.full(len(frequency), numpy.nan)
    if known.any():
        inner, across = unit[known][:, 1:, 1:], unit[known][:, 1:, :1]
        solved = numpy.linalg.solve(inner, across)
        multiple[known] = numpy.einsum("fik,fik->f", across.conj(), solved).real
        left = numpy.maximum(1 - multiple[known], numpy.finfo(float).tiny)
        corner = numpy.einsum("fii->fi", numpy.linalg.inv(inner)).real
        for k, name in enumerate(names):  # gain on the cause, once the others are taken off
            gain = numpy.abs(solved[:, k, 0]) ** 2 / corner[:, k]
            partial[name][known] = gain / (gain + left)
    return Coherence(
        frequency,
        ordinary,
        partial,
        multiple,
        _limit(averages, 1, alpha),
        _limit(averages - causes + 1, 1, alpha),
        _limit(averages, causes, alpha),
        alpha,
    )


def _limit(averages: float, causes: int, alpha: float) -> float:
    """Return what the coherence of unrelated signals passes with chance alpha: a beta law."""
    from scipy.stats import beta

    return float(beta.isf(alpha, causes, averages - causes)) if averages > causes else 1.0
