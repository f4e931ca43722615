"""Event-driven integration of a model with dry-friction switches.

One run: a `Problem` and `Options` go in, a `Solution` comes out. The work is done by ``driver.c``
on modes compiled with ``kernel.c``, or by their Python twin in ``stepper.py`` on CasADi's virtual
machine; both give the same bits.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..errors import SimulationError
from .buffered import evaluator
from .native import CompileError
from .native.run import NativeRun, NotYet
from .outcome import Outcome
from .problem import Event, EventLog, Options, Problem, Solution
from .stepper import Stepper

if TYPE_CHECKING:
    from .stepper import Model
    from .table import ModeTable

log = logging.getLogger(__name__)

LOOK = 64  # steps on the virtual machine between two looks for machine code
# A compiled run that meets a mode without machine code is left for the virtual machine only where
# that catches up sooner, at a hundredth of the speed, than a compiler is done.
PATIENCE = 0.005  # s

Array = np.ndarray


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
    if options.backend == "vm" or callable(problem.inputs):
        if options.backend == "native":
            raise SimulationError("no compiled run possible: an input is a Python function")
        return _integrate_vm(problem, options)
    if options.backend == "native":
        return _compiled(problem, options)
    return _soonest(problem, options)


def _compiled(problem: Problem, options: Options) -> Solution:
    """Run compiled, and wait for the compiler."""
    if not problem.modes.compiled():
        raise SimulationError(f"no compiled run possible: {problem.modes.refusal}")
    try:
        return _integrate_native(problem, options, patience=math.inf)
    except CompileError as failure:  # a mode met on the way
        raise SimulationError(f"no compiled run possible: {failure}") from failure


def _soonest(problem: Problem, options: Options) -> Solution:
    """Run compiled as soon as that can be, on the virtual machine until then.

    A run that finds its machine code on the way is made again, compiled, from the start: that
    costs a hundredth of what it took so far, and both give the same bits.
    """
    began, patience = time.monotonic(), PATIENCE
    while problem.modes.at_hand(0):
        try:
            return _integrate_native(problem, _within(options, began), patience)
        except CompileError as failure:  # a mode met on the way
            log.warning("simulating without compiled code, slower: %s", failure)
            break
        except NotYet:
            try:
                return _integrate_vm(problem, _within(options, began), overtake=True)
            except _Overtaken:
                patience = math.inf  # what was gained is not given up for one more mode
    else:
        try:
            return _integrate_vm(problem, options, overtake=problem.modes.refusal is None)
        except _Overtaken:
            return _integrate_native(problem, _within(options, began), math.inf)
    return _integrate_vm(problem, _within(options, began))


def _within(options: Options, began: float) -> Options:
    """Options with the seconds that are left."""
    left = options.time_budget - (time.monotonic() - began)
    return replace(options, time_budget=max(left, 0.0))


# ---------------------------------------------------------------------- on the virtual machine


class _Overtaken(Exception):  # an answer within this module, not an error
    """Machine code is there for all that a run has met."""


class _Overtakable(Stepper):
    """A run that ends where compiled code can take its place."""

    modes: ModeTable
    met: dict[int, tuple[Model, Model]]
    turns = 0

    def step(self) -> None:
        self.turns += 1
        if self.turns % LOOK == 0 and all([self.modes.at_hand(mask) for mask in self.met]):
            raise _Overtaken
        super().step()


def _integrate_vm(problem: Problem, options: Options, overtake: bool = False) -> Solution:
    made: dict[int, tuple[Model, Model]] = {}

    def model(mask: int) -> tuple[Model, Model]:
        if mask not in made:
            mode = problem.modes.functions(mask)
            made[mask] = evaluator(mode.rhs), evaluator(mode.guard)
            if overtake:
                problem.modes.at_hand(mask)
        return made[mask]

    stepper: Stepper
    if overtake:
        stepper = _Overtakable(problem, options, model)
        stepper.modes, stepper.met = problem.modes, made
    else:
        stepper = Stepper(problem, options, model)
    return solution_of(stepper, stepper.run())


def solution_of(stepper: Stepper, outcome: Outcome) -> Solution:
    """Gather what the Python twin has done."""
    n, k = stepper.n, stepper.k
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
        None if stepper.record is None else np.array(stepper.record).reshape(-1, n + 3),
    )


# ---------------------------------------------------------------------- compiled


def _integrate_native(problem: Problem, options: Options, patience: float = math.inf) -> Solution:
    this = NativeRun(problem, options)
    outcome = this.to_the_end(options.time_budget, patience)
    run, kept = this.run, this.kept
    events = EventLog(kept["events"][: run.event_count], kept["event_codes"][: run.event_count])
    return _solution(
        kept["rows"][: run.row_count],
        kept["row_codes"][: run.row_count],
        events,
        outcome,
        (run.t, kept["x_end"], kept["code"][: run.k]),
        (run.steps, run.rejected, run.evaluations),
        "native",
        kept["record"][: run.record_count] if options.record else None,
    )


# ---------------------------------------------------------------------- helpers


def _solution(
    rows: Array,
    codes: Array,
    events: Sequence[Event],
    outcome: Outcome,
    end: tuple[float, Array, Array],
    counts: tuple[int, int, int],
    backend: Literal["native", "vm"],
    record: Array | None,
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
        record=record,
    )
