"""What all plots share: signals with units, axes without global state, colours."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from ..units import from_si
from ..units import pretty as pretty  # plots find it here, with the rest of the style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..simulation import Trajectory

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
STYLES = ("-", "--", "-.", ":")
INK, GRID, SHADE = "#2b2f36", "#d9dce1", "#fbe9e2"
SIZE = (5.0, 3.5)
FORMATS = (".svg", ".png", ".pdf")


@dataclass(frozen=True, eq=False)
class Signal:
    """Values to plot, with a name and a unit.

    Examples
    --------
    >>> speed = Signal(numpy.array([1.0, 2.0]), "speed", "m/s")
    >>> speed.label, speed.scaled(3.6, "km/h").values.tolist()
    ('speed [m/s]', [3.6, 7.2])
    """

    values: numpy.ndarray
    name: str
    unit: str = ""

    @property
    def label(self) -> str:
        """Name and unit, as on an axis."""
        return f"{self.name} [{pretty(self.unit or '1')}]"

    def scaled(self, factor: float, unit: str) -> Signal:
        """Return the values times a factor, in a new unit."""
        return replace(self, values=self.values * factor, unit=unit)

    def named(self, name: str) -> Signal:
        """Return the same values under another name."""
        return replace(self, name=name)


def signal(trajectory: Trajectory, what: str | Signal) -> Signal:
    """Return a signal of a trajectory with its unit; a `Signal` passes through.

    Parameters
    ----------
    trajectory : Trajectory
    what : str or Signal

    Returns
    -------
    Signal
    """
    if isinstance(what, Signal):
        return what
    return Signal(numpy.asarray(trajectory[what]), what, trajectory.unit(what))


def new_axes(size: tuple[float, float] = SIZE) -> Axes:
    """Return the axes of a new figure that no global state knows.

    Parameters
    ----------
    size : (float, float)
        Inches.

    Returns
    -------
    matplotlib.axes.Axes

    Examples
    --------
    >>> new_axes().figure.axes == [new_axes().figure.axes[0]]
    False
    """
    from matplotlib.figure import Figure

    return Figure(figsize=size, layout="constrained").subplots()


def figure_of(ax: Axes) -> Figure:
    """Return the whole figure that some axes belong to."""
    return ax.get_figure(root=True)  # type: ignore[return-value]


def save(plot: Axes | Figure, path: str | Path) -> Path:
    """Write a plot to a file; the ending chooses the format.

    Parameters
    ----------
    plot : Axes or Figure
    path : str or Path
        Ending in ``.svg``, ``.png`` or ``.pdf``.

    Returns
    -------
    Path

    Raises
    ------
    BondGraphError
        For another ending, or where the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(new_axes(), f"{folder}/empty.png").name
    'empty.png'
    """
    from matplotlib.axes import Axes

    path = Path(path)
    if path.suffix not in FORMATS:
        raise BondGraphError(
            f"cannot write {path.name!r}: use the ending {', '.join(FORMATS[:-1])} or {FORMATS[-1]}"
        )
    figure = figure_of(plot) if isinstance(plot, Axes) else plot
    try:
        figure.savefig(path, dpi=160)
    except OSError as error:
        raise BondGraphError(f"cannot write {path}: {error.strerror or error}") from None
    return path


def dressed(ax: Axes | None) -> Axes:
    """Give axes the house's dress, making them where there are none."""
    ax = new_axes() if ax is None else ax
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_color("#8a9099")
    ax.grid(True, color=GRID, lw=0.6)
    ax.set_axisbelow(True)
    ax.tick_params(colors=INK, labelsize=9, length=3)
    ax.xaxis.label.set_color(INK)
    ax.yaxis.label.set_color(INK)
    return ax


def line(index: int, thin: bool = False) -> dict[str, Any]:
    """Return colour, style and width of a curve by its place in a family."""
    return {
        "color": PALETTE[index % len(PALETTE)],
        "ls": "-" if thin else STYLES[index % len(STYLES)],
        "lw": 1.0 if thin else 1.6,
    }


def legend(ax: Axes) -> None:
    """Add a legend where there are curves to tell apart."""
    curves = [
        curve
        for curve in ax.lines
        if not str(curve.get_label()).startswith("_") and curve.get_alpha() is None
    ]
    if len(curves) > 1:
        ax.legend(handles=curves, frameon=False, fontsize=9, labelcolor=INK)


def in_own_unit(values: numpy.ndarray, unit: str) -> numpy.ndarray:
    """Convert SI values to a unit."""
    return numpy.array([from_si(float(value), unit) for value in values])
