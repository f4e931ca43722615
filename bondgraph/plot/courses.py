"""Plots of a recording beside a model before and after something was added to it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy

from .envelope import Envelope, envelope
from .gaps import BLUE, FAINT, RED, key_above
from .style import INK, dressed, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..discrepancy import FrequencyGaps
    from ..discrepancy.discovery import Course, Gap, LearnedLaw

DOTS = 160  # more samples than this are a line
LINES = 45  # of a spectrum that are told apart, by a factor of e in frequency
MOST_POINTS = 700  # of a cloud: more only make it heavier
_BEFORE: dict[str, Any] = {"color": RED, "ls": "--", "lw": 1.3}
_AFTER: dict[str, Any] = {"color": BLUE, "ls": "-", "lw": 1.3}


def course_plot(
    course: Course,
    signal: str,
    span: tuple[float, float] | None = None,
    *,
    changed: bool = True,
    ax: Axes | None = None,
) -> Axes:
    """Plot what was measured beside the model before and after.

    Parameters
    ----------
    course : Course
    signal : str
    span : (float, float), optional
        Times to show, s; all unless given. Long records are drawn as envelopes.
    changed : bool
        Whether there is an ``after`` that differs.
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy.discovery import Course
    >>> t = numpy.linspace(0, 1, 51)
    >>> run = Course("run", t, {"v": t}, {"v": t**2}, {"v": t}, {"v": 0.1}, {"v": "m/s"})
    >>> [line.get_label() for line in course_plot(run, "v").lines]
    ['measured', 'before', 'after']
    """
    ax = dressed(ax)
    t, rows = within(course.t, span)
    measured = envelope(t, course.measured[signal][rows])
    if not measured.whole:
        ax.fill_between(
            measured.t, measured.low, measured.high, color=FAINT, lw=0.8, label="measured"
        )
    elif len(t) <= DOTS:
        ax.plot(t, measured.low, "o", ms=3, color="#7d848e", ls="", label="measured")
    else:
        ax.plot(t, measured.low, color=FAINT, lw=3.2, solid_capstyle="round", label="measured")
    _outline(ax, envelope(t, course.before[signal][rows]), "before", _BEFORE)
    if changed:
        _outline(ax, envelope(t, course.after[signal][rows]), "after", _AFTER)
    return _over_time(ax, f"{signal} [{pretty(course.units.get(signal) or '1')}]")


def gap_course(
    course: Course, signal: str, *, changed: bool = True, ax: Axes | None = None
) -> Axes:
    """Plot measured less model before and after, with the band that noise would fill.

    Parameters
    ----------
    course : Course
    signal : str
    changed : bool
        Whether there is an ``after`` that differs.
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy.discovery import Course
    >>> t = numpy.linspace(0, 1, 51)
    >>> run = Course("run", t, {"v": t}, {"v": t**2}, {"v": t}, {"v": 0.1}, {"v": "m/s"})
    >>> gap_course(run, "v").get_ylabel()
    'measured less model, v [m/s]'
    """
    ax = dressed(ax)
    t, measured = course.t, course.measured[signal]
    before = envelope(t, measured - course.before[signal])
    noise = _reach(len(t) / len(before.t)) * course.noise.get(signal, numpy.nan)
    if numpy.isfinite(noise) and noise > 0:
        ax.axhspan(-noise, noise, color=FAINT, alpha=0.5, lw=0, label="noise")
    _outline(ax, before, "before", _BEFORE)
    if changed:
        _outline(ax, envelope(t, measured - course.after[signal]), "after", _AFTER)
    unit = pretty(course.units.get(signal) or "1")
    return _over_time(ax, f"measured less model, {signal} [{unit}]")


def _reach(count: float) -> float:
    """Return how many standard deviations the largest of so many samples of noise is about."""
    from scipy.stats import norm

    return max(2.0, float(norm.isf(0.5 / count)))


def within(t: Any, span: tuple[float, float] | None) -> tuple[numpy.ndarray, Any]:
    """Return the times of a span, and where they stand."""
    if span is None:
        return t, slice(None)
    rows = slice(*numpy.searchsorted(t, span))
    return t[rows], rows


def _outline(ax: Axes, found: Envelope, label: str, style: dict[str, Any]) -> None:
    """Draw a curve; of an envelope its upper and lower edge."""
    if not numpy.isfinite(found.low).any():
        return
    if not found.whole:  # dashes of two near edges would blot
        style = {**style, "ls": "-", "lw": 0.7 if style["ls"] == "--" else 1.1}
        ax.plot(found.t, found.high, label=f"_{label}", **style)
    ax.plot(found.t, found.low, label=label, **style)


def _over_time(ax: Axes, label: str) -> Axes:
    ax.set_xlabel("time [s]")
    ax.set_ylabel(label)
    ax.margins(x=0.01)
    key_above(ax)
    return ax


def gap_spectra(
    before: FrequencyGaps | None, after: FrequencyGaps | None, *, ax: Axes | None = None
) -> Axes:
    """Plot spectra of a gap before and after, with the floor and the signal itself.

    Parameters
    ----------
    before, after : FrequencyGaps or None
        Of one signal; None where there is none.
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy import Residuals, by_frequency
    >>> t = numpy.arange(4000) / 1000
    >>> y = numpy.random.default_rng(0).normal(size=4000)
    >>> found = by_frequency(Residuals(t, {"v": y}, {"v": 0 * t}), "v", floor=1.0)
    >>> [line.get_label() for line in gap_spectra(found, None).lines]
    ['measured', 'before', 'noise floor']
    """
    ax = dressed(ax)
    shown = [found for found in (before, after) if found is not None]
    for found in shown[:1]:
        _density(ax, found.measured, "measured", {"color": "#9aa1ab", "ls": ":", "lw": 1.2})
    if before is not None:
        _density(ax, before.gap, "before", _BEFORE)
    if after is not None:
        _density(ax, after.gap, "after", _AFTER)
    for found in shown[:1]:
        if found.floor_density > 0:
            ax.axhline(found.floor_density, color=INK, lw=1.0, ls="-.", label="noise floor")
        ax.set_ylabel(f"density of {found.signal} [{pretty(f'({found.unit or 1})^2/Hz')}]")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("frequency [Hz]")
    ax.margins(x=0.01)
    key_above(ax)
    return ax


def _density(ax: Axes, found: Any, label: str, style: dict[str, Any]) -> None:
    """Draw a spectrum; lines nearer together than the eye can tell are one, their mean."""
    frequency, density = found.frequency[1:], found.density[1:]
    if not len(frequency):
        return
    place = numpy.floor(LINES * numpy.log(frequency / frequency[0]))
    starts = numpy.flatnonzero(numpy.diff(place, prepend=-1.0))
    counts = numpy.diff(starts, append=len(place))
    means = [numpy.add.reduceat(column, starts) / counts for column in (frequency, density)]
    ax.plot(*means, label=label, **style)


def learned_law(law: LearnedLaw, *, ax: Axes | None = None) -> Axes:
    """Plot a law over the data that say so, with two standard deviations about it.

    Parameters
    ----------
    law : LearnedLaw
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy.discovery import LearnedLaw
    >>> x = numpy.linspace(-1, 1, 21)
    >>> dots = numpy.column_stack([x, x])
    >>> law = LearnedLaw("drag at v", "flow of v", "effort", ("m/s", "N"), x, x, 0 * x + 0.1, dots)
    >>> learned_law(law).get_xlabel()
    'flow of v [m/s]'
    """
    ax = dressed(ax)
    ax.axhline(0, color=INK, lw=0.6)
    points = numpy.asarray(law.points, dtype=float).reshape(-1, 2)
    points = points[numpy.isfinite(points).all(axis=1)]
    points = points[:: max(-(-len(points) // MOST_POINTS), 1)]
    if len(points):
        style: dict[str, Any] = {"ms": 2.6, "color": "#7d848e", "ls": "", "alpha": 0.55}
        ax.plot(points[:, 0], points[:, 1], "o", mew=0, label="data alone", **style)
    if len(law.x):
        low, high = law.y - 2 * law.std, law.y + 2 * law.std
        known = numpy.isfinite(low) & numpy.isfinite(high)
        band: dict[str, Any] = {"color": BLUE, "alpha": 0.25, "lw": 0, "where": known}
        ax.fill_between(law.x, low, high, label="two std", **band)
        ax.plot(law.x, law.y, color=BLUE, lw=1.8, label="law")
    ax.set_xlabel(f"{law.across} [{pretty(law.units[0] or '1')}]")
    ax.set_ylabel(f"{law.along} [{pretty(law.units[1] or '1')}]")
    key_above(ax)
    return ax


def gap_shares(gaps: Mapping[str, Gap], *, changed: bool = True, ax: Axes | None = None) -> Axes:
    """Plot the gap of each signal as so many times its noise floor, before and after.

    Parameters
    ----------
    gaps : mapping of str to Gap
    changed : bool
        Whether there is an ``after`` that differs.
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy.discovery import Gap
    >>> ax = gap_shares({"v": Gap(0.9, 0.5, 0.11, 0.1)})
    >>> ax.get_xlabel()
    'gap over its noise floor [1]'
    """
    ax = dressed(ax)
    names = list(gaps)
    rows = numpy.arange(len(names))
    before, after, nominal = (
        numpy.array([_over_floor(getattr(gap, kind), gap.noise_floor) for gap in gaps.values()])
        for kind in ("before", "after", "nominal")
    )
    if changed:
        ax.hlines(rows, after, before, color=FAINT, lw=3)
    dots: list[tuple[numpy.ndarray, str, dict[str, Any]]] = [
        (nominal, "as given", {"marker": "d", "color": INK, "mfc": "white"}),
        (before, "before", {"marker": "s", "color": RED}),
        (after, "after", {"marker": "o", "color": BLUE}),
    ]
    for values, label, style in dots if changed else dots[:2]:
        if numpy.isfinite(values).any():
            ax.plot(values, rows, ls="", ms=6, label=label, **style)
    ax.axvline(1.0, color=INK, lw=1.0, ls="-.", label="noise floor")
    _times_floor(ax, numpy.concatenate([before, after, nominal]))
    ax.set_yticks(rows, names)
    ax.set_ylim(len(names) - 0.5, -0.5)
    ax.grid(False, axis="y")
    ax.set_xlabel("gap over its noise floor [1]")
    key_above(ax)
    return ax


def _times_floor(ax: Axes, values: numpy.ndarray) -> None:
    """Give a logarithmic axis numbers that are read at a glance."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    fine = values[numpy.isfinite(values)]
    low, high = min([0.9, *fine]) / 1.15, max([3.0, *fine]) * 1.3
    steps = (1, 2, 5) if high / low < 200 else (1,)
    powers = range(int(numpy.floor(numpy.log10(low))), int(numpy.log10(high)) + 1)
    marks = [step * 10.0**power for power in powers for step in steps]
    ax.set_xscale("log")
    ax.set_xlim(low, high)
    ax.xaxis.set_major_locator(FixedLocator([mark for mark in marks if low <= mark <= high]))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _over_floor(value: float, floor: float) -> float:
    fine = numpy.isfinite(value) and numpy.isfinite(floor) and floor > 0 and value > 0
    return value / floor if fine else float("nan")
