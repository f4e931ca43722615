"""Many runs of one model of which only the ends are asked for: the inner loop of a sweep."""

from __future__ import annotations

import ctypes
import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy

from ..errors import BondGraphError
from .compiled import CompiledModel
from .ends import Ends, gathered
from .inputs import InputTable, at, gather
from .native.run import BATCH_DONE, OUTCOMES, PAUSED, NativeRun
from .outcome import Outcome
from .problem import Options, Problem
from .run import simulate
from .solvers import EXPLICIT, choose
from .starts import Columns, Starts, at_point, count_of, sorted_columns, starts_of

Array = numpy.ndarray


def run_many(
    model: CompiledModel,
    t_span: tuple[float, float],
    points: Mapping[str, Any],
    parameters: Mapping[Any, Any] | None = None,
    initial: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, Any] | None = None,
    *,
    rtol: float = 1e-6,
    atol: float = 0.0,
    max_step: float = math.inf,
    max_events: int = 100_000,
    max_steps: int = 10_000_000,
    time_budget: float = 600.0,
    solver: str = "auto",
    backend: str = "auto",
    stop: Callable[[], bool] | None = None,
) -> Ends:
    """Run a model once for each point and return how the runs end.

    Where the model runs as compiled C, so does the loop over the points; other threads can work
    meanwhile. A run is the same, to the bit, as `simulate` gives, whatever the other points are.

    Parameters
    ----------
    model : CompiledModel
    t_span : (float, float)
        Start and end, s.
    points : mapping of str to (np,) array-like
        Parameters, initial states and inputs that differ from run to run, by name, in SI. A name
        that is both belongs to the parameter.
    parameters, initial, inputs : mapping, optional
        What all runs share, as for `simulate`.
    rtol, atol, max_step, max_events, max_steps, time_budget, solver, backend
        As for `simulate`; the limits are those of each run.
    stop : callable, optional
        Asked twenty times a second; true ends the work with KeyboardInterrupt.

    Returns
    -------
    Ends
        A point that cannot be run, such as one with a negative mass, is told in its `refusals`.

    Raises
    ------
    BondGraphError
        Where no point can be run: unknown names, columns of unequal length, wrong options.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> ends = run_many(CompiledModel(mass_on_belt.graph()), (0, 2), {"k": [50.0, 100.0]})
    >>> ends.entered[:, 0, 0].tolist(), ends.outcomes[0].value
    ([2, 3], 'finished')
    """
    span = float(t_span[0]), float(t_span[1])
    limits: dict[str, Any] = {
        "rtol": rtol,
        "atol": atol,
        "max_step": max_step,
        "max_events": max_events,
        "max_steps": max_steps,
        "time_budget": time_budget,
    }
    columns = sorted_columns(model, points)
    shared = dict(parameters or {}), dict(initial or {}), dict(inputs or {})
    table = gather(model.equations, shared[2], switched=model.switched)
    explicit = choose(model, solver, backend).solver == EXPLICIT and not model.switched
    wanted = explicit and backend != "vm" and model.modes.compiled()
    if wanted and isinstance(table, InputTable) and not (columns[2] and len(table.knots) > 1):
        starts = starts_of(model, span, columns, (*shared, table))
        if solver == EXPLICIT or starts.explicit:
            options = Options(**limits, t_eval=numpy.zeros(0))
            return _native(model, span, starts, table, options, stop)
    limits |= {"solver": solver, "backend": backend}
    return _one_by_one(model, span, columns, shared, limits, stop)


# ---------------------------------------------------------------------- one after the other


def _one_by_one(
    model: CompiledModel,
    t_span: tuple[float, float],
    columns: Columns,
    shared: Sequence[dict[Any, Any]],
    limits: dict[str, Any],
    stop: Callable[[], bool] | None,
) -> Ends:
    runs: list[Any] = []
    for point in range(count_of(columns)):
        if stop is not None and stop():
            raise KeyboardInterrupt
        given, initial, inputs = (shared[i] | at_point(columns[i], point) for i in range(3))
        try:
            runs.append(simulate(model, t_span, given, initial, inputs, t_eval=[], **limits))
        except BondGraphError as error:
            runs.append(str(error))
    return gathered(model, runs)


# ---------------------------------------------------------------------- compiled


class _Batch(ctypes.Structure):
    """`Batch` of batch.c."""

    _fields_ = (
        *((name, ctypes.c_longlong) for name in ("count", "n_parameters")),
        *((name, ctypes.c_double) for name in ("t_begin", "seconds_each")),
        *((name, ctypes.c_void_p) for name in ("parameters", "x0", "weights", "energy0", "inputs")),
        *((name, ctypes.c_void_p) for name in ("t_end", "x_end", "codes", "entered", "steps")),
        ("outcomes", ctypes.c_void_p),
        *((name, ctypes.c_longlong) for name in ("at", "begun")),
        ("started", ctypes.c_double),
    )


def _native(
    model: CompiledModel,
    t_span: tuple[float, float],
    starts: Starts,
    table: InputTable,
    options: Options,
    stop: Callable[[], bool] | None,
) -> Ends:
    size, n, k = len(starts.accepted), model.modes.n, model.modes.k
    kept = {
        "parameters": starts.p,
        "x0": starts.x0,
        "weights": starts.weights,
        "energy0": starts.energy0,
        "t_end": numpy.empty(size),
        "x_end": numpy.empty((size, n + 2)),
        "codes": numpy.empty((size, k), dtype=numpy.int8),
        "entered": numpy.empty((size, k, 3), dtype=numpy.int64),
        "steps": numpy.empty((size, 3), dtype=numpy.int64),
        "outcomes": numpy.empty(size, dtype=numpy.int64),
    }
    if len(starts.u):
        kept["inputs"] = starts.u
    if size:
        problem = Problem(model.modes, starts.p[0], starts.x0[0], t_span, table)
        _loop(NativeRun(problem, options), kept, (t_span[0], options.time_budget), stop)
    return _ends(model, starts, kept, table)


def _loop(
    this: NativeRun,
    kept: Mapping[str, Array],
    begin: tuple[float, float],
    stop: Callable[[], bool] | None,
) -> None:
    """Let batch.c go through all points, serving what it asks for."""
    batch = _Batch(
        count=len(kept["t_end"]),
        n_parameters=kept["parameters"].shape[1],
        t_begin=begin[0],
        seconds_each=begin[1],
        **{name: array.ctypes.data for name, array in kept.items()},
    )
    while True:
        status = this.driver.halfarrow_batch(this.address, ctypes.addressof(batch))
        if status == BATCH_DONE:
            return
        if status == PAUSED:
            if stop is not None and stop():
                raise KeyboardInterrupt
        else:
            before = time.monotonic()
            this.serve(status)
            batch.started += time.monotonic() - before  # a compiler's time is not the run's


def _ends(
    model: CompiledModel, starts: Starts, kept: Mapping[str, Array], table: InputTable
) -> Ends:
    """Put the accepted runs among those refused."""
    size = len(starts.accepted) + len(starts.refusals)
    n, rows = model.modes.n, starts.accepted

    def whole(part: Array, empty: Any = math.nan) -> Array:
        out = numpy.full((size, *part.shape[1:]), empty, dtype=part.dtype)
        out[rows] = part
        return out

    u = starts.u if len(starts.u) else at(table, kept["t_end"]).T
    supplied, dissipated = kept["x_end"][:, n], kept["x_end"][:, n + 1]
    stored = numpy.full(len(rows), math.nan)
    if starts.tells:
        ones = numpy.ones(len(model.equations.contacts))
        arguments = zip(kept["t_end"].tolist(), kept["x_end"][:, :n], u, starts.p, strict=True)
        stored = numpy.array([model.measures(*given, ones)[-1] for given in arguments])
        stored -= starts.energy0
    missing = supplied - stored - dissipated
    scale = numpy.max(numpy.abs([supplied, dissipated, stored, starts.energy0]), axis=0)
    with numpy.errstate(invalid="ignore"):  # nothing moved, nothing is missing
        residual = numpy.where(scale == 0, 0.0, missing / scale)
    outcomes: list[Outcome | None] = [None] * size
    for point, code in zip(rows.tolist(), kept["outcomes"].tolist(), strict=True):
        outcomes[point] = OUTCOMES.get(code, Outcome.TIME_BUDGET)
    return Ends(
        model=model,
        outcomes=tuple(outcomes),
        refusals=starts.refusals,
        t_end=whole(kept["t_end"]),
        x=whole(kept["x_end"][:, :n]),
        codes=whole(kept["codes"], 0),
        entered=whole(kept["entered"], 0),
        supplied=whole(supplied),
        dissipated=whole(dissipated),
        stored=whole(stored),
        residual=whole(residual),
        steps=whole(kept["steps"][:, 0], 0),
        p=whole(starts.p),
        u=whole(u),
    )
