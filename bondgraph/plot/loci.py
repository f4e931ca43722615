"""Plots of eigenvalues along a parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy

from ..units import from_si
from .style import INK, PALETTE, SHADE, dressed, in_own_unit, legend, line, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..stability import Locus

# So many curves can be told apart; of more, the least stable at the operating point are named.
MOST = 10
FURTHER = "#b4b9c1"


def root_locus(locus: Locus, *, ax: Axes | None = None) -> Axes:
    """Plot the eigenvalues of a locus in the upper half of the complex plane.

    Colour tells the parameter; crosses stand at the operating point, diamonds
    where a mode becomes stable or unstable.

    Parameters
    ----------
    locus : Locus
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import assess
    >>> ax = root_locus(assess(bicycle_brake.graph(), vary=["V0=0.25:1.5:50"]).loci[0])
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('growth rate [1/s]', 'frequency [Hz]')
    """
    from matplotlib.collections import LineCollection

    ax = dressed(ax)
    shown = in_own_unit(locus.values, locus.unit)
    low, high = _view(locus)
    for column in _upper(locus):
        points = numpy.column_stack([column.real, column.imag / (2 * numpy.pi)])
        pieces = numpy.stack([points[:-1], points[1:]], axis=1)
        lines = LineCollection(list(pieces), cmap="viridis", lw=2.2, capstyle="round")
        lines.set_array((shown[:-1] + shown[1:]) / 2)
        ax.add_collection(lines, autolim=False)
    bar = ax.figure.colorbar(lines, ax=ax, pad=0.02)
    bar.ax.tick_params(colors=INK, labelsize=9, length=3)
    bar.set_label(f"{locus.name} [{pretty(locus.unit or '1')}]", color=INK)
    bar.outline.set_visible(False)
    if bar.solids is not None:
        bar.solids.set(rasterized=False, edgecolor="face")
    _mark_locus(ax, locus)
    _shade_unstable(ax, low, high)
    ax.set_xlabel("growth rate [1/s]")
    ax.set_ylabel("frequency [Hz]")
    ax.set_ylim(-0.03 * _highest(locus), 1.12 * _highest(locus))
    return ax


def growth_rates(locus: Locus, *, ax: Axes | None = None) -> Axes:
    """Plot the growth rate of each mode over the parameter of a locus.

    Of more than ten modes, those that are least stable at the operating point have a colour and a
    name.

    Parameters
    ----------
    locus : Locus
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import assess
    >>> ax = growth_rates(assess(bicycle_brake.graph(), vary=["V0=0.25:1.5:50"]).loci[0])
    >>> ax.get_xlabel()
    'V0 [m/s]'
    """
    ax = dressed(ax)
    shown = in_own_unit(locus.values, locus.unit)
    low, high = _view(locus)
    columns = _upper(locus)
    at = int(numpy.nanargmin(numpy.abs(locus.values - locus.at)))
    told = sorted(range(len(columns)), key=lambda k: -numpy.nan_to_num(columns[k][at].real))[:MOST]
    for index, column in enumerate(columns):
        here = column[at]
        name = f"{abs(here.imag) / (2 * numpy.pi):.4g} Hz" if here.imag else "real"
        dress = line(index) if index in told else {"color": FURTHER, "lw": 0.8, "zorder": 1.5}
        ax.plot(shown, column.real, label=name if index in told else f"_{name}", **dress)
    for edge in locus.crossings:
        value = from_si(edge.value, locus.unit)
        ax.plot(value, 0, "D", ms=6, color=INK, mfc="white" if not edge.boundary else INK)
    ax.axvline(from_si(locus.at, locus.unit), color=INK, lw=0.8, ls=(0, (4, 3)))
    ax.axhspan(0, high, color=SHADE, lw=0, zorder=0)
    ax.axhline(0, color=INK, lw=0.8)
    ax.set_ylim(low, high)
    ends = sorted((shown[0], shown[-1], from_si(locus.at, locus.unit)))
    ax.set_xlim(ends[0], ends[-1])
    ax.set_xlabel(f"{locus.name} [{pretty(locus.unit or '1')}]")
    ax.set_ylabel("growth rate [1/s]")
    legend(ax)
    return ax


def _upper(locus: Locus) -> list[numpy.ndarray]:
    """Return the branches of a locus that lie in the upper half plane somewhere, or are real."""
    columns = []
    for column in locus.eigenvalues.T:
        if numpy.nansum(column.imag) >= 0 and not numpy.isnan(column).all():
            columns.append(numpy.where(column.imag < 0, numpy.nan, column))
    return columns


def _highest(locus: Locus) -> float:
    """Return the highest frequency of a locus, Hz; 1 where nothing oscillates."""
    return float(numpy.nanmax(locus.eigenvalues.imag, initial=0.0)) / (2 * numpy.pi) or 1.0


def _view(locus: Locus) -> tuple[float, float]:
    """Choose the range of growth rates to show: the edge, not the far ends."""
    index = int(numpy.nanargmin(numpy.abs(locus.values - locus.at)))
    real = locus.eigenvalues.real
    waves = numpy.where(numpy.abs(locus.eigenvalues.imag) > 0, real, numpy.nan)
    near = waves if numpy.isfinite(waves).any() else real
    here = near[index][numpy.isfinite(near[index])]
    reach = max(numpy.abs(here).max(initial=0.0), -min(float(numpy.nanmin(near)), 0.0))
    low = max(float(numpy.nanmin(real)), -2.0 * reach)
    high = min(float(numpy.nanmax(real)), 2.0 * reach)
    margin = 0.08 * (max(high, 0.0) - min(low, 0.0) or 1.0)
    return min(low, 0.0) - margin, max(high, 0.0) + margin


def _mark_locus(ax: Axes, locus: Locus) -> None:
    """Mark the operating point and the crossings of the imaginary axis."""
    index = int(numpy.nanargmin(numpy.abs(locus.values - locus.at)))
    here = [column[index] for column in _upper(locus)]
    ax.plot(
        [point.real for point in here],
        [point.imag / (2 * numpy.pi) for point in here],
        "x",
        ms=7,
        mew=1.8,
        color=PALETTE[1],
        ls="none",
        label="operating point",
        zorder=4,
    )
    for edge in locus.crossings:
        ax.plot(0, edge.frequency_hz, "D", ms=6, color=INK, mfc=INK if edge.boundary else "white")
        if edge.boundary:
            value = from_si(edge.value, locus.unit)
            words = "Hopf" if edge.kind == "hopf" else "fold"
            ax.annotate(
                f"{words}: {locus.name} = {value:.4g}{' ' + pretty(locus.unit) if locus.unit else ''}",
                (0, edge.frequency_hz),
                xytext=(7, -13),
                textcoords="offset points",
                fontsize=9,
                color=INK,
            )
    ax.legend(frameon=False, fontsize=9, labelcolor=INK, loc="upper right")


def _shade_unstable(ax: Axes, low: float, high: float) -> None:
    ax.axvspan(0, high, color=SHADE, lw=0, zorder=0)
    ax.axvline(0, color=INK, lw=0.8)
    ax.set_xlim(low, high)
