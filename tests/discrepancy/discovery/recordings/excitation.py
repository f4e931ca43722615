"""Inputs that test benches use, and what sensors make of signals."""

from __future__ import annotations

import numpy

Array = numpy.ndarray


def spectrum(rows: int, interval: float, low: float, high: float, seed: int) -> Array:
    """Random phases and flat amplitudes in a band, one-sided, unit root mean square."""
    frequencies = numpy.fft.rfftfreq(rows, interval)
    lines = (frequencies >= low) & (frequencies <= high)
    phases = numpy.random.default_rng(seed).uniform(0, 2 * numpy.pi, len(frequencies))
    return numpy.where(lines, numpy.exp(1j * phases), 0) * rows / numpy.sqrt(2 * lines.sum())


def multisine(
    rows: int, interval: float, low: float, high: float, seed: int, fine: int = 1
) -> Array:
    """One period of a random-phase multisine of unit RMS, on a grid ``fine`` times as dense."""
    lines = spectrum(rows, interval, low, high, seed)
    return numpy.asarray(numpy.fft.irfft(lines, rows * fine) * fine)


def steps(rows: int, hold: int, seed: int) -> Array:
    """A random binary sequence of -1 and 1 that changes every ``hold`` rows at most."""
    signs = numpy.random.default_rng(seed).choice([-1.0, 1.0], rows // hold + 1)
    return numpy.repeat(signs, hold)[:rows]


def noisy(x: Array, share: float, rng: numpy.random.Generator) -> Array:
    """Add white noise, its standard deviation a share of the signal's."""
    return x + share * numpy.std(x) * rng.normal(size=len(x))


def quantised(x: Array, step: float) -> Array:
    return numpy.asarray(numpy.round(x / step) * step)
