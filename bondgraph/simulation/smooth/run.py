"""Runs of smooth models by CasADi's integrators: a problem in, rows out."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy

from ...errors import SimulationError
from ..inputs import Functions, InputTable, at
from ..outcome import Outcome
from ..problem import Options
from .functions import SmoothFunctions, solve_algebraic
from .march import March
from .pieces import own_grid, pieces
from .plugin import Plugin
from .scales import Sizes, typical

Array = numpy.ndarray

# So often a run is made, at most, where states stay far smaller than was estimated.
RUNS = 4
# Times at which sources are looked at for the size of what they drive.
PROBES = 17
# Of the run's tolerance, and the least: how near cubics follow inputs that are functions of time.
SHARE, FINEST = 0.1, 1e-9


@dataclass(frozen=True, eq=False)
class SmoothProblem:
    """What to integrate, and how.

    Attributes
    ----------
    functions : SmoothFunctions
    parameters : (np,) array
    x0 : (n,) array
    z0 : (nz,) array
        Consistent with x0 and the inputs at the start.
    t_span : (float, float)
        Start and end, s.
    inputs : InputTable
    solver : {"cvodes", "idas", "rosenbrock"}
    options : Options
        Output times, unless given, are those of `bondgraph.simulation.smooth.pieces.own_grid`.
    """

    functions: SmoothFunctions
    parameters: Array
    x0: Array
    z0: Array
    t_span: tuple[float, float]
    inputs: InputTable
    solver: str
    options: Options


@dataclass(frozen=True, eq=False)
class SmoothSolution:
    """Rows of a run and its last good point.

    Attributes
    ----------
    t : (nt,) array
    x : (nt, n) array
    z : (nt, nz) array
    outcome : Outcome
    t_end, x_end, z_end
        The last good point, whatever the outcome.
    supplied_end, dissipated_end : float
        Energies from the start to there, J.
    steps : int
    """

    t: Array
    x: Array
    z: Array
    outcome: Outcome
    t_end: float
    x_end: Array
    z_end: Array
    supplied_end: float
    dissipated_end: float
    steps: int


def tabled(
    inputs: InputTable | Callable[[float], Array], span: tuple[float, float], rtol: float
) -> InputTable:
    """Return inputs as a table; functions of time are followed within a tenth of `rtol`.

    Raises
    ------
    SimulationError
        For a function that cannot be followed.
    """
    if isinstance(inputs, InputTable):
        return inputs
    if isinstance(inputs, Functions):
        return inputs.table(span, max(SHARE * rtol, FINEST))
    raise SimulationError(
        "an input that is a Python function has to come with its name; give Samples(times, values), "
        "or write the source as an expression of time"
    )


def integrate_smooth(problem: SmoothProblem) -> SmoothSolution:
    """Integrate a smooth model.

    Notes
    -----
    The run is cut where inputs jump or bend, so that no step crosses a knot; after a
    jump the algebraic variables are solved anew. States are kept on the branch of
    the algebraic equations on which they start: where it ends in a fold, so does the
    run. Where states turn out far smaller than the estimate by which their errors were
    measured, the run is made again with sizes that fit.
    """
    functions, p, options = problem.functions, problem.parameters, problem.options
    parts = pieces(problem.inputs, problem.t_span)
    times = own_grid(parts) if options.t_eval is None else options.t_eval
    start, end = problem.t_span
    plugin = Plugin(functions, problem.solver, options.rtol, float(options.atol), options.max_step)
    first = problem.x0, problem.z0
    began, spent = time.monotonic(), 0
    with numpy.errstate(all="ignore"):  # what is not finite ends in an outcome
        sizes = typical(functions, _samples(problem), first, p, end - start)
        for _ in range(RUNS):
            left = replace(
                options,
                max_steps=options.max_steps - spent,
                time_budget=options.time_budget - (time.monotonic() - began),
            )
            found = Sizes(sizes, first)
            march = March(functions, plugin, p, *first, found, left)
            outcome = march.run(parts, times)
            spent += march.steps
            better = found.corrected()
            if better is None or outcome in (Outcome.STEP_LIMIT, Outcome.TIME_BUDGET):
                break
            sizes = better[0], better[1] if outcome.ok else sizes[1]
    t, x, z, _ = zip(*march.rows, strict=True) if march.rows else ((), (), (), ())
    rows = numpy.array(z).reshape(len(t), functions.nz)
    z_end = _closed(problem, march)
    if len(t) and t[-1] == march.t:
        rows[-1] = z_end
    return SmoothSolution(
        numpy.array(t, dtype=float),
        numpy.array(x).reshape(len(t), functions.n),
        rows,
        outcome,
        march.t,
        march.x,
        z_end,
        float(march.work[0]),
        float(march.work[1]),
        spent,
    )


def _samples(problem: SmoothProblem) -> list[tuple[float, Array]]:
    """Return times and inputs that occur: at the start, spread over the run, and at extremes."""
    start, end = problem.t_span
    # no fixed fraction of the run, so that a periodic source is not met at its zeros only
    spread = start + (end - start) * numpy.modf(numpy.arange(PROBES) * 0.6180339887498949)[0]
    values = at(problem.inputs, spread)
    inside = problem.inputs.values
    samples = [(float(moment), values[:, index]) for index, moment in enumerate(spread)]
    for extreme in (inside.max(axis=0), inside.min(axis=0)):
        samples.append((start, extreme))
    return samples


def _closed(problem: SmoothProblem, march: March) -> Array:
    """Return algebraic values at the last point, consistent with a jump right there."""
    u = at(problem.inputs, numpy.array([march.t]))[:, 0]
    found = solve_algebraic(problem.functions, march.t, march.x, u, problem.parameters, march.z)
    return march.z if found is None else found
