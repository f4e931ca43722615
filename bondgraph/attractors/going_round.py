"""Whether a run goes round a cycle: its periods, the closed orbit near it, what is left of the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy

from ..cycles import LimitCycle, PeriodicOrbit, limit_cycle, periodic_orbit
from ..errors import BondGraphError, SimulationError
from ..simulation import Trajectory
from .bench import Bench

Array = numpy.ndarray

# Crossings of a section kept for measuring a period, tried in turn.
CROSSINGS = (7, 26)
# Less motion than this, beside the states' sizes, is none.
NOISE = 1e-6
# A run is in a cycle if its swings are this near those of the closed orbit.
LIKE = 0.02
# Without an orbit, what is left of the way to a cycle, by the steps from period to period.
LEFT = 1e-3
# A double multiplier of one is known to about the root of what others are.
DOUBLE = 1e-4
# Shifted by what such a state gains in a period, the rates of a turning machine are the same, to
# this part of what they differ by on the way.
SHIFTED = 0.02
# Closing an orbit costs about as much as running so many periods for each state.
CLOSING = 25


@dataclass(frozen=True, eq=False)
class Round:
    """A cycle that a run goes round.

    Attributes
    ----------
    cycle : LimitCycle
        As the run shows it.
    part : Trajectory
        The part of the run that shows it.
    orbit : PeriodicOrbit or None
        Closed by Newton.
    known : int or None
        Place among the cycles known before.
    note : str
    """

    cycle: LimitCycle
    part: Trajectory
    orbit: PeriodicOrbit | None = None
    known: int | None = None
    note: str = ""


@dataclass(frozen=True, eq=False)
class Ways:
    """How cycles are recognised.

    Attributes
    ----------
    known : sequence of PeriodicOrbit
        Found before.
    orbits : bool
        Whether to close them by Newton.
    sizes : (n,) array
        Of the states.
    periods : float
        How many periods of a run the seconds left would pay, over one second of the model.
    """

    known: Sequence[PeriodicOrbit]
    orbits: bool
    sizes: Array
    periods: float


def round_of(bench: Bench, run: Trajectory, ways: Ways) -> tuple[Round | None, str]:
    """Return the cycle that a run goes round, or None and what is known instead.

    Parameters
    ----------
    bench : Bench
    run : Trajectory
        Rows of its last part, evenly spaced.
    ways : Ways

    Returns
    -------
    (Round or None, str)
    """
    sizes, watched = ways.sizes, bench.moving & ~onward(run, ways.sizes)
    candidate = _measured(bench, run, sizes, watched)
    if candidate is None:
        return None, ""
    cycle, part, swings = candidate
    seen = cycle, swings[1]
    turning = bench.moving & ~watched
    if turning.any():
        gain = _gain(part, cycle) * turning
        names = ", ".join(n for n, t in zip(bench.names, turning, strict=True) if t)
        if not _same_shifted(bench, part, gain):
            return None, f"{names} goes on and on, and the motion changes with it"
        said = f"{names} goes on by {', '.join(f'{g:.6g}' for g in gain[turning])} in a period"
        return _repeating(part, cycle, (sizes, watched), f"{said}, so the orbit was not closed")
    place = next(
        (i for i, orbit in enumerate(ways.known) if alike(bench, seen, orbit, sizes)), None
    )
    if place is not None:
        return Round(cycle, part, known=place), ""
    said = ""
    if bench.free:
        said = f"{', '.join(sorted(bench.free))} drift, so the orbit was not closed"
    elif ways.orbits and ways.periods < CLOSING * cycle.period * (len(bench.names) + 1):
        said = "the seconds left were too few to close the orbit"
    elif ways.orbits:
        try:
            orbit = periodic_orbit(None, part, cycle.period)
        except (BondGraphError, numpy.linalg.LinAlgError) as error:
            said = f"the orbit was not closed: {error}"
        else:
            if not alike(bench, seen, orbit, sizes):
                return None, "the run is not yet near a cycle"
            if verdict(orbit) == "unstable":
                return None, f"it passed a cycle of {orbit.frequency_hz:.6g} Hz that repels"
            return Round(cycle, part, orbit), ""
    return _repeating(part, cycle, (sizes, watched), said)


def _repeating(
    part: Trajectory, cycle: LimitCycle, measure: tuple[Array, Array], said: str
) -> tuple[Round | None, str]:
    """Accept a cycle that no orbit proves, where hardly anything is left of the way to it."""
    left = _way_left(part, cycle, *measure)
    if left <= LEFT:
        return Round(cycle, part, note=said), ""
    return None, f"its periods of {cycle.period:.4g} s repeat to {left:.2g} of their size"


def periods_seen(bench: Bench, run: Trajectory, sizes: Array) -> int:
    """Return how many periods the rows of a run may show.

    Parameters
    ----------
    bench : Bench
    run : Trajectory
    sizes : (n,) array

    Returns
    -------
    int
    """
    late = [(event.element, event.to_mode) for event in run.events if event.t > run.t[0]]
    if late:
        return max(late.count(item) for item in set(late))
    signal = _liveliest(bench, run, sizes, bench.moving & ~onward(run, sizes))
    return 0 if signal is None else len(signal[2])


# ---------------------------------------------------------------------- states that go on


def onward(run: Trajectory, sizes: Array) -> Array:
    """Return which states go on and on in the rows of a run, like an angle, (n,) bool array.

    What they were in the first third of the rows they are never again in the last.
    """
    third = run.x.shape[1] // 3
    if not third:
        return numpy.zeros(len(run.x), dtype=bool)
    early, late = run.x[:, :third], run.x[:, -third:]
    gone = (late.min(axis=1) > early.max(axis=1)) | (late.max(axis=1) < early.min(axis=1))
    return gone & (numpy.ptp(run.x, axis=1) > NOISE * sizes)


def _gain(part: Trajectory, cycle: LimitCycle) -> Array:
    """Return by how much each state is more after the last period than before it."""
    last = float(cycle.times[-1])
    ends = [[numpy.interp(t, part.t, row) for row in part.x] for t in (last - cycle.period, last)]
    return numpy.subtract(ends[1], ends[0])


def _same_shifted(bench: Bench, part: Trajectory, gain: Array) -> bool:
    """Whether rates are the same after a whole shift, though not after a part of it.

    So it is with a machine that has turned once; what merely creeps is not the same.
    """
    if len(part.z) or bench.model.switched:
        return False
    equations, modes = bench.model.equations, bench.model.mode_set
    u = [bench.inputs.get(symbol.name, 0.0) for symbol in equations.inputs]
    p = [part.parameters[symbol.name] for symbol in equations.parameters]
    whole, parts = 0.0, 0.0
    for place in numpy.linspace(0, len(part.t) - 1, 5).astype(int):
        codes = part.codes[place]
        mask = sum(1 << int(bit) for bit in numpy.flatnonzero(codes == 0))
        function = modes.signals(mask, modes.equations(mask).derivatives)
        x = part.x[:, [place]] + gain[:, None] * numpy.array([0.0, 0.27, 0.5, 0.73, 1.0])
        width = numpy.ones(x.shape[1])
        columns = (part.t[place], u, p, codes)
        t, u_, p_, s = (numpy.multiply.outer(numpy.atleast_1d(c), width) for c in columns)
        found = function(t, x, u_, p_, s)
        size = numpy.abs(found).max(axis=1, keepdims=True)
        off = numpy.abs(found - found[:, :1]) / numpy.where(size > 0, size, 1.0)
        whole, parts = max(whole, float(off[:, -1].max())), max(parts, float(off[:, 1:-1].max()))
    return whole <= SHIFTED * parts


# ---------------------------------------------------------------------- as the run shows it


def verdict(orbit: PeriodicOrbit) -> str:
    """Return whether an orbit attracts; one among others of any size is ``"undecided"``.

    There two multipliers are one, and rounding moves each by its own root.
    """
    sizes = numpy.abs(orbit.floquet.others)
    if orbit.verdict == "unstable" and sizes.max(initial=0.0) < 1 + DOUBLE:
        return "undecided"
    return orbit.verdict


def _measured(
    bench: Bench, run: Trajectory, sizes: Array, watched: Array
) -> tuple[LimitCycle, Trajectory, Array] | None:
    """Return a repeating motion at the end of a run, and the part of the run that shows it."""
    graph, middle = bench.graph, float(run.t[0])
    late = [event for event in run.events if event.t > middle]
    marks: dict[tuple[str, str], list[float]] = {}
    for event in late:
        marks.setdefault((event.element, event.to_mode), []).append(event.t)
    chosen = sorted(marks, key=lambda key: (graph[key[0]].code(key[1]) != 0, -len(marks[key]), key))
    for name, mode in chosen[:2]:
        times = numpy.array(marks[name, mode])
        for count in CROSSINGS:
            if len(times) <= 3:
                break
            part = _since(run, times[-min(count, len(times))])
            found = _cycle(part, element=name, mode=mode)
            swings = None if found is None else _swings(bench, part, found)
            if found and swings is not None and _steady_swing(swings, sizes, watched):
                return found, part, swings
    if late and chosen and len(marks[chosen[0]]) > 3:
        return None
    signal = _liveliest(bench, run, sizes, watched)
    if signal is None:
        return None
    name, level, times = signal
    for count in CROSSINGS:
        if len(times) <= 3:
            break
        part = _since(run, times[-min(count, len(times))])
        found = _cycle(part, signal=name, value=level)
        swings = None if found is None else _swings(bench, part, found)
        if found and swings is not None and _steady_swing(swings, sizes, watched):
            return found, part, swings
    return None


def _cycle(part: Trajectory, **how: object) -> LimitCycle | None:
    try:
        found = limit_cycle(part, periods=3, tolerance=LIKE / 4, **how)  # type: ignore[arg-type]
    except SimulationError:
        return None
    return found if found.settled else None


def _since(run: Trajectory, t: float) -> Trajectory:
    """Return the rows and events of a run from a little before a time on."""
    first = max(0, int(numpy.searchsorted(run.t, t, side="left")) - 2)
    begin = run.t[first]
    z = run.z[:, first:] if run.z.shape[1] == len(run.t) else run.z
    return replace(
        run,
        t=run.t[first:],
        x=run.x[:, first:],
        codes=run.codes[first:],
        z=z,
        changes=[change for change in run.changes if change.t > begin],
    )


def _liveliest(
    bench: Bench, run: Trajectory, sizes: Array, watched: Array
) -> tuple[str, float, Array] | None:
    """Return the state that moves most beside its size, a level, and when it passes that upwards."""
    best: tuple[float, int] | None = None
    for place in numpy.flatnonzero(watched):
        row = run.x[place]
        swing = float(numpy.ptp(row))
        if not swing > NOISE * sizes[place]:
            continue
        moved = swing / float(numpy.abs(row).max())
        if best is None or moved > best[0] * 1.01:
            best = moved, int(place)
    if best is None:
        return None
    row = run.x[best[1]]
    level = float(numpy.trapezoid(row, run.t) / (run.t[-1] - run.t[0]))
    ups = numpy.flatnonzero((row[:-1] < level) & (row[1:] >= level))
    return bench.names[best[1]], level, run.t[ups]


def _swings(bench: Bench, part: Trajectory, cycle: LimitCycle) -> Array | None:
    """Return least and most of each state in the last period but one and in the last, (2, 2, n) array.

    The run is made again there, since a motion of bursts may hide between its rows.
    """
    last, period = float(cycle.times[-1]), cycle.period
    first = int(numpy.searchsorted(part.t, last - 2 * period, side="right")) - 1
    if first < 0:
        return None
    symbols = bench.model.equations.algebraic
    z = part.z[:, first] if len(part.z) else ()
    guess = {symbol.name: float(v) for symbol, v in zip(symbols, z, strict=False)}
    run = bench.run(part.parameters, part.x[:, first], (float(part.t[first]), last), guess=guess)
    found = []
    for begin in (last - 2 * period, last - period):
        here = run.x[:, (run.t >= begin) & (run.t <= begin + period)]
        if not here.shape[1] or not run.outcome.ok:
            return None
        found.append([here.min(axis=1), here.max(axis=1)])
    return numpy.array(found)


def _steady_swing(swings: Array, largest: Array, watched: Array) -> bool:
    """Whether the swings of the last two periods are alike."""
    early, late = swings
    swing = numpy.maximum(late[1] - late[0], early[1] - early[0])
    sizes = numpy.maximum(swing, 1e-3 * numpy.maximum(numpy.abs(late).max(axis=0), largest))
    off = numpy.abs(late - early) / numpy.where(sizes > 0, sizes, 1.0)
    return bool(off[:, watched].max(initial=0.0) <= 2.5 * LIKE)


def alike(
    bench: Bench, seen: tuple[LimitCycle, Array], orbit: PeriodicOrbit, largest: Array
) -> bool:
    """Whether the last period of a run is near a closed orbit.

    Parameters
    ----------
    bench : Bench
    seen : (LimitCycle, (2, n) array)
        Cycle of the run, and least and most of each state in its last period.
    orbit : PeriodicOrbit
    largest : (n,) array
        Sizes of the states: a small part of these is no difference.

    Returns
    -------
    bool
    """
    cycle, swings = seen
    if abs(cycle.period / orbit.period - 1) > LIKE:
        return False
    whole = orbit.run.x
    own = numpy.array([whole.min(axis=1), whole.max(axis=1)])
    width = own[1] - own[0]
    base = numpy.maximum(0.05 * numpy.abs(own).max(axis=0), 1e-3 * largest)
    sizes = numpy.maximum(width, base)
    off = numpy.abs(swings - own) / numpy.where(sizes > 0, sizes, 1.0)
    return bool(off[:, bench.moving].max(initial=0.0) <= LIKE)


def _way_left(part: Trajectory, cycle: LimitCycle, sizes: Array, watched: Array) -> float:
    """Return how far a run still is from a cycle, beside its size, by its steps from period to period."""
    from ..cycles.again import again

    period, last = cycle.period, float(cycle.times[-1])
    times = last - period * (numpy.array([3.0, 2.0, 1.0]) + 0.37) + period
    if times[0] <= part.t[0]:
        return numpy.inf
    z = part.z[:, 0] if len(part.z) else None
    try:
        run = again(part, (float(part.t[0]), float(times[-1])), part.x[:, 0], z, times, 1e-10)
    except SimulationError:
        return numpy.inf
    swing = numpy.maximum(numpy.ptp(part.x, axis=1), 1e-3 * sizes)
    size = numpy.where(swing > 0, swing, 1.0)[watched]
    steps = numpy.abs(numpy.diff(run.x, axis=1)[watched] / size[:, None]).max(axis=0)
    if len(steps) < 2:
        return numpy.inf
    if steps[1] < 1e-6:
        return float(steps[1])
    ratio = steps[1] / max(steps[0], 1e-300)
    return float(steps[1] / (1 - ratio)) if ratio < 1 else numpy.inf
