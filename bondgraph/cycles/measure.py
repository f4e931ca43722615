"""Limit cycles read off a run: period, scatter, how long it sticks, how far signals swing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy

from ..errors import SimulationError
from ..parameters import unknown_name
from ..simulation import Trajectory
from .sections import poincare_section

Array = numpy.ndarray

# A cycle may touch its mark more than once; of so many marks a period is looked for.
MOST_MARKS = 8
LEAST_PERIODS = 3


@dataclass(frozen=True)
class Amplitude:
    """How far a signal swings over the cycles looked at, in SI.

    Attributes
    ----------
    least, most, mean : float

    Examples
    --------
    >>> Amplitude(-1.0, 3.0, 1.2).peak_to_peak
    4.0
    """

    least: float
    most: float
    mean: float

    @property
    def peak_to_peak(self) -> float:
        """Most less least."""
        return self.most - self.least


@dataclass(frozen=True, eq=False)
class LimitCycle:
    """A cycle as a run shows it, over its last periods.

    Attributes
    ----------
    period : float
        Mean of the last periods, s.
    scatter : float
        Standard deviation of a single period, s.
    drift : float
        Change of the period from the first to the second half of the periods, over the period.
    tolerance : float
    mark : str
        What begins a period, in words.
    marks_per_period : int
        How often that happens in a period.
    times : (k + 1,) array
        Beginnings of the periods, s.
    held : dict of str to float
        By contact: share of the period in the mode of code 0, in which it is held.
    events_per_period : float
        Changes of mode of all contacts.
    run : Trajectory
    """

    period: float
    scatter: float
    drift: float
    tolerance: float
    mark: str
    marks_per_period: int
    times: Array
    held: Mapping[str, float]
    events_per_period: float
    run: Trajectory = field(repr=False)

    @property
    def frequency_hz(self) -> float:
        """One over the period, Hz."""
        return 1 / self.period

    @property
    def settled(self) -> bool:
        """Whether scatter and drift are within the tolerance."""
        return max(abs(self.drift), self.scatter / self.period) <= self.tolerance

    def amplitude(self, signal: str) -> Amplitude:
        """Return how far a signal swings over the cycles looked at.

        Parameters
        ----------
        signal : str
            Any name that the trajectory knows.

        Returns
        -------
        Amplitude
            An extreme between stored rows is that of a parabola through the three next to it.
        """
        run = self.run
        inside = (run.t >= self.times[0]) & (run.t <= self.times[-1])
        if inside.sum() < 3:
            raise SimulationError(
                f"the run has {inside.sum()} rows in the cycles looked at; store more of them"
            )
        t, y, codes = run.t[inside], run[signal][inside], run.codes[inside]
        mean = float(numpy.trapezoid(y, t) / (t[-1] - t[0]))
        return Amplitude(-_top(t, -y, codes), _top(t, y, codes), mean)


def limit_cycle(
    trajectory: Trajectory,
    element: str | None = None,
    mode: str = "stick",
    *,
    signal: str | None = None,
    value: float | None = None,
    periods: int = 4,
    tolerance: float = 1e-4,
) -> LimitCycle:
    """Measure the cycle that a run ends in.

    A period begins where a contact enters a mode, as it does at a located event. Where no contact
    does, or a signal is named, it begins where the signal passes a value upwards.

    Parameters
    ----------
    trajectory : Trajectory
    element : str, optional
        Contact to look at; the first that enters the mode unless given.
    mode : str
    signal : str, optional
        Begins periods in place of events; the first state unless given.
    value : float, optional
        That the signal passes; the mean of the last half of the run unless given.
    periods : int
        How many of the last periods to look at.
    tolerance : float
        Relative scatter and drift up to which the cycle counts as settled.

    Returns
    -------
    LimitCycle

    Raises
    ------
    SimulationError
        For a run with fewer than three periods, or an element without such a mode.

    Examples
    --------
    >>> from bondgraph import simulate
    >>> from bondgraph.models import bicycle_brake
    >>> run = simulate(bicycle_brake.graph(), 0.5, {"tau": 0.02}, rtol=1e-9)
    >>> cycle = limit_cycle(run)
    >>> round(cycle.frequency_hz, 6), cycle.settled, round(cycle.held["friction"], 2)
    (143.318344, True, 0.65)
    """
    if periods < 1:
        raise SimulationError(f"periods is {periods}; look at one at least")
    marks, words = _marks(trajectory, element, mode, signal, value)
    count = _marks_a_period(marks, tolerance)
    if len(marks) < LEAST_PERIODS * count + 1:
        raise SimulationError(
            f"run of {trajectory.model.equations.name!r}: {words} {len(marks)} times up to "
            f"{trajectory.t_end:g} s, which is no cycle to measure: it takes three periods; simulate "
            f"longer, or name a signal"
        )
    times = marks[::-1][::count][::-1][-periods - 1 :]
    lengths = numpy.diff(times)
    half = max(1, len(lengths) // 2)
    drift = float(lengths[-half:].mean() - lengths[:half].mean()) / float(lengths.mean())
    changes = sum(times[0] < event.t <= times[-1] for event in trajectory.events)
    return LimitCycle(
        float(lengths.mean()),
        float(lengths.std()),
        drift,
        tolerance,
        words,
        count,
        times,
        {name: _held(trajectory, name, times) for name in trajectory.model.contact_names},
        changes / len(lengths),
        trajectory,
    )


def _marks(
    run: Trajectory, element: str | None, mode: str, signal: str | None, value: float | None
) -> tuple[Array, str]:
    """Return the times that may begin a period, and what happens then."""
    contacts = run.model.contact_names
    if element is not None and element not in contacts:
        raise unknown_name("contact", element, contacts)
    entered = [
        event for event in run.events if event.to_mode == mode and element in (None, event.element)
    ]
    if signal is None and entered:
        name = element or entered[0].element
        times = [event.t for event in entered if event.element == name]
        return numpy.array(times), f"{name} enters {mode!r}"
    if element is not None:
        raise SimulationError(
            f"{element!r} never enters mode {mode!r} in this run; name another mode or a signal",
            elements=[element],
        )
    if signal is None and not run.states:
        raise SimulationError("a model without states has no cycle of its own; name a signal")
    name = signal or run.states[0]
    late = run.t >= (run.t[0] + run.t[-1]) / 2
    rows, at = run[name][late], run.t[late]
    level = value
    if level is None:
        level = float(numpy.trapezoid(rows, at) / (at[-1] - at[0])) if len(at) > 1 else 0.0
    found = poincare_section(run, name, level)
    return found.times, f"{name} passes {level:.6g} upwards"


def _marks_a_period(marks: Array, tolerance: float) -> int:
    """Return after how many marks the intervals repeat; one where they never do."""
    lengths = numpy.diff(marks)
    best, least = 1, numpy.inf
    for count in range(1, MOST_MARKS + 1):
        if len(lengths) < 3 * count:
            break
        sums = lengths[-3 * count :].reshape(3, count)
        spread = float(numpy.ptp(sums, axis=0).max() / sums.sum(axis=1).mean())
        if spread <= tolerance:
            return count
        if spread < 0.1 * least:
            best, least = count, spread
    return best if least < 0.01 else 1


def _held(run: Trajectory, name: str, times: Array) -> float:
    """Return the share of time in which a contact is in its mode of code 0."""
    graph = run.model.equations.graph
    own = [event for event in run.events if event.element == name]
    column = run.model.contact_names.index(name)
    first, last = float(times[0]), float(times[-1])
    code = int(run.codes[0, column]) if len(run.codes) else 1
    total, since = 0.0, first
    for event in own:
        if event.t <= first:
            code = graph[name].code(event.to_mode)
            continue
        if event.t > last:
            break
        total += (event.t - since) * (code == 0)
        code, since = graph[name].code(event.to_mode), event.t
    return (total + (last - since) * (code == 0)) / (last - first)


def _top(t: Array, y: Array, codes: Array) -> float:
    """Return the highest value, by a parabola where the rows around it are of one mode."""
    at = int(numpy.argmax(y))
    highest = float(y[at])
    if not 0 < at < len(y) - 1 or (codes[at - 1 : at + 2] != codes[at]).any():
        return highest
    before, after = t[at - 1] - t[at], t[at + 1] - t[at]
    if not (before < 0 < after):
        return highest
    low, high = (y[at - 1] - y[at]) / before, (y[at + 1] - y[at]) / after
    bend = (high - low) / (after - before)
    slope = low - bend * before
    return float(highest - slope**2 / (4 * bend)) if bend < 0 else highest
