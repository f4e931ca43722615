"""At which frequencies the gap is more than noise."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy

from ...cycles import Spectrum, spectrum
from ...errors import MeasurementError
from .crossing import Coherence, coherence, spectral_matrix
from .even import evenly
from .floor import Floor, floor_of
from .value import Residuals

Array = numpy.ndarray

LINES_APART = 2  # bands with no more lines between them are one


@dataclass(frozen=True)
class Band:
    """A band of frequencies in which the gap stands above the floor.

    Attributes
    ----------
    low, high : float
        Hz.
    peak : float
        Frequency of its highest line, Hz.
    share : float
        Of the gap's power above the floor at all frequencies.
    over : float
        Power in the band over the floor's there.
    """

    low: float
    high: float
    peak: float
    share: float
    over: float


@dataclass(frozen=True, eq=False)
class FrequencyGaps:
    """Spectra of a gap and of its signal, and the bands where the gap is more than noise.

    Attributes
    ----------
    signal, unit : str
    gap, measured : Spectrum
        With window, resolution and averages.
    floor : Floor
    floor_density : float
        Of white noise of the floor's size, in the spectra's unit.
    limit : float
        Density that noise passes at any line with chance `alpha`.
    freedom : float
        Degrees of freedom of a line, overlapping segments counted as what they are worth.
    bands : tuple of Band
        Largest share first; empty where the gap is within noise.
    coherence : Coherence or None
        Of the gap with what it may depend on.
    treatment : str
        What was done to missing or uneven samples.
    alpha : float
    """

    signal: str
    unit: str
    gap: Spectrum
    measured: Spectrum
    floor: Floor
    floor_density: float
    limit: float
    freedom: float
    bands: tuple[Band, ...]
    coherence: Coherence | None
    treatment: str
    alpha: float


def by_frequency(
    found: Residuals,
    signal: str,
    causes: Iterable[str] | None = None,
    *,
    floor: Any = None,
    segment: float | None = None,
    window: str = "hann",
    alpha: float = 0.01,
) -> FrequencyGaps:
    """Estimate the spectrum of a gap, the bands above the floor and the coherence with causes.

    Densities are Welch's, of segments that overlap by half. Each line is held against
    chi-squared (F where the floor is estimated) with Bonferroni's correction over all lines.

    Parameters
    ----------
    found : Residuals
    signal : str
    causes : iterable of str, optional
        Signals the gap may depend on, see `Residuals.along`; the inputs unless given.
    floor : float, Floor, or mapping, optional
        As for `by_signal`.
    segment : float, optional
        Length of a segment, s; an eighth of the recording unless given.
    window : str
        Of `scipy.signal.get_window`.
    alpha : float

    Returns
    -------
    FrequencyGaps

    Raises
    ------
    MeasurementError
        For recordings with long holes or steps that differ much; see `evenly`.
    SimulationError
        For segments and windows without meaning.

    References
    ----------
    Welch, The use of fast Fourier transform for the estimation of power spectra, IEEE Trans.
    Audio and Electroacoustics 15 (1967) 70-73.

    Examples
    --------
    >>> t = numpy.arange(8000) / 1000
    >>> noise = numpy.random.default_rng(1).normal(0, 0.1, 8000)
    >>> hum = 0.05 * numpy.sin(2 * numpy.pi * 200 * t)
    >>> found = by_frequency(Residuals(t, {"v": noise + hum}, {"v": 0 * t}), "v", floor=0.1)
    >>> [round(band.peak) for band in found.bands]
    [200]
    """
    from scipy.signal import get_window

    own = floor_of(found, signal, floor)
    asked = tuple(found.inputs) if causes is None else tuple(causes)
    rows = [found.gap(signal), found.measured[signal], *(found.along(name) for name in asked)]
    data = evenly(found.t, rows, f"{found.name}, {signal}")
    # what never changes has no coherence
    moving = [k for k in range(len(asked)) if numpy.ptp(data.columns[2 + k]) > 0]
    span = data.t[-1] - data.t[0]
    length = span / 8 if segment is None else segment
    # nothing is taken off the gap: a bias is a part of it, at the lowest lines
    gap = spectrum(
        (data.t, data.columns[0]),
        f"gap of {signal}",
        segment=length,
        window=window,
        detrend=False,
    )
    measured = spectrum((data.t, data.columns[1]), signal, segment=length, window=window)
    count = round(length * gap.rate)
    weights = get_window(window, count)
    step = count - int(0.5 * count)
    worth = independent(weights, step, gap.averages)
    floor_density = 2 * own.sigma**2 / gap.rate
    limit = floor_density * _largest(2 * worth, own.freedom, alpha / max(len(gap.frequency), 1))
    linked = None
    if moving:
        kept = [0, *(2 + k for k in moving)]
        matrix = spectral_matrix(data.columns[kept], count, step, weights)
        names = tuple(asked[k] for k in moving)
        linked = coherence(matrix, gap.frequency, names, worth, alpha)
    return FrequencyGaps(
        signal,
        found.unit(signal),
        gap,
        measured,
        own,
        floor_density,
        limit,
        2 * worth,
        _bands(gap, floor_density, limit),
        linked,
        data.treatment,
        alpha,
    )


def independent(weights: Array, step: int, averages: int) -> float:
    """Return how many independent segments overlapping ones are worth.

    Parameters
    ----------
    weights : (count,) array
        Of the window.
    step, averages : int
        Samples from a segment to the next, and how many there are.

    Returns
    -------
    float

    References
    ----------
    Welch 1967, as for `by_frequency`.
    """
    own = (weights**2).sum() ** 2
    shifted = [
        ((weights[k * step :] * weights[: len(weights) - k * step]).sum() ** 2) / own
        for k in range(1, averages)
        if k * step < len(weights)
    ]
    extra = sum((1 - (k + 1) / averages) * rho for k, rho in enumerate(shifted))
    return averages / (1 + 2 * extra)


def _largest(freedom: float, of_floor: float, alpha: float) -> float:
    from scipy.stats import f as fisher

    return float(fisher.isf(alpha, freedom, min(of_floor, 1e6)))


def _bands(gap: Spectrum, floor_density: float, limit: float) -> tuple[Band, ...]:
    """Join lines above the limit to bands, as wide as they stay above the floor's own level."""
    above = gap.density > limit
    if not above.any():
        return ()
    excess = gap.density - floor_density
    # lines below the floor count too: without them scatter alone would look like power
    total = max(float(excess.sum()), float(excess[above].sum()))
    places = numpy.flatnonzero(above)
    cuts = numpy.flatnonzero(numpy.diff(places) > LINES_APART + 1) + 1
    bands = []
    for group in numpy.split(places, cuts):
        lines = slice(int(group[0]), int(group[-1]) + 1)
        top = int(group[numpy.argmax(gap.density[group])])
        noise = floor_density * (lines.stop - lines.start)
        bands.append(
            Band(
                float(max(gap.frequency[lines.start] - gap.line_spacing / 2, 0.0)),
                float(gap.frequency[lines.stop - 1] + gap.line_spacing / 2),
                float(gap.frequency[top]),
                float(excess[lines].sum()) / total,
                float(gap.density[lines].sum() / noise) if noise > 0 else numpy.inf,
            )
        )
    return tuple(sorted(bands, key=lambda band: -band.share))


def gap_rate(found: Residuals, signal: str, smooth: float, order: int = 1) -> Array:
    """Differentiate a gap: where a flow is measured, this is what a missing effort leaves.

    A force left out of a mass m shows in the rate of the gap of its speed, times m, before the
    rest of the model answers. Savitzky and Golay's cubic is laid through the samples of a window.

    Parameters
    ----------
    found : Residuals
    signal : str
    smooth : float
        Length of the window, s: noise faster than it is taken off, and so is any faster effect.
    order : int
        Of the derivative, 1 to 3.

    Returns
    -------
    (nt,) array
        In the signal's unit over s to the `order`; NaN where the gap is.

    Raises
    ------
    MeasurementError
        For uneven samples, holes, and windows of fewer than five samples.

    References
    ----------
    Savitzky, Golay, Smoothing and differentiation of data by simplified least squares procedures,
    Analytical Chemistry 36 (1964) 1627-1639.

    Examples
    --------
    >>> t = numpy.linspace(0, 1, 101)
    >>> found = Residuals(t, {"v": 3 * t}, {"v": t})
    >>> gap_rate(found, "v", 0.1).round(6)[[0, 50, 100]].tolist()
    [2.0, 2.0, 2.0]
    """
    from scipy.signal import savgol_filter

    gap = found.gap(signal)
    data = evenly(found.t, gap, f"{found.name}, {signal}")
    if "steps" in data.treatment:
        raise MeasurementError(f"{found.name}, {signal}: a rate takes even steps; resample first")
    spacing = (found.t[-1] - found.t[0]) / (len(found.t) - 1)
    count = 2 * int(smooth / spacing / 2) + 1
    if not (5 <= count <= len(gap) and order in (1, 2, 3)):
        raise MeasurementError(
            f"smooth={smooth:g} s, order={order}: the window takes 5 to {len(gap)} samples of "
            f"{spacing:g} s, the order is 1 to 3"
        )
    rate = savgol_filter(data.columns[0], count, 3, deriv=order, delta=spacing)
    rate[numpy.isnan(gap)] = numpy.nan
    return rate
