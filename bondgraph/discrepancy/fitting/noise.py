"""The noise of a channel from its residuals, and how many samples they are worth."""

from __future__ import annotations

import numpy

from ..measurement.quality import NORMAL

Array = numpy.ndarray


def spread(residuals: Array, unknowns: float, robust: bool) -> float:
    """Return the standard deviation of residuals.

    Parameters
    ----------
    residuals : (n,) array
    unknowns : float
        Degrees of freedom used up.
    robust : bool
        By the median of absolute values, which outliers do not move.

    Returns
    -------
    float

    Examples
    --------
    >>> spread(numpy.array([1.0, -1.0, 1.0, -1.0]), 2, False)
    1.4142135623730951
    """
    n = len(residuals)
    share = n / max(n - unknowns, 1.0)
    if robust:
        return float(NORMAL * numpy.median(numpy.abs(residuals)) * share**0.5)
    return float((residuals @ residuals / n * share) ** 0.5)


def correlation_time(residuals: Array) -> float:
    """Return by how much correlation lessens the worth of residuals, in samples; 1 if white.

    1 + 2 sum rho_k over the lags before the first one whose autocorrelation is below two
    standard deviations of white noise.

    Parameters
    ----------
    residuals : (n,) array

    Returns
    -------
    float

    References
    ----------
    Priestley, Spectral Analysis and Time Series, Academic Press 1981.

    Examples
    --------
    >>> correlation_time(numpy.repeat([1.0, -1.0, -1.0, 1.0] * 20, 10)) > 5
    True
    """
    n = len(residuals)
    centred = residuals - residuals.mean()
    power = float(centred @ centred)
    if n < 8 or power == 0:
        return 1.0
    size = 1 << (2 * n - 1).bit_length()
    rho = numpy.fft.irfft(numpy.abs(numpy.fft.rfft(centred, size)) ** 2, size)[: n // 2] / power
    below = numpy.flatnonzero(rho < 2 / n**0.5)
    last = int(below[0]) if len(below) else len(rho)
    return float(max(1.0, 1 + 2 * rho[1:last].sum()))
