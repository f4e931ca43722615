"""Whether innovations are white, and how much of them is not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ...errors import MeasurementError
from .even import evenly

Array = numpy.ndarray

LEAST = 50


@dataclass(frozen=True, eq=False)
class Whiteness:
    """Two tests of whiteness, and how far from white a series is.

    Attributes
    ----------
    count : int
        Samples.
    effective : float
        Independent ones that they are worth for a mean.
    lags : int
    autocorrelation : (lags,) array
        From lag 1.
    limit : float
        What a white series' autocorrelation passes at any lag with chance 5 %.
    ljung_box, p_ljung_box : float
        Portmanteau statistic and its chance.
    frequency, cumulative : (nf,) array
        Hz, and share of the power up to there: a straight line for white noise.
    kolmogorov, p_kolmogorov : float
        Largest distance from that line, and its chance.
    predictable : float
        Share of the variance that the last `lags` samples foretell, 0 to 1, less what chance
        gives. Unlike p it does not grow with the length of the record.
    above : float or None
        Share of the mean square above the floor, where one was given.
    where : str
        In words: the lag of the largest autocorrelation, and the frequencies that hold too much.
    """

    count: int
    effective: float
    lags: int
    autocorrelation: Array
    limit: float
    ljung_box: float
    p_ljung_box: float
    frequency: Array
    cumulative: Array
    kolmogorov: float
    p_kolmogorov: float
    predictable: float
    above: float | None
    where: str

    @property
    def verdict(self) -> str:
        """What the tests say, with the size of it."""
        size = f"{100 * self.predictable:.3g} % of the variance is predictable"
        if self.above is not None:
            size += f", {100 * self.above:.3g} % of the mean square lies above the floor"
        white = min(self.p_ljung_box, self.p_kolmogorov) >= 0.005
        return (
            f"white as far as {self.count} samples tell"
            if white
            else f"not white: {size}; {self.where}"
        )


def whiteness(
    series: Any, t: Any = None, *, lags: int | None = None, floor: Any = None
) -> Whiteness:
    """Test innovations or a gap for whiteness.

    Long records reject whiteness for the least correlation: read `predictable` and `where`
    beside the p values.

    Parameters
    ----------
    series : (nt,) array-like
    t : (nt,) array-like, s, optional
        One sample a second unless given.
    lags : int, optional
        Twenty, or a fifth of the samples, unless given.
    floor : float, optional
        Standard deviation of the noise.

    Returns
    -------
    Whiteness

    Raises
    ------
    MeasurementError
        For fewer than 50 samples, a constant series, and lags without meaning.

    References
    ----------
    Ljung, Box, On a measure of lack of fit in time series models, Biometrika 65 (1978) 297-303;
    Durbin, Tests for serial correlation in regression analysis based on the periodogram of
    least-squares residuals, Biometrika 56 (1969) 1-15.

    Examples
    --------
    >>> noise = numpy.random.default_rng(3).normal(size=2000)
    >>> whiteness(noise).verdict
    'white as far as 2000 samples tell'
    >>> round(whiteness(noise[1:] + noise[:-1]).predictable, 1)
    0.5
    """
    from scipy.stats import chi2, kstwo, norm

    values = numpy.asarray(series, dtype=float).ravel()
    times = numpy.arange(len(values), dtype=float) if t is None else numpy.asarray(t, dtype=float)
    if len(values) < LEAST or len(times) != len(values):
        raise MeasurementError(
            f"{len(values)} values for {len(times)} times: whiteness takes {LEAST} at least, and "
            "as many of both"
        )
    data = evenly(times, values, "innovations")
    values = data.columns[0]
    count = len(values)
    lags = min(20, count // 5) if lags is None else lags
    centred = values - values.mean()
    power = float(centred @ centred)
    if not 1 <= lags < count // 2 or not power > 1e-20 * float(values @ values):
        raise MeasurementError(
            f"lags={lags}: give 1 to {count // 2 - 1}, and a series that changes"
        )
    rho = _autocorrelation(centred, lags) / power
    box = count * (count + 2) * float((rho**2 / (count - numpy.arange(1, lags + 1))).sum())
    rate = (count - 1) / (data.t[-1] - data.t[0])
    lines = numpy.abs(numpy.fft.rfft(centred)[1 : (count - 1) // 2 + 1]) ** 2
    frequency = numpy.arange(1, len(lines) + 1) * rate / count
    cumulative = numpy.cumsum(lines) / lines.sum()
    line = numpy.arange(1, len(lines) + 1) / len(lines)
    # the last value is 1 by its making: m - 1 free ones, as m - 1 sorted uniform numbers
    distance = float(
        max(numpy.abs(cumulative - line).max(), numpy.abs(cumulative - line + 1 / len(lines)).max())
    )
    effective = count / max(1 + 2 * float(rho[: _first_small(rho, count)].sum()), 1 / count)
    return Whiteness(
        count,
        min(float(effective), float(count)),
        lags,
        rho,
        float(norm.isf(0.025 / lags) / numpy.sqrt(count)),
        box,
        float(chi2.sf(box, lags)),
        frequency,
        cumulative,
        distance,
        float(kstwo.sf(distance, max(len(lines) - 1, 1))),
        _predictable(rho, count),
        None if floor is None else _above(values, float(floor)),
        _where(rho, frequency, lines, rate),
    )


def _autocorrelation(centred: Array, lags: int) -> Array:
    return numpy.array([centred[k:] @ centred[:-k] for k in range(1, lags + 1)])


def _first_small(rho: Array, count: int) -> int:
    small = numpy.flatnonzero(numpy.abs(rho) < 2 / numpy.sqrt(count))
    return int(small[0]) if len(small) else len(rho)


def _predictable(rho: Array, count: int) -> float:
    """Return the share an autoregression explains (Yule and Walker), less what chance gives."""
    from scipy.linalg import solve_toeplitz

    column = numpy.append(1.0, rho[:-1])
    column[0] += 1e-10  # a pure sine makes the matrix singular
    explained = float(rho @ solve_toeplitz(column, rho))
    return min(max((explained - len(rho) / count) / (1 - len(rho) / count), 0.0), 1.0)


def _above(values: Array, floor: float) -> float:
    square = float((values**2).mean())
    return max(1 - floor**2 / square, 0.0)


def _where(rho: Array, frequency: Array, lines: Array, rate: float) -> str:
    """Name the largest lag, and the eighth of the frequencies that holds the most."""
    lag = int(numpy.argmax(numpy.abs(rho)))
    parts = [(part.sum(), k) for k, part in enumerate(numpy.array_split(lines, 8))]
    most, place = max(parts)
    low, high = place * rate / 16, (place + 1) * rate / 16
    return (
        f"autocorrelation {rho[lag]:.2g} at a lag of {(lag + 1) / rate:.3g} s; "
        f"{100 * most / lines.sum():.3g} % of the power from {low:.3g} to {high:.3g} Hz, "
        "12.5 % were white"
    )
