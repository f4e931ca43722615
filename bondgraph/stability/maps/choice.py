"""Modes of contacts at many points: the first to try, and the better ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy

from ...codegen.casadi_to_numpy import on_arrays
from ...codegen.program import Program
from ...codegen.to_casadi import to_casadi
from ...elements import DryFriction, Switched
from ...equations import Equations, derive
from ...graph import BondGraph
from ...modes import CODES, SLIP_BACKWARD, SLIP_FORWARD, STICK, contacts, in_mode
from ...steady import first_possible
from ...values import start_expressions
from .numbers import picked, stacked

Array = numpy.ndarray


class FirstModes:
    """The modes that `bondgraph.steady.first_modes` finds, at many points.

    Parameters
    ----------
    graph : BondGraph
    fixed : mapping of str to str
        Modes that are given.
    names : sequence of str
        Order of the parameter vector.
    guess : mapping of str to float
    """

    def __init__(
        self,
        graph: BondGraph,
        fixed: Mapping[str, str],
        names: Sequence[str],
        guess: dict[str, float],
    ) -> None:
        self.contacts = contacts(graph)
        self._graph, self._names, self._guess = graph, tuple(names), guess
        self._start: dict[str, int] = {name: graph[name].code(mode) for name, mode in fixed.items()}
        self._free = [name for name in self.contacts if name not in fixed]
        self._equations = derive(graph) if self._free else None
        if self._equations is not None and self._equations.switches:
            found = first_possible(graph, fixed)
            self._start |= {n: graph[n].code(mode) for n, mode in found.items()}
            self._free = []
        if self._free:
            assert self._equations is not None
            slips = {item.name: item.slip for item in self._equations.contacts}
            self._slips = self._function(self._equations, [slips[name] for name in self._free])
        self._held: dict[tuple[str, ...], Any] = {}

    def at(self, p: Sequence[Any], m: int) -> Array:
        """Return the code of each contact, shape (number of contacts, m)."""
        codes = numpy.zeros((len(self.contacts), m), dtype=numpy.int8)
        for name, code in self._start.items():
            codes[self.contacts.index(name)] = code
        if not self._free:
            return codes
        ones = [numpy.ones(len(self._free)), p]
        slips = stacked(self._slips(*ones)[0], m)
        places = [self.contacts.index(name) for name in self._free]
        codes[places] = numpy.where(slips < 0, CODES[SLIP_BACKWARD], CODES[SLIP_FORWARD])
        resting = (slips == 0).T
        for pattern in numpy.unique(resting[resting.any(axis=1)], axis=0):
            at = numpy.flatnonzero((resting == pattern).all(axis=1))
            self._at_rest(codes, pattern, at, p)
        return codes

    def _at_rest(self, codes: Array, pattern: Array, at: Array, p: Sequence[Any]) -> None:
        """Let contacts without slip stay stuck unless more than their breakaway pulls at them."""
        names = tuple(name for name, rests in zip(self._free, pattern, strict=True) if rests)
        if names not in self._held:
            assert self._equations is not None
            held = derive(in_mode(self._graph, dict.fromkeys(names, STICK)))
            limits = {item.name: item.breakaway for item in self._equations.contacts}
            rows = [held.ports[f"{name}.e"] for name in names] + [limits[name] for name in names]
            self._held[names] = self._function(held, rows)
        free = [self.contacts.index(name) for name in self._free]
        signs = [codes[place, at].astype(float) for place in free]
        found = stacked(self._held[names](signs, picked(p, at))[0], len(at))
        for place, name in enumerate(names):
            effort, limit = found[place], found[len(names) + place]
            stays = limit - numpy.abs(effort) >= 0
            slips = numpy.where(effort > 0, CODES[SLIP_FORWARD], CODES[SLIP_BACKWARD])
            codes[self.contacts.index(name), at] = numpy.where(stays, CODES[STICK], slips)

    def _function(self, equations: Equations, rows: Sequence[Any]) -> Any:
        """Return rows at the start as a function of slip directions and parameters."""
        import casadi
        import sympy

        assert self._equations is not None
        base = self._equations
        given = {name: value for name, value in self._guess.items() if _starts(base, name)}
        start = dict(zip(base.states, start_expressions(base, given), strict=True))
        expanded = [equations.substituted(row).xreplace(start) for row in rows]
        table = {symbol.name: symbol for symbol in self._graph.parameters}
        signs = [item.direction for item in base.contacts if item.name in self._free]
        known = {*signs, *(table[name] for name in self._names)}
        zero = [dict.fromkeys(row.free_symbols - known, sympy.S.Zero) for row in expanded]
        program = Program.pruned(
            "first",
            [("signs", signs), ("p", [table[name] for name in self._names])],
            [],
            {"rows": [row.xreplace(none) for row, none in zip(expanded, zero, strict=True)]},
        )
        function = to_casadi(program)
        sizes = [casadi.SX.sym(f"a{i}", function.size1_in(i)) for i in range(2)]
        return on_arrays(casadi.Function("first", sizes, [function(*sizes)]))


def _starts(equations: Equations, name: str) -> bool:
    return name in equations.outputs or any(state.name == name for state in equations.states)


def better_codes(
    elements: Sequence[tuple[str, Switched]], codes: Array, rows: Sequence[Any], m: int
) -> Array:
    """Return the codes that contacts would rather have, those they have where they agree.

    Parameters
    ----------
    elements : sequence of (str, Switched)
    codes : (c,) array
        Those they have.
    rows : sequence of float or (m,) array
        Flow, effort and margins, contact by contact.
    m : int

    Returns
    -------
    (c, m) array
    """
    wanted = numpy.repeat(codes[:, None], m, axis=1)
    place = 0
    for index, (_, element) in enumerate(elements):
        code = int(codes[index])
        own = list(element.modes.values()).index(code)
        flow, effort, margin = (
            numpy.broadcast_to(rows[at], (m,)) for at in (place, place + 1, place + 2 + own)
        )
        place += 2 + len(element.modes)
        moving = isinstance(element, DryFriction) and code != 0
        agrees = (margin > 0) | ((margin == 0) & (not moving))
        for at in numpy.flatnonzero(~agrees):
            wanted[index, at] = element.next_code(code, float(effort[at]), float(flow[at]))
    return wanted
