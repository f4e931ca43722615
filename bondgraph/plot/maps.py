"""Plots of eigenvalue maps: where a steady state is stable, and how fast it oscillates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from .style import INK, PALETTE, dressed, in_own_unit, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..stability import EigenvalueMap

GAP, HATCH = "#c3c7cd", "#2b2f3670"


def stability_map(found: EigenvalueMap, *, ax: Axes | None = None) -> Axes:
    """Plot where a steady state is stable, over two axes of a map.

    Colour tells the frequency of the leading oscillatory mode, and is left out where nothing
    oscillates; the unstable region is hatched, and its boundary drawn. Points without a result
    are grey.

    Parameters
    ----------
    found : EigenvalueMap
        Of a product of two axes.
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
    if len(found.shape) != 2 or min(found.shape) < 2:
        raise BondGraphError(
            f"a stability map is drawn over two axes of at least two points, this one has "
            f"{found.shape}; give eigenvalue_map two and product=True"
        )
    ax = dressed(ax)
    ax.grid(False)
    names = list(found.axes)
    at = [in_own_unit(found.axes[name], found.units[name]) for name in names]
    growth = found.on_grid(found.growth).T
    known = numpy.isfinite(growth)
    _frequencies(ax, at, found.on_grid(found.frequency_hz).T)
    if not known.all():
        _cells(ax, at, numpy.where(known, numpy.nan, 1.0), [GAP])
    if (growth[known] >= 0).any():
        top = float(numpy.nanmax(growth)) + 1
        hatched = ax.contourf(*at, growth, levels=[0, top], colors="none", hatches=["////"])
        hatched.set(edgecolor=HATCH, linewidth=0.0)
    if (growth[known] > 0).any() and (growth[known] < 0).any():
        ax.contour(*at, growth, levels=[0.0], colors=[PALETTE[1]], linewidths=[2.2])
    ax.set_xlabel(_label(names[0], found.units[names[0]]))
    ax.set_ylabel(_label(names[1], found.units[names[1]]))
    _key(ax, not known.all())
    return ax


def _label(name: str, unit: str) -> str:
    return f"{name} [{pretty(unit or '1')}]"


def _frequencies(ax: Axes, at: list[numpy.ndarray], values: numpy.ndarray) -> None:
    """Colour cells by frequency, with a bar beside the axes, where anything oscillates."""
    if not numpy.isfinite(values).any():
        return
    field = _cells(ax, at, values, None)
    bar = ax.figure.colorbar(field, ax=ax, pad=0.02)
    bar.set_label("frequency of the leading mode [Hz]", color=INK)
    bar.outline.set_visible(False)


def _cells(
    ax: Axes, at: list[numpy.ndarray], values: numpy.ndarray, colours: list[str] | None
) -> Any:
    from matplotlib.colors import ListedColormap

    chosen = ListedColormap(colours) if colours else "viridis"
    return ax.pcolormesh(*at, values, cmap=chosen, shading="nearest", alpha=0.85, rasterized=True)


def _key(ax: Axes, gaps: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Patch(facecolor="none", edgecolor=HATCH, lw=0, hatch="////", label="unstable"),
        Line2D([], [], color=PALETTE[1], lw=2.2, label="boundary"),
    ]
    if gaps:
        handles.append(Patch(facecolor=GAP, label="no result"))
    ax.legend(
        handles=handles,
        ncols=len(handles),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        frameon=False,
        fontsize=9,
        labelcolor=INK,
    )
