"""Many runs to their ends, one after the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import BondGraphError
from ..simulation import CompiledModel, Outcome, simulate

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Ends:
    """How runs ended, a row each.

    Attributes
    ----------
    outcome : list of Outcome or str
        A text says why a run could not be started.
    t_end : (np,) array
    x : (np, n) array
    codes : (np, k) array
    entered : (np, k, 3) array
        Entries into stick, slip+ and slip-.
    supplied, dissipated : (np,) arrays
    steps : (np,) array
    """

    outcome: list[Outcome | str]
    t_end: Array
    x: Array
    codes: Array
    entered: Array
    supplied: Array
    dissipated: Array
    steps: Array


def run_many(
    model: CompiledModel,
    t_span: tuple[float, float],
    points: Mapping[str, Array],
    parameters: Mapping[str, Any] | None = None,
    initial: Mapping[str, Any] | None = None,
    inputs: Mapping[str, Any] | None = None,
    **options: Any,
) -> Ends:
    """Run a model at many points."""
    count = len(next(iter(points.values())))
    n, k = len(model.equations.states), len(model.contact_names)
    ends = Ends(
        [],
        numpy.full(count, numpy.nan),
        numpy.full((count, n), numpy.nan),
        numpy.zeros((count, k), dtype=numpy.int8),
        numpy.zeros((count, k, 3), dtype=int),
        *(numpy.full(count, numpy.nan) for _ in range(2)),
        numpy.zeros(count, dtype=int),
    )
    graph = model.equations.graph
    known = {s.name for s in graph.parameters}, {s.name for s in graph.inputs}
    for row in range(count):
        given = dict(parameters or {}), dict(inputs or {}), dict(initial or {})
        for name, column in points.items():
            role = 0 if name in known[0] else 1 if name in known[1] else 2
            given[role][name] = float(column[row])
        try:
            run = simulate(model, t_span, given[0], given[2], given[1], **options)
        except BondGraphError as error:
            ends.outcome.append(str(error))
            continue
        ends.outcome.append(run.outcome)
        ends.t_end[row], ends.steps[row] = run.t_end, run.steps
        ends.x[row], ends.codes[row] = run.x_end, run.codes_end
        ends.supplied[row], ends.dissipated[row] = run.energy.supplied, run.energy.dissipated
        for event in run.events:
            column = ("stick", "slip+", "slip-").index(event.to_mode)
            ends.entered[row, model.contact_names.index(event.element), column] += 1
    return ends
