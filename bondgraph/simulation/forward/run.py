"""The public `sensitivities`: a run, and its derivatives along it."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy

from ...errors import SimulationError
from ..compiled import CompiledModel
from ..inputs import at
from ..native import CompileError
from ..run import carried_out
from .model import ForwardModel
from .native import NativeReplay
from .project import Projector
from .replay import PythonReplay
from .result import Sensitivities
from .seeds import chosen, names_of
from .smooth import beside
from .switched import SwitchedReplay
from .value import Replayed, Travelled, Undefined

if TYPE_CHECKING:
    from ...causality import CausalGraph
    from ...graph import BondGraph
    from ..trajectory import Trajectory

log = logging.getLogger(__name__)


def sensitivities(
    graph: BondGraph | CausalGraph | CompiledModel,
    t_span: tuple[float, float] | float,
    wrt: Any,
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
) -> Sensitivities:
    """Simulate, and differentiate the run by parameters and initial states, through its events.

    Parameters
    ----------
    graph, t_span, parameters, initial, inputs, t_eval, rtol
        As for `simulate`.
    wrt : sequence of str or Symbol
        Parameters of the model's table, and states, whose initial value is meant. A
        parameter acts through the table's expressions, and through initial values
        that depend on it; those derived ones that `parameters` gives a number stay.
        A derived parameter is moved alone, as if it were overridden.
    atol, max_step, max_events, max_steps, time_budget, backend, solver
        As for `simulate`.

    Returns
    -------
    Sensitivities
        With the trajectory, bit for bit that of `simulate`.

    Raises
    ------
    BondGraphError
        When the run cannot be started; for unknown names in `wrt`; and where there
        is no derivative, as at a grazing contact, with the time and the element.

    Notes
    -----
    With dopri5 the run's own steps are made again with S = dx/dtheta, dS/dt = f_x S + f_p P.
    The steps are chosen by the states alone, so S is the derivative of what was
    computed; its error is not controlled, and goes with rtol as that of the states.
    At an event the time moves by dt = -(g_x S + g_p P)/(dg/dt), and S jumps by
    (f_before - f_after) dt. The other solvers integrate S beside the states, with the
    same tolerance.

    References
    ----------
    Hiskens, Pai, Trajectory sensitivity analysis of hybrid systems, IEEE Transactions
    on Circuits and Systems I 47 (2000) 204-220.

    Examples
    --------
    A mass on a belt starts at its speed and lets go at t = F/(k v_b):

    >>> from bondgraph.models import mass_on_belt
    >>> found = sensitivities(
    ...     mass_on_belt.graph(), 0.5, ["k", "v_b"], {"c": 0}, {"v": 0.15}, rtol=1e-9
    ... )
    >>> found.trajectory.events[0].from_mode, [round(float(v), 6) for v in found.events[0]]
    ('stick', [-0.002667, -1.777778])
    """
    model = graph if isinstance(graph, CompiledModel) else CompiledModel(graph)
    names = chosen(model.equations, wrt)
    began = time.monotonic()
    trajectory = carried_out(
        model,
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
        record=True,
    )
    forward: ForwardModel = model.forward
    seeds = forward.seeds(names, names_of(parameters or {}), names_of(initial or {}))
    deadline = began + time_budget
    if trajectory.solver != "dopri5":
        return beside(forward.beside(len(names)), trajectory, names, seeds, deadline)
    return _replayed(forward, trajectory, names, seeds, deadline)


def _replayed(
    forward: ForwardModel,
    run: Trajectory,
    names: tuple[str, ...],
    seeds: Any,
    deadline: float,
) -> Sensitivities:
    travelled = _travelled(run, seeds)
    try:
        found = _replay(forward, run, travelled, deadline)
    except Undefined as failure:
        raise failure.named(run.model.contact_names) from None
    return Sensitivities(
        trajectory=run,
        wrt=names,
        x=found.rows.transpose(1, 2, 0),
        x_end=found.end,
        events=found.events,
        z=numpy.zeros((0, len(names), len(run.t))),
        seeds=travelled.seeds,
    )


def _travelled(run: Trajectory, seeds: Any) -> Travelled:
    assert run.kept is not None
    solution, options = run.kept.solution, run.kept.options
    assert solution is not None and solution.record is not None
    steps = solution.record
    end = numpy.concatenate([[run.t_end, 0.0, len(solution.events)], run.x_end])
    record = numpy.concatenate([steps, end[None]])
    events = numpy.array([event[1:4] for event in solution.events], dtype=int).reshape(-1, 3)
    codes = numpy.array(run.codes_end, dtype=float)
    for switch, before, _ in events[::-1]:
        codes[switch] = before
    model = run.model
    p = numpy.array([run.parameters[symbol.name] for symbol in model.equations.parameters])
    by_p, by_x = seeds(run.parameters, run.kept.problem.x0)
    return Travelled(
        record=record,
        events=events,
        codes=codes,
        parameters=p,
        inputs=run.inputs,
        t_eval=options.t_eval,
        rows=len(run.t),
        seeds=by_p,
        start=by_x,
        noise=options.rtol,
    )


def _too_late() -> SimulationError:
    return SimulationError(
        "the seconds allowed were used up before the sensitivities were done; raise time_budget, "
        "loosen rtol or shorten the time span"
    )


def _replay(
    forward: ForwardModel, run: Trajectory, travelled: Travelled, deadline: float
) -> Replayed:
    if run.model.switched:
        assert run.kept is not None
        x0 = run.kept.problem.x0
        return SwitchedReplay(forward.switched, travelled, x0).to_the_end(deadline, _too_late)
    table = forward.tangents
    project = Projector(
        table, travelled.parameters, lambda t: at(run.inputs, numpy.array([t]))[:, 0]
    )
    if run.backend == "native":
        try:
            return NativeReplay(table, travelled, project).to_the_end(deadline, _too_late)
        except CompileError as failure:
            log.warning("sensitivities without compiled code, slower: %s", failure)
    return PythonReplay(table, travelled, project).to_the_end(deadline, _too_late)
