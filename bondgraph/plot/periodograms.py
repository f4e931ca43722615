"""Plots of periodograms: whiteness, and two windows of a recording side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy

from .gaps import BLUE, FAINT, RED, key_above
from .style import INK, dressed, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..discrepancy import Whiteness, WindowComparison

MARKS = {
    "appears": "^",
    "grows": "P",
    "stays": "o",
    "shrinks": "v",
    "vanishes": "x",
    "drowned": "s",
    "unsure": "d",
}


def whiteness_plot(found: Whiteness, *, ax: Axes | None = None) -> Axes:
    """Plot a cumulative periodogram with the band that a white series stays in.

    Parameters
    ----------
    found : Whiteness
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy import whiteness
    >>> ax = whiteness_plot(whiteness(numpy.random.default_rng(0).normal(size=500)))
    >>> ax.get_ylabel()
    'share of the power below [1]'
    """
    from scipy.stats import kstwo

    ax = dressed(ax)
    top = found.frequency[-1]
    half = float(kstwo.isf(0.05, max(len(found.frequency) - 1, 1)))
    line = found.frequency / top
    ax.fill_between(
        found.frequency,
        numpy.clip(line - half, 0, 1),
        numpy.clip(line + half, 0, 1),
        color=FAINT,
        alpha=0.6,
        lw=0,
        label="white, 95 %",
    )
    ax.plot(found.frequency, found.cumulative, color=RED, lw=1.6, label="series")
    ax.set_xlabel("frequency [Hz]")
    ax.set_ylabel("share of the power below [1]")
    ax.margins(x=0)
    key_above(ax)
    return ax


def window_comparison(found: WindowComparison, *, unit: str = "", ax: Axes | None = None) -> Axes:
    """Plot the spectra of two windows, with a mark for each peak that says how it changed.

    Parameters
    ----------
    found : WindowComparison
    unit : str
        Of the signal.
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy import Measurement, compare_windows
    >>> t = numpy.arange(8000) / 1000
    >>> y = numpy.random.default_rng(2).normal(size=8000)
    >>> run = Measurement(t, {"a": y})
    >>> ax = window_comparison(compare_windows(run, "a", (0, 4), (4, 7.9)), unit="m/s^2")
    >>> ax.get_ylabel()
    'density of a [(m/s²)²/Hz]'
    """
    ax = dressed(ax)
    curves: tuple[tuple[Any, tuple[float, float], dict[str, Any]], ...] = (
        (found.before, found.spans[0], {"color": BLUE, "ls": "--", "lw": 1.1}),
        (found.during, found.spans[1], {"color": RED, "ls": "-", "lw": 1.3}),
    )
    for part, span, style in curves:
        label = f"{span[0]:.3g} to {span[1]:.3g} s"
        ax.semilogy(part.frequency[1:], part.density[1:], label=label, **style)
    for kind, mark in MARKS.items():
        peaks = found.of(kind)
        if peaks:
            at = [peak.frequency_hz for peak in peaks]
            high = [1.6 * max(peak.before, peak.during) for peak in peaks]
            ax.plot(at, high, mark, color=INK, ms=5, ls="", label=kind)
    ax.set_xlabel("frequency [Hz]")
    ax.set_ylabel(f"density of {found.signal} [{pretty(f'({unit or 1})^2/Hz')}]")
    ax.margins(x=0)
    key_above(ax)
    return ax
