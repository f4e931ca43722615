"""What noise alone would reach: the best gain of all effects where nothing is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy

if TYPE_CHECKING:
    from .screen import Sketch

DRAWS = 400
LEVEL = 0.99


def threshold(sketch: Sketch, level: float = LEVEL, draws: int = DRAWS) -> float:
    """Return the gain that the best of all effects stays below where nothing is missing.

    Parameters
    ----------
    sketch : Sketch
    level : float
        Share of the recordings of a complete model in which it does.
    draws : int
        Simulated recordings, the same in every call.

    Returns
    -------
    float
        Drop of the criterion, as `Hypothesis.gain`.

    Notes
    -----
    Recordings of the model by itself with white noise, in the coordinates of the reduced factor:
    what a candidate gains is the square of the part of the noise that lies along it.
    """
    columns, reduced = sketch.columns, sketch.reduced[-1]
    factor = reduced.factor[:, :-1]
    rng = numpy.random.default_rng(0)
    noise = rng.normal(size=(len(factor), draws))
    best = numpy.full(draws, -numpy.inf)
    size = numpy.linalg.norm(factor, axis=0)
    for candidate, group in zip(columns.candidates, columns.groups, strict=True):
        where = [index for index in group if size[index] > 0]
        if not where:
            continue
        basis, _ = numpy.linalg.qr(factor[:, where] / size[where])
        along = basis.T @ noise
        if not candidate.signed[0] and len(where) == 1:
            along = numpy.maximum(along, 0.0)
        terms = len(candidate.effect.fitted)
        best = numpy.maximum(best, (along**2).sum(axis=0) - terms * numpy.log(reduced.count))
    return float(numpy.quantile(best, level))
