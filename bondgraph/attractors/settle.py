"""One run until it has settled: at rest, in a cycle, beyond all bounds, or not within the horizon."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy

from ..cycles import LimitCycle, PeriodicOrbit
from ..simulation import Outcome, Trajectory
from .bench import Bench
from .going_round import Ways, periods_seen, round_of
from .rest import FREE, Rest, maybe_rest

Array = numpy.ndarray

ROWS = 1500
# Distances beside the states' sizes: so near a stable steady state a run returns if it shrinks,
# and so near whatever it does.
NEAR, THERE = 1e-3, 1e-7
# With more periods than this in the rows, the next stage's rows are not spread any wider.
ENOUGH = 12
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
        before = time.process_time()
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
        spent = max(time.process_time() - before, 1e-6)
        ways = Ways(known, orbits, largest, clock.left * length / spent)
        found, note = round_of(bench, run, ways)
        if found is not None:
            return Settled(
                "cycle",
                found.part,
                run.t_end,
                cycle=found.cycle,
                orbit=found.orbit,
                known=found.known,
                note=found.note,
                entered=entered,
            )
        notes += [note] if note else []
        x, t = run.x_end, t + length
        guess = {
            s.name: float(v)
            for s, v in zip(bench.model.equations.algebraic, run.z_end, strict=False)
        }
        limit = clock.horizon * (PATIENCE if run.events else 1.0)
        length = min(2 * length, max(limit - t, 0.0))
        look = min(look if periods_seen(bench, run, largest) > ENOUGH else 2 * look, length / 2)
        if length < clock.first / 2 or clock.left <= 0:
            why = "the seconds allowed are used up" if clock.left <= 0 else "the horizon ended"
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
