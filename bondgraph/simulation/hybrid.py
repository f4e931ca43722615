"""Event-driven integration of a model with dry-friction switches.

One run: a `Problem` and `Options` go in, a `Solution` comes out. The work is done by ``driver.c``
on modes compiled with ``kernel.c``, or by their Python twin in ``stepper.py`` on CasADi's virtual
machine; both give the same bits.
"""

from __future__ import annotations

import logging
import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ..errors import SimulationError
from . import native
from .outcome import Outcome
from .stepper import Stepper

if TYPE_CHECKING:
    import ctypes

    import casadi as ca

    from .stepper import Model

__all__ = [
    "Event",
    "InputTable",
    "ModeFunctions",
    "ModeTable",
    "Options",
    "Problem",
    "Solution",
    "integrate",
]

log = logging.getLogger(__name__)

Array = np.ndarray
MAX_SWITCHES = 63


@dataclass(frozen=True, eq=False)
class ModeFunctions:
    """The functions of one structural mode, that is of one set of stuck switches.

    Parameters
    ----------
    rhs : casadi.Function or callable
        (t, x, u, p, s) -> n + 2 numbers: dx/dt, supplied and dissipated power. `s` holds k codes:
        0 stick, +1 and -1 slip.
    guard : casadi.Function or callable, optional
        (t, x, u, p, s) -> 2k numbers, g and a. A slipping switch has g = s v and a = v, its slip; a
        stuck one g = breakaway - abs(a) and a = the effort that holds it. An event is g falling
        below 0. Only a model without switches may leave it out.
    """

    rhs: Any
    guard: Any = None


class ModeTable:
    """The modes of one model, made when first met and kept for all its runs.

    Parameters are inputs of the functions, so one table serves every parameter set, and several
    threads at once.

    Parameters
    ----------
    n, m, k : int
        Numbers of states, inputs and switches.
    provider : callable
        mask -> `ModeFunctions`; bit j of the mask says that switch j is stuck.

    Attributes
    ----------
    refusal : str or None
        Why the model cannot run as compiled C, once that was tried.
    """

    def __init__(self, n: int, m: int, k: int, provider: Callable[[int], ModeFunctions]) -> None:
        if k > MAX_SWITCHES:
            raise SimulationError(f"{k} switches are more than the {MAX_SWITCHES} supported")
        self.n, self.m, self.k = n, m, k
        self._provider = provider
        self._functions: dict[int, ModeFunctions] = {}
        self._native: dict[int, native.NativeMode] = {}
        self._driver: ctypes.CDLL | None = None
        self.refusal: str | None = None
        self._lock = threading.RLock()

    def functions(self, mask: int) -> ModeFunctions:
        """The mode in which the switches of the mask's bits are stuck."""
        with self._lock:
            if mask not in self._functions:
                self._functions[mask] = self._checked(self._provider(mask), mask)
            return self._functions[mask]

    def _checked(self, mode: ModeFunctions, mask: int) -> ModeFunctions:
        if not _is_casadi(mode.rhs):
            return mode
        rhs = _dense(mode.rhs, self.n + 2, f"rhs of mode {mask}")
        if not self.k:
            return ModeFunctions(rhs)
        return ModeFunctions(rhs, _dense(mode.guard, 2 * self.k, f"guard of mode {mask}"))

    def machine_code(self, mask: int) -> native.NativeMode:
        """The same, as compiled C; raises CompileError."""
        with self._lock:
            if mask not in self._native:
                mode = self.functions(mask)
                self._native[mask] = native.load_mode(
                    mode.rhs, mode.guard, (self.n, self.m, self.k)
                )
            return self._native[mask]

    def driver(self) -> ctypes.CDLL:
        """The compiled integrator; raises CompileError."""
        with self._lock:
            if self._driver is None:
                self._driver = native.load_driver()
            return self._driver

    def loaded(self) -> dict[int, native.NativeMode]:
        """The compiled modes so far."""
        with self._lock:
            return dict(self._native)

    def compiled(self) -> bool:
        """Whether the model can run as compiled C; says once why where it cannot."""
        with self._lock:
            if self.refusal is None and not self._native:
                try:
                    if not _is_casadi(self.functions(0).rhs):
                        raise native.CompileError("the model is given as Python functions")
                    self.driver()
                    self.machine_code(0)
                except native.CompileError as failure:
                    self.refusal = str(failure)
                    log.warning("simulating without compiled code, slower: %s", failure)
            return self.refusal is None


@dataclass(frozen=True, eq=False)
class InputTable:
    """Inputs over time: values at knots, kept or joined by straight lines in between.

    Parameters
    ----------
    knots : (nk,) array, increasing
        Times. Before the first and after the last, the inputs are constant; one knot is a constant.
    values : (nk, m) array
        The inputs at the knots.
    hold : (m,) sequence of 0 or 1
        0 keeps a value until the next knot, 1 interpolates linearly.
    """

    knots: Array
    values: Array
    hold: Array

    def __post_init__(self) -> None:
        knots, values = _doubles(self.knots), _doubles(self.values)
        hold = np.ascontiguousarray(self.hold, dtype=np.int8)
        if knots.ndim != 1 or len(knots) == 0 or values.shape != (len(knots), len(hold)):
            raise SimulationError(
                f"an input table of {len(hold)} channels needs (nk,) knots and (nk, {len(hold)}) "
                f"values, not {knots.shape} and {values.shape}"
            )
        if not np.isfinite(knots).all() or not (np.diff(knots) > 0).all():
            raise SimulationError("the times of an input table must be finite and increase")
        if not np.isfinite(values).all():
            raise SimulationError("an input table must hold finite values")
        if not np.isin(hold, (0, 1)).all():
            raise SimulationError("the hold of an input is 0 (zero order) or 1 (linear)")
        object.__setattr__(self, "knots", knots)
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "hold", hold)


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

    def input_table(self) -> tuple[Callable[[float], Array] | None, Array, Array, Array]:
        """The callable, or None and knots, values and which channels are linear."""
        if isinstance(self.inputs, InputTable):
            return None, self.inputs.knots, self.inputs.values, self.inputs.hold == 1
        empty = np.zeros(0), np.zeros((0, self.modes.m)), np.zeros(self.modes.m, dtype=bool)
        return self.inputs, *empty


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


@dataclass(frozen=True, eq=False)
class Solution:
    """What `integrate` found; rows are output times.

    Attributes
    ----------
    t, x, codes : (nt,), (nt, n) and (nt, k) arrays
        Times, states and codes; a row exactly at an event holds the codes after it.
    supplied, dissipated : (nt,) arrays, J
        Energies since the start.
    events : list of Event
    outcome : Outcome
    t_end, x_end, codes_end, supplied_end, dissipated_end
        The last good point, whatever the outcome.
    steps, rejected, rhs_evals : int
    backend : {"native", "vm"}
    """

    t: Array
    x: Array
    codes: Array
    supplied: Array
    dissipated: Array
    events: list[Event]
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


def integrate(problem: Problem, options: Options | None = None) -> Solution:
    """Integrate a problem from event to event.

    Raises
    ------
    SimulationError
        Output times outside the time span, a tolerance of the wrong size, a mode whose functions
        have the wrong size, or ``backend="native"`` where that is impossible.

    Notes
    -----
    Dormand-Prince 5(4) with dense output. Events are searched on the interpolant and located by
    steps of the method itself, so the state at an event has the accuracy of any other. What happens
    during a run (overflow, divergence, chattering, a limit) is told by `Solution.outcome`.
    """
    options = options or Options()
    if options.t_eval is not None and len(options.t_eval):
        first, last = options.t_eval[0], options.t_eval[-1]
        if not (problem.t_span[0] <= first and last <= problem.t_span[1]):
            raise SimulationError(f"t_eval leaves the time span {problem.t_span}")
    if np.ndim(options.atol) and np.shape(options.atol) != (problem.modes.n,):
        raise SimulationError(f"atol must be a number or {problem.modes.n} numbers")
    if _native_wanted(problem, options):
        try:
            return _integrate_native(problem, options)
        except native.CompileError as failure:  # a mode met on the way
            if options.backend == "native":
                raise SimulationError(f"no compiled run possible: {failure}") from failure
            log.warning("simulating without compiled code, slower: %s", failure)
    return _integrate_vm(problem, options)


def _native_wanted(problem: Problem, options: Options) -> bool:
    if options.backend == "vm":
        return False
    callable_input = problem.inputs is not None and not isinstance(problem.inputs, InputTable)
    possible = not callable_input and problem.modes.compiled()
    if options.backend == "native" and not possible:
        reason = "an input is a Python function" if callable_input else problem.modes.refusal
        raise SimulationError(f"no compiled run possible: {reason}")
    return possible


# ---------------------------------------------------------------------- on the virtual machine


def _integrate_vm(problem: Problem, options: Options) -> Solution:
    made: dict[int, tuple[Model, Model]] = {}

    def model(mask: int) -> tuple[Model, Model]:
        if mask not in made:
            mode = problem.modes.functions(mask)
            made[mask] = _evaluator(mode.rhs), _evaluator(mode.guard)
        return made[mask]

    stepper = Stepper(problem, options, model)
    outcome = stepper.run()
    n, k = problem.modes.n, problem.modes.k
    rows = np.array(stepper.rows).reshape(len(stepper.rows), n + 3)
    codes = np.array(stepper.row_codes, dtype=np.int8).reshape(len(stepper.rows), k)
    events = [
        Event(t, switch, before, after, x[:n], float(x[n]), float(x[n + 1]))
        for t, switch, before, after, x in stepper.events
    ]
    return _solution(
        rows,
        codes,
        events,
        outcome,
        (stepper.t, stepper.x, stepper.code.astype(np.int8)),
        (stepper.steps, stepper.rejected, stepper.evaluations),
        "vm",
    )


def _evaluator(function: Any) -> Model:
    """A CasADi function as a plain one, through its buffer: a microsecond a call."""
    if not _is_casadi(function):
        return function
    buffer, trigger = function.buffer()
    arguments = [np.zeros(function.nnz_in(i)) for i in range(5)]
    result = np.zeros(function.nnz_out(0))
    for i, argument in enumerate(arguments):
        buffer.set_arg(i, argument.data)
    buffer.set_res(0, result.data)
    t_, x_, u_, p_, s_ = arguments

    def evaluate(t: float, x: Array, u: Array, p: Array, s: Array) -> Array:
        t_[0], x_[:], u_[:], p_[:], s_[:] = t, x, u, p, s
        trigger()
        return result.copy()

    evaluate.buffer = buffer  # type: ignore[attr-defined]  # keeps it alive
    return evaluate


# ---------------------------------------------------------------------- compiled


def _integrate_native(problem: Problem, options: Options) -> Solution:
    this = native.NativeRun(problem, options)
    outcome = this.to_the_end(options.time_budget)
    run, kept, n = this.run, this.kept, problem.modes.n
    events = kept["events"][: run.event_count]
    codes = kept["event_codes"][: run.event_count]
    columns = events[:, 0], *codes.T, events[:, n + 1], events[:, n + 2]
    t, switch, before, after, supplied, dissipated = (column.tolist() for column in columns)
    states = list(events[:, 1 : n + 1])
    return _solution(
        kept["rows"][: run.row_count],
        kept["row_codes"][: run.row_count],
        list(map(Event, t, switch, before, after, states, supplied, dissipated)),
        outcome,
        (run.t, kept["x_end"], kept["code"][: run.k]),
        (run.steps, run.rejected, run.evaluations),
        "native",
    )


# ---------------------------------------------------------------------- helpers


def _solution(
    rows: Array,
    codes: Array,
    events: list[Event],
    outcome: Outcome,
    end: tuple[float, Array, Array],
    counts: tuple[int, int, int],
    backend: Literal["native", "vm"],
) -> Solution:
    n = rows.shape[1] - 3
    t_end, x_end, codes_end = end
    return Solution(
        t=rows[:, 0],
        x=rows[:, 1 : n + 1],
        codes=codes,
        supplied=rows[:, n + 1],
        dissipated=rows[:, n + 2],
        events=events,
        outcome=outcome,
        t_end=t_end,
        x_end=x_end[:n],
        codes_end=codes_end,
        supplied_end=float(x_end[n]),
        dissipated_end=float(x_end[n + 1]),
        steps=counts[0],
        rejected=counts[1],
        rhs_evals=counts[2],
        backend=backend,
    )


def _doubles(values: Any) -> Array:
    return np.ascontiguousarray(values, dtype=float)


def _is_casadi(function: Any) -> bool:
    return hasattr(function, "sz_arg")


def _dense(function: ca.Function, size: int, what: str) -> ca.Function:
    """The function with all its arguments and its result full, checked for its size."""
    import casadi as ca

    if function.n_in() != 5 or function.n_out() != 1 or function.numel_out(0) != size:
        raise SimulationError(f"the {what} must take (t, x, u, p, s) and give {size} numbers")
    if function.nnz_out(0) == size:
        return function
    arguments = [ca.MX.sym(name, function.numel_in(i)) for i, name in enumerate("txups")]
    return ca.Function(function.name(), arguments, [ca.densify(function(*arguments))])
