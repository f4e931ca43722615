"""A chunk of points from parameters to eigenvalues, mode by mode."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy

from ...elements import C, Storage
from ...equations import Equations, derive
from ...errors import BondGraphError, SteadyStateError
from ...graph import BondGraph
from ...modes import contacts, in_mode
from ...steady import MAX_MODE_CHANGES, check_guess, find_rest, input_values
from .choice import FirstModes, better_codes
from .eigen import eigenvalues, falling
from .newton import newton
from .numbers import Evaluated, ModeNumbers, picked
from .reduction import state_matrices, with_algebraic
from .small import eigvals
from .table import Table
from .value import PointOutcome

Array = numpy.ndarray
Given = tuple[
    Mapping[Any, Any] | None,
    Mapping[Any, float] | None,
    Mapping[str, str] | None,
    Mapping[Any, float] | None,
]


@dataclass(eq=False)
class Chunk:
    """Results of m points; the attributes are those of `EigenvalueMap`, filled on the way."""

    eigenvalues: Array
    states: Array
    outcomes: Array
    isolated: Array
    codes: Array
    reasons: dict[PointOutcome, str] = field(default_factory=dict)

    def fail(self, at: Array, outcome: PointOutcome, reason: str) -> None:
        """Name the outcome of points that have no result."""
        if at.size:
            self.outcomes[at] = outcome
            self.reasons.setdefault(outcome, reason)


class MapSolver:
    """What all chunks of a map share: the parameter table and the modes met so far.

    Parameters
    ----------
    graph : BondGraph
    names : tuple of str
        What varies: parameters or inputs.
    given : (parameters, inputs, modes, guess)
    searches : int
        Most points that may be searched one by one.
    compiled : bool
        Whether eigenvalues are worth being worked out by compiled code.

    Attributes
    ----------
    contacts : tuple of str
    labels : dict of str to dict of int to str
        Names of the codes of each contact's modes.
    """

    def __init__(
        self,
        graph: BondGraph,
        names: tuple[str, ...],
        given: Given,
        searches: int,
        compiled: bool = False,
    ) -> None:
        parameters, inputs, modes, guess = given
        self.graph = graph
        self.contacts = contacts(graph)
        self._elements = tuple((name, graph[name]) for name in self.contacts)
        self.labels = {
            name: {code: label for label, code in element.modes.items()}
            for name, element in self._elements
        }
        check_guess(graph, guess)
        self._guess = {str(getattr(k, "name", k)): float(v) for k, v in (guess or {}).items()}
        self._fixed = dict(modes or {})
        in_mode(graph, self._fixed)  # to refuse what it refuses
        base = derive(graph)
        table = {symbol.name for symbol in graph.parameters}
        self._inputs = input_values(base, inputs)
        self._varied = tuple(name for name in names if name in table)
        self._table = Table(base, parameters or {}, self._varied)
        self._names = self._table.names
        self._first = FirstModes(graph, self._fixed, self._names, self._guess)
        self._modes: dict[tuple[int, ...], ModeNumbers | BondGraphError] = {}
        self._lock = threading.RLock()
        self._searches, self._compiled = searches, compiled
        self._states = _all_states(base)

    @property
    def kept(self) -> tuple[list[int], int]:
        """Columns of the states that some mode met has, and the most states that one has."""
        met = [item for item in self._modes.values() if isinstance(item, ModeNumbers)]
        names = {symbol.name for item in met for symbol in item.equations.states}
        columns = [place for place, name in enumerate(self._states) if name in names]
        return columns, max((item.order for item in met), default=0)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of all states that a mode may have, the whole graph's first."""
        return self._states

    def solve(self, points: Mapping[str, Array], m: int) -> Chunk:
        """Find steady states and eigenvalues at m points.

        Parameters
        ----------
        points : mapping of str to (m,) array
        m : int

        Returns
        -------
        Chunk
        """
        chunk = self._empty(m)
        values, refusal = self._table.at(points, m)
        chunk.fail(numpy.flatnonzero(refusal.at), PointOutcome.REFUSED, refusal.reason)
        p = [values[name] for name in self._names]
        given = {name: points.get(name, value) for name, value in self._inputs.items()}
        codes = self._first.at(p, m)
        for place, name in enumerate(self.contacts):
            if name in self._fixed:
                codes[place] = self.graph[name].code(self._fixed[name])
        chunk.codes[:] = codes
        waiting = numpy.flatnonzero(~refusal.at)
        tried: dict[tuple[int, ...], Array] = {}
        for _ in range(MAX_MODE_CHANGES):
            if not waiting.size:
                break
            waiting = self._round(chunk, waiting, (given, p), tried)
        chunk.fail(waiting, PointOutcome.NO_STEADY_STATE, self._no_modes())
        return chunk

    def _empty(self, m: int) -> Chunk:
        n = len(self.states)
        return Chunk(
            numpy.full((m, n), complex(numpy.nan, numpy.nan)),
            numpy.full((m, n), numpy.nan),
            numpy.zeros(m, dtype=numpy.int8),
            numpy.zeros(m, dtype=bool),
            numpy.zeros((len(self.contacts), m), dtype=numpy.int8),
        )

    def _no_modes(self) -> str:
        return (
            f"model {self.graph.name!r} has no steady state that agrees with its contacts' modes "
            f"near the start; give modes={{...}} or another guess"
        )

    def _round(
        self,
        chunk: Chunk,
        waiting: Array,
        given: tuple[dict[str, Any], list[Any]],
        tried: dict[tuple[int, ...], Array],
    ) -> Array:
        """Solve all points in the modes they are in; return those that want others."""
        left: list[Array] = []
        for column, at in _groups(chunk.codes[:, waiting], waiting):
            key = tuple(int(code) for code in column)
            before = tried.setdefault(key, numpy.zeros(len(chunk.outcomes), dtype=bool))
            chunk.fail(at[before[at]], PointOutcome.NO_STEADY_STATE, self._no_modes())
            at = at[~before[at]]
            before[at] = True
            numbers = self._numbers(key)
            if isinstance(numbers, BondGraphError):
                chunk.fail(at, PointOutcome.NO_STEADY_STATE, str(numbers))
            elif at.size:
                left.append(self._in_mode(chunk, at, key, numbers, given))
        return numpy.sort(numpy.concatenate(left)) if left else numpy.zeros(0, dtype=int)

    def _numbers(self, key: tuple[int, ...]) -> ModeNumbers | BondGraphError:
        """Return the functions of a mode, made when it is first met."""
        with self._lock:
            if key not in self._modes:
                modes = {
                    name: element.label(code)
                    for (name, element), code in zip(self._elements, key, strict=True)
                }
                try:
                    self._modes[key] = ModeNumbers(self.graph, modes, self._names, self._guess)
                except BondGraphError as error:
                    if not self._modes:
                        raise
                    self._modes[key] = error
            return self._modes[key]

    def _in_mode(
        self,
        chunk: Chunk,
        at: Array,
        key: tuple[int, ...],
        numbers: ModeNumbers,
        given: tuple[dict[str, Any], list[Any]],
    ) -> Array:
        """Solve points in one mode; return those whose contacts want another."""
        inputs, values = given
        u = picked([inputs.get(s.name, 0.0) for s in numbers.equations.inputs], at)
        p = picked(values, at)
        found, good, isolated = self._rest(chunk, at, numbers, u, p)
        at, u, p = at[good], picked(u, good), picked(p, good)
        found, isolated = _chosen(found, good), isolated[good]
        wanted = better_codes(self._elements, numpy.array(key), found.contacts, len(at))
        for place, name in enumerate(self.contacts):
            if name in self._fixed:
                wanted[place] = key[place]
        moved = (wanted != numpy.array(key)[:, None]).any(axis=0)
        chunk.codes[:, at[moved]] = wanted[:, moved]
        stay = ~moved
        if stay.all():
            self._keep(chunk, at, numbers, found, isolated, (u, p))
        elif stay.any():
            rest = picked(u, stay), picked(p, stay)
            self._keep(chunk, at[stay], numbers, _chosen(found, stay), isolated[stay], rest)
        return at[moved]

    def _rest(
        self, chunk: Chunk, at: Array, numbers: ModeNumbers, u: list[Any], p: list[Any]
    ) -> tuple[Evaluated, Array, Array]:
        """Return steady states, which of the points have one, and which are isolated."""
        m = len(at)
        good, isolated = numpy.zeros(m, dtype=bool), numpy.ones(m, dtype=bool)
        if numbers.explicit:
            found = numbers.rest(u, p, m)
            good = numbers.settled(found)
            if good.all():
                return found, good, isolated
            x = found.x.copy()
        else:
            x = numpy.full((numbers.size, m), numpy.nan)
        if not numbers.searched:
            rest = numpy.flatnonzero(~good)
            x[:, rest], good[rest], isolated[rest] = _searched(
                numbers, picked(u, rest), picked(p, rest), len(rest)
            )
        for place in numpy.flatnonzero(~good).tolist():
            x[:, place], good[place], isolated[place] = self._alone(chunk, at, place, numbers, u, p)
        return numbers.at(x, u, p), good, isolated

    def _alone(
        self,
        chunk: Chunk,
        at: Array,
        place: int,
        numbers: ModeNumbers,
        u: list[Any],
        p: list[Any],
    ) -> tuple[Array, bool, bool]:
        """Search one point as `bondgraph.steady_state` does."""
        none = numpy.full(numbers.size, numpy.nan), False, False
        where = at[place : place + 1]
        with self._lock:
            self._searches -= 1
            if self._searches < 0:
                chunk.fail(where, PointOutcome.NOT_TRIED, "give a larger `searches`")
                return none
        own_u, own_p = ([float(v[place]) for v in row] for row in _wide((u, p), len(at)))
        states = numbers.start(own_u, own_p, 1)[:, 0]
        try:
            with numpy.errstate(all="ignore"):  # trial values may overflow; they are turned down
                x, isolated = find_rest(
                    numbers.smooth, numbers.modes, (states, numbers.algebraic_start), own_u, own_p
                )
        except SteadyStateError as error:
            chunk.fail(where, PointOutcome.NO_STEADY_STATE, str(error))
            return none
        return x, True, isolated

    def _keep(
        self,
        chunk: Chunk,
        at: Array,
        numbers: ModeNumbers,
        found: Evaluated,
        isolated: Array,
        given: tuple[list[Any], list[Any]],
    ) -> None:
        """Work out the eigenvalues at steady states and keep both."""
        states = [symbol.name for symbol in numbers.equations.states]
        columns = [self.states.index(name) for name in states]
        for row, column in enumerate(columns):
            chunk.states[at, column] = found.x[row]
        chunk.isolated[at] = isolated
        finite = numpy.isfinite(sum(found.slopes, numpy.zeros(len(at))))
        chunk.fail(
            at[~finite], PointOutcome.NOT_FINITE, "the Jacobian is not finite at the steady state"
        )
        if not finite.all():
            at, found = at[finite], _chosen(found, finite)
            given = picked(given[0], finite), picked(given[1], finite)
        if not numbers.equations.algebraic:
            poles = eigenvalues(
                found.slopes,
                numbers.rows,
                numbers.columns,
                numbers.blocks,
                len(at),
                self._compiled,
            )
        else:
            matrices, determined = state_matrices(numbers, found, *given)
            names = ", ".join(symbol.name for symbol in numbers.equations.algebraic)
            chunk.fail(
                at[~determined],
                PointOutcome.NOT_DETERMINED,
                f"the algebraic variables ({names}) are not determined by their equations",
            )
            at = at[determined]
            poles = falling(eigvals(matrices[determined], self._compiled))
        chunk.eigenvalues[at, : len(states)] = poles


def _groups(codes: Array, points: Array) -> list[tuple[Array, Array]]:
    """Return the columns that differ, each with the points that have it."""
    if (codes == codes[:, :1]).all():
        return [(codes[:, 0], points)]
    return [
        (column, points[(codes == column[:, None]).all(axis=0)])
        for column in numpy.unique(codes, axis=1).T
    ]


def _all_states(base: Equations) -> tuple[str, ...]:
    """Return the names of the states, and of those that a mode may free behind them."""
    names = [symbol.name for symbol in base.states]
    storages = (
        f"{name}.{'q' if isinstance(element, C) else 'p'}"
        for name, element in base.graph.of(Storage)
    )
    return tuple(dict.fromkeys([*names, *storages]))


def _searched(
    numbers: ModeNumbers, u: list[Any], p: list[Any], m: int
) -> tuple[Array, Array, Array]:
    """Search all points at once from their initial states."""
    if not m:
        none = numpy.zeros(0, dtype=bool)
        return numpy.zeros((numbers.size, 0)), none, none

    def functions(x: Array, points: Array) -> tuple[Array, Array]:
        found = numbers.at(x, picked(u, points), picked(p, points))
        return found.rates, numbers.dense(found.slopes, len(points))

    start, begun = with_algebraic(numbers, numbers.start(u, p, m), u, p)
    x, found, isolated = newton(functions, start)
    return x, found & begun, isolated


def _chosen(found: Evaluated, at: Array) -> Evaluated:
    if at.dtype == bool and at.all():
        return found
    return Evaluated(
        found.x[:, at], found.rates[:, at], picked(found.slopes, at), picked(found.contacts, at)
    )


def _wide(rows: tuple[list[Any], list[Any]], m: int) -> list[list[Array]]:
    return [[numpy.broadcast_to(value, (m,)) for value in row] for row in rows]
