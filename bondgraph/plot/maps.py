"""Plots of eigenvalue maps: where a steady state is stable, and how fast it oscillates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from ..units import from_si
from .style import INK, dressed, in_own_unit, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..stability import EigenvalueMap

GAP, HATCH = "#c3c7cd", "#2b2f3670"
# Decaying is blue, growing orange, as in the verdict; half of the points on a side end its scale,
# so that a few fast modes do not bleach all others.
DECAY, GROWTH, MIDDLE = "#0072B2", "#D55E00", "#f7f7f5"
EDGE = "#1c2026"


def stability_map(
    found: EigenvalueMap, *, at: Mapping[str, float] | None = None, ax: Axes | None = None
) -> Axes:
    """Plot where a steady state is stable, over two axes of a map.

    Colour tells the frequency of the leading oscillatory mode, and is left out where nothing
    oscillates; the unstable region is hatched, and its boundary drawn. Points without a result
    are grey.

    Parameters
    ----------
    found : EigenvalueMap
        Of a product of two axes.
    at : mapping of str to float, optional
        Where a cross stands, by the names of the axes, SI; not drawn beyond them.
    ax : Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        For a map that has not two axes of at least two points.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import eigenvalue_map
    >>> axes = {"V0": numpy.linspace(0.3, 1.5, 20), "v_s": numpy.linspace(0.04, 0.3, 20)}
    >>> ax = stability_map(eigenvalue_map(bicycle_brake.graph(), axes, product=True))
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('V0 [m/s]', 'v_s [m/s]')
    """
    ax, scales = _plane(found, ax)
    growth = _grid(found, found.growth)
    _coloured(
        ax, scales, _grid(found, found.frequency_hz), "frequency of the leading mode [Hz]", "viridis"
    )
    if (growth[numpy.isfinite(growth)] >= 0).any():
        top = float(numpy.nanmax(growth)) + 1
        hatched = ax.contourf(*scales, growth, levels=[0, top], colors="none", hatches=["////"])
        hatched.set(edgecolor=HATCH, linewidth=0.0)
    _finish(ax, found, scales, at, hatched=True)
    return ax


def growth_map(
    found: EigenvalueMap, *, at: Mapping[str, float] | None = None, ax: Axes | None = None
) -> Axes:
    """Plot how fast the least stable mode grows or decays, over two axes of a map.

    Parameters
    ----------
    found : EigenvalueMap
        Of a product of two axes.
    at : mapping of str to float, optional
        Where a cross stands, by the names of the axes, SI; not drawn beyond them.
    ax : Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        For a map that has not two axes of at least two points.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import eigenvalue_map
    >>> axes = {"v_b": numpy.linspace(0.1, 0.5, 5), "v_s": numpy.linspace(0.05, 0.2, 5)}
    >>> ax = growth_map(eigenvalue_map(mass_on_belt.graph(), axes, product=True))
    >>> ax.figure.axes[1].get_ylabel()
    'growth rate [1/s]'
    """
    from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm

    ax, scales = _plane(found, ax)
    growth = _grid(found, found.growth)
    known = growth[numpy.isfinite(growth)]
    low, high = (
        float(f"{numpy.median(side):.2g}") if side.size else 0.0
        for side in (-known[known < 0], known[known > 0])
    )
    # without points on a side its colours are still there, and the middle is zero
    low, high = low or high or 1.0, high or low or 1.0
    colours = LinearSegmentedColormap.from_list("growth", [DECAY, MIDDLE, GROWTH])
    _coloured(ax, scales, growth, "growth rate [1/s]", colours, TwoSlopeNorm(0.0, -low, high))
    _finish(ax, found, scales, at)
    return ax


def _plane(found: EigenvalueMap, ax: Axes | None) -> tuple[Axes, list[numpy.ndarray]]:
    """Return dressed axes, and the two scales in their own units."""
    if len(found.shape) != 2 or min(found.shape) < 2:
        raise BondGraphError(
            f"a stability map is drawn over two axes of at least two points, this one has "
            f"{found.shape}; give eigenvalue_map two and product=True"
        )
    ax = dressed(ax)
    ax.grid(False)
    return ax, [in_own_unit(values, found.units[name]) for name, values in found.axes.items()]


def _grid(found: EigenvalueMap, values: numpy.ndarray) -> numpy.ndarray:
    """Return values as a plot wants them: rows upwards, columns across."""
    return found.on_grid(values).T


def _coloured(
    ax: Axes,
    scales: list[numpy.ndarray],
    values: numpy.ndarray,
    label: str,
    colours: Any,
    norm: Any = None,
) -> None:
    """Colour cells by their values, with a bar beside the axes, where there are values."""
    if not numpy.isfinite(values).any():
        return
    field = _cells(ax, scales, values, colours, norm)
    bar = ax.figure.colorbar(field, ax=ax, pad=0.02, extend="both" if norm is not None else None)
    bar.set_label(label, color=INK)
    bar.ax.tick_params(colors=INK, labelsize=9, length=3)
    bar.outline.set_visible(False)
    if norm is not None:  # each side of zero has a scale of its own
        ends = (norm.vmin, norm.vmin / 2, 0.0, norm.vmax / 2, norm.vmax)
        bar.set_ticks(ends, labels=[_short(end) for end in ends])
        bar.minorticks_off()


def _short(value: float) -> str:
    return f"{value:.0f}" if 100 <= abs(value) < 1e5 else f"{value:.3g}"


def _cells(
    ax: Axes, scales: list[numpy.ndarray], values: numpy.ndarray, colours: Any, norm: Any = None
) -> Any:
    # an image, not a path for each cell: a large map stays a small file
    return ax.pcolormesh(
        *scales, values, cmap=colours, norm=norm, shading="nearest", alpha=0.85, rasterized=True
    )


def _finish(
    ax: Axes,
    found: EigenvalueMap,
    scales: list[numpy.ndarray],
    at: Mapping[str, float] | None,
    hatched: bool = False,
) -> None:
    """Draw what both kinds of maps have: gaps, boundary, operating point, labels, key."""
    from matplotlib.colors import ListedColormap

    growth = _grid(found, found.growth)
    known = numpy.isfinite(growth)
    if not known.all():
        _cells(ax, scales, numpy.where(known, numpy.nan, 1.0), ListedColormap([GAP]))
    line = bool((growth[known] > 0).any() and (growth[known] < 0).any())
    if line:
        ax.contour(*scales, growth, levels=[0.0], colors=[EDGE], linewidths=[2.0])
    for set_label, (name, unit) in zip(
        (ax.set_xlabel, ax.set_ylabel), found.units.items(), strict=True
    ):
        set_label(f"{name} [{pretty(unit or '1')}]")
    crossed = at is not None and _cross(ax, found, scales, at)
    _key(ax, hatched=hatched, line=line, cross=crossed, gaps=not known.all())


def _cross(
    ax: Axes, found: EigenvalueMap, scales: list[numpy.ndarray], at: Mapping[str, float]
) -> bool:
    """Mark a point, and say whether it lies within the axes."""
    x, y = (from_si(float(at[name]), found.units[name]) for name in found.axes)
    if not all(min(scale) <= v <= max(scale) for scale, v in zip(scales, (x, y), strict=True)):
        return False
    for width, colour in ((4.0, "white"), (2.0, INK)):
        ax.plot(x, y, "x", ms=9, mew=width, color=colour, label="_operating point", zorder=5)
    return True


def _key(ax: Axes, *, hatched: bool, line: bool, cross: bool, gaps: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    mark = {"color": INK, "marker": "x", "ls": "none", "ms": 8, "mew": 2.0}
    kinds = (
        (hatched, Patch(facecolor="none", edgecolor=HATCH, lw=0, hatch="////", label="unstable")),
        (line, Line2D([], [], color=EDGE, lw=2.0, label="boundary")),
        (cross, Line2D([], [], label="operating point", **mark)),
        (gaps, Patch(facecolor=GAP, label="no result")),
    )
    handles: list[Any] = [handle for shown, handle in kinds if shown]
    if not handles:
        return
    ax.legend(
        handles=handles,
        ncols=len(handles),
        loc="lower left",
        bbox_to_anchor=(-0.02, 1.0),
        frameon=False,
        fontsize=9,
        labelcolor=INK,
        columnspacing=1.2,
        handlelength=1.6,
    )
