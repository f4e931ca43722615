"""Recordings beside the model before and after: over time, close up, and what is left."""

from __future__ import annotations

from collections.abc import Iterable

import numpy

from ...errors import BondGraphError
from ...plot import course_plot, gap_course, gap_spectra
from ...plot.courses import within
from ...plot.envelope import envelope
from ...report import Figure, Panel, Section, Text
from ..discovery import Course, Discovery
from ..residual import FrequencyGaps, Residuals, by_frequency
from .words import KINDS, changed, file_names

Array = numpy.ndarray

MOST = 6  # signals drawn; the numbers of all are in the files
LONG = 300  # samples from which on a close-up shows more
PERIODS = 8  # in a close-up


def course_sections(found: Discovery) -> list[Section]:
    """Draw courses of both kinds, then what is left of them."""
    names, left_out = _drawn_signals(found)
    if not names:
        return []
    files = file_names(names)
    groups = {"train": found.train, "validation": found.validation}
    figures: list[object] = []
    for name in names:
        for kind, courses in groups.items():
            course = _farthest(courses, name)
            if course is not None:
                figures.append(_course(found, course, name, f"{kind}-{files[name]}", KINDS[kind]))
    note = (
        [Text(f"Not drawn, in the tables and files: {', '.join(left_out)}.", "note")]
        if left_out
        else []
    )
    left = [
        figure
        for name in names
        if (figure := _left(found, name, f"left-{files[name]}")) is not None
    ]
    return [
        Section("Measured against model", (*figures, *note)),
        Section("What is left", tuple(left)),
    ]


def _drawn_signals(found: Discovery) -> tuple[list[str], list[str]]:
    """Return the signals to draw, those farthest off where there are many, and the others."""
    courses = (*found.validation, *found.train)
    names = list(dict.fromkeys(name for course in courses for name in _present(course)))
    worst = {name: max(_distance(course, name) for course in courses) for name in names}
    chosen = sorted(names, key=lambda name: -worst[name])[:MOST]
    return [n for n in names if n in chosen], [n for n in names if n not in chosen]


def _present(course: Course) -> list[str]:
    """Return the signals that have a value, measured and simulated."""
    return [
        name
        for name, values in course.measured.items()
        if numpy.isfinite(values).any() and name in course.before and name in course.after
    ]


def _distance(course: Course, signal: str) -> float:
    """Return the gap before, in standard deviations of the noise."""
    if signal not in _present(course):
        return -1.0
    size = _rms(course.measured[signal] - course.before[signal])
    noise = course.noise.get(signal, 0.0)
    return size / noise if noise > 0 else size


def _rms(values: Array) -> float:
    fine = values[numpy.isfinite(values)]
    if not len(fine):
        return 0.0
    largest = float(numpy.abs(fine).max()) or 1.0  # squares of what diverged overflow
    return largest * float(numpy.sqrt(numpy.mean((fine / largest) ** 2)))


def _farthest(courses: Iterable[Course], signal: str) -> Course | None:
    """Return the recording of a signal in which the model alone is farthest off."""
    having = [course for course in courses if signal in _present(course)]
    return max(having, key=lambda course: _distance(course, signal), default=None)


def _course(found: Discovery, course: Course, signal: str, stem: str, kind: str) -> Figure:
    more = changed(found)
    panels = [_course_panel(course, signal, stem, None, more)]
    close = _close_up(course, signal)
    words = f"Grey: measured, {len(course.t)} samples. Orange: the model with its parameters fitted"
    words += f". Blue: with {found.chosen.label}." if more else "."
    if not envelope(course.t, course.measured[signal]).whole:
        words += " So many samples are drawn as envelopes, least to largest."
    if close is not None:
        panels.append(_course_panel(course, signal, f"{stem}-close", close, more))
        words += f" Second plot: {close[0]:.4g} to {close[1]:.4g} s, where the model alone is farthest off."
    return Figure(f"{signal} of {course.name}, {kind}.", tuple(panels), words)


def _course_panel(
    course: Course, signal: str, stem: str, span: tuple[float, float] | None, more: bool
) -> Panel:
    words = f"{signal} over time in {course.name}, measured and model"
    ax = course_plot(course, signal, span, changed=more)
    t, rows = within(course.t, span)
    unit = course.units.get(signal) or "1"
    columns: dict[str, Array] = {}
    for label in ("measured", "before", "after"):
        part = envelope(t, getattr(course, label)[signal][rows])
        columns["time [s]"] = part.t
        if part.whole:
            columns[f"{label} [{unit}]"] = part.low
        else:
            columns[f"{label}, least [{unit}]"] = part.low
            columns[f"{label}, largest [{unit}]"] = part.high
    return Panel(stem, ax, words, columns)


def _close_up(course: Course, signal: str) -> tuple[float, float] | None:
    """Return a few periods about the place where the model alone is farthest off."""
    count = len(course.t)
    if count <= LONG:
        return None
    gap = numpy.nan_to_num(course.measured[signal] - course.before[signal], posinf=0, neginf=0)
    share = (gap / (numpy.abs(gap).max() or 1.0)) ** 2
    width = int(numpy.clip(PERIODS * _period(course.measured[signal]), 40, count // 4))
    total = numpy.concatenate([[0.0], numpy.cumsum(share)])
    start = int(numpy.argmax(total[width:] - total[:-width]))
    return float(course.t[start]), float(course.t[min(start + width, count - 1)])


def _period(values: Array) -> float:
    """Return how many samples a period takes; half of the power is faster, half slower."""
    filled = numpy.where(numpy.isfinite(values), values, numpy.nanmean(values))
    power = numpy.abs(numpy.fft.rfft(filled - filled.mean())) ** 2
    if not power.sum() > 0:
        return float(len(values))
    line = int(numpy.searchsorted(numpy.cumsum(power), power.sum() / 2))
    return len(values) / max(line, 1)


def _left(found: Discovery, signal: str, stem: str) -> Figure | None:
    """Draw what is left of a signal, on held-out data where there are any."""
    course = _farthest(found.validation, signal)
    kind = "held out" if course is not None else "learned from"
    course = course if course is not None else _farthest(found.train, signal)
    if course is None:
        return None
    more = changed(found)
    ax = gap_course(course, signal, changed=more)
    panels = [Panel(f"{stem}-time", ax, f"Gap of {signal} over time", _gaps(course, signal))]
    words = "Measured less model. What stays within the grey band is noise."
    labels = ("before", "after")[: 1 + more]
    rows, spectra = _spectra(course, signal, labels)
    if spectra:
        ax = gap_spectra(spectra.get("before"), spectra.get("after"))
        panels.append(Panel(f"{stem}-spectrum", ax, f"Spectrum of the gap of {signal}"))
        words += (
            " Spectrum: at which frequencies; at the dash-dotted line all is noise. Dotted: the "
            "signal itself."
        )
        if rows.stop - rows.start < len(course.t):
            ends = course.t[rows.start], course.t[rows.stop - 1]
            words += f" It is of the longest piece without gaps, {ends[0]:.4g} to {ends[1]:.4g} s."
    else:
        words += " The samples are too few or too uneven for a spectrum."
    return Figure(f"{signal} of {course.name}, {kind}.", tuple(panels), words)


def _gaps(course: Course, signal: str) -> dict[str, Array]:
    unit = course.units.get(signal) or "1"
    columns: dict[str, Array] = {}
    for label in ("before", "after"):
        part = envelope(course.t, course.measured[signal] - getattr(course, label)[signal])
        columns["time [s]"] = part.t
        for word, values in (("least", part.low), ("largest", part.high))[part.whole :]:
            heading = f"gap {label}" if part.whole else f"gap {label}, {word}"
            columns[f"{heading} [{unit}]"] = values
    return columns


def _spectra(
    course: Course, signal: str, labels: tuple[str, ...]
) -> tuple[slice, dict[str, FrequencyGaps]]:
    """Return the rows that spectra of a gap are of, and the spectra; none where none can be."""
    whole = slice(0, len(course.t))
    for rows in (whole, _longest(numpy.isfinite(course.measured[signal]))):
        found = {label: _spectrum(course, signal, label, rows) for label in labels}
        fine = {label: one for label, one in found.items() if one is not None}
        if fine:
            return rows, fine
    return whole, {}


def _longest(present: Array) -> slice:
    """Return the longest piece without a gap."""
    edges = numpy.flatnonzero(numpy.diff(numpy.concatenate([[0], present.astype(int), [0]])))
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return slice(0, 0)
    place = int(numpy.argmax(ends - starts))
    return slice(int(starts[place]), int(ends[place]))


def _spectrum(course: Course, signal: str, label: str, rows: slice) -> FrequencyGaps | None:
    """Return the spectrum of a gap; None where the samples do not allow one."""
    noise = course.noise.get(signal, numpy.nan)
    known = float(noise) if numpy.isfinite(noise) and noise > 0 else None
    try:
        gaps = Residuals(
            course.t[rows],
            {signal: course.measured[signal][rows]},
            {signal: getattr(course, label)[signal][rows]},
            {signal: course.units.get(signal, "")},
            name=course.name,
        )
        return by_frequency(gaps, signal, (), floor=known)
    except BondGraphError:
        return None
