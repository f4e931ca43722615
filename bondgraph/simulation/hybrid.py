"""Event-driven integration of a model with dry-friction switches.

One run: a `Problem` and `Options` go in, a `Solution` comes out. The work is done by ``driver.c``
on modes compiled with ``kernel.c``, or by their Python twin in ``stepper.py`` on CasADi's virtual
machine; both give the same bits.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..errors import SimulationError
from .buffered import evaluator
from .compiler import CompileError
from .native import NativeRun
from .outcome import Outcome
from .problem import Event, EventLog, InputTable, Options, Problem, Solution
from .stepper import Stepper

if TYPE_CHECKING:
    from .stepper import Model

log = logging.getLogger(__name__)

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
    if _native_wanted(problem, options):
        try:
            return _integrate_native(problem, options)
        except CompileError as failure:  # a mode met on the way
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
            made[mask] = evaluator(mode.rhs), evaluator(mode.guard)
        return made[mask]

    stepper = Stepper(problem, options, model)
    outcome = stepper.run()
    return solution_of(stepper, outcome)


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
    )


# ---------------------------------------------------------------------- compiled


def _integrate_native(problem: Problem, options: Options) -> Solution:
    this = NativeRun(problem, options)
    outcome = this.to_the_end(options.time_budget)
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
