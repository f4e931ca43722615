"""Plots of where model and recording disagree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from .style import GRID, INK, PALETTE, dressed, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..discrepancy import (
        FrequencyGaps,
        RegionGaps,
        SignalGaps,
        WindowGaps,
    )

FAINT = "#c3c7cd"
BLUE, RED, GREEN = PALETTE[:3]


def signal_gaps(found: SignalGaps, *, ax: Axes | None = None) -> Axes:
    """Plot the gap of each signal, split into noise floor and what lies above it.

    Parameters
    ----------
    found : SignalGaps
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy import Residuals, by_signal
    >>> t = numpy.linspace(0, 1, 101)
    >>> ax = signal_gaps(by_signal(Residuals(t, {"v": t + 0.3}, {"v": t}), floor=0.1))
    >>> ax.get_xlabel()
    'mean square of the gap / variance of the signal [1]'
    """
    ax = dressed(ax)
    names = [row.signal for row in found]
    square = numpy.array([row.nrmse**2 for row in found])
    over = numpy.array([row.above for row in found]) * square
    ax.barh(names, over, color=RED, height=0.6, label="above the floor")
    ax.barh(
        names,
        square - over,
        left=over,
        color="white",
        edgecolor=BLUE,
        hatch="////",
        height=0.6,
        label="noise floor",
    )
    ax.invert_yaxis()
    ax.grid(False, axis="y")
    ax.set_xlabel("mean square of the gap / variance of the signal [1]")
    key_above(ax)
    return ax


def window_gaps(found: WindowGaps, *, ax: Axes | None = None) -> Axes:
    """Plot the gap in windows of time; windows above the floor are filled, the onset is marked.

    Parameters
    ----------
    found : WindowGaps
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy import Residuals, by_window
    >>> t = numpy.linspace(0, 1, 101)
    >>> ax = window_gaps(by_window(Residuals(t, {"v": t + 0.3}, {"v": t}), "v", floor=0.1))
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('time [s]', 'rmse of v [1]')
    """
    ax = dressed(ax)
    wide = found.edges[:, 1] - found.edges[:, 0]
    styles: tuple[tuple[numpy.ndarray, dict[str, Any]], ...] = (
        (found.significant, {"color": RED, "label": "above the floor"}),
        (
            ~found.significant,
            {"color": "white", "edgecolor": BLUE, "hatch": "////", "label": "as the floor"},
        ),
    )
    for chosen, style in styles:
        if chosen.any():
            ax.bar(
                found.edges[chosen, 0],
                found.rmse[chosen],
                wide[chosen] * 0.94,
                align="edge",
                **style,
            )
    ax.axhline(found.floor.sigma, color=INK, ls="--", lw=1.2, label="noise floor")
    if found.onset is not None:
        ax.axvline(found.onset, color=INK, ls=":", lw=1.6, label=f"onset, {found.onset:.4g} s")
    ax.set_xlabel("time [s]")
    ax.set_ylabel(f"rmse of {found.signal} [{pretty(found.unit or '1')}]")
    key_above(ax)
    return ax


def frequency_gaps(found: FrequencyGaps, *, ax: Axes | None = None) -> Axes:
    """Plot spectra of a gap and of its signal, with the floor and the bands above it.

    Parameters
    ----------
    found : FrequencyGaps
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy import Residuals, by_frequency
    >>> t = numpy.arange(4000) / 1000
    >>> y = numpy.random.default_rng(0).normal(size=4000)
    >>> ax = frequency_gaps(by_frequency(Residuals(t, {"v": y}, {"v": 0 * t}), "v", floor=1.0))
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('frequency [Hz]', 'density [(1)²/Hz]')
    """
    ax = dressed(ax)
    for band in found.bands:
        ax.axvspan(band.low, band.high, color="#fbe9e2", lw=0, zorder=0)
    lines = slice(1, None)
    ax.semilogy(
        found.measured.frequency[lines],
        found.measured.density[lines],
        color=BLUE,
        ls="--",
        lw=1.2,
        label=f"{found.signal}, measured",
    )
    ax.semilogy(
        found.gap.frequency[lines], found.gap.density[lines], color=RED, lw=1.4, label="gap"
    )
    if found.floor_density > 0:
        ax.axhline(found.floor_density, color=INK, lw=1.0, ls=":", label="floor")
        ax.axhline(found.limit, color=INK, lw=1.0, ls="-.", label=f"limit, {100 * found.alpha:g} %")
    ax.set_xlabel("frequency [Hz]")
    unit = pretty(f"({found.unit or '1'})^2/Hz")
    ax.set_ylabel(f"density [{unit}]")
    ax.margins(x=0)
    key_above(ax)
    return ax


def coherence_plot(found: FrequencyGaps, *, ax: Axes | None = None) -> Axes:
    """Plot the coherence of a gap with its causes; partial where there are several.

    Parameters
    ----------
    found : FrequencyGaps
    ax : Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        Where no cause was tried.

    Examples
    --------
    >>> from bondgraph.discrepancy import Residuals, by_frequency
    >>> t = numpy.arange(4000) / 1000
    >>> y = numpy.random.default_rng(0).normal(size=4000)
    >>> found = Residuals(t, {"v": y}, {"v": 0 * t}, {}, {"u": y})
    >>> coherence_plot(by_frequency(found, "v", floor=1.0)).get_ylabel()
    'coherence with the gap of v [1]'
    """
    if found.coherence is None:
        raise BondGraphError(f"no cause was tried for {found.signal}; give by_frequency causes=")
    ax = dressed(ax)
    linked = found.coherence
    several = len(linked.ordinary) > 1
    shown = linked.partial if several else linked.ordinary
    for k, (name, values) in enumerate(shown.items()):
        style: dict[str, Any] = {
            "color": PALETTE[k % 6],
            "ls": ("-", "--", "-.", ":")[k % 4],
            "lw": 1.3,
        }
        ax.plot(linked.frequency, values, label=name, **style)
    limit = linked.limit_partial if several else linked.limit
    ax.axhline(limit, color=INK, lw=1.0, ls=":", label=f"limit, {100 * linked.alpha:g} %")
    ax.set_ylim(0, 1.02)
    ax.set_xlabel("frequency [Hz]")
    word = "partial coherence" if several else "coherence"
    ax.set_ylabel(f"{word} with the gap of {found.signal} [1]")
    ax.margins(x=0)
    key_above(ax)
    return ax


def region_gaps(found: RegionGaps, *, ax: Axes | None = None) -> Axes:
    """Plot a gap over one or two signals; bins that are too empty are grey or hatched.

    Parameters
    ----------
    found : RegionGaps
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.discrepancy import Residuals, by_region
    >>> t = numpy.linspace(0, 1, 1001)
    >>> found = Residuals(t, {"v": t + t**2}, {"v": t}, {"v": "m/s"})
    >>> region_gaps(by_region(found, "v", "v", floor=0.1, permutations=9)).get_xlabel()
    'v [m/s]'
    """
    ax = dressed(ax)
    unit = pretty(found.unit or "1")
    labels = [
        f"{name} [{pretty(own or '1')}]"
        for name, own in zip(found.over, found.over_units, strict=True)
    ]
    if len(labels) == 2:
        return _cells(ax, found, labels, unit)
    middle = (found.edges[0][1:] + found.edges[0][:-1]) / 2
    half = numpy.diff(found.edges[0]) / 2
    ax.axhline(0.0, color=INK, lw=0.8)
    for chosen, colour, word in ((~found.thin, BLUE, "mean, 95 %"), (found.thin, FAINT, "few")):
        chosen = chosen & (found.count > 0)
        if not chosen.any():
            continue
        low, tall = (found.mean - found.spread)[chosen], 2 * found.spread[chosen]
        ax.bar(middle[chosen], tall, 1.88 * half[chosen], low, color=GRID, alpha=0.6)
        ax.errorbar(
            middle[chosen],
            found.mean[chosen],
            found.band[chosen],
            fmt="o",
            ms=4,
            color=colour,
            capsize=3,
            label=word,
        )
    for x, count in zip(middle, found.count, strict=True):
        ax.annotate(
            f"{count}",
            (x, 0.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            fontsize=7,
            color=INK,
        )
    ax.margins(y=0.12)
    ax.set_xlabel(labels[0])
    ax.set_ylabel(f"{_what(found)} [{unit}]")
    ax.set_title(_tests(found), fontsize=9, color=INK, loc="right")
    key_above(ax)
    return ax


def _cells(ax: Axes, found: RegionGaps, labels: list[str], unit: str) -> Axes:
    """Draw a map: colour where enough samples are, grey where few, nothing where none."""
    from matplotlib.colors import ListedColormap

    ax.grid(False)
    good = numpy.ma.masked_where(found.thin | (found.count == 0), found.mean)
    most = float(numpy.abs(good).max()) if good.count() else 1.0
    mesh = ax.pcolormesh(*found.edges, good.T, cmap="PuOr", vmin=-most, vmax=most)
    few = numpy.ma.masked_where(~found.thin | (found.count == 0), found.count * 0.0)
    ax.pcolormesh(*found.edges, few.T, cmap=ListedColormap([FAINT]))
    bar = ax.figure.colorbar(mesh, ax=ax, pad=0.02)
    bar.set_label(f"mean of the {_what(found)} [{unit}]", color=INK)
    bar.outline.set_visible(False)
    ax.set_xlabel(labels[0])
    ax.set_ylabel(labels[1])
    ax.set_title(_tests(found), fontsize=9, color=INK, loc="right")
    return ax


def _what(found: RegionGaps) -> str:
    """Name what was binned: the gap, or other values in its place."""
    return f"gap of {found.signal}" if found.floor is not None else f"values for {found.signal}"


def _tests(found: RegionGaps) -> str:
    mean, power = found.of_mean, found.of_power
    return (
        f"correlation ratio {mean.ratio:.2g}, p = {mean.p:.2g}; "
        f"of squares {power.ratio:.2g}, p = {power.p:.2g}"
    )


def key_above(ax: Axes) -> None:
    """Put the key above the axes, where it hides nothing.

    Parameters
    ----------
    ax : Axes
    """
    handles: list[Any]
    handles, labels = ax.get_legend_handles_labels()
    if handles:
        ax.legend(
            handles,
            labels,
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0 if not ax.get_title(loc="right") else 1.06),
            ncols=4,
            frameon=False,
            fontsize=8,
            labelcolor=INK,
            handlelength=1.6,
            columnspacing=1.0,
        )
