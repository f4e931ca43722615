"""Plots of trajectories: over time, in the phase plane, and while building up."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from .style import PALETTE, SIZE, Signal, dressed, legend, line, pretty, signal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..simulation import Trajectory


def time_response(
    trajectory: Trajectory,
    signals: str | Signal | Iterable[str | Signal],
    *,
    ax: Axes | None = None,
    events: bool = True,
) -> Axes:
    """Plot signals over time, with stick and slip events marked.

    Parameters
    ----------
    trajectory : Trajectory
    signals : str, Signal, or iterable of these
        Of one unit.
    ax : Axes, optional
    events : bool
        Mark changes of mode.

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        For signals of different units: they need axes of their own.

    Examples
    --------
    >>> from bondgraph import simulate
    >>> from bondgraph.models import mass_on_belt
    >>> ax = time_response(simulate(mass_on_belt.graph(), 1.0), ["v", "slip"])
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('time [s]', 'v, slip [m/s]')
    """
    chosen = _together(trajectory, signals)
    ax = dressed(ax)
    factor, unit = _time_scale(float(trajectory.t[-1] - trajectory.t[0]))
    for index, item in enumerate(chosen):
        ax.plot(trajectory.t * factor, item.values, label=item.name, **line(index))
        if events:
            _mark(ax, trajectory, trajectory.t * factor, item.values, PALETTE[index])
    ax.set_xlabel(f"time [{unit}]")
    ax.set_ylabel(_shared_label(chosen))
    ax.margins(x=0.01)
    legend(ax)
    return ax


def overview(trajectory: Trajectory, names: Iterable[str] | None = None) -> Figure:
    """Plot signals over time in one figure, one row of axes for each unit.

    Parameters
    ----------
    trajectory : Trajectory
    names : iterable of str, optional
        Outputs unless given; states where the model has none.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from bondgraph import simulate
    >>> from bondgraph.models import mass_on_belt
    >>> figure = overview(simulate(mass_on_belt.graph(), 1.0))
    >>> [ax.get_ylabel() for ax in figure.axes]
    ['x [m]', 'v, slip [m/s]']
    """
    from matplotlib.figure import Figure

    outputs = trajectory.model.equations.outputs
    rows: dict[str, list[str]] = {}
    for name in (outputs or trajectory.states) if names is None else names:
        rows.setdefault(trajectory.unit(name), []).append(name)
    count = max(len(rows), 1)
    figure = Figure(figsize=(SIZE[0] * 1.6, 0.6 * SIZE[1] * count + 0.6), layout="constrained")
    grid = figure.subplots(count, 1, sharex=True, squeeze=False)
    for ax, group in zip(grid[:, 0], rows.values(), strict=False):
        time_response(trajectory, group, ax=ax)
        ax.label_outer()
    return figure


def phase_plane(
    trajectory: Trajectory,
    pairs: Iterable[tuple[str | Signal, str | Signal]],
    *,
    ax: Axes | None = None,
    events: bool = True,
    since: float | None = None,
) -> Axes:
    """Plot signals against each other, such as velocity over deflection.

    Parameters
    ----------
    trajectory : Trajectory
    pairs : iterable of (x, y)
        Each a name or a `Signal`; all x of one unit, and all y.
    ax : Axes, optional
    events : bool
        Mark changes of mode, and the start.
    since : float, optional
        Time, s: what comes before is pale, such as the way to a cycle.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph import simulate
    >>> from bondgraph.models import mass_on_belt
    >>> ax = phase_plane(simulate(mass_on_belt.graph(), 1.0), [("x", "v")])
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('x [m]', 'v [m/s]')
    """
    ax = dressed(ax)
    taken = [(signal(trajectory, x), signal(trajectory, y)) for x, y in pairs]
    across = _together(trajectory, [x for x, _ in taken])
    upwards = _together(trajectory, [y for _, y in taken])
    late = trajectory.t >= (trajectory.t[0] if since is None else since)
    for index, (x, y) in enumerate(taken):
        style = line(index, thin=since is None)
        ax.plot(x.values[late], y.values[late], label=y.name, **{**style, "ls": "-"})
        if since is not None:
            pale = {"color": style["color"], "lw": 0.6, "alpha": 0.45}
            ax.plot(x.values[~late], y.values[~late], label=f"{y.name}, before", zorder=1.9, **pale)
        if events:
            ax.plot(x.values[:1], y.values[:1], "s", ms=4, color=PALETTE[index], label="_start")
            _mark(ax, trajectory, x.values, y.values, PALETTE[index], since)
    ax.set_xlabel(_shared_label(across))
    ax.set_ylabel(_shared_label(upwards))
    legend(ax)
    return ax


def application(
    trajectory: Trajectory,
    what: str | Signal,
    *,
    ax: Axes | None = None,
    label: str = "",
    index: int = 0,
) -> Axes:
    """Plot how a signal builds up, and when it passes 63 % of its last value.

    Parameters
    ----------
    trajectory : Trajectory
    what : str or Signal
        Such as the force of a brake's pads.
    ax : Axes, optional
    label : str
        Of the curve, for a family of them.
    index : int
        Place in the family, which decides colour and style.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from bondgraph import simulate
    >>> from bondgraph.models import bicycle_brake
    >>> ax = application(simulate(bicycle_brake.graph(), 0.2, {"mu_s": 0.42}), "N")
    >>> ax.get_ylabel()
    'N [N]'
    """
    ax = dressed(ax)
    item = signal(trajectory, what)
    factor, unit = _time_scale(float(trajectory.t[-1] - trajectory.t[0]))
    ax.plot(trajectory.t * factor, item.values, label=label or item.name, **line(index))
    level = item.values[0] + (1 - numpy.exp(-1.0)) * (item.values[-1] - item.values[0])
    passed = int(numpy.argmax(numpy.sign(level - item.values[0]) * (item.values - level) >= 0))
    ax.plot(trajectory.t[passed] * factor, item.values[passed], "o", ms=5, color=PALETTE[index])
    ax.set_xlabel(f"time [{unit}]")
    ax.set_ylabel(item.label)
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=min(0.0, float(item.values.min())))
    legend(ax)
    return ax


def _time_scale(length: float) -> tuple[float, str]:
    return (1e3, "ms") if length < 1 else (1.0, "s")


def _together(trajectory: Trajectory, signals: Any) -> list[Signal]:
    """Return signals that may share an axis."""
    several = [signals] if isinstance(signals, str | Signal) else list(signals)
    chosen = [signal(trajectory, item) for item in several]
    units = {item.unit for item in chosen}
    if len(units) != 1:
        names = ", ".join(item.label for item in chosen) or "none"
        raise BondGraphError(f"signals of one unit share an axis, got {names}; use further axes")
    return chosen


def _shared_label(signals: Sequence[Signal]) -> str:
    names = ", ".join(dict.fromkeys(item.name for item in signals))
    return f"{names} [{pretty(signals[0].unit or '1')}]"


def _mark(
    ax: Axes,
    trajectory: Trajectory,
    x: numpy.ndarray,
    y: numpy.ndarray,
    color: str,
    since: float | None = None,
) -> None:
    """Put a full dot where a contact sticks and a hollow one where it lets go."""
    for mode, filled in (("stick", True), ("slip", False)):
        times = [
            event.t
            for event in trajectory.events
            if event.to_mode.startswith(mode) and (since is None or event.t >= since)
        ]
        if times:
            ax.plot(
                numpy.interp(times, trajectory.t, x),
                numpy.interp(times, trajectory.t, y),
                "o",
                ms=3.2,
                mew=0.9,
                color=color,
                mfc=color if filled else "white",
                zorder=3,
                label=f"_{mode}",
            )
