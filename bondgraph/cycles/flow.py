"""Where a run ends, and how that changes with where it begins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import SimulationError
from ..simulation import CompiledModel, Trajectory, sensitivities, simulate
from ..simulation.inputs import at

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Setting:
    """What the runs of a search share.

    Attributes
    ----------
    model : CompiledModel
    parameters, inputs, initial : mapping
        As for `bondgraph.simulate`; `initial` holds guesses of algebraic variables.
    start : float
        Time at which each run begins, s.
    rtol : float
    scale : (n,) array
        Sizes of the states.
    """

    model: CompiledModel
    parameters: Any
    inputs: Any
    initial: Any
    start: float
    rtol: float
    scale: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(state.name for state in self.model.equations.states)

    def at(self, x: Array) -> dict[str, float]:
        """Return states by name, with the guesses of algebraic variables."""
        return {**self.initial, **dict(zip(self.names, map(float, x), strict=True))}

    def run(self, x: Array, duration: float) -> Trajectory:
        """Simulate from states for a time; raise where that stops early."""
        span = (self.start, self.start + duration)
        run = simulate(self.model, span, self.parameters, self.at(x), self.inputs, None, self.rtol)
        if not run.outcome.ok:
            raise SimulationError(
                f"model {self.model.equations.name!r}: a run of the search stopped at "
                f"{run.t_end:g} s: {run.outcome.advice}"
            )
        return run


def end_by_start(setting: Setting, x: Array, duration: float) -> Array:
    """Return the Jacobian of the states at a run's end by those at its start.

    Parameters
    ----------
    setting : Setting
    x : (n,) array
    duration : float
        s.

    Returns
    -------
    (n, n) array
        Through the events of the run, which move.

    Raises
    ------
    BondGraphError
        Where there is none, as at an event that is only grazed.
    """
    end = setting.start + duration
    found = sensitivities(
        setting.model,
        (setting.start, end),
        setting.names,
        setting.parameters,
        setting.at(x),
        setting.inputs,
        [end],
        setting.rtol,
    )
    return found.x_end


def rates(run: Trajectory, place: int) -> Array:
    """Return the rates of the states at a row of a run, in the row's mode.

    Parameters
    ----------
    run : Trajectory
    place : int

    Returns
    -------
    (n,) array
    """
    modes, codes = run.model.mode_set, run.codes[place]
    mask = sum(1 << int(bit) for bit in numpy.flatnonzero(codes == 0))
    function = modes.signals(mask, modes.equations(mask).derivatives)
    t = run.t[place : place + 1] if place >= 0 else run.t[place:][:1]
    p = [run.parameters[symbol.name] for symbol in run.model.equations.parameters]
    columns = (t, run.x[:, place], at(run.inputs, t)[:, 0], p, codes)
    return function(*(numpy.array(item, dtype=float)[:, None] for item in columns))[:, 0]
