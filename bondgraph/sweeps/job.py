"""What a sweep asks for, sorted and checked once, in a form that travels to other processes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ..dimensions import si_unit
from ..errors import ParameterError, SweepError, suggestion
from ..graph import BondGraph
from ..parameters import Parameter, unknown_name
from ..resolver import resolve
from ..simulation import CompiledModel
from ..simulation.inputs import gather
from ..simulation.problem import Options
from ..simulation.solvers import choose
from ..units import check_compatible, to_si
from ..values import algebraic_names
from .points import Points
from .quantities import ENDS, RUN, Quantity
from .read import Named

Array = numpy.ndarray

# Times of each run that quantities along the run look at.
SAMPLES = 4001


@dataclass(frozen=True, eq=False)
class Job:
    """A sweep without its points.

    Attributes
    ----------
    graph : BondGraph
    t_span : (float, float)
        s.
    quantities : tuple of Named
    shared : (dict, dict, dict)
        Parameters, initial states and inputs that all points share.
    options : dict
        Of `bondgraph.simulate`: tolerances, limits, solver and backend.
    t_eval : (nt,) array
        Times at which runs are looked at along their way.
    """

    graph: BondGraph
    t_span: tuple[float, float]
    quantities: tuple[Named, ...]
    shared: tuple[dict[str, Any], dict[str, Any], dict[str, Any]]
    options: dict[str, Any]
    t_eval: Array

    @property
    def needs(self) -> str:
        """Whether the ends of runs are enough, ``"ends"``, or not, ``"run"``."""
        kinds = {getattr(item.what, "needs", RUN) for item in self.quantities}
        return ENDS if kinds == {ENDS} else RUN


def made_job(
    model: CompiledModel,
    t_span: Any,
    quantities: tuple[Named, ...],
    shared: tuple[Mapping[Any, Any] | None, ...],
    options: Mapping[str, Any],
    t_eval: Any = None,
) -> Job:
    """Check all that does not depend on the point.

    Parameters
    ----------
    model : CompiledModel
    t_span : (float, float) or float
    quantities : tuple of Named
    shared : (mapping, mapping, mapping)
    options : mapping
    t_eval : (nt,) array-like, optional

    Returns
    -------
    Job

    Raises
    ------
    BondGraphError
        For times and tolerances that make no run, unknown names, quantities
        that the model does not have.
    """
    span = _span(t_span)
    for item in quantities:
        if isinstance(item.what, Quantity):
            item.what.check(model, span)
    _check_options(model, options)
    given: Any = tuple(
        {_name(key): value for key, value in (part or {}).items()} for part in shared
    )
    _check_shared(model, given)
    return Job(model.equations.graph, span, quantities, given, dict(options), _times(t_eval, span))


def _check_options(model: CompiledModel, options: Mapping[str, Any]) -> None:
    """Raise for what would refuse every point."""
    rtol = options["rtol"]
    if not isinstance(rtol, int | float) or not 1e-13 <= rtol <= 0.1:
        raise SweepError(f"rtol is {rtol!r}; it must lie between 1e-13 and 0.1")
    choose(model, options["solver"], options["backend"])
    limits = ("atol", "max_step", "max_events", "max_steps", "time_budget", "backend")
    Options(**{name: options[name] for name in limits})


def _check_shared(model: CompiledModel, shared: tuple[dict[str, Any], ...]) -> None:
    """Raise for names the model does not have, and values that no such parameter has."""
    parameters, initial, inputs = shared
    table = {symbol.name: symbol for symbol in model.equations.graph.parameters}
    for name, value in parameters.items():
        if name not in table:
            raise unknown_name("parameter", name, table)
        row = model.equations.graph.parameters[table[name]]
        resolve({table[name]: Parameter(None, row.unit)}, {name: value})
    states = [state.name for state in model.equations.states]
    known = [*states, *model.equations.outputs, *algebraic_names(model.equations)]
    for name in initial:
        if name not in known:
            raise unknown_name("state", name, known)
    gather(model.equations, inputs, switched=model.switched)


def in_si(model: CompiledModel, points: Points) -> dict[str, Array]:
    """Return the points' values in SI, by name.

    Raises
    ------
    SweepError, ParameterError
        For names the model does not have, and units that do not fit.
    """
    units = _units(model)
    for name in points.columns:
        if name not in units:
            hint = suggestion(name, units) or f"known: {', '.join(units)}"
            raise SweepError(f"parameter, state or input {name!r} is not known; {hint}")
    return {
        name: _converted(name, column, points.units[name], units[name])
        for name, column in points.columns.items()
    }


def unit_at(model: CompiledModel, points: Points, name: str) -> str:
    """Return the unit in which a varied name's values are given."""
    return points.units[name] or si_unit(_units(model)[name] or "")


def _units(model: CompiledModel) -> dict[str, str | None]:
    """Return what may be varied, with its unit; None where any will do."""
    equations = model.equations
    units: dict[str, str | None] = dict.fromkeys(
        [*(state.name for state in equations.states), *equations.outputs]
    )
    units |= {symbol.name: unit or None for symbol, unit in equations.graph.inputs.items()}
    return units | {symbol.name: row.unit for symbol, row in equations.graph.parameters.items()}


def _converted(name: str, column: Array, unit: str, expected: str | None) -> Array:
    if not unit:
        return column
    try:
        if expected is not None:
            check_compatible(unit, expected)
        distinct, places = numpy.unique(column, return_inverse=True)
        return numpy.array([to_si(value, unit) for value in distinct.tolist()])[places]
    except ParameterError as error:
        raise ParameterError(f"values of {name!r}: {error}") from None


def _name(key: Any) -> str:
    return key if isinstance(key, str) else str(getattr(key, "name", key))


def _span(t_span: Any) -> tuple[float, float]:
    try:
        start, end = (0.0, float(t_span)) if isinstance(t_span, int | float) else map(float, t_span)
    except (TypeError, ValueError):
        raise SweepError(f"t_span must be (start, end) in seconds, got {t_span!r}") from None
    if not (math.isfinite(start) and math.isfinite(end) and start < end):
        raise SweepError(f"t_span must be finite and run forward, got {start:g} s to {end:g} s")
    return start, end


def _times(t_eval: Any, span: tuple[float, float]) -> Array:
    if t_eval is None:
        return numpy.linspace(*span, SAMPLES)
    times = numpy.array(t_eval, dtype=float).ravel()
    inside = times.size > 1 and numpy.isfinite(times).all() and (numpy.diff(times) > 0).all()
    if not inside or times[0] < span[0] or times[-1] > span[1]:
        raise SweepError(
            f"t_eval must be two or more increasing times within {span[0]:g} s to {span[1]:g} s"
        )
    return times
