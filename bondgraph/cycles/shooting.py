"""Periodic orbits by shooting: the start that a run comes back to, through events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy

from ..errors import SimulationError
from ..graph import BondGraph
from ..simulation import CompiledModel, Trajectory
from .floquet import Floquet
from .flow import Setting, end_by_start, rates
from .guess import Guess, sizes, taken

Array = numpy.ndarray

LARGEST_TRIVIAL_ERROR = 1e-5
LEAST_SHARE = 1e-3
# Beside the states' own sizes: an orbit that moves less is a steady state.
STILL = 1e-6


@dataclass(frozen=True, eq=False)
class PeriodicOrbit:
    """A periodic orbit and what becomes of disturbances of it.

    Attributes
    ----------
    period : float
        s.
    start : dict of str to float
        States at `time`.
    time : float
        Time at the start, s.
    forced : bool
        Whether the period is that of an input.
    floquet : Floquet
    run : Trajectory
        Once round.
    iterations : int
    residual : float
        What the states are off after a period, beside their sizes.
    """

    period: float
    start: dict[str, float]
    time: float
    forced: bool
    floquet: Floquet
    run: Trajectory = field(repr=False)
    iterations: int
    residual: float

    @property
    def frequency_hz(self) -> float:
        """One over the period, Hz."""
        return 1 / self.period

    @property
    def multipliers(self) -> Array:
        """Floquet multipliers, largest first, (n,) complex array."""
        return self.floquet.multipliers

    @property
    def stable(self) -> bool:
        """Whether disturbances die out."""
        return self.floquet.stable

    @property
    def verdict(self) -> str:
        """``"stable"``, ``"unstable"`` or ``"undecided"``."""
        return self.floquet.verdict

    @property
    def notes(self) -> tuple[str, ...]:
        """What a careful reader should know."""
        said = []
        zeros, graph = self.floquet.zeros, self.run.model.equations.graph
        held = {
            event.element
            for event in self.run.events
            if graph[event.element].code(event.to_mode) == 0
        }
        if zeros and held:
            said.append(
                f"{zeros} of {len(self.multipliers)} multipliers {'is' if zeros == 1 else 'are'} zero: "
                f"while {', '.join(sorted(held))} holds its flow, what was different before is forgotten"
            )
        if self.verdict == "undecided":
            said.append("a multiplier is as good as one in size: the linear part does not decide")
        return tuple(said)


def periodic_orbit(
    graph: BondGraph | CompiledModel | None,
    guess: Trajectory | Mapping[Any, float],
    period: float | None = None,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, Any] | None = None,
    *,
    forced: bool = False,
    start: float = 0.0,
    rtol: float = 1e-12,
    tolerance: float = 1e-8,
    max_iterations: int = 30,
) -> PeriodicOrbit:
    """Find a periodic orbit, stable or not, by Newton on where a run ends.

    Parameters
    ----------
    graph : BondGraph, CompiledModel or None
        None with a Trajectory, whose model it is then.
    guess : Trajectory or mapping
        A run that ends near the orbit; or states, by name or symbol, near it.
    period : float, optional
        Guess of the period, s, read off a Trajectory unless given. With `forced`, the period.
    parameters, inputs : mapping, optional
        As for `bondgraph.simulate`; those of a Trajectory unless given.
    forced : bool
        Whether an input repeats itself after `period`, which is then not searched for.
    start : float
        Time at which runs begin, s: the phase of the inputs.
    rtol : float
        Of the runs.
    tolerance : float
        How near a run has to come back, beside the sizes of the states.
    max_iterations : int

    Returns
    -------
    PeriodicOrbit

    Raises
    ------
    SimulationError
        Where the search does not close an orbit, runs into a steady state, or has no guess of
        the period.

    Notes
    -----
    With an unknown period the shift along the orbit is held by a step across it. The start is
    taken where contacts slip, as far from events as can be: there all directions are free.

    References
    ----------
    Nayfeh, Balachandran, Applied nonlinear dynamics, Wiley 1995, ch. 6: shooting; Leine,
    Nijmeijer, Dynamics and bifurcations of non-smooth mechanical systems, Springer 2004:
    multipliers that are zero.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, assemble
    >>> van_der_pol = assemble(
    ...     "van_der_pol", One("l") >> (I("L", 1), C("c", 1), R("r", effort=lambda f: f**3 / 3 - f))
    ... )
    >>> orbit = periodic_orbit(van_der_pol, {"c.q": 2.0, "L.p": 0.0}, period=6.5)
    >>> round(orbit.period, 7), orbit.verdict
    (6.6632869, 'stable')
    """
    if forced and period is None:
        raise SimulationError("a forced orbit has the period of its input; give period=...")
    begun = taken(graph, guess, (period, forced, start), parameters, inputs)
    setting = _setting(begun, rtol)
    x, duration, run, iterations = _closed(setting, begun, forced, tolerance, max_iterations)
    _refuse_still(setting, run)
    monodromy = end_by_start(setting, x, duration)
    along = None if forced else rates(run, 0)
    floquet = Floquet.of(monodromy, not forced, along)
    largest = float(numpy.abs(floquet.multipliers).max(initial=1.0))
    if floquet.trivial_error > LARGEST_TRIVIAL_ERROR * max(1.0, largest):
        raise SimulationError(
            f"model {run.model.equations.name!r}: the multiplier along the orbit is off one by "
            f"{floquet.trivial_error:.2g}; the orbit grazes an event, or the runs are too coarse: give a "
            f"smaller rtol or a guess at another phase"
        )
    return PeriodicOrbit(
        duration,
        dict(zip(setting.names, map(float, x), strict=True)),
        setting.start,
        forced,
        floquet,
        run,
        iterations,
        float(_off(setting, run, x)),
    )


def _setting(begun: Guess, rtol: float) -> Setting:
    """Return the setting of all runs, with states measured on a first one."""
    ones = numpy.ones(len(begun.x))
    first = Setting(
        begun.model, begun.parameters, begun.inputs, begun.initial, begun.start, rtol, ones
    )
    run = begun.run or first.run(begun.x, begun.period)
    scale = sizes(run, begun.period)
    return Setting(
        begun.model, begun.parameters, begun.inputs, begun.initial, begun.start, rtol, scale
    )


def _off(setting: Setting, run: Trajectory, x: Array) -> float:
    """Return the greatest distance of a run's end from its start, beside the states' sizes."""
    return float(numpy.abs((run.x_end - x) / setting.scale).max(initial=0.0))


def _closed(
    setting: Setting, begun: Guess, forced: bool, tolerance: float, max_iterations: int
) -> tuple[Array, float, Trajectory, int]:
    """Return start, period and run of an orbit, and the steps it took."""
    x, duration = begun.x.copy(), begun.period
    run = setting.run(x, duration)
    off = _off(setting, run, x)
    for iteration in range(max_iterations):
        if off <= tolerance:
            return x, duration, run, iteration
        step, longer = _step(setting, x, duration, run, forced)
        share = 1.0
        while share > LEAST_SHARE:
            trial = x + share * step, duration + share * longer
            found = _tried(setting, trial, begun.period)
            if found is not None and _off(setting, found, trial[0]) < off:
                break
            share /= 2
        else:
            break
        (x, duration), run = trial, found
        off = _off(setting, run, x)
    raise SimulationError(
        f"model {setting.model.equations.name!r}: no periodic orbit found near the guess; after a period "
        f"of {duration:g} s the states are off by {off:.2g} of their size; give a nearer guess"
    )


def _tried(setting: Setting, trial: tuple[Array, float], period: float) -> Trajectory | None:
    x, duration = trial
    if not 0.2 * period < duration < 5 * period:
        return None
    try:
        return setting.run(x, duration)
    except SimulationError:
        return None


def _step(
    setting: Setting, x: Array, duration: float, run: Trajectory, forced: bool
) -> tuple[Array, float]:
    """Return Newton's step of the start, and of the period where it is not known."""
    scale, n = setting.scale, len(x)
    matrix = end_by_start(setting, x, duration) * scale / scale[:, None] - numpy.eye(n)
    right = -(run.x_end - x) / scale
    if forced:
        return numpy.linalg.lstsq(matrix, right, rcond=1e-12)[0] * scale, 0.0
    late, early = (rates(run, place) / scale * duration for place in (-1, 0))
    full = numpy.zeros((n + 1, n + 1))
    full[:n, :n], full[:n, n] = matrix, late
    full[n, :n] = early / max(float(numpy.linalg.norm(early)), 1e-300)
    found = numpy.linalg.lstsq(full, numpy.append(right, 0.0), rcond=1e-12)[0]
    return found[:n] * scale, float(found[n] * duration)


def _refuse_still(setting: Setting, run: Trajectory) -> None:
    """Refuse a steady state, which any period closes."""
    moved = numpy.ptp(run.x, axis=1) if run.x.size else numpy.zeros(0)
    if (moved <= STILL * setting.scale).all():
        raise SimulationError(
            f"model {run.model.equations.name!r}: the search ran into a steady state; give a guess "
            f"nearer to the orbit"
        )
