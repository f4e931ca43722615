"""Plots of eigenvalue maps: where a steady state is stable, and how fast it oscillates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from ..units import from_si
from .boundaries import draw_between, draw_followed
from .style import INK, dressed, in_own_unit, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..stability import Boundary, EigenvalueMap

GAP, HATCH = "#c3c7cd", "#2b2f3670"
# Decaying is blue, growing orange, as in the verdict; half of the points on a side end its scale,
# so that a few fast modes do not bleach all others.
DECAY, GROWTH, MIDDLE = "#0072B2", "#D55E00", "#f7f7f5"
# As in the modal table: smaller real parts beside the fastest eigenvalue are rounding.
NEUTRAL = 1e-13
# Frequencies whose spread is less than this share of them are alike.
ALIKE = 0.01


def stability_map(
    found: EigenvalueMap,
    *,
    at: Mapping[str, float] | None = None,
    boundaries: Iterable[Boundary] = (),
    ax: Axes | None = None,
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
    boundaries : iterable of Boundary
        Edges followed over these two parameters; where there is none beside it, the edge is drawn
        as it runs between the points.
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
    ratio = _grid(found, least_damping(found))
    frequency = _grid(found, found.frequency_hz)
    label = "frequency of the leading mode [Hz]"
    _coloured(ax, scales, frequency, label, "viridis", _span(frequency))
    growing = bool((ratio[numpy.isfinite(ratio)] <= 0).any())
    if growing:
        hatched = ax.contourf(*scales, ratio, levels=[-2, 0], colors="none", hatches=["////"])
        hatched.set(edgecolor=HATCH, linewidth=0.0)
    _finish(ax, found, scales, at, list(boundaries), hatched=growing)
    return ax


def damping_map(
    found: EigenvalueMap,
    *,
    at: Mapping[str, float] | None = None,
    boundaries: Iterable[Boundary] = (),
    ax: Axes | None = None,
) -> Axes:
    """Plot the least damping ratio of all modes, over two axes of a map.

    It is what decides in a verdict: positive where all modes decay, 1 where none of them swings,
    zero on the edge of stability, and -1 where a mode runs away without swinging.

    Parameters
    ----------
    found : EigenvalueMap
        Of a product of two axes.
    at : mapping of str to float, optional
        Where a cross stands, by the names of the axes, SI; not drawn beyond them.
    boundaries : iterable of Boundary
        Edges followed over these two parameters; where there is none beside it, the edge is drawn
        as it runs between the points.
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
    >>> ax = damping_map(eigenvalue_map(mass_on_belt.graph(), axes, product=True))
    >>> ax.figure.axes[1].get_ylabel()
    'least damping ratio [%]'
    """
    from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm

    ax, scales = _plane(found, ax)
    ratio = 100 * _grid(found, least_damping(found))
    known = ratio[numpy.isfinite(ratio)]
    low, high = (
        float(f"{numpy.median(side):.2g}") if side.size else 0.0
        for side in (-known[known < 0], known[known > 0])
    )
    # without points on a side its colours are still there, and the middle is zero
    low, high = low or high or 1.0, high or low or 1.0
    colours = LinearSegmentedColormap.from_list("damping", [GROWTH, MIDDLE, DECAY])
    _coloured(ax, scales, ratio, "least damping ratio [%]", colours, TwoSlopeNorm(0.0, -low, high))
    _finish(ax, found, scales, at, list(boundaries))
    return ax


def least_damping(found: EigenvalueMap) -> numpy.ndarray:
    """Return the least damping ratio of all modes at each point, shape (np,).

    Parameters
    ----------
    found : EigenvalueMap

    Returns
    -------
    (np,) array
        nan where there is no result; zero where an eigenvalue is.

    Examples
    --------
    >>> from bondgraph.models import quarter_car
    >>> from bondgraph.stability import eigenvalue_map
    >>> found = eigenvalue_map(quarter_car.graph(), {"b_s": numpy.array([1200.0])})
    >>> least_damping(found).round(3).tolist()
    [0.21]
    """
    poles, ok = found.eigenvalues, found.ok
    least = numpy.full(len(found), numpy.nan)
    if poles.shape[1]:
        size = numpy.abs(poles)
        ratios = numpy.where(size > 0, -poles.real / numpy.where(size > 0, size, 1.0), 0.0)
        # what is nothing but rounding beside the fastest mode neither grows nor decays
        scale = numpy.nanmax(numpy.where(ok[:, None], size, 0.0), axis=1, keepdims=True)
        ratios = numpy.where(numpy.abs(poles.real) <= NEUTRAL * scale, 0.0, ratios)
        least[ok] = numpy.nanmin(ratios[ok], axis=1)
    return least


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


def _span(values: numpy.ndarray) -> Any:
    """Return the scale of frequencies; what hardly differs gets one colour, not a rainbow."""
    from matplotlib.colors import Normalize

    known = values[numpy.isfinite(values)]
    if not known.size:
        return None
    low, high = float(known.min()), float(known.max())
    least = ALIKE * abs(high) - (high - low)
    return Normalize(low - max(least, 0) / 2, high + max(least, 0) / 2)


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
    from matplotlib.colors import TwoSlopeNorm

    field = _cells(ax, scales, values, colours, norm)
    two = isinstance(norm, TwoSlopeNorm)
    bar = ax.figure.colorbar(field, ax=ax, pad=0.02, extend="both" if two else "neither")
    bar.set_label(label, color=INK)
    bar.ax.tick_params(colors=INK, labelsize=9, length=3)
    bar.outline.set_visible(False)
    if two:  # each side of zero has a scale of its own
        ends = (norm.vmin, norm.vmin / 2, 0.0, norm.vmax / 2, norm.vmax)
        bar.set_ticks(ends, labels=[_short(end) for end in ends])
        bar.minorticks_off()
    else:
        bar.ax.ticklabel_format(axis="y", useOffset=False)


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
    boundaries: list[Boundary],
    hatched: bool = False,
) -> None:
    """Draw what both kinds of maps have: gaps, boundary, operating point, labels, key."""
    from matplotlib.colors import ListedColormap

    ratio = _grid(found, least_damping(found))
    known = numpy.isfinite(ratio)
    if not known.all():
        _cells(ax, scales, numpy.where(known, numpy.nan, 1.0), ListedColormap([GAP]))
    lines = draw_followed(ax, found, boundaries)
    if (ratio[known] > 0).any() and (ratio[known] < 0).any():
        lines = {**draw_between(ax, scales, ratio), **lines}
    labels = [f"{name} [{pretty(unit or '1')}]" for name, unit in found.units.items()]
    ax.set(xlabel=labels[0], ylabel=labels[1])
    # the outer half cells are cut off, and what stands alone still has the map's frame
    ax.set_xlim(scales[0].min(), scales[0].max())
    ax.set_ylim(scales[1].min(), scales[1].max())
    crossed = at is not None and _cross(ax, found, scales, at)
    _key(ax, lines, hatched=hatched, cross=crossed, gaps=not known.all())


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


def _key(
    ax: Axes, lines: Mapping[str, dict[str, Any]], *, hatched: bool, cross: bool, gaps: bool
) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    mark: dict[str, Any] = {"color": INK, "marker": "x", "ls": "none", "ms": 8, "mew": 2.0}
    kinds = (
        (hatched, Patch(facecolor="none", edgecolor=HATCH, lw=0, hatch="////", label="unstable")),
        *((True, Line2D([], [], label=kind, **dress)) for kind, dress in lines.items()),
        (cross, Line2D([], [], label="operating point", **mark)),
        (gaps, Patch(facecolor=GAP, label="no result")),
    )
    handles: list[Any] = [handle for shown, handle in kinds if shown]
    if not handles:
        return
    ax.legend(
        handles=handles,
        ncols=min(len(handles), 3),
        loc="lower left",
        bbox_to_anchor=(-0.02, 1.0),
        frameon=False,
        fontsize=9,
        labelcolor=INK,
        columnspacing=0.9,
        handlelength=1.3,
    )
