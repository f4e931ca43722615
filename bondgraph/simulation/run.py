"""The public `simulate`: numbers in, trajectory out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy

from ..causality import CausalGraph
from ..codegen.program import ProgramError
from ..errors import BondGraphError, SimulationError
from ..graph import BondGraph
from ..values import algebraic_guess, parameter_values
from .chatter import reverses
from .compiled import CompiledModel
from .hybrid import integrate
from .inputs import Functions, at, gather
from .outcome import Outcome
from .problem import Options, Problem, Solution
from .smooth import (
    SmoothProblem,
    SmoothSolution,
    initial_algebraic,
    integrate_smooth,
    tabled,
)
from .solvers import Choice, Start, choose, stiff_advice
from .switched import imposed_before, integrate_switched, mask_of
from .trajectory import Energy, Kept, Trajectory

# Outcomes of runs that did not get on, for a reason to be looked for.
HELD_UP = (Outcome.STEP_LIMIT, Outcome.STEP_UNDERFLOW, Outcome.TIME_BUDGET)


def simulate(
    graph: BondGraph | CausalGraph | CompiledModel,
    t_span: tuple[float, float] | float,
    parameters: Mapping[Any, Any] | None = None,
    initial: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, Any] | None = None,
    t_eval: Any = None,
    rtol: float = 1e-6,
    *,
    atol: float = 0.0,
    max_step: float = math.inf,
    max_events: int = 100_000,
    max_steps: int = 10_000_000,
    time_budget: float = 600.0,
    backend: Literal["auto", "native", "vm"] = "auto",
    solver: Literal["auto", "dopri5", "cvodes", "idas", "rosenbrock"] = "auto",
) -> Trajectory:
    """Simulate a model in time; contacts stick and slip at located events.

    A model that keeps algebraic variables is integrated together with them.

    Parameters
    ----------
    graph : BondGraph, CausalGraph or CompiledModel
        A CompiledModel is reused without deriving or compiling again.
    t_span : (float, float) or float
        Start and end, s; a single number is the end of a run from zero.
    parameters : mapping, optional
        Values by name or symbol, in SI or as ``(value, unit)``.
    initial : mapping, optional
        Initial states by name or symbol; the elements' own unless given. An
        output that fixes one state, such as a speed, may be given instead. The
        name of an algebraic variable gives the guess from which its solution is
        sought, zero otherwise; where its equations have several solutions, the
        run stays on the branch found from there.
    inputs : mapping, optional
        By name or symbol: a number, ``(times, values)``, `Samples`, or a
        function of time. dopri5 calls functions, on the slower virtual machine;
        other solvers, and inputs whose rate is needed, follow them by cubics
        within a tenth of rtol and refuse functions that jump.
    t_eval : (nt,) array-like, optional
        Times to report; the integrator's own steps unless given. CasADi's
        integrators do not tell theirs: they report 1000 equal steps, and denser
        ones after the start and each jump of an input.
    rtol : float
        Relative tolerance, 1e-13 to 0.1.
    atol : float
        Absolute tolerance; zero measures each state against its own range and
        the energy of the whole system.
    max_step : float
        Longest step, s.
    max_events, max_steps : int
        Limits that end the run in a named outcome.
    time_budget : float
        Wall-clock limit, s.
    backend : {"auto", "native", "vm"}
        Compiled C, or CasADi's virtual machine; auto compiles where a C
        compiler is found and the solver is dopri5.
    solver : {"auto", "dopri5", "cvodes", "idas", "rosenbrock"}
        dopri5, explicit, locates events; the others, by CasADi, are for stiff
        models without contacts: cvodes for those without algebraic variables,
        idas and rosenbrock with or without. Auto takes rosenbrock for models that
        keep algebraic variables or are stiff near the start, else dopri5;
        `Trajectory.solver_reason` tells.

    Returns
    -------
    Trajectory
        With a named outcome; it may have stopped early.

    Raises
    ------
    BondGraphError
        When the run cannot be started: structure, values or options.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> run = simulate(mass_on_belt.graph(), 2.0)
    >>> run.outcome.value, run.events[0].to_mode
    ('finished', 'stick')
    """
    return carried_out(
        graph,
        t_span,
        parameters,
        initial,
        inputs,
        t_eval,
        rtol,
        atol=atol,
        max_step=max_step,
        max_events=max_events,
        max_steps=max_steps,
        time_budget=time_budget,
        backend=backend,
        solver=solver,
        record=False,
    )


def carried_out(
    graph: BondGraph | CausalGraph | CompiledModel,
    t_span: tuple[float, float] | float,
    parameters: Mapping[Any, Any] | None,
    initial: Mapping[Any, Any] | None,
    inputs: Mapping[Any, Any] | None,
    t_eval: Any,
    rtol: float,
    *,
    atol: float,
    max_step: float,
    max_events: int,
    max_steps: int,
    time_budget: float,
    backend: Literal["auto", "native", "vm"],
    solver: Literal["auto", "dopri5", "cvodes", "idas", "rosenbrock"],
    record: bool,
) -> Trajectory:
    """Simulate as `simulate` says; ``record`` keeps every step in the trajectory."""
    model = graph if isinstance(graph, CompiledModel) else CompiledModel(graph)
    span = _span(t_span)
    equations = model.equations
    choose(model, solver, backend)  # first, to refuse what cannot be before looking at numbers
    values = parameter_values(equations, parameters, model.resolver)
    table = gather(equations, inputs, switched=model.switched)
    x0 = numpy.array(model.initial_state(values, initial), dtype=float)
    p = numpy.array([values[symbol.name] for symbol in equations.parameters], dtype=float)
    options = Options(
        rtol=_tolerance(rtol),
        atol=float(atol),
        max_step=float(max_step),
        max_events=max_events,
        max_steps=max_steps,
        time_budget=time_budget,
        t_eval=_grid(t_eval, span),
        backend=backend,
        record=record,
    )
    try:
        choice = choose(model, solver, backend, Start(span, x0, p, table))
        if choice.solver == "dopri5":
            if isinstance(table, Functions) and table.needs_rate:
                table = tabled(table, span, options.rtol)
            run = _hybrid(model, (span, x0, p), values, table, options)
            return _reasoned(run, choice, span)
        guess = numpy.array(algebraic_guess(equations, initial))
        run = _smooth(model, (span, x0, p), values, (table, guess), options, choice.solver)
        return _reasoned(run, choice, span)
    except ProgramError as error:
        raise SimulationError(
            f"model {equations.name!r} cannot be turned into numbers: {error}"
        ) from None


def _reasoned(run: Trajectory, choice: Choice, span: tuple[float, float]) -> Trajectory:
    """Say why the solver was taken, and which would have come further."""
    remark, outcome = "", run.outcome
    if outcome in HELD_UP and not run.model.contact_names:
        p = numpy.array([run.parameters[s.name] for s in run.model.equations.parameters])
        end = Start(span, run.x_end, p, run.inputs)
        if _chatters(run, end):
            outcome = Outcome.CHATTERING
        elif choice.solver == "dopri5":
            remark = stiff_advice(run.model, end)
    return replace(run, outcome=outcome, solver_reason=choice.reason, remark=remark)


def _chatters(run: Trajectory, end: Start) -> bool:
    """Whether a run ended at a jump of its laws that drives it back from both sides."""
    if len(run.z_end) or not len(run.x_end):
        return False
    rhs = run.model.modes.functions(0).rhs

    def rates(t: float, x: numpy.ndarray) -> numpy.ndarray:
        u = at(end.inputs, numpy.array([t]))[:, 0]
        return rhs(t, x, u, end.p, []).full().ravel()[: len(x)]

    return reverses(rates, run.t_end, run.x_end, end.span[1] - end.span[0])


def _hybrid(
    model: CompiledModel,
    start: tuple[tuple[float, float], numpy.ndarray, numpy.ndarray],
    values: dict[str, float],
    table: Any,
    options: Options,
) -> Trajectory:
    span, x0, p = start
    if model.switched:
        return _searched(model, start, values, table, options)
    model.modes.functions(0)  # first, to say by name what has no numeric form
    stored, weights = model.measured(span[0], x0, _at(table, span[0]), p)
    energy = stored or 0.0
    problem = Problem(
        modes=model.modes,
        parameters=p,
        x0=x0,
        t_span=span,
        inputs=table,
        weights=weights,
        energy0=energy,
    )
    solution = integrate(problem, options)
    end = None
    if stored is not None:
        u = _at(table, solution.t_end)
        end, _ = model.measured(solution.t_end, solution.x_end, u, p)
    trajectory = _trajectory(model, solution, values, table, _audit(solution, energy, end))
    return _with_steps(trajectory, Kept(problem, options, solution))


def _searched(
    model: CompiledModel,
    start: tuple[tuple[float, float], numpy.ndarray, numpy.ndarray],
    values: dict[str, float],
    table: Any,
    options: Options,
) -> Trajectory:
    """Run a model whose modes are searched; its energy is known once it is in one."""
    if options.backend == "native":
        raise SimulationError(
            f"model {model.equations.name!r} has switching elements other than friction, which run on the "
            f"virtual machine; use backend='auto'"
        )
    span, x0, p = start
    problem = Problem(
        modes=model.modes, parameters=p, x0=x0, t_span=span, inputs=table, energy0=0.0
    )
    modes = model.mode_set
    solution = integrate_switched(problem, options, modes)

    def stored(t: float, x: numpy.ndarray, codes: numpy.ndarray) -> float | None:
        try:
            numbers = modes.numbers(mask_of(codes))
            energy = modes.stored(mask_of(codes))
        except BondGraphError:  # a run that found no mode to begin in
            return None
        if energy is None:
            return None
        u, s = at(table, numpy.array([t]))[:, 0], codes.astype(float)
        imposed = imposed_before(numbers, (t, u, p, s), x, numpy.abs(x))
        return energy(t, x, u, p, s, numpy.zeros(len(numbers.held)) if imposed is None else imposed)

    first = solution.codes[0] if len(solution.codes) else solution.codes_end
    energies = (
        stored(span[0], x0, first),
        stored(solution.t_end, solution.x_end, solution.codes_end),
    )
    audit = _audit(solution, energies[0] or 0.0, energies[1])
    trajectory = _trajectory(model, solution, values, table, audit)
    return _with_steps(trajectory, Kept(problem, options, solution))


def _smooth(
    model: CompiledModel,
    start: tuple[tuple[float, float], numpy.ndarray, numpy.ndarray],
    values: dict[str, float],
    given: tuple[Any, numpy.ndarray],
    options: Options,
    solver: str,
) -> Trajectory:
    (span, x0, p), (inputs, guess) = start, given
    table = tabled(inputs, span, options.rtol)
    u0 = at(table, numpy.array(span[:1]))[:, 0]
    problem = SmoothProblem(
        functions=model.smooth,
        parameters=p,
        x0=x0,
        z0=initial_algebraic(model.smooth, span[0], x0, u0, p, guess),
        t_span=span,
        inputs=table,
        solver=solver,
        options=options,
    )
    solution = integrate_smooth(problem)
    first, _ = model.measured(span[0], numpy.append(x0, problem.z0), u0, p)
    end = None
    if first is not None:
        last = numpy.append(solution.x_end, solution.z_end)
        end, _ = model.measured(solution.t_end, last, _at(table, solution.t_end), p)
    audit = _audit(solution, first or 0.0, end)
    trajectory = _smooth_trajectory(model, solution, values, table, audit, solver)
    return _with_steps(trajectory, Kept(problem, options))


def _with_steps(trajectory: Trajectory, kept: Kept) -> Trajectory:
    return replace(trajectory, kept=kept) if kept.options.record else trajectory


def _span(t_span: Any) -> tuple[float, float]:
    try:
        start, end = (0.0, float(t_span)) if isinstance(t_span, int | float) else map(float, t_span)
    except (TypeError, ValueError):
        raise SimulationError(f"t_span must be (start, end) in seconds, got {t_span!r}") from None
    if not (math.isfinite(start) and math.isfinite(end)):
        raise SimulationError(f"t_span must be finite, got {t_span!r}")
    if end <= start:
        raise SimulationError(f"the run must end after it starts, got {start:g} s to {end:g} s")
    return start, end


def _tolerance(rtol: float) -> float:
    if not isinstance(rtol, int | float) or not 1e-13 <= rtol <= 0.1:
        raise SimulationError(f"rtol is {rtol!r}; it must lie between 1e-13 and 0.1")
    return float(rtol)


def _grid(t_eval: Any, span: tuple[float, float]) -> numpy.ndarray | None:
    if t_eval is None:
        return None
    grid = numpy.array(t_eval, dtype=float).ravel()
    if not numpy.isfinite(grid).all() or (numpy.diff(grid) <= 0).any():
        raise SimulationError("t_eval must be finite and increasing")
    if grid.size and (grid[0] < span[0] or grid[-1] > span[1]):
        raise SimulationError(
            f"t_eval reaches from {grid[0]:g} s to {grid[-1]:g} s, outside {span[0]:g} s to {span[1]:g} s"
        )
    return grid


def _at(table: Any, t: float) -> numpy.ndarray:
    return at(table, numpy.array([t]))[:, 0]


def _audit(solution: Solution | SmoothSolution, start: float, end: float | None) -> Energy:
    supplied, dissipated = float(solution.supplied_end), float(solution.dissipated_end)
    if end is None:
        return Energy(supplied, None, dissipated, None)
    stored = end - start
    scale = max(abs(supplied), abs(dissipated), abs(stored), abs(start))
    residual = supplied - stored - dissipated
    return Energy(supplied, stored, dissipated, residual / scale if scale > 0 else 0.0)


def _trajectory(
    model: CompiledModel, solution: Solution, values: dict[str, float], table: Any, energy: Energy
) -> Trajectory:
    return Trajectory(
        t=solution.t,
        x=solution.x.T,
        codes=solution.codes,
        changes=solution.events,
        outcome=solution.outcome,
        t_end=solution.t_end,
        energy=energy,
        parameters=values,
        backend=solution.backend,
        steps=solution.steps,
        model=model,
        inputs=table,
        x_end=solution.x_end,
        codes_end=solution.codes_end,
    )


def _smooth_trajectory(
    model: CompiledModel,
    solution: SmoothSolution,
    values: dict[str, float],
    table: Any,
    energy: Energy,
    solver: str,
) -> Trajectory:
    none = numpy.zeros((len(solution.t), 0), dtype=numpy.int8)
    return Trajectory(
        t=solution.t,
        x=solution.x.T,
        codes=none,
        changes=(),
        outcome=solution.outcome,
        t_end=solution.t_end,
        energy=energy,
        parameters=values,
        backend="vm",
        steps=solution.steps,
        model=model,
        inputs=table,
        x_end=solution.x_end,
        codes_end=none[:0].reshape(0),
        solver=solver,
        z=solution.z.T,
        z_end=solution.z_end,
    )
