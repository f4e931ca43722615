"""Plots of modes: poles and zeros, how junctions move, where the energy is."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy

from .gaps import FAINT, key_above
from .style import INK, PALETTE, SHADE, dressed, figure_of, new_axes, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..linear import LinearSystem, Mode, ModeShape

HATCHES = ("", "////", "....", "xxxx", "\\\\\\\\", "----", "++++")
WRITTEN = 0.09  # shares from here on have their number inside
VISIBLE = 0.004  # elements without such a share in any mode are left out


def pole_zero_plot(
    system: LinearSystem,
    output: str | None = None,
    input: str | None = None,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Plot poles as crosses and zeros as circles in the complex plane.

    Parameters
    ----------
    system : LinearSystem
    output, input : str, optional
        Channel whose zeros are shown; those of the whole system unless given, none where
        it has no inputs or outputs.
    ax : Axes, optional

    Returns
    -------
    Axes
        Where things grow is shaded.

    Examples
    --------
    >>> from bondgraph import linearize
    >>> from bondgraph.models import quarter_car
    >>> ax = pole_zero_plot(linearize(quarter_car.graph()), "v_body", "v_road")
    >>> [len(line.get_xdata()) for line in ax.lines if line.get_label() in ("poles", "zeros")]
    [1, 4]
    """
    ax = dressed(ax)
    bare = not (system.sources and system.outputs)
    zeros = numpy.zeros(0) if bare and output is None else system.zeros(output, input)
    ax.axvline(0, color=INK, lw=0.8)
    ax.axhline(0, color=INK, lw=0.6)
    marks: list[tuple[Any, str, dict[str, Any]]] = [
        (zeros, "zeros", {"marker": "o", "mfc": "none", "color": PALETTE[0], "ms": 9}),
        (system.poles(), "poles", {"marker": "x", "color": PALETTE[1], "ms": 7}),
    ]
    for roots, label, style in marks:
        if len(roots):
            ax.plot(roots.real, roots.imag, ls="", mew=1.7, label=label, zorder=3, **style)
    ax.margins(0.12)
    low, high = ax.get_xlim()
    reach = max(high, 0.06 * (high - low))
    ax.axvspan(0, reach, color=SHADE, lw=0, zorder=0)
    ax.set_xlim(min(low, -0.06 * (high - low)), reach)
    ax.set_xlabel("real part [1/s]")
    ax.set_ylabel("imaginary part [rad/s]")
    key_above(ax)
    return ax


def mode_shape_plot(shape: ModeShape, *, within_unit: bool = False, ax: Axes | None = None) -> Axes:
    """Plot a mode as a bar for each junction, with its phase as a hand and as a number.

    Bars are full where the junction moves along with the largest (phase within a quarter
    turn of zero), hatched where it moves against it.

    Parameters
    ----------
    shape : ModeShape
    within_unit : bool
        Whether each bar is over the largest of its own unit, so that small units show; else
        over the largest flow and the largest effort, in SI.
    ax : Axes, optional

    Returns
    -------
    Axes
        Flows of 1-junctions above, efforts of 0-junctions below.

    Examples
    --------
    >>> from bondgraph import linearize
    >>> from bondgraph.models import quarter_car
    >>> ax = mode_shape_plot(linearize(quarter_car.graph()).mode_shapes()[0])
    >>> [label.get_text() for label in ax.get_yticklabels()][0]
    '1 wheel [m/s]'
    """
    shown = shape.within_unit() if within_unit else shape.motion
    sizes = {name: abs(value) for name, value in shown.items()}
    names = list(sizes)
    if ax is None:
        ax = new_axes((5.6, 1.1 + 0.3 * max(len(names), 1)))
    ax = dressed(ax)
    for row, name in enumerate(names):
        phase = shape.phase(name)
        against = abs(phase) > 90
        colour = PALETTE[0] if name in shape.flows else PALETTE[4]
        ax.barh(
            row,
            sizes[name],
            height=0.6,
            color="white" if against else colour,
            edgecolor=colour,
            hatch="////" if against else "",
            lw=1.2,
        )
        if sizes[name] > 0:
            _hand(ax, row, phase)
            words = _plain(f"{sizes[name]:.2g} ∠ {phase:.0f}°").replace("\N{MINUS SIGN}0°", "0°")
            ax.text(1.16, row, words, va="center", size=9, color=INK)
    for row in range(1, len(names)):
        if names[row - 1] in shape.flows and names[row] not in shape.flows:
            ax.axhline(row - 0.5, color=FAINT, lw=0.8)
    ax.set_yticks(range(len(names)), [_junction(shape, name) for name in names])
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.set_xlim(0, 1.5)
    ax.set_xticks([0, 0.25, 0.5, 0.75, 1])
    ax.grid(False, axis="y")
    of = "largest of its unit" if within_unit else "largest"
    ax.set_xlabel(f"flow or effort over the {of} [1]")
    ax.set_title(_title(shape.pole), fontsize=10, color=INK, loc="left")
    return ax


def energy_plot(found: LinearSystem | Iterable[Mode], *, ax: Axes | None = None) -> Axes:
    """Plot where the energy of each mode is, as shares of the storages.

    Parameters
    ----------
    found : LinearSystem or iterable of Mode
        Of a pair of eigenvalues, the first is shown.
    ax : Axes, optional

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph import linearize
    >>> from bondgraph.models import quarter_car
    >>> ax = energy_plot(linearize(quarter_car.graph()))
    >>> [label.get_text() for label in ax.get_yticklabels()]
    ['1.217 Hz, ζ = 0.2101', '10.87 Hz, ζ = 0.2193']
    """
    from matplotlib.colors import to_rgba

    every: Iterable[Mode] = found.modes() if hasattr(found, "modes") else found
    modes = [mode for mode in every if mode.eigenvalue.imag >= 0]
    if ax is None:
        ax = new_axes((5.6, 1.3 + 0.42 * max(len(modes), 1)))
    ax = dressed(ax)
    names = list(
        dict.fromkeys(
            name
            for mode in modes
            for name, share in sorted(mode.energies.items())
            if abs(share) >= VISIBLE
        )
    )
    ends = {+1: numpy.zeros(len(modes)), -1: numpy.zeros(len(modes))}
    for place, name in enumerate(names):
        shares = numpy.array([mode.energies.get(name, 0.0) for mode in modes])
        left = numpy.where(shares >= 0, ends[+1], ends[-1])
        colour = PALETTE[place % len(PALETTE)]
        ax.barh(
            range(len(modes)),
            shares,
            left=left,
            height=0.62,
            color=to_rgba(colour, 0.45),
            edgecolor=colour,
            hatch=HATCHES[place % len(HATCHES)],
            lw=1.0,
            label=name,
        )
        for row, share in enumerate(shares):
            ends[1 if share >= 0 else -1][row] += share
            if abs(share) >= WRITTEN:
                _written(ax, left[row] + share / 2, row, f"{100 * share:.0f} %")
    for row, mode in enumerate(modes):
        if not mode.energies:
            ax.text(0.01, row, "not known", va="center", size=9, color=INK)
    ax.set_yticks(range(len(modes)), [_title(mode.eigenvalue) for mode in modes])
    ax.set_ylim(max(len(modes), 1) - 0.45, -0.55)
    ax.set_xlim(min(0.0, *ends[-1], 0.0) * 1.02, max([1.0, *ends[+1]]) * 1.005)
    ax.grid(False, axis="y")
    ax.set_xlabel("share of the mode's energy [1]")
    _roomy_key(ax)
    return ax


def _roomy_key(ax: Axes) -> None:
    """Put the key above in rows of three, which a narrow figure holds."""
    handles, labels = ax.get_legend_handles_labels()
    ax.legend(
        handles,
        labels,
        ncols=min(len(labels), 3) or 1,
        loc="lower left",
        bbox_to_anchor=(-0.25, 1.0),
        frameon=False,
        fontsize=9,
        labelcolor=INK,
        columnspacing=0.9,
        handlelength=1.3,
    )


def _hand(ax: Axes, row: int, phase: float) -> None:
    """Draw a small hand that points where the phasor does, to the right for phase zero."""
    from matplotlib.transforms import ScaledTranslation

    turn = numpy.radians(phase)
    across, up = 7 / 72 * numpy.cos(turn), 7 / 72 * numpy.sin(turn)
    to_inches = figure_of(ax).dpi_scale_trans
    arrow = {"arrowstyle": "-|>", "lw": 1.1, "color": INK, "shrinkA": 0, "shrinkB": 0}
    head, tail = (
        ax.transData + ScaledTranslation(sign * across, sign * up, to_inches) for sign in (1, -1)
    )
    ax.annotate("", (1.09, row), (1.09, row), xycoords=head, textcoords=tail, arrowprops=arrow)


def _written(ax: Axes, x: float, row: int, words: str) -> None:
    """Write on a bar, on a plain ground so that hatching does not cross it."""
    box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85}
    ax.text(x, row, words, ha="center", va="center", size=9, color=INK, bbox=box)


def _junction(shape: ModeShape, name: str) -> str:
    kind = "1" if name in shape.flows else "0"
    return f"{kind} {name} [{pretty(shape.units.get(name) or '1')}]"


def _title(pole: complex) -> str:
    """Say what kind of mode it is: frequency and damping, or rate."""
    if pole.imag:
        ratio = -pole.real / abs(pole)
        return _plain(f"{abs(pole.imag) / (2 * numpy.pi):.4g} Hz, ζ = {ratio:.4g}")
    return _plain(f"{pole.real:.4g} 1/s")


def _plain(words: str) -> str:
    return words.replace("-", "\N{MINUS SIGN}")
