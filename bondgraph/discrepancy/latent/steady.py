"""Steadiness: how large effects are in each part of the recordings.

What is missing by one name is as large early as late. An effect that only stands for another
comes and goes with what the other does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy

from .columns import Candidate
from .relax import Course
from .screen import Hypothesis, Sketch, products

Array = numpy.ndarray

PARTS = 3
TOLD = 0.1  # of the whole size, to which a part has to tell its own
TIMES = 4.0  # larger or smaller is another size
DEVIATIONS = 4.0


@dataclass(frozen=True, eq=False)
class Steadiness:
    """Sizes of one effect by parts of the recordings.

    Attributes
    ----------
    label : str
        Effect and site.
    sizes, std : (k,) arrays
        Over its size in all recordings, to first order, and standard deviations.
    """

    label: str
    sizes: Array
    std: Array

    @property
    def unsteady(self) -> dict[int, float]:
        """Parts in which the size is well told and another than in the whole, and that size."""
        told = self.std < TOLD
        other = (self.sizes > TIMES) | (self.sizes < 1 / TIMES)
        sure = numpy.abs(self.sizes - 1) > DEVIATIONS * self.std
        return {int(k): float(self.sizes[k]) for k in numpy.flatnonzero(told & other & sure)}


def steadiness(
    sketch: Sketch, fitted: Sketch, labels: Sequence[str], parts: int = PARTS
) -> tuple[Steadiness, ...]:
    """Return how large effects are in each part, the others beside them.

    Parameters
    ----------
    sketch : Sketch
        Of the model without the effects.
    fitted : Sketch
        Along the runs of the model that has them.
    labels : sequence of str
        Effects and sites.
    parts : int
        Of each recording, equally long.

    Returns
    -------
    tuple of Steadiness
        Of those effects that the sketch has scored.
    """
    found = {item.label: item for item in sketch.singles if len(item.candidates) == 1}
    scored = {item.label for item in fitted.columns.candidates}
    known = [(label, found[label]) for label in labels if label in found and label in scored]
    together = _together(sketch, [item for _, item in known])
    return tuple(
        _steadiness(fitted, label, [known[number][1], *_others(known, number)], together, parts)
        for number, (label, _) in enumerate(known)
    )


def _others(known: Sequence[tuple[str, Hypothesis]], number: int) -> list[Hypothesis]:
    return [item for i, (_, item) in enumerate(known) if i != number]


def _group(sketch: Sketch, candidate: Candidate) -> tuple[int, ...]:
    """Return the columns of one form of an effect at a site."""
    for other, group in zip(sketch.columns.candidates, sketch.columns.groups, strict=True):
        if other.label == candidate.label and other.shape.features == candidate.shape.features:
            return group[: len(other.shape.features)]  # without the constant beside it
    return ()


def _together(sketch: Sketch, items: Sequence[Hypothesis]) -> dict[str, Array]:
    """Return the amounts of effects that are fitted together, by label."""
    if not items:
        return {}
    groups = [_group(sketch, item.candidates[0]) for item in items]
    where = [index for group in groups for index in group]
    error = min(item.error for item in items)
    nearest = min(sketch.reduced, key=lambda each: abs(each.error - error))
    gram, cross = nearest.gram[numpy.ix_(where, where)], nearest.gram[where, -1]
    scaled, size = _scaled(gram)
    amounts = numpy.linalg.lstsq(scaled, cross / size, rcond=1e-10)[0] / size
    bounds = numpy.cumsum([0, *(len(group) for group in groups)])
    return {
        item.label: amounts[low:high]
        for item, low, high in zip(items, bounds, bounds[1:], strict=False)
    }


def _steadiness(
    sketch: Sketch,
    label: str,
    items: Sequence[Hypothesis],
    together: dict[str, Array],
    parts: int,
) -> Steadiness:
    """Give the first of several effects a size of its own in each part, beside what is fitted."""
    columns, (first, *others) = sketch.columns, items
    group = _group(sketch, first.candidates[0])
    beside = [index for item in others for index in _group(sketch, item.candidates[0])]
    if not group:
        return Steadiness(label, numpy.ones(parts), numpy.full(parts, numpy.inf))
    values = []
    for course, sides in zip(sketch.relaxed.courses, columns.values, strict=True):
        there = _windows(course, parts)
        before, after = (
            numpy.hstack([(side[:, group] @ together[label])[:, None] * there, side[:, beside]])
            for side in sides
        )
        values.append((before, after))
    index = [group[0]] * parts + beside
    split = replace(
        columns,
        candidates=(),
        groups=(),
        probes=columns.probes[index],
        rates=columns.rates[index],
        values=tuple(values),
    )
    found = products(sketch.relaxed, split, sketch.relaxed.error)
    gram, cross = found.gram[:-1, :-1], found.gram[:-1, -1]
    scaled, size = _scaled(gram)
    inverse = numpy.linalg.pinv(scaled, rcond=1e-10, hermitian=True)
    amounts = inverse @ (cross / size) / size
    left = max(float(found.gram[-1, -1] - cross @ amounts), 0.0)
    spread = (inverse / numpy.outer(size, size))[:parts, :parts]
    spread = spread * left / max(found.count - len(size), 1)
    told = (numpy.diag(gram)[:parts] > 0) & (numpy.diag(spread) > 0)
    weights = numpy.where(told, 1 / numpy.where(told, numpy.diag(spread), 1.0), 0.0)
    if told.sum() < 2:
        return Steadiness(label, numpy.ones(parts), numpy.full(parts, numpy.inf))
    # what all parts have in common is for the fit to tell; own parameters do the same as that
    apart = numpy.eye(parts) - weights / weights.sum()
    std = numpy.sqrt(numpy.maximum(numpy.diag(apart @ spread @ apart.T), 0.0))
    return Steadiness(label, 1 + apart @ amounts[:parts], numpy.where(told, std, numpy.inf))


def _scaled(gram: Array) -> tuple[Array, Array]:
    """Return products of columns of length one, and the lengths; infinite where nothing is."""
    size = numpy.sqrt(numpy.where(numpy.diag(gram) > 0, numpy.diag(gram), numpy.inf))
    return gram / numpy.outer(size, size), size


def _windows(course: Course, parts: int) -> Array:
    """Return which part of its recording each time of a course lies in, shape (nt, parts)."""
    begins, ends = float(course.record.t[0]), float(course.record.t[-1])
    share = (course.grid.t - begins) / max(ends - begins, 1e-300)
    number = numpy.clip((share * parts).astype(int), 0, parts - 1)
    return (number[:, None] == numpy.arange(parts)).astype(float)
