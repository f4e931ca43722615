"""Inputs: multisines, steps, chirps, from a seed."""

from __future__ import annotations

import numpy

from .plants import Plant

Array = numpy.ndarray
KINDS = ("multisine", "steps", "chirp")


def excitation(plant: Plant, kind: str, size: int, rng: numpy.random.Generator) -> Array:
    """Return samples of an input that stays within offset and amplitude.

    Parameters
    ----------
    plant : Plant
    kind : of `KINDS`
    size : number of samples
    rng : numpy.random.Generator
    """
    t = numpy.arange(size) * plant.step
    low, high = plant.band
    low = max(low, 1.5 / t[-1])
    if kind == "multisine":
        lines = numpy.geomspace(low, high, 10) * rng.uniform(0.93, 1.07, 10)
        phases = rng.uniform(0, 2 * numpy.pi, 10)
        values = numpy.sin(2 * numpy.pi * numpy.outer(t, lines) + phases).sum(axis=1)
        values /= abs(values).max()
    elif kind == "steps":
        values = _steps(t, 0.5 / high, 0.25 / low, rng)
    else:
        sweep = low * t[-1] / numpy.log(high / low) * ((high / low) ** (t / t[-1]) - 1)
        values = numpy.sin(2 * numpy.pi * sweep) * rng.uniform(0.8, 1.0)
    # from nothing, so that it does not matter what was before the first sample
    begun = numpy.minimum(t / max(4 * plant.step, 0.25 / high), 1.0)
    return begun * (plant.offset + plant.amplitude * values)


def _steps(t: Array, shortest: float, longest: float, rng: numpy.random.Generator) -> Array:
    values, i = numpy.empty(len(t)), 0
    while i < len(t):
        span = numpy.exp(rng.uniform(numpy.log(shortest), numpy.log(longest)))
        count = max(2, round(span / t[1]))
        values[i : i + count] = rng.uniform(-1, 1)
        i += count
    return values / abs(values).max()
