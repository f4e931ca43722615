"""Plots of sweeps: a curve over one axis, a map over two, failed points marked by outcome."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError, suggestion
from .style import INK, PALETTE, dressed, pretty

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

HATCHES = ("////", "....", "xx", "\\\\\\\\", "++", "oo")
FAINT = "#8a9099"
_OWN = ("outcome", "t_end", "message", "seconds")


def sweep_map(dataset: xarray.Dataset, name: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Plot a quantity of a sweep over its one or two axes.

    Points that failed are crossed or hatched, with a legend of their outcomes.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of `bondgraph.sweeps.sweep`.
    name : str, optional
        The quantity; the first unless given.
    ax : Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        For an unknown quantity, one that is no number a point, and sweeps over
        more than two names.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.sweeps import grid, sweep
    >>> found = sweep(mass_on_belt.graph(), grid(k=[50, 75, 100]), "count:contact:stick", t_span=1.0)
    >>> ax = sweep_map(found)
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('spring stiffness [N/m]', 'count:contact:stick [1]')
    """
    chosen = _chosen(dataset, name)
    values = dataset[chosen]
    axes = [str(key) for key in dataset.coords if dataset[key].dims]
    if values.dims != dataset.outcome.dims or not 1 <= len(axes) <= 2:
        raise BondGraphError(
            f"{chosen!r} over {', '.join(axes)} makes no curve and no map; select one value of the "
            f"others first, as in dataset.sel(...), or one entry of an array"
        )
    ax = dressed(ax)
    grid = len(values.dims) == len(axes)
    if len(axes) == 2:
        mappable = _map(ax, dataset, values, axes) if grid else _cloud(ax, dataset, values, axes)
        bar = ax.figure.colorbar(mappable, ax=ax, pad=0.02)
        bar.set_label(_label(values), color=INK)
        bar.outline.set_visible(False)
    else:
        _curve(ax, dataset, values, axes[0], line=grid)
    ax.set_xlabel(_label(dataset[axes[0]]))
    ax.set_ylabel(_label(dataset[axes[1]]) if len(axes) == 2 else _label(values))
    return ax


def _chosen(dataset: xarray.Dataset, name: str | None) -> str:
    names = [str(key) for key in dataset.data_vars if key not in _OWN]
    if name is None and names:
        return names[0]
    if name not in names:
        hint = suggestion(str(name), names) or f"there is {', '.join(names) or 'none'}"
        raise BondGraphError(f"quantity {name!r} is not in the sweep; {hint}")
    return str(name)


def _label(column: xarray.DataArray) -> str:
    unit = pretty(str(column.attrs.get("units", "")) or "1")
    return f"{column.attrs.get('long_name', column.name)} [{unit}]"


def _failures(dataset: xarray.Dataset) -> dict[str, Any]:
    """Return where each outcome but the good one stands, by name."""
    words = dataset.outcome.attrs["flag_meanings"].split()
    codes = numpy.asarray(dataset.outcome.values)
    return {
        words[code].replace("_", " "): codes == code
        for code in numpy.unique(codes).tolist()
        if words[code] != "finished"
    }


def _map(ax: Axes, dataset: xarray.Dataset, values: xarray.DataArray, axes: list[str]) -> Any:
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    edges = [_edges(numpy.asarray(dataset[name].values, dtype=float)) for name in axes]
    shown = numpy.ma.masked_invalid(numpy.asarray(values.values)).T
    ax.grid(False)
    mesh = ax.pcolormesh(*edges, shown, cmap="viridis", rasterized=True)
    handles = []
    for (outcome, where), hatch in zip(_failures(dataset).items(), HATCHES, strict=False):
        cells = PolyCollection(_corners(edges, where), hatch=hatch, facecolor="none")
        cells.set(edgecolor=FAINT, linewidth=0)
        ax.add_collection(cells, autolim=False)
        handles.append(Patch(facecolor="white", edgecolor=FAINT, hatch=hatch, label=outcome))
    _legend(ax, handles)
    return mesh


def _corners(edges: list[numpy.ndarray], where: numpy.ndarray) -> list[numpy.ndarray]:
    """Return the rectangles of the cells where something holds."""
    x, y = edges
    return [
        numpy.array([(x[i], y[j]), (x[i + 1], y[j]), (x[i + 1], y[j + 1]), (x[i], y[j + 1])])
        for i, j in numpy.argwhere(where)
    ]


def _cloud(ax: Axes, dataset: xarray.Dataset, values: xarray.DataArray, axes: list[str]) -> Any:
    x, y = (numpy.asarray(dataset[name].values, dtype=float) for name in axes)
    numbers = numpy.asarray(values.values)
    good = numpy.isfinite(numbers)
    dots = ax.scatter(x[good], y[good], c=numbers[good], cmap="viridis", s=14)
    handles = [
        ax.scatter(x[where], y[where], marker="x", s=22, color=PALETTE[1 + i % 5], label=outcome)
        for i, (outcome, where) in enumerate(_failures(dataset).items())
    ]
    _legend(ax, handles)
    return dots


def _curve(
    ax: Axes, dataset: xarray.Dataset, values: xarray.DataArray, name: str, *, line: bool
) -> None:
    x, numbers = numpy.asarray(dataset[name].values, dtype=float), numpy.asarray(values.values)
    few = len(x) <= 40 or not line
    ax.plot(
        x, numbers, "-" if line else "", marker="o" if few else "", ms=3, color=PALETTE[0], lw=1.4
    )
    low = numpy.nanmin(numbers) if numpy.isfinite(numbers).any() else 0.0
    handles = [
        ax.plot(
            x[where],
            numpy.full(int(where.sum()), low),
            "x",
            color=PALETTE[1 + i % 5],
            label=outcome,
        )[0]
        for i, (outcome, where) in enumerate(_failures(dataset).items())
    ]
    _legend(ax, handles)


def _legend(ax: Axes, handles: list[Any]) -> None:
    if handles:
        ax.legend(
            handles=handles,
            loc="lower left",
            bbox_to_anchor=(0, 1),
            ncols=3,
            frameon=False,
            fontsize=9,
            labelcolor=INK,
        )


def _edges(centres: numpy.ndarray) -> numpy.ndarray:
    """Return the edges between points, and as far outside the first and last."""
    if len(centres) == 1:
        half = abs(centres[0]) / 2 or 0.5
        return numpy.array([centres[0] - half, centres[0] + half])
    middle = (centres[:-1] + centres[1:]) / 2
    return numpy.array([2 * centres[0] - middle[0], *middle, 2 * centres[-1] - middle[-1]])
