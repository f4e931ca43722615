"""Bars: what takes part in a mode, what feeds it, and which parameter moves it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .style import INK, SIZE, dressed, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..stability import Effect, Mode

# Orange makes a motion grow, blue makes it decay, as everywhere in a report.
GROW, DECAY = "#D55E00", "#0072B2"
PART, ENERGY = "#56B4E9", "#E69F00"
ROW, FRAME = 0.3, 0.95  # inches: of a row of bars, and of what stands around all of them
MOST = 12
SEEN = 0.01  # a smaller share of the longest bar is no bar


def share_bars(mode: Mode, *, ax: Axes | None = None) -> Axes:
    """Plot which elements take part in a mode, and which hold its energy.

    Parameters
    ----------
    mode : Mode
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> ax = share_bars(assess(mass_on_belt.graph()).critical)
    >>> [text.get_text() for text in ax.get_yticklabels()], ax.get_xlabel()
    (['mass', 'spring'], 'share [%]')
    """
    told = [*mode.carriers.items(), *mode.energies.items()]
    names = list(dict.fromkeys(name for name, share in told if share >= SEEN))[:MOST]
    ax = _rows(names, ax, high=0.45)
    half = 0.36
    for shift, shares, colour, label in (
        (-half / 2, mode.carriers, PART, "takes part"),
        (half / 2, mode.energies, ENERGY, "holds energy"),
    ):
        if shares:
            places = [index + shift for index in range(len(names))]
            widths = [100 * shares.get(name, 0.0) for name in names]
            ax.barh(places, widths, half, color=colour, label=label)
    ax.set_xlim(0, None)
    ax.set_xlabel("share [%]")
    ax.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=2,
        frameon=False,
        fontsize=9,
        labelcolor=INK,
    )
    return ax


def feed_bars(mode: Mode, *, ax: Axes | None = None) -> Axes:
    """Plot what each dissipator or source adds to a mode's growth rate.

    Parameters
    ----------
    mode : Mode
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> ax = feed_bars(assess(mass_on_belt.graph()).critical)
    >>> [text.get_text() for text in ax.get_yticklabels()]
    ['contact', 'damper']
    """
    largest = sorted(mode.feeds.items(), key=lambda item: -abs(item[1]))[:MOST]
    largest = [item for item in largest if abs(item[1]) >= SEEN * abs(largest[0][1])]
    shown = sorted(largest, key=lambda item: -item[1])
    ax = _rows([name for name, _ in shown], ax)
    _signed(ax, [rate for _, rate in shown])
    ax.set_xlabel("adds to the growth rate [1/s]")
    return ax


def sensitivity_bars(
    effects: Sequence[Effect], change: float = 0.1, *, ax: Axes | None = None
) -> Axes:
    """Plot how much each parameter moves a growth rate.

    Parameters
    ----------
    effects : sequence of Effect
        Of one eigenvalue, in the order of the rows; the first twelve are shown.
    change : float
        Relative change of each parameter.
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.stability import assess
    >>> found = assess(mass_on_belt.graph()).sensitivities.ranked(0, derived=False, by="growth")
    >>> ax = sensitivity_bars(found[:2])
    >>> [text.get_text() for text in ax.get_yticklabels()]
    ['mu_s', 'mu_k']
    """
    shown = list(effects)[:MOST]
    ax = _rows([item.parameter for item in shown], ax)
    _signed(ax, [item.growth(change) for item in shown])
    ax.set_xlabel(f"change of the growth rate for {change:+.0%} [1/s]")
    return ax


def _rows(names: Sequence[str], ax: Axes | None, high: float = ROW) -> Axes:
    """Return axes with a row for each name, the first on top."""
    ax = new_axes((SIZE[0], FRAME + high * max(len(names), 1))) if ax is None else ax
    ax = dressed(ax)
    ax.grid(False, axis="y")
    ax.set_yticks(range(len(names)), labels=list(names))
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.tick_params(axis="y", length=0)
    return ax


def _signed(ax: Axes, values: Sequence[float]) -> None:
    """Draw bars to both sides of zero, each with its number."""
    bars = ax.barh(
        range(len(values)), values, 0.62, color=[GROW if v > 0 else DECAY for v in values]
    )
    ax.bar_label(bars, [f"{value:+.3g}" for value in values], padding=3, fontsize=9, color=INK)
    ax.axvline(0, color=INK, lw=0.8)
    reach = max(map(abs, values), default=0.0) or 1.0
    low, high = min(0.0, *values, 0.0), max(0.0, *values, 0.0)
    ax.set_xlim(
        low - (0.3 * reach if low else 0.04 * reach), high + (0.3 * reach if high else 0.04 * reach)
    )
