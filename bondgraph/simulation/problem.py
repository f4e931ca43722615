"""What goes into an integration and what comes out, as frozen values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from ..errors import SimulationError
from .inputs.table import InputTable
from .outcome import Outcome
from .table import ModeTable

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Problem:
    """What to integrate.

    Parameters
    ----------
    modes : ModeTable
        The model.
    parameters : (np,) array
    x0 : (n,) array
        The state at the start.
    t_span : (float, float)
        Start and end.
    inputs : InputTable or callable, optional
        A callable t -> (m,) array is integrated by the Python twin.
    weights : (n,) array, optional
        1/sqrt(stiffness of the storage) of each state, 0 where unknown: with the energy in the
        model it tells how large a state may become, and so how small an error matters.
    energy0 : float
        The energy stored at the start.
    """

    modes: ModeTable
    parameters: Array
    x0: Array
    t_span: tuple[float, float]
    inputs: InputTable | Callable[[float], Array] | None = None
    weights: Array | None = None
    energy0: float = 0.0

    def __post_init__(self) -> None:
        n, m = self.modes.n, self.modes.m
        object.__setattr__(self, "parameters", _doubles(self.parameters))
        object.__setattr__(self, "x0", _doubles(self.x0))
        if self.x0.shape != (n,):
            raise SimulationError(f"{n} initial states needed, not {self.x0.shape}")
        if self.weights is not None and np.shape(self.weights) != (n,):
            raise SimulationError(f"{n} weights needed, not {np.shape(self.weights)}")
        start, end = self.t_span
        if not (math.isfinite(start) and math.isfinite(end) and start <= end):
            raise SimulationError(f"the time span {start} to {end} must be finite and run forward")
        if m and self.inputs is None:
            raise SimulationError(f"{m} inputs needed, none given")
        if isinstance(self.inputs, InputTable) and len(self.inputs.hold) != m:
            raise SimulationError(f"{m} inputs needed, not {len(self.inputs.hold)}")

    def weights_or_zero(self) -> Array:
        """The weights, zeros where none are given."""
        return np.zeros(self.modes.n) if self.weights is None else _doubles(self.weights)

    def input_table(self) -> tuple[Callable[[float], Array] | None, Array, Array, Array, Array]:
        """The callable, or None and knots, values, shapes and jumps of the table."""
        table = self.inputs
        if isinstance(table, InputTable):
            return None, table.knots, table.values, table.shapes, table.jumps
        function = table
        m = self.modes.m
        empty = np.zeros(0), np.zeros((0, m)), np.zeros((0, 3, m)), np.zeros(0, dtype=np.int8)
        return function, *empty


@dataclass(frozen=True, eq=False)
class Options:
    """How to integrate.

    Parameters
    ----------
    rtol, atol : float, float or (n,) array
        Error allowed in a step: atol + rtol times the size of a state, which is at least 1e-3 of
        its largest value so far and 1e-7 of what the energy in the model can make of it.
    max_step : float
        Longest step. Needed only where a law depends on time itself.
    max_events, max_steps : int
        A run with more is stopped (tried steps count too).
    time_budget : float
        Seconds a run may take.
    bound : float
        A state beyond it has diverged.
    t_eval : (nt,) array, optional
        Increasing times of the output rows; without it every step and both sides of every event.
    backend : {"auto", "native", "vm"}
        Compiled C where possible; only; or CasADi's virtual machine under the Python twin.
    record : bool
        Whether to keep every step, for `bondgraph.simulation.forward`.
    """

    rtol: float = 1e-6
    atol: float | Array = 0.0
    max_step: float = math.inf
    max_events: int = 100_000
    max_steps: int = 100_000_000
    time_budget: float = math.inf
    bound: float = 1e100
    t_eval: Array | None = None
    backend: Literal["auto", "native", "vm"] = "auto"
    record: bool = False

    def __post_init__(self) -> None:
        if not 0 < self.rtol < 1:
            raise SimulationError(f"rtol must lie between 0 and 1, not {self.rtol}")
        if not np.all(np.asarray(self.atol) >= 0):
            raise SimulationError("atol must not be negative")
        if not self.max_step > 0:
            raise SimulationError(f"max_step must be positive, not {self.max_step}")
        if self.backend not in ("auto", "native", "vm"):
            raise SimulationError(f"backend is 'auto', 'native' or 'vm', not {self.backend!r}")
        if self.t_eval is not None:
            t_eval = _doubles(self.t_eval)
            if t_eval.ndim != 1 or not (np.diff(t_eval) >= 0).all():
                raise SimulationError("t_eval must be one row of times that do not decrease")
            object.__setattr__(self, "t_eval", t_eval)


class Event(NamedTuple):
    """One switch changing its mode; codes are 0 stick, +1 and -1 slip."""

    t: float
    switch: int
    before: int
    after: int
    x: Array
    supplied: float
    dissipated: float


class EventLog(Sequence[Event]):
    """The events of a run, kept as arrays until they are looked at.

    Parameters
    ----------
    rows : (ne, n + 3) array
        Time, state, energies supplied and dissipated.
    codes : (ne, 3) array of int
        Switch, its code before and after.
    """

    def __init__(self, rows: Array, codes: Array) -> None:
        self.rows, self.codes = rows, codes

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return EventLog(self.rows[index], self.codes[index])
        row, (switch, before, after) = self.rows[index], self.codes[index].tolist()
        return Event(
            float(row[0]), switch, before, after, row[1:-2], float(row[-2]), float(row[-1])
        )


@dataclass(frozen=True, eq=False)
class Solution:
    """What `integrate` found; rows are output times.

    Attributes
    ----------
    t, x, codes : (nt,), (nt, n) and (nt, k) arrays
        Times, states and codes; a row exactly at an event holds the codes after it.
    supplied, dissipated : (nt,) arrays, J
        Energies since the start.
    events : sequence of Event
    outcome : Outcome
    t_end, x_end, codes_end, supplied_end, dissipated_end
        The last good point, whatever the outcome.
    steps, rejected, rhs_evals : int
    backend : {"native", "vm"}
    record : (ns, n + 3) array or None
        Of every step: time and length, events before it, state at its start.
    """

    t: Array
    x: Array
    codes: Array
    supplied: Array
    dissipated: Array
    events: Sequence[Event]
    outcome: Outcome
    t_end: float
    x_end: Array
    codes_end: Array
    supplied_end: float
    dissipated_end: float
    steps: int
    rejected: int
    rhs_evals: int
    backend: Literal["native", "vm"]
    record: Array | None = None


def _doubles(values: Any) -> Array:
    return np.ascontiguousarray(values, dtype=float)
