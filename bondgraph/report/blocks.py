"""What a report is made of: sections of text, tables and figures, as frozen values.

Texts are plain: whatever they hold is escaped when the page is written.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..simulation import Trajectory


@dataclass(frozen=True)
class Text:
    """A paragraph.

    Attributes
    ----------
    words : str
    kind : str
        ``"plain"``, ``"note"`` or ``"code"``.
    """

    words: str
    kind: str = "plain"


@dataclass(frozen=True)
class Bullets:
    """A list of sentences."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """A table of texts.

    Attributes
    ----------
    head : tuple of str
    rows : tuple of tuple of str
    align : str
        A letter a column: l, r or c (code, for names as they are typed).
    caption : str
    labelled : bool
        Whether the first column labels its row.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    align: str = ""
    caption: str = ""
    labelled: bool = False


@dataclass(frozen=True, eq=False)
class Panel:
    """One plot: axes, and the numbers behind them.

    Attributes
    ----------
    name : str
        Of its files, without ending.
    ax : Axes
    description : str
        What it shows, for those who cannot see it.
    numbers : mapping of str to array, optional
        Columns of the CSV; those of the plotted curves unless given.
    """

    name: str
    ax: Axes
    description: str
    numbers: Mapping[str, numpy.ndarray] | None = None

    def columns(self) -> dict[str, numpy.ndarray]:
        """Return the numbers by column heading.

        Examples
        --------
        >>> from bondgraph.plot import new_axes
        >>> ax = new_axes()
        >>> line = ax.plot([0, 1], [2, 3], label="v")
        >>> text = ax.set_xlabel("time [s]"), ax.set_ylabel("speed [m/s]")
        >>> {key: column.tolist() for key, column in Panel("p", ax, "").columns().items()}
        {'time [s]': [0, 1], 'v: speed [m/s]': [2, 3]}
        """
        if self.numbers is not None:
            return dict(self.numbers)
        across, upwards = self.ax.get_xlabel(), self.ax.get_ylabel()
        curves = [
            (
                str(line.get_label()),
                numpy.asarray(line.get_xdata()),
                numpy.asarray(line.get_ydata()),
            )
            for line in self.ax.lines
            if not str(line.get_label()).startswith("_")
        ]
        shared = all(numpy.array_equal(x, curves[0][1]) for _, x, _ in curves)
        found: dict[str, numpy.ndarray] = {across: curves[0][1]} if shared and curves else {}
        for label, x, y in curves:
            if not shared:
                found[f"{label}: {across}"] = x
            found[f"{label}: {upwards}"] = y
        return found


@dataclass(frozen=True, eq=False)
class Figure:
    """Plots side by side, with a title and a caption.

    Attributes
    ----------
    title : str
    panels : tuple of Panel
    caption : str
    run : Trajectory, optional
        The simulation behind it; its outcome is listed at the report's end.
    """

    title: str
    panels: tuple[Panel, ...]
    caption: str = ""
    run: Trajectory | None = None


@dataclass(frozen=True)
class Markup:
    """HTML that the report itself has made, such as a drawing or formulas.

    Never text from outside: it is put into the page as it is.
    """

    html: str


@dataclass(frozen=True, eq=False)
class Section:
    """A titled part of a report.

    Attributes
    ----------
    title : str
    blocks : tuple of Text, Bullets, Table, Figure or Markup
    """

    title: str
    blocks: tuple[Any, ...] = field(default_factory=tuple)

    @property
    def figures(self) -> tuple[Figure, ...]:
        """The figures among the blocks."""
        return tuple(block for block in self.blocks if isinstance(block, Figure))
