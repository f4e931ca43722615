"""Poincaré sections: where a signal passes a value, with time and state located."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import Any

import numpy

from ..errors import SimulationError
from ..simulation import Trajectory
from .again import again

Array = numpy.ndarray

NODES = 12
# Rows nearer to each other than this share of their time are one instant: no run fits between.
LEAST = 1e-12


@dataclass(frozen=True, eq=False)
class Section:
    """Crossings of a section by a run.

    Attributes
    ----------
    signal : str
    value : float
    direction : int
        1 upwards, -1 downwards, 0 both.
    times : (k,) array
        Of the crossings, s.
    states : (k, n) array
    names : tuple of str
        Of the states.
    run : Trajectory
    """

    signal: str
    value: float
    direction: int
    times: Array
    states: Array
    names: tuple[str, ...]
    run: Trajectory = field(repr=False)

    def __len__(self) -> int:
        return len(self.times)

    @property
    def periods(self) -> Array:
        """Times from crossing to crossing, s, shape (k - 1,)."""
        return numpy.diff(self.times)

    def return_map(self, state: str, step: int = 1) -> tuple[Array, Array]:
        """Return a state at each crossing, and at the crossing so many later.

        Parameters
        ----------
        state : str
        step : int

        Returns
        -------
        before, after : (k - step,) array
            A periodic orbit is where they are equal.

        Raises
        ------
        SimulationError
            For a name that is no state, or fewer crossings than that.
        """
        if state not in self.names:
            raise SimulationError(f"{state!r} is no state; the section has {', '.join(self.names)}")
        if not 1 <= step < len(self):
            raise SimulationError(
                f"a return map over {step} crossings needs more than {len(self)} of them; "
                f"simulate longer"
            )
        values = self.states[:, self.names.index(state)]
        return values[:-step], values[step:]


def poincare_section(
    trajectory: Trajectory,
    signal: str,
    value: float = 0.0,
    direction: int = 1,
    *,
    start: float | None = None,
    rtol: float = 1e-10,
) -> Section:
    """Find where a signal passes a value, and locate time and state there.

    Between the two stored rows around a crossing the model is simulated again from the first
    one, at `rtol`, and interpolated by a polynomial, so that the crossing is as good as the row
    before it. Crossings between rows that come in pairs are not seen: store rows closely enough.

    Parameters
    ----------
    trajectory : Trajectory
    signal : str
        Any name that the trajectory knows.
    value : float
        SI.
    direction : {1, -1, 0}
        Upwards, downwards, both.
    start : float, optional
        Leave out what is before, s.
    rtol : float
        Of the short runs.

    Returns
    -------
    Section

    Raises
    ------
    SimulationError
        For a direction that is none of these.
    ParameterError
        For a signal that is not known.

    References
    ----------
    Hénon, On the numerical computation of Poincaré maps, Physica D 5 (1982) 412-414.

    Examples
    --------
    >>> from bondgraph import C, I, One, assemble, simulate
    >>> v = One("v")
    >>> pendulum = assemble("pendulum", v >> (I("m", 1), C("k", 1, initial=1)))
    >>> run = simulate(pendulum, 20, rtol=1e-10)
    >>> (poincare_section(run, "k.q").periods / numpy.pi).round(6).tolist()
    [2.0, 2.0]
    """
    if direction not in (-1, 0, 1):
        raise SimulationError(f"direction is {direction!r}; give 1 upwards, -1 downwards or 0")
    levels = trajectory[signal] - value
    times, states = [], []
    for place in _brackets(levels, direction):
        if start is not None and trajectory.t[place + 1] < start:
            continue
        time, state = _located(trajectory, signal, value, place, rtol)
        times.append(time)
        states.append(state)
    names = trajectory.states
    return Section(
        signal,
        float(value),
        direction,
        numpy.array(times),
        numpy.array(states).reshape(len(times), len(names)),
        names,
        trajectory,
    )


def _brackets(levels: Array, direction: int) -> list[int]:
    """Return the rows after which a level changes its sign in the direction asked for."""
    up = (levels[:-1] < 0) & (levels[1:] >= 0)
    down = (levels[:-1] > 0) & (levels[1:] <= 0)
    wanted = {1: up, -1: down, 0: up | down}[direction]
    return [int(place) for place in numpy.flatnonzero(wanted)]


def _located(
    run: Trajectory, signal: str, value: float, place: int, rtol: float
) -> tuple[float, Array]:
    """Return time and state of the crossing between two rows."""
    first, last = float(run.t[place]), float(run.t[place + 1])
    if _one_instant(first, last):  # both sides of an event
        return last, run.x[:, place + 1].copy()
    z = run.z[:, place] if len(run.z) else None
    nodes = _chebyshev(first, last)
    short = again(run, (first, last), run.x[:, place], z, nodes, rtol)
    if not short.outcome.ok or len(short.t) != len(nodes):
        return _straight(run, signal, value, place)
    levels = short[signal] - value
    cuts = numpy.array([e.t for e in short.events if first < e.t < last])
    if cuts.size:  # polynomials end at an event: go on from the last one before the crossing
        nodes, levels, short = _piece(run, (first, last), cuts, signal, value, short, rtol)
    time = _root(nodes, levels)
    states = numpy.array([_polynomial(nodes, row, time) for row in short.x])
    return time, states


def _piece(
    run: Trajectory,
    span: tuple[float, float],
    cuts: Array,
    signal: str,
    value: float,
    short: Trajectory,
    rtol: float,
) -> tuple[Array, Array, Trajectory]:
    """Return nodes, levels and run of the piece between events in which the signal crosses."""
    ends = [span[0], *numpy.unique(cuts).tolist(), span[1]]
    x, z = short.x[:, 0], short.z[:, 0] if len(short.z) else None
    for low, high in itertools.pairwise(ends):
        if _one_instant(low, high):
            continue
        nodes = _chebyshev(low, high)
        short = again(run, (low, high), x, z, nodes, rtol)
        levels = short[signal] - value
        if levels[0] * levels[-1] <= 0 or high == span[1]:
            break
        x, z = short.x_end, short.z_end if len(short.z) else None
    return nodes, levels, short


def _one_instant(low: float, high: float) -> bool:
    return high - low <= LEAST * max(abs(low), abs(high))


def _chebyshev(low: float, high: float) -> Array:
    """Return nodes of an interval, its ends among them."""
    angles = numpy.pi * numpy.arange(NODES) / (NODES - 1)
    nodes = (low + high) / 2 - (high - low) / 2 * numpy.cos(angles)
    nodes[0], nodes[-1] = low, high
    return nodes


def _polynomial(nodes: Array, values: Array, time: float) -> float:
    """Evaluate the polynomial through values at Chebyshev's nodes, by the barycentric formula."""
    near = numpy.flatnonzero(nodes == time)
    if near.size:
        return float(values[near[0]])
    weights = (-1.0) ** numpy.arange(len(nodes))
    weights[[0, -1]] /= 2
    weights /= time - nodes
    return float(weights @ values / weights.sum())


def _root(nodes: Array, levels: Array) -> float:
    """Return where the polynomial through levels is zero: between the first nodes that say so."""
    from scipy.optimize import brentq

    changes = numpy.flatnonzero(numpy.sign(levels[:-1]) * numpy.sign(levels[1:]) <= 0)
    if not changes.size:  # rounding took the crossing out of the interval
        return float(nodes[int(numpy.argmin(numpy.abs(levels)))])
    low, high = nodes[changes[0]], nodes[changes[0] + 1]
    if levels[changes[0]] == 0:
        return float(low)

    def level(time: float) -> float:
        return _polynomial(nodes, levels, time)

    return float(brentq(level, low, high, xtol=1e-15 * max(abs(high), 1e-300), rtol=1e-14))


def _straight(run: Trajectory, signal: str, value: float, place: int) -> tuple[float, Array]:
    """Join two rows by a straight line, where the model does not run between them."""
    ends: Any = run[signal][place : place + 2] - value
    share = ends[0] / (ends[0] - ends[1])
    t, x = run.t[place : place + 2], run.x[:, place : place + 2]
    return float(t[0] + share * (t[1] - t[0])), x[:, 0] + share * (x[:, 1] - x[:, 0])
