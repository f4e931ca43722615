"""Where the runs of a batch begin: points sorted into parameters, initial states and inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import BondGraphError, SimulationError
from ..parameters import unknown_name
from ..values import algebraic_names, require
from .compiled import CompiledModel, unit_scales
from .inputs import InputTable, at
from .solvers import EXPLICIT, Start, choose

Array = numpy.ndarray

Columns = tuple[dict[str, Array], dict[str, Array], dict[str, Array]]


def sorted_columns(model: CompiledModel, points: Mapping[str, Any]) -> Columns:
    """Sort what differs from run to run into parameters, initial values and inputs."""
    equations = model.equations
    names = {symbol.name for symbol in equations.graph.parameters}
    inputs = {symbol.name for symbol in equations.graph.inputs}
    states = {symbol.name for symbol in equations.states} | set(equations.outputs)
    states |= algebraic_names(equations)
    found: Columns = ({}, {}, {})
    lengths = set()
    for name, values in points.items():
        column = numpy.asarray(values, dtype=float)
        if column.ndim != 1:
            raise SimulationError(f"the values of {name!r} must be one row, not {column.shape}")
        lengths.add(len(column))
        place = 0 if name in names else 2 if name in inputs else 1
        if place == 1 and name not in states:
            raise unknown_name("parameter, state or input", name, sorted(names | states | inputs))
        found[place][name] = column
    if len(lengths) != 1:
        raise SimulationError(
            f"each point needs a value of every name; there are columns of {sorted(lengths)} values"
        )
    return found


def count_of(columns: Columns) -> int:
    """Number of points."""
    return len(next(column for part in columns for column in part.values()))


def at_point(columns: Mapping[str, Array], point: int) -> dict[str, float]:
    """Values of one point."""
    return {name: float(column[point]) for name, column in columns.items()}


@dataclass(frozen=True, eq=False)
class Starts:
    """Where the accepted runs begin, one row each, and why others cannot.

    Attributes
    ----------
    accepted : (na,) array of int
        Which points they are.
    refusals : dict of int to str
        Why the others are not, by point.
    p, x0, weights : (na, P), (na, n) and (na, n) arrays
        Parameters, initial states and their scales for unit energy.
    energy0 : (na,) array, J
    u : (na, m) array
        Constant inputs; no rows where all runs share theirs.
    tells : bool
        Whether the stored energy is known.
    explicit : bool
        Whether none of them is stiff.
    """

    accepted: Array
    refusals: dict[int, str]
    p: Array
    x0: Array
    weights: Array
    energy0: Array
    u: Array
    tells: bool
    explicit: bool


Shared = tuple[dict[Any, Any], dict[Any, Any], dict[Any, Any], InputTable]


def starts_of(
    model: CompiledModel, span: tuple[float, float], columns: Columns, shared: Shared
) -> Starts:
    """Evaluate where each point's run begins.

    Parameters
    ----------
    model : CompiledModel
    span : (float, float)
        Of the runs, s.
    columns : Columns
    shared : tuple
        Parameters, initial values and inputs that all runs share, and the table of these inputs.

    Returns
    -------
    Starts

    Raises
    ------
    BondGraphError
        For what refuses every point.
    """
    size, table = count_of(columns), shared[3]
    names = [symbol.name for symbol in model.equations.parameters]
    values = model.resolver.along(shared[0], columns[0], partial=True)
    rows = zip(*(column.tolist() for column in columns[0].values()), strict=True)
    points = list(rows) if columns[0] else [()] * size
    p, x0 = numpy.empty((size, len(names))), numpy.empty((size, len(model.equations.states)))
    refusals: dict[int, str] = {}
    checked = False
    for i, point in enumerate(points):
        try:
            found = values(point)
            own = shared[1] | at_point(columns[1], i) if columns[1] else shared[1]
            x0[i] = model.initial_state(found, own)
        except BondGraphError as error:
            refusals[i] = str(error)
            continue
        if not checked:
            require(model.equations, found)
            checked = True
        p[i] = [found[name] for name in names]
    same = at(table, numpy.array(span[:1])).T
    u = _varied(model, columns[2], numpy.repeat(same, size, axis=0))
    for i in numpy.flatnonzero(~numpy.isfinite(u).all(axis=1)).tolist():
        refusals.setdefault(i, "an input is not finite")
    good = numpy.array([i for i in range(size) if i not in refusals], dtype=int)
    p, x0, u = p[good], x0[good], u[good]
    ones = numpy.ones(len(model.equations.contacts))
    found_measures = [model.measures(span[0], *given, ones) for given in zip(x0, u, p, strict=True)]
    measures = numpy.array(found_measures).reshape(len(good), x0.shape[1] + 1)
    energies = measures[:, -1]
    looks = () if model.contact_names else zip(x0, u, p, strict=True)
    return Starts(
        accepted=good,
        refusals=refusals,
        p=p,
        x0=x0,
        weights=unit_scales(measures[:, :-1]),
        energy0=numpy.nan_to_num(energies, nan=0.0),
        u=u if columns[2] else u[:0],
        tells=not numpy.isnan(energies).any(),
        explicit=all(_is_explicit(model, span, table, *given) for given in looks),
    )


def _varied(model: CompiledModel, columns: Mapping[str, Array], u: Array) -> Array:
    """Put in the inputs that vary from run to run, all of which are constant over time."""
    names = [symbol.name for symbol in model.equations.inputs]
    for name, column in columns.items():
        u[:, names.index(name)] = column
    return u


def _is_explicit(
    model: CompiledModel, span: tuple[float, float], table: InputTable, x: Array, u: Array, p: Array
) -> bool:
    """Whether the run is not stiff, by the choice that `simulate` makes."""
    if len(table.knots) == 1:
        table = InputTable(table.knots, u[None], table.hold)
    return choose(model, "auto", "auto", Start(span, x, p, table)).solver == EXPLICIT
