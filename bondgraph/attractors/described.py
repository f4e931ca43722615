"""From a settled run to an attractor in plain values, and whether two of them are one."""

from __future__ import annotations

from dataclasses import replace

import numpy

from ..cycles import Amplitude, LimitCycle, PeriodicOrbit
from ..simulation import Trajectory
from .bench import Bench
from .going_round import onward, verdict
from .rest import FREE, Rest
from .settle import Settled
from .value import Attractor

Array = numpy.ndarray

# Rows of a cycle once round.
ROUND = 1000
# Beside their sizes, attractors nearer than this are one.
SAME = 2e-3


def described(bench: Bench, values: dict[str, float], settled: Settled, start: str) -> Attractor:
    """Describe what a run ended in.

    Parameters
    ----------
    bench : Bench
    values : dict of str to float
        All parameters.
    settled : Settled
    start : str
        Name of the start.

    Returns
    -------
    Attractor
    """
    if settled.kind == "cycle":
        return _cycle(bench, values, settled, start)
    run, rest = settled.run, settled.rest
    notes = (settled.note,) if settled.note else ()
    if rest is not None:
        shown = {
            name: Amplitude(value, value, value)
            for name, value in (rest.outputs or _bound(bench, rest.states)).items()
        }
        held = {name: float(bench.graph[name].code(mode) == 0) for name, mode in rest.modes.items()}
        stable = True if rest.growth < 0 else None if rest.growth == 0 else False
        return _attractor(
            bench,
            run,
            "steady",
            (start,),
            shown,
            notes,
            held=held,
            stable=stable,
            states=dict(rest.states),
            modes=dict(rest.modes),
            isolated=rest.isolated,
        )
    with numpy.errstate(all="ignore"):
        shown = {name: _plain(run[name]) for name in _shown(bench)}
    states = dict(zip(bench.names, map(float, run.x_end), strict=True))
    modes = {
        name: bench.graph[name].label(int(code))
        for name, code in zip(bench.model.contact_names, run.codes_end, strict=True)
    }
    if settled.kind != "steady":
        modes = {}
    return _attractor(bench, run, settled.kind, (start,), shown, notes, states=states, modes=modes)


def _attractor(
    bench: Bench,
    run: Trajectory,
    kind: str,
    starts: tuple[str, ...],
    amplitudes: dict[str, Amplitude],
    notes: tuple[str, ...],
    **more: object,
) -> Attractor:
    plain: dict[str, object] = {
        "stable": None,
        "period": None,
        "events_per_period": None,
        "held": {},
        "states": {},
        "modes": {},
        "isolated": True,
        "multipliers": None,
    }
    return Attractor(
        kind=kind,
        starts=starts,
        amplitudes=amplitudes,
        units={name: run.unit(name) for name in amplitudes},
        run=run,
        notes=notes,
        **{**plain, **more},  # type: ignore[arg-type]
    )


def _shown(bench: Bench) -> tuple[str, ...]:
    return tuple(bench.model.equations.outputs) or tuple(
        name for name in bench.names if name not in bench.free
    )


def _bound(bench: Bench, states: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in states.items() if name not in bench.free}


def _plain(row: Array) -> Amplitude:
    good = row[numpy.isfinite(row)]
    if not good.size:
        return Amplitude(numpy.nan, numpy.nan, numpy.nan)
    return Amplitude(float(good.min()), float(good.max()), float(good.mean()))


def _cycle(bench: Bench, values: dict[str, float], settled: Settled, start: str) -> Attractor:
    orbit, seen = settled.orbit, settled.cycle
    assert seen is not None
    notes = [settled.note] if settled.note else []
    if orbit is None:
        run, period = settled.run, seen.period
        cycle, multipliers, stable = seen, None, None
    else:
        run, period = _round(bench, values, orbit), orbit.period
        cycle = _as_cycle(bench, run, period)
        multipliers = tuple(complex(m) for m in orbit.multipliers)
        stable = {"stable": True, "unstable": False}.get(verdict(orbit))
        notes += orbit.notes
    names = _shown(bench)
    states = dict(zip(bench.names, map(float, run.x[:, 0]), strict=True))
    return _attractor(
        bench,
        run,
        "cycle",
        (start,),
        {name: cycle.amplitude(name) for name in names},
        tuple(notes),
        stable=stable,
        period=period,
        events_per_period=cycle.events_per_period,
        held={name: float(share) for name, share in cycle.held.items()},
        states=states,
        multipliers=multipliers,
    )


def _round(bench: Bench, values: dict[str, float], orbit: PeriodicOrbit) -> Trajectory:
    """Run a closed orbit once round, in many rows."""
    x = numpy.array([orbit.start[name] for name in bench.names])
    guess = {
        symbol.name: float(value)
        for symbol, value in zip(
            bench.model.equations.algebraic,
            orbit.run.z[:, 0] if len(orbit.run.z) else (),
            strict=False,
        )
    }
    return bench.run(
        values, x, (0.0, orbit.period), rtol=1e-11, guess=guess, max_step=orbit.period / ROUND
    )


def _as_cycle(bench: Bench, run: Trajectory, period: float) -> LimitCycle:
    """Return what a run once round shows, as if measured on a long one."""
    held = {}
    for column, name in enumerate(bench.model.contact_names):
        changes = [event for event in run.events if event.element == name]
        code, since, total = int(run.codes[0, column]), float(run.t[0]), 0.0
        for event in changes:
            total += (event.t - since) * (code == 0)
            code, since = bench.graph[name].code(event.to_mode), event.t
        held[name] = float((total + (run.t[-1] - since) * (code == 0)) / period)
    times = numpy.array([run.t[0], run.t[-1]])
    return LimitCycle(period, 0.0, 0.0, 0.0, "", 1, times, held, float(len(run.events)), run)


def same(bench: Bench, one: Attractor, other: Attractor, sizes: Array) -> bool:
    """Whether two attractors are one; mirror images are not.

    Parameters
    ----------
    bench : Bench
    one, other : Attractor
    sizes : (n,) array
        Of the states over all starts: points nearer than a part of these are one.

    Returns
    -------
    bool
    """
    if one.kind != other.kind:
        return False
    if one.kind == "unbounded":
        return True
    if one.kind in ("unsettled", "stopped"):
        return one.notes[:1] == other.notes[:1]
    if one.kind == "steady":
        known = one.stable is not None and other.stable is not None
        if known and (one.modes != other.modes or one.isolated != other.isolated):
            return False
        off = numpy.abs(_point(one) - _point(other)) / numpy.where(sizes > 0, sizes, 1.0)
        return not one.isolated or bool(off[bench.moving].max(initial=0.0) <= SAME)
    if not one.isolated and not other.isolated:
        return True
    assert one.period is not None and other.period is not None
    if abs(one.period / other.period - 1) > SAME:
        return False
    return _near(bench, *(_swings(item) for item in (one, other)))


def _point(item: Attractor) -> Array:
    return numpy.array(list(item.states.values()))


def _swings(item: Attractor) -> Array:
    x, period = item.run.x, item.period
    assert period is not None
    late = x[:, item.run.t >= item.run.t[-1] - period * (1 + 1e-9)]
    turning = onward(item.run, numpy.zeros(len(x))) & (item.multipliers is None)
    late = numpy.where(turning[:, None], 0.0, late)  # how often it has turned is no matter
    return numpy.array([late.min(axis=1), late.max(axis=1)])


def _near(bench: Bench, one: Array, other: Array) -> bool:
    both = numpy.abs(numpy.concatenate([one, other]))
    swing = numpy.ptp(one, axis=0)
    size = numpy.where(swing > 1e-3 * both.max(axis=0), swing, both.max(axis=0))
    off = numpy.abs(one - other) / numpy.where(size > 0, size, 1.0)
    return bool(off[:, bench.moving].max(initial=0.0) <= SAME)


def among_many(item: Attractor, rest: Rest | None) -> Attractor:
    """Mark a cycle about a steady state without damping: others of any size lie beside it."""
    if rest is None or item.kind != "cycle" or item.stable is not None:
        return item
    sizes = numpy.abs(rest.poles)
    free = numpy.abs(rest.poles.real) <= FREE * sizes.max(initial=0.0)
    if rest.growth == 0 and (rest.poles.imag[free] != 0).any():
        return replace(item, isolated=False)
    return item


def merged(one: Attractor, start: str) -> Attractor:
    """Return an attractor with one more start that leads to it."""
    return replace(one, starts=(*one.starts, start))
