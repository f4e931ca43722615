"""One run until it has settled: at rest, in a cycle, beyond all bounds, or not within the horizon."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy

from ..cycles import LimitCycle, PeriodicOrbit, limit_cycle, periodic_orbit
from ..errors import BondGraphError, SimulationError
from ..simulation import Outcome, Trajectory
from .bench import Bench
from .rest import FREE, Rest, maybe_rest

Array = numpy.ndarray

ROWS = 1500
# Crossings of a section kept for measuring a period, tried in turn.
CROSSINGS = (7, 26)
# Distances beside the states' sizes: so near a stable steady state a run returns if it shrinks,
# and so near whatever it does.
NEAR, THERE = 1e-3, 1e-7
# With more periods than this in the rows, the next stage's rows are not spread any wider.
ENOUGH = 12
# A run is in a cycle if its swings are this near those of the closed orbit.
LIKE = 0.02
# Without an orbit, what is left of the way to a cycle, by the steps from period to period.
LEFT = 1e-3
# A double multiplier of one is known to about the root of what others are.
DOUBLE = 1e-4
# A state so many times the largest it began with has no bound.
BEYOND = 1e6
# While contacts go on changing their modes a run gets so many times its horizon.
PATIENCE = 50.0


@dataclass(frozen=True)
class Clock:
    """Lengths of runs, and when the seconds allowed are used up.

    Attributes
    ----------
    first, horizon : float
        Length of the first stage and of all of them, s of the model.
    until : float
        Processor time at which no new stage begins, s.
    rtol : float
    """

    first: float
    horizon: float
    until: float
    rtol: float = 1e-8

    @property
    def left(self) -> float:
        """Seconds of the processor left."""
        return self.until - time.process_time()


@dataclass(frozen=True, eq=False)
class Settled:
    """Where a run went.

    Attributes
    ----------
    kind : str
        ``"steady"``, ``"cycle"``, ``"unbounded"``, ``"stopped"`` or ``"unsettled"``.
    run : Trajectory
        Its last stage.
    t_end : float
        s since its start.
    rest : Rest or None
    cycle : LimitCycle or None
        As the run shows it.
    orbit : PeriodicOrbit or None
        Closed by Newton.
    known : int or None
        Place among the cycles that were known before.
    note : str
    entered : dict of str to int
        How often each contact was entered into the mode of code 0.
    """

    kind: str
    run: Trajectory
    t_end: float
    rest: Rest | None = None
    cycle: LimitCycle | None = None
    orbit: PeriodicOrbit | None = None
    known: int | None = None
    note: str = ""
    entered: dict[str, int] = field(default_factory=dict)


def clock_for(poles: Array, horizon: float | None, **limits: float) -> Clock:
    """Choose lengths from the eigenvalues: periods and the slowest decay.

    Parameters
    ----------
    poles : (k,) complex array
        Of the steady state, or of the start where there is none.
    horizon : float, optional
        As the user wants it, s.
    **limits
        `until` and `rtol` of the clock.

    Returns
    -------
    Clock
    """
    sizes = numpy.abs(poles)
    alive = poles[sizes > FREE * sizes.max(initial=0.0)]
    if not len(alive):
        slow = decay = 1.0
    else:
        waves = alive[numpy.abs(alive.imag) > 0.05 * numpy.abs(alive)]
        base = numpy.abs(waves.imag) if len(waves) else numpy.abs(alive)
        slow = float(2 * numpy.pi / base.min())
        real = numpy.abs(alive.real)
        decay = float(1 / max(real.min(), 1e-4 / slow))
    first = max(12 * slow, min(2 * decay, 60 * slow))
    last = max(600 * slow, min(60 * decay, 20_000 * slow)) if horizon is None else horizon
    return Clock(min(first, last), last, **limits)


def settle(
    bench: Bench,
    values: dict[str, float],
    x: Array,
    clock: Clock,
    sizes: Array,
    known: Sequence[PeriodicOrbit] = (),
    orbits: bool = True,
) -> Settled:
    """Run from states until it is clear where that leads.

    Parameters
    ----------
    bench : Bench
    values : dict of str to float
        All parameters.
    x : (n,) array
        States at the start.
    clock : Clock
    sizes : (n,) array
        Of the states; less than a part of these is no motion.
    known : sequence of PeriodicOrbit
        Cycles found before, which need no second proof.
    orbits : bool
        Whether to prove a cycle by closing it.

    Returns
    -------
    Settled
    """
    t, length, look = 0.0, clock.first, clock.first / 2
    notes: list[str] = []
    largest = numpy.maximum(numpy.abs(x), sizes)
    entered = dict.fromkeys(bench.model.contact_names, 0)
    guess: dict[str, float] = {}
    while True:
        rows = numpy.linspace(t + length - look, t + length, ROWS)
        run = bench.run(
            values, x, (t, t + length), rows=rows, rtol=clock.rtol, seconds=clock.left, guess=guess
        )
        _count(run, entered)
        ended = _ended(bench, run, largest)
        if ended is not None:
            kind, note = ended
            return Settled(kind, run, run.t_end, note=note, entered=entered)
        rest, note = _at_rest(bench, values, run, largest)
        if rest is not None or _still(bench, run, x, largest):
            return Settled("steady", run, run.t_end, rest, note=note, entered=entered)
        found = _in_cycle(bench, run, largest, (known, orbits), notes)
        if found is not None:
            return replace(found, entered=entered)
        x, t = run.x_end, t + length
        guess = {
            s.name: float(v)
            for s, v in zip(bench.model.equations.algebraic, run.z_end, strict=False)
        }
        limit = clock.horizon * (PATIENCE if run.events else 1.0)
        length = min(2 * length, max(limit - t, 0.0))
        look = min(look if _periods_seen(bench, run, largest) > ENOUGH else 2 * look, length / 2)
        if length < clock.first / 2 or clock.left <= 0:
            spent = clock.left <= 0
            why = "the seconds allowed are used up" if spent else "the horizon ended"
            said = "; ".join(dict.fromkeys(notes))
            note = f"after {t:.4g} s {why} and the run had not settled{': ' if said else ''}{said}"
            return Settled("unsettled", run, t, note=note, entered=entered)


def _count(run: Trajectory, entered: dict[str, int]) -> None:
    graph = run.model.equations.graph
    for event in run.events:
        entered[event.element] += graph[event.element].code(event.to_mode) == 0


def _ended(bench: Bench, run: Trajectory, largest: Array) -> tuple[str, str] | None:
    """Return kind and note of a run that went no further, or beyond all bounds."""
    outcome = run.outcome
    if outcome is Outcome.DIVERGED:
        return "unbounded", ""
    if outcome is Outcome.TIME_BUDGET:
        return "unsettled", f"the seconds allowed were used up at {run.t_end:.4g} s"
    sizes, ends = largest[bench.moving], numpy.abs(run.x_end)[bench.moving]
    base = numpy.where(sizes > 0, sizes, 1.0)
    grown = bool((ends > BEYOND * base).any())
    if grown and len(run.t) > 2:
        late = numpy.abs(run.x[bench.moving]) / base[:, None]
        grown = late[:, len(run.t) // 2 :].max() > 1.5 * late[:, : len(run.t) // 2].max()
    if grown:
        return "unbounded", ""
    if outcome is Outcome.NON_FINITE and (ends > 1e3 * base).any():
        return "unbounded", ""
    return (
        None if outcome.ok else ("stopped", f"{outcome.value} at {run.t_end:.4g} s: {run.advice}")
    )


# ---------------------------------------------------------------------- at rest


def _at_rest(
    bench: Bench, values: dict[str, float], run: Trajectory, largest: Array
) -> tuple[Rest | None, str]:
    """Return the steady state that a run has come to, if it has, or why that is not known."""
    if any(event.t > run.t[0] for event in run.events):
        return None, ""
    graph = bench.graph
    modes = {
        name: graph[name].label(int(code))
        for name, code in zip(bench.model.contact_names, run.codes_end, strict=True)
    }
    late = run.x[:, 2 * len(run.t) // 3 :]
    sizes = numpy.maximum(largest, numpy.abs(late).max(axis=1, initial=0.0))
    sizes = numpy.where(sizes > 0, sizes, 1.0)[bench.moving]
    moved = numpy.ptp(late, axis=1)[bench.moving] / sizes
    if moved.max(initial=0.0) > 10 * NEAR:
        return None, ""
    rest, reason = maybe_rest(bench, values, run.x_end, modes)
    if rest is None:
        return None, f"small motions about it are not known: {reason}"
    if rest.modes != modes:
        return None, "small motions about it are not known: its contacts are between two modes"
    away = (numpy.abs(run.x - rest.vector[:, None])[bench.moving] / sizes[:, None]).max(
        axis=0, initial=0.0
    )
    third = max(1, len(away) // 3)
    before, after = float(away[:third].max()), float(away[-third:].max())
    if after <= THERE:
        return rest, ""
    poles = numpy.abs(rest.poles.real)
    span = float(run.t[-1] - run.t[0]) * 2 / 3
    slowest = float(
        poles[poles > FREE * numpy.abs(rest.poles).max(initial=0.0)].min(initial=numpy.inf)
    )
    shrinks = after <= before * (1 - 0.3 * (1 - numpy.exp(-slowest * span)))
    return (rest, "") if after <= NEAR and rest.stable and shrinks else (None, "")


def _still(bench: Bench, run: Trajectory, begin: Array, largest: Array) -> bool:
    """Whether nothing has moved since the stage before, whatever small motions do."""
    if run.t_end < 2 * (run.t_end - run.t[0]) or any(event.t > run.t[0] for event in run.events):
        return False
    sizes = numpy.where(largest > 0, largest, 1.0)[bench.moving, None]
    points = numpy.column_stack([begin, run.x])[bench.moving]
    moved = numpy.ptp(points, axis=1, keepdims=True) / sizes
    return bool(moved.max(initial=0.0) <= THERE)


# ---------------------------------------------------------------------- in a cycle


def _in_cycle(
    bench: Bench,
    run: Trajectory,
    sizes: Array,
    how: tuple[Sequence[PeriodicOrbit], bool],
    notes: list[str],
) -> Settled | None:
    known, orbits = how
    candidate = _measured(bench, run, sizes)
    if candidate is None:
        return None
    cycle, part = candidate
    place = next(
        (i for i, orbit in enumerate(known) if alike(bench, part, cycle, orbit, sizes)), None
    )
    if place is not None:
        return Settled("cycle", part, run.t_end, cycle=cycle, known=place)
    if bench.free:
        said = f"{', '.join(sorted(bench.free))} drift, so the orbit was not closed"
    elif orbits:
        try:
            orbit = periodic_orbit(None, part, cycle.period)
        except (BondGraphError, numpy.linalg.LinAlgError) as error:
            said = f"the orbit was not closed: {error}"
        else:
            if not alike(bench, part, cycle, orbit, sizes):
                notes.append("the run is not yet near a cycle")
                return None
            if verdict(orbit) == "unstable":
                notes.append(f"it passed a cycle of {orbit.frequency_hz:.6g} Hz that repels")
                return None
            return Settled("cycle", part, run.t_end, cycle=cycle, orbit=orbit)
    else:
        said = ""
    left = _way_left(bench, part, cycle, sizes)
    if left <= LEFT:
        return Settled("cycle", part, run.t_end, cycle=cycle, note=said)
    notes.append(f"its periods of {cycle.period:.4g} s repeat to {left:.2g} of their size")
    return None


def _periods_seen(bench: Bench, run: Trajectory, sizes: Array) -> int:
    """Return how many periods the rows of a run may show."""
    late = [(event.element, event.to_mode) for event in run.events if event.t > run.t[0]]
    if late:
        return max(late.count(item) for item in set(late))
    signal = _liveliest(bench, run, sizes)
    return 0 if signal is None else len(signal[2])


def verdict(orbit: PeriodicOrbit) -> str:
    """Return whether an orbit attracts; one among others of any size is ``"undecided"``.

    There two multipliers are one, and rounding moves each by its own root.
    """
    sizes = numpy.abs(orbit.floquet.others)
    if orbit.verdict == "unstable" and sizes.max(initial=0.0) < 1 + DOUBLE:
        return "undecided"
    return orbit.verdict


def _measured(bench: Bench, run: Trajectory, sizes: Array) -> tuple[LimitCycle, Trajectory] | None:
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
            if found is not None and _steady_swing(bench, part, found, sizes):
                return found, part
    if late and chosen and len(marks[chosen[0]]) > 3:
        return None
    signal = _liveliest(bench, run, sizes)
    if signal is None:
        return None
    name, level, times = signal
    for count in CROSSINGS:
        if len(times) <= 3:
            break
        part = _since(run, times[-min(count, len(times))])
        found = _cycle(part, signal=name, value=level)
        if found is not None and _steady_swing(bench, part, found, sizes):
            return found, part
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


def _liveliest(bench: Bench, run: Trajectory, sizes: Array) -> tuple[str, float, Array] | None:
    """Return the state that moves most beside its size, a level, and when it passes that upwards."""
    best: tuple[float, int] | None = None
    for place in numpy.flatnonzero(bench.moving):
        row = run.x[place]
        swing = float(numpy.ptp(row))
        if not swing > 10 * THERE * sizes[place]:
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


def _steady_swing(bench: Bench, part: Trajectory, cycle: LimitCycle, largest: Array) -> bool:
    """Whether the swings of the last two periods are alike."""
    late, early = (
        _extremes(part, float(end) - cycle.period, float(end))
        for end in (cycle.times[-1], cycle.times[-2])
    )
    if late is None or early is None:
        return False
    swing = numpy.maximum(late[1] - late[0], early[1] - early[0])
    sizes = numpy.maximum(swing, 1e-3 * numpy.maximum(numpy.abs(late).max(axis=0), largest))
    off = numpy.abs(late - early) / numpy.where(sizes > 0, sizes, 1.0)
    return bool(off[:, bench.moving].max(initial=0.0) <= 2.5 * LIKE)


def _extremes(run: Trajectory, begin: float, end: float) -> Array | None:
    """Return least and most of each state between two times, (2, n) array."""
    here = (run.t >= begin) & (run.t <= end)
    if here.sum() < 5:
        return None
    part = run.x[:, here]
    return numpy.array([part.min(axis=1), part.max(axis=1)])


def alike(
    bench: Bench, part: Trajectory, cycle: LimitCycle, orbit: PeriodicOrbit, largest: Array
) -> bool:
    """Whether the last period of a run is near a closed orbit.

    Parameters
    ----------
    bench : Bench
    part : Trajectory
    cycle : LimitCycle
        Of the run.
    orbit : PeriodicOrbit
    largest : (n,) array
        Sizes of the states: a small part of these is no difference.

    Returns
    -------
    bool
    """
    if abs(cycle.period / orbit.period - 1) > LIKE:
        return False
    last = float(cycle.times[-1])
    swings = _extremes(part, last - cycle.period, last)
    if swings is None:
        return False
    whole = orbit.run.x
    own = numpy.array([whole.min(axis=1), whole.max(axis=1)])
    width = own[1] - own[0]
    base = numpy.maximum(0.05 * numpy.abs(own).max(axis=0), 1e-3 * largest)
    sizes = numpy.maximum(width, base)
    off = numpy.abs(swings - own) / numpy.where(sizes > 0, sizes, 1.0)
    return bool(off[:, bench.moving].max(initial=0.0) <= LIKE)


def _way_left(bench: Bench, part: Trajectory, cycle: LimitCycle, sizes: Array) -> float:
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
    size = numpy.where(swing > 0, swing, 1.0)[bench.moving]
    steps = numpy.abs(numpy.diff(run.x, axis=1)[bench.moving] / size[:, None]).max(axis=0)
    if len(steps) < 2:
        return numpy.inf
    if steps[1] < 1e-6:
        return float(steps[1])
    ratio = steps[1] / max(steps[0], 1e-300)
    return float(steps[1] / (1 - ratio)) if ratio < 1 else numpy.inf
