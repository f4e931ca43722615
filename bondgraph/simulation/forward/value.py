"""What a replay is given and what it finds, as frozen values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy

from ...errors import SimulationError
from ..inputs import InputTable

Array = numpy.ndarray
Projection = Callable[[float, Array, Array, Array, Array], Array]

GRAZING, AMBIGUOUS, NON_FINITE = "grazing", "ambiguous", "non-finite"
UNTOLD = "untold"


@dataclass(frozen=True, eq=False)
class Travelled:
    """A run as its steps, and what its sensitivities start from.

    Attributes
    ----------
    record : (ns + 1, n + 3) array
        Of every step: time and length, events before it, state at its start; the
        last row is the end of the run.
    events : (ne, 3) array of int
        Switch, code before, code after.
    codes : (k,) array
        At the start, jumps at the start made.
    parameters : (np,) array
    inputs : InputTable or callable
    t_eval : (nt,) array or None
        None for rows at the start, after each step and after each event.
    rows : int
        How many there will be.
    seeds : (np, q) array
        Derivatives of the parameters.
    start : (n, q) array
        Derivatives of the state at the start.
    noise : float
        Share of a guard's terms by which it may be wrong.
    """

    record: Array
    events: Array
    codes: Array
    parameters: Array
    inputs: InputTable | Callable[[float], Array]
    t_eval: Array | None
    rows: int
    seeds: Array
    start: Array
    noise: float


@dataclass(frozen=True, eq=False)
class Replayed:
    """What a replay found.

    Attributes
    ----------
    rows : (nt, n, q) array
        Sensitivities at the output times.
    end : (n, q) array
        At the end of the run.
    events : (ne, q) array, s over the unit of what it is by
        Derivatives of the event times.
    """

    rows: Array
    end: Array
    events: Array


class Undefined(Exception):  # an answer within this folder, not an error
    """The run has no derivative.

    Attributes
    ----------
    why : {"grazing", "ambiguous", "non-finite", "untold"}
    t : float
    switch : int
        Meaningless where the sensitivities themselves are no numbers.
    """

    def __init__(self, why: str, t: float, switch: int) -> None:
        super().__init__(why)
        self.why, self.t, self.switch = why, t, switch

    def named(self, names: Sequence[str]) -> SimulationError:
        """Return the error for the user."""
        if self.why == NON_FINITE:
            return SimulationError(
                f"the sensitivities are no finite numbers from t = {self.t:g} s on: a law has no "
                f"finite slope there (such as sqrt(x) at 0), or they overflow; shorten the run"
            )
        name = names[self.switch]
        if self.why == UNTOLD:
            return SimulationError(
                f"the state jumps at t = {self.t:.9g} s, where {name!r} changes its mode, in more "
                f"than one impact at once; sensitivities follow one jump at a time: differentiate "
                f"the run up to there",
                elements=[name],
            )
        if self.why == GRAZING:
            return SimulationError(
                f"{name!r} changes its mode at t = {self.t:.9g} s in a grazing contact: its margin "
                f"touches zero rather than crosses it, as far as the tolerance can tell, so the time of "
                f"the event has no derivative; tighten rtol, or move a parameter off this point",
                elements=[name],
            )
        return SimulationError(
            f"{name!r} and another contact change their modes at once at t = {self.t:.9g} s, and "
            f"each would move the event in its own way: there is no derivative, it differs by the "
            f"order in which they come; move a parameter off this point",
            elements=[name],
        )
