"""Maps: the eigenvalues of the steady state over many points of parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy

from ...errors import ParameterError
from ...graph import BondGraph
from ...parameters import unknown_name
from ...units import to_si
from .small import WORTHWHILE
from .solver import Chunk, MapSolver
from .value import EigenvalueMap, PointOutcome

Array = numpy.ndarray

CHUNK = 8192
SEARCHES = 1000


def eigenvalue_map(
    graph: BondGraph,
    points: Mapping[Any, Any],
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, float] | None = None,
    modes: Mapping[str, str] | None = None,
    guess: Mapping[Any, float] | None = None,
    *,
    product: bool = False,
    chunk: int = CHUNK,
    workers: int = 1,
    searches: int = SEARCHES,
) -> EigenvalueMap:
    """Find the steady state and its eigenvalues at many points of parameters.

    The same as `bondgraph.steady_state` and `bondgraph.linearize` at each of the points, but on
    arrays: where the equations of rest can be put in order they are evaluated, otherwise all
    points are searched at once by Newton, and those left over one by one. A point that fails is
    a named outcome in its place.

    Parameters
    ----------
    graph : BondGraph
    points : mapping
        Parameter or input, by name or symbol, to an array in SI or to ``(array, unit)``. Arrays
        of one length are points; with `product`, each is an axis of its own.
    parameters : mapping, optional
        What is the same at all points; of what varies it is not looked at.
    inputs : mapping, optional
        Constant inputs, zero unless given.
    modes : mapping of str to str, optional
        Fix the mode of contacts. The others find theirs, point by point.
    guess : mapping, optional
        Start of the search by state.
    product : bool
        Whether to take all combinations, in the order of the mapping, the last fastest.
    chunk : int
        Points worked on at once; bounds the memory needed beside the result.
    workers : int
        Threads.
    searches : int
        Most points that may be searched one by one, which is slow; any more are "not tried".

    Returns
    -------
    EigenvalueMap

    Raises
    ------
    ParameterError
        For names that are not known, arrays that do not fit together, and what is wrong with
        the parameters that do not vary.
    BondGraphError
        Where the graph cannot be derived in any mode.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> speeds = {"V0": numpy.linspace(0.5, 1.5, 5), "v_s": numpy.array([0.05, 0.2])}
    >>> found = eigenvalue_map(bicycle_brake.graph(), speeds, product=True)
    >>> found.on_grid(found.stable)[:, 1].tolist()
    [False, False, False, True, True]
    """
    axes = {str(getattr(key, "name", key)): value for key, value in points.items()}
    if not axes:
        raise ParameterError("a map needs something that varies, such as {'V0': array}")
    units = _units(graph, axes)
    given = {name: _axis(name, value, units[name]) for name, value in axes.items()}
    size = _size(given, product)
    chunk = max(1, int(chunk))
    solver = MapSolver(
        graph, tuple(given), (parameters, inputs, modes, guess), searches, size >= WORTHWHILE
    )
    spans = [slice(first, min(first + chunk, size)) for first in range(0, size, chunk)]

    def solved(span: slice) -> Chunk:
        return solver.solve(_taken(given, product, span), span.stop - span.start)

    if workers > 1 and len(spans) > 1:
        with ThreadPoolExecutor(workers) as pool:
            found = _joined(solver, size, spans, pool.map(solved, spans))
    else:
        found = _joined(solver, size, spans, map(solved, spans))
    values = _taken(given, product, slice(0, size))
    return EigenvalueMap(graph.name, values, units, given if product else {}, *found)


def _joined(
    solver: MapSolver, size: int, spans: list[slice], chunks: Iterator[Chunk] | map[Chunk]
) -> tuple[Any, ...]:
    """Write chunks into arrays of the whole map, one after the other as they come."""
    n = len(solver.states)
    poles = numpy.full((size, n), complex(numpy.nan, numpy.nan))
    states = numpy.full((size, n), numpy.nan)
    outcomes = numpy.zeros(size, dtype=numpy.int8)
    isolated = numpy.zeros(size, dtype=bool)
    codes = numpy.zeros((len(solver.contacts), size), dtype=numpy.int8)
    reasons: dict[PointOutcome, str] = {}
    for span, part in zip(spans, chunks, strict=True):
        poles[span], states[span] = part.eigenvalues, part.states
        outcomes[span], isolated[span] = part.outcomes, part.isolated
        codes[:, span] = part.codes
        for outcome, reason in part.reasons.items():
            reasons.setdefault(outcome, reason)
    modes = dict(zip(solver.contacts, codes, strict=True))
    columns, most = solver.kept
    if len(columns) < n:
        states = states[:, columns]
    names = tuple(solver.states[column] for column in columns)
    return names, poles[:, :most], states, outcomes, modes, solver.labels, isolated, reasons


def _units(graph: BondGraph, axes: Mapping[str, Any]) -> dict[str, str]:
    known = {symbol.name: row.unit for symbol, row in graph.parameters.items()}
    known |= {symbol.name: unit for symbol, unit in graph.inputs.items()}
    for name in axes:
        if name not in known:
            raise unknown_name("parameter", name, known)
    return {name: known[name] for name in axes}


def _axis(name: str, value: Any, expected: str) -> Array:
    """Return values in SI as a plain array."""
    unit = ""
    if isinstance(value, tuple) and len(value) == 2 and isinstance(value[1], str):
        value, unit = value
    try:
        array = numpy.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ParameterError(f"parameter {name!r}: expected an array of numbers") from None
    if array.ndim != 1 or not array.size:
        raise ParameterError(
            f"parameter {name!r}: expected one row of numbers, got shape {array.shape}"
        )
    if not unit:
        return array
    try:
        zero, one = (to_si(number, unit, expected=expected) for number in (0.0, 1.0))
    except ParameterError as error:
        raise ParameterError(f"parameter {name!r}: {error}") from None
    return zero + (one - zero) * array if zero else one * array


def _size(given: Mapping[str, Array], product: bool) -> int:
    lengths = {name: len(values) for name, values in given.items()}
    if product:
        return int(numpy.prod([*lengths.values()], dtype=numpy.int64))
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise ParameterError(
            f"points need arrays of one length, got {told}; for all combinations say product=True"
        )
    return next(iter(lengths.values()))


def _taken(given: Mapping[str, Array], product: bool, span: slice) -> dict[str, Array]:
    """Return the values at some of the points."""
    if not product:
        return {name: values[span] for name, values in given.items()}
    places = numpy.unravel_index(
        numpy.arange(span.start, span.stop), tuple(map(len, given.values()))
    )
    return {
        name: values[place] for (name, values), place in zip(given.items(), places, strict=True)
    }
