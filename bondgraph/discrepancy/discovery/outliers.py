"""Outliers: samples that no course near the data comes near to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy

from ..latent.relax import Course, Relaxed, followed
from ..measurement.quality import NORMAL
from .prepare import FEW, Prepared

if TYPE_CHECKING:
    from .search import Found

Array = numpy.ndarray

FAR = 6.0  # robust standard deviations
ROUNDS = 3
BESIDE = 3  # samples on either side of an outlier are drawn along by it


def without_outliers(
    found: Relaxed, recordings: Sequence[Prepared]
) -> tuple[tuple[Prepared, ...], tuple[str, ...]]:
    """Leave out samples that are far from the smoothed course.

    Parameters
    ----------
    found : Relaxed
    recordings : sequence of Prepared
        That it follows.

    Returns
    -------
    tuple of Prepared
    tuple of str
        What was left out, in words.
    """
    courses: dict[str, list[Course]] = {}
    for course in found.courses:
        courses.setdefault(course.record.name, []).append(course)
    kept, words = [], []
    for row in recordings:
        cleaned, said = _cleaned(found, row, courses.get(row.name, []))
        kept.append(cleaned)
        words += said
    return tuple(kept), tuple(words)


def cleared(found: Found, held: Sequence[Prepared]) -> list[Prepared]:
    """Leave outliers out of other recordings, as they were of those learned from."""
    relaxed = found.sketches[0].relaxed
    signals = relaxed.functions.outputs
    cleaned = []
    for row in held:
        for _ in range(ROUNDS):
            row, words = _cleaned(relaxed, row, [followed(relaxed, row.record(signals))])
            if not words:
                break
        cleaned.append(row)
    return cleaned


def _cleaned(
    found: Relaxed, row: Prepared, courses: Sequence[Course]
) -> tuple[Prepared, list[str]]:
    columns, words = dict(row.plain.columns), []
    left = [course.record.measured - found.said(course) for course in courses]
    for place, name in enumerate(found.functions.outputs):
        if name not in row.signals:
            continue
        far = numpy.zeros(len(row.plain.t), dtype=bool)
        for course, residuals in zip(courses, left, strict=True):
            off = residuals[:, place]
            spread = NORMAL * float(numpy.nanmedian(numpy.abs(off)))
            with numpy.errstate(invalid="ignore"):
                marked = numpy.abs(off) > FAR * max(spread, course.record.noise[place])
            if marked.sum() > FEW * len(marked):
                marked &= _peaks(numpy.abs(off))
            far[numpy.searchsorted(row.plain.t, course.record.t[marked])] = True
        if 0 < far.sum() <= FEW * len(far):
            columns[name] = numpy.where(far, numpy.nan, columns[name])
            words.append(
                f"{row.name}: {int(far.sum())} samples of {name!r} are left out as outliers"
            )
    if not words:
        return row, []
    return replace(row, plain=row.plain.changed(columns=columns)), words


def _peaks(off: Array) -> Array:
    """Return which values are the largest among their neighbours."""
    padded = numpy.pad(numpy.nan_to_num(off), BESIDE)
    around = numpy.lib.stride_tricks.sliding_window_view(padded, 2 * BESIDE + 1)
    return numpy.asarray(numpy.nan_to_num(off) >= around.max(axis=1))
