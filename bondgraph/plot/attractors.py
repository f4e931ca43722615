"""Plots of what a model ends in: cycles beside the steady state, and along a parameter."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from ..units import from_si
from .style import INK, PALETTE, SHADE, dressed, line, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..attractors import Attractor, Attractors, Reach

# How much it counts for a pair of signals that a push of the size of the cycle is seen in it.
SEEN = 10.0
MARKS = {"steady": "o", "cycle": "o", "unbounded": "^", "unsettled": "x", "stopped": "x"}
WORDS = {
    "unbounded": "grows without bound",
    "unsettled": "not settled",
    "stopped": "stopped by the solver",
}


def attractor_plot(
    found: Attractors, pair: tuple[str, str] | None = None, *, ax: Axes | None = None
) -> Axes:
    """Plot cycles and steady states of a model in one plane.

    Dots on a cycle are changes of mode: full where a contact sticks or closes, hollow where it
    lets go. A dashed line is the smallest push of the steady state that leaves it, where that is
    known.

    Parameters
    ----------
    found : Attractors
        From `bondgraph.find_attractors`.
    pair : (str, str), optional
        Signals across and upwards; those between which the first cycle is roundest unless given,
        a quantity and its rate before others.
    ax : Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        Where there is nothing to draw.

    Examples
    --------
    >>> from bondgraph import find_attractors
    >>> from bondgraph.models import mass_on_belt
    >>> ax = attractor_plot(find_attractors(mass_on_belt.graph()))
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('x [m]', 'v [m/s]')
    """
    shown = [*found.cycles, *(item for item in found.found if item.kind == "steady")]
    if not shown:
        raise BondGraphError(f"{found.model!r} has neither a cycle nor a steady state to draw")
    across, upwards = _pair(found, shown[0]) if pair is None else pair
    ax = dressed(ax)
    for index, item in enumerate(found.cycles):
        _loop(ax, item, (across, upwards), index)
    for item in shown[len(found.cycles) :]:
        _dot(ax, (_at(item, across), _at(item, upwards)), bool(item.stable))
    if found.point is not None and not found.point.stable:
        known = {**found.point.states, **found.point.outputs}
        if across in known and upwards in known:
            _dot(ax, (known[across], known[upwards]), False)
    _push(ax, found, (across, upwards))
    run = shown[0].run
    for name, label in ((across, ax.set_xlabel), (upwards, ax.set_ylabel)):
        label(f"{name} [{pretty(run.unit(name) or '1')}]")
    ax.margins(0.08)
    handles = dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    ax.legend(list(handles.values()), list(handles), **_above())
    return ax


def reach_plot(found: Reach, signal: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Plot how far a signal swings in what the model's own start ends in, over a parameter.

    Full dots are cycles, hollow ones steady states; dashed lines stand where the outcome changes.
    Ranges that end in a cycle are shaded.

    Parameters
    ----------
    found : Reach
        From `bondgraph.reach`.
    signal : str, optional
        An output; the first displacement among those that swing unless given, or the first of all.
    ax : Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        For a signal that is no output of the model.

    Examples
    --------
    >>> from bondgraph import reach
    >>> from bondgraph.models import bicycle_brake
    >>> ax = reach_plot(reach(bicycle_brake.graph(), ("tau", 0.01, 0.04, 4), {"mu_s": 0.5}), "x_c")
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('tau [s]', 'swing of x_c [m]')
    """
    name = _swinging(found) if signal is None else signal
    if name not in found.units:
        raise BondGraphError(f"{name!r} is no output of {found.model!r}: {', '.join(found.units)}")
    ax = dressed(ax)
    cuts = [from_si(change.value, found.unit) for change in found.changes]
    x = numpy.array([from_si(value, found.unit) for value in found.values])
    y = numpy.array([_swing(point, name) for point in found.points])
    groups = numpy.searchsorted(cuts, x)
    for group in numpy.unique(groups):
        here = groups == group
        kind = found.points[int(numpy.argmax(here))].outcome
        color = PALETTE[1] if kind == "cycle" else PALETTE[0]
        if kind in ("cycle", "steady"):
            ax.plot(x[here], y[here], color=color, lw=1.6)
    for kind, mark in MARKS.items():
        here = numpy.array([point.outcome == kind for point in found.points], dtype=bool)
        if here.any():
            color = PALETTE[1] if kind == "cycle" else PALETTE[0] if kind == "steady" else INK
            full = color if kind == "cycle" else "white"
            at = y[here] if kind in ("cycle", "steady") else numpy.zeros(here.sum())
            words = {"cycle": "cycle", "steady": "steady state", **WORDS}[kind]
            ax.plot(x[here], at, mark, ms=5, color=color, mfc=full, ls="none", label=words)
    rows = _ranges(ax, found, x, cuts)
    ax.set_ylim(bottom=min(0.0, float(numpy.nanmin(y, initial=0.0))))
    low, high = ax.get_ylim()
    ax.set_ylim(low - 0.04 * (high - low), high + (0.08 + 0.06 * rows) * (high - low))
    ax.set_xlabel(f"{found.name} [{pretty(found.unit or '1')}]")
    ax.set_ylabel(f"swing of {name} [{pretty(found.units[name] or '1')}]")
    ax.legend(**_above())
    return ax


def _above() -> dict[str, Any]:
    """Return where and how a legend stands above the axes, off the curves."""
    place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "ncols": 2, "borderaxespad": 0.2}
    return {**place, "frameon": False, "fontsize": 9, "labelcolor": INK, "columnspacing": 1.2}


def _push(ax: Axes, found: Attractors, pair: tuple[str, str]) -> None:
    """Draw the smallest push of the steady state that leaves it, where these signals tell it."""
    edge, point = found.edge, found.point
    if edge is None or point is None or not numpy.isfinite(edge.leaves):
        return
    known = {**point.states, **point.outputs}
    if not all(name in edge.outputs and name in known for name in pair):
        return
    begin = [known[name] for name in pair]
    end = [at + edge.outputs[name] for at, name in zip(begin, pair, strict=True)]
    ax.plot(*zip(begin, end, strict=True), color=INK, lw=1.0, ls=(0, (4, 3)), zorder=2.5)
    style: dict[str, Any] = {"ms": 6, "color": INK, "mfc": "white", "ls": "none", "zorder": 4}
    ax.plot(*end, "D", label="smallest push that leaves", **style)


def _loop(ax: Axes, item: Attractor, pair: tuple[str, str], index: int) -> None:
    """Draw a cycle once round, with its events."""
    run, period = item.run, item.period
    assert period is not None
    late = run.t >= run.t[-1] - period * (1 + 1e-9)
    x, y = (run[name] for name in pair)
    style = {**line(index), "ls": "-"}
    name = f"{item.frequency_hz:.4g} Hz" + (
        ", neither stable nor not" if item.stable is None else ""
    )
    ax.plot(x[late], y[late], label=f"cycle, {name}", **style)
    for held in (True, False):
        times = [
            event.t
            for event in run.events
            if (run.model.equations.graph[event.element].code(event.to_mode) == 0) is held
            and event.t >= run.t[-1] - period
        ]
        if times:
            places = numpy.clip(numpy.searchsorted(run.t, times), 0, len(run.t) - 1)
            fill = style["color"] if held else "white"
            dots: dict[str, Any] = {
                "ms": 4,
                "mew": 0.9,
                "color": style["color"],
                "mfc": fill,
                "ls": "none",
            }
            ax.plot(x[places], y[places], "o", zorder=3, **dots)


def _dot(ax: Axes, at: tuple[float, float], stable: bool) -> None:
    label = "steady state, stable" if stable else "steady state, not stable"
    style: dict[str, Any] = {
        "ms": 7,
        "color": INK,
        "mfc": INK if stable else "white",
        "ls": "none",
        "zorder": 4,
    }
    ax.plot(*at, "o", label=label, **style)


def _at(item: Attractor, name: str) -> float:
    if name in item.amplitudes:
        return item.amplitudes[name].mean
    return item.states[name] if name in item.states else float(item.run[name][-1])


def _pair(found: Attractors, item: Attractor) -> tuple[str, str]:
    """Choose the two signals between which a cycle is roundest.

    A rate over its quantity comes first, and where a push is known, signals that show it.
    """
    run = item.run
    names = list(item.amplitudes) if len(item.amplitudes) > 1 else list(run.states)
    if len(names) < 2:
        return (run.states[0], names[0]) if names and run.states else ("", "")
    rows = {name: run[name] for name in names}
    best, most = (names[0], names[1]), -1.0
    for x, y in itertools.permutations(names, 2):
        a, b = rows[x], rows[y]
        if not numpy.ptp(a) > 0 or not numpy.ptp(b) > 0:
            continue
        turn = numpy.trapezoid(b, a) - (b[0] + b[-1]) / 2 * (a[-1] - a[0])
        round_ = abs(float(turn)) / float(numpy.ptp(a) * numpy.ptp(b))
        is_rate = run.unit(y) in (f"{run.unit(x)}/s", "1/s" if not run.unit(x) else None)
        score = round_ + (1.0 if is_rate else 0.0) + (0.01 if run.unit(x) in ("m", "rad") else 0.0)
        if found.edge is not None:
            score += SEEN * abs(found.edge.outputs.get(y, 0.0)) / float(numpy.ptp(b))
        if score > most + 1e-9:
            best, most = (x, y), score
    return best


def _swing(point: object, name: str) -> float:
    swing = point.amplitudes.get(name)  # type: ignore[attr-defined]
    return numpy.nan if swing is None else float(swing.peak_to_peak)


def _swinging(found: Reach) -> str:
    """Choose an output to show: a displacement that swings, else the first that does."""
    names = list(found.units)
    if not names:
        raise BondGraphError(f"{found.model!r} has no outputs to show")
    cycles = [point for point in found.points if point.outcome == "cycle"]
    swing = [name for name in names if any(_swing(point, name) > 0 for point in cycles)] or names
    return next((name for name in swing if found.units[name] == "m"), swing[0])


def _ranges(ax: Axes, found: Reach, x: numpy.ndarray, cuts: list[float]) -> int:
    """Shade ranges that end in a cycle, mark where the outcome changes; return rows of text."""
    ends = [float(x[0]), *cuts, float(x[-1])]
    kinds = [change.before.outcome for change in found.changes] + [found.points[-1].outcome]
    for low, high, kind in zip(ends[:-1], ends[1:], kinds, strict=True):
        if kind == "cycle":
            ax.axvspan(low, high, color=SHADE, lw=0, zorder=0)
    low, row, rows = -numpy.inf, 0, 0
    for cut in cuts:
        row = (row + 1) % 3 if cut - low < 0.12 * (ends[-1] - ends[0]) else 0
        low, rows = cut, max(rows, row)
        ax.axvline(cut, color=INK, lw=0.8, ls=(0, (4, 3)))
        ax.annotate(
            f"{cut:.4g}",
            (cut, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(3, -10 - 12 * row),
            textcoords="offset points",
            fontsize=9,
            color=INK,
        )
    return rows + bool(cuts)
