"""Numeric functions of the modes of a switched model, made when a mode is first met."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy
import sympy

from ...codegen.program import Program
from ...codegen.to_casadi import to_casadi
from ...elements import EndStop, Switched
from ...equations import Equations
from ...errors import BondGraphError, SimulationError
from ...graph import TIME
from ...modes import ModeEquations, mode_equations

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class ModeNumbers:
    """Numeric functions of one mode; all take ``(t, x, u, p, s)``, most also ``w``.

    Attributes
    ----------
    equations : ModeEquations
    rhs : casadi.Function
        Rates of all states, supplied and dissipated power, shape (n + 2,).
    guard : casadi.Function
        Margins, then values, shape (2k,).
    relation : callable
        ``(t, x, u, p, s, w)`` to what bound states are off their relation, shape
        (b,), and its Jacobian by w, shape (b, h): w is imposed on what is held.
    push : callable
        ``(t, x, u, p, s, w)`` to the Jacobians of the state rates and powers,
        shape (n + 2, h), and of the answers, shape (k, h), by the rate of w.
    held : tuple of int
        The switch that each entry of w belongs to.
    bound : (b,) array of int
        Indices of the bound states.
    """

    equations: ModeEquations
    rhs: Any
    guard: Any
    relation: Callable[..., tuple[Array, Array]]
    push: Callable[..., tuple[Array, Array]]
    held: tuple[int, ...]
    bound: Array


class SwitchedModel:
    """The switches of a model and the numeric functions of its modes.

    Parameters
    ----------
    base : Equations
        Of the graph with all modes open.
    inputs : sequence of Symbol
        All inputs, with the rates that modes may need.
    parameters : sequence of Symbol

    Attributes
    ----------
    names : tuple of str
        Qualified names of the switching elements.
    elements : tuple of Switched
    """

    def __init__(
        self, base: Equations, inputs: Sequence[sympy.Symbol], parameters: Sequence[sympy.Symbol]
    ) -> None:
        self.base = base
        found = {name: element for name, element in base.graph.of(Switched) if element.switches}
        self.names = tuple(found)
        self.elements: tuple[Switched, ...] = tuple(found.values())
        self._inputs, self._parameters = tuple(inputs), tuple(parameters)
        self._equations: dict[int, ModeEquations | BondGraphError] = {}
        self._numbers: dict[int, ModeNumbers] = {}

    def equations(self, mask: int) -> ModeEquations:
        """Return the equations of the mode in which the switches of the mask's bits are held.

        Raises
        ------
        BondGraphError
            Where the mode cannot be.
        """
        if mask not in self._equations:
            held = [name for bit, name in enumerate(self.names) if mask >> bit & 1]
            try:
                self._equations[mask] = self._checked(mode_equations(self.base, held))
            except BondGraphError as error:
                self._equations[mask] = error
        found = self._equations[mask]
        if isinstance(found, BondGraphError):
            raise found
        return found

    def _checked(self, mode: ModeEquations) -> ModeEquations:
        algebraic = [symbol.name for symbol in mode.equations.algebraic]
        if algebraic:
            raise SimulationError(
                f"model {self.base.name!r} keeps algebraic variables ({', '.join(algebraic)}) beside switching "
                f"elements; add a compliance or inertia where they arise",
                elements=algebraic,
            )
        known = {*self._inputs, *mode.imposed.values(), *mode.imposed_rates.values()}
        foreign = [symbol.name for symbol in mode.equations.inputs if symbol not in known]
        if foreign:
            raise SimulationError(
                f"model {self.base.name!r}: a mode needs {', '.join(foreign)}, a second rate, which samples cannot "
                f"give; add a compliance or inertia behind the source or switch"
            )
        return mode

    def program(self, mask: int, name: str, results: Mapping[str, Sequence[sympy.Expr]]) -> Program:
        """Build a program in ``(t, x, u, p, s, w, v)`` on a mode's equations."""
        mode = self.equations(mask)
        stand_ins = {state: sympy.Dummy(state.name, real=True) for state in mode.bound}
        return Program.pruned(
            name,
            [
                ("t", [TIME]),
                ("x", [stand_ins.get(state, state) for state in mode.states]),
                ("u", self._inputs),
                ("p", self._parameters),
                ("s", self._directions(mode)),
                ("w", mode.imposed.values()),
                ("v", mode.imposed_rates.values()),
            ],
            mode.equations.assignments,
            {
                key: [stand_ins[state] - state for state in mode.bound]
                if key == "relation"
                else rows
                for key, rows in results.items()
            },
        )

    def _directions(self, mode: ModeEquations) -> list[sympy.Symbol]:
        return [mode.directions.get(name, sympy.Dummy(f"{name}.direction")) for name in self.names]

    def impact(self, switch: int, p: Array) -> tuple[float, float]:
        """Return restitution and rest speed of an end stop, for a parameter vector."""
        stop = self.elements[switch]
        assert isinstance(stop, EndStop)
        given = dict(zip(self._parameters, map(float, p), strict=True))
        return float(stop.restitution.subs(given)), float(stop.rest.subs(given))

    def numbers(self, mask: int) -> ModeNumbers:
        """Return the numeric functions of a mode.

        Raises
        ------
        BondGraphError
            Where the mode cannot be.
        """
        if mask not in self._numbers:
            self._numbers[mask] = self._made(mask)
        return self._numbers[mask]

    def _made(self, mask: int) -> ModeNumbers:
        import casadi

        mode = self.equations(mask)
        program = self.program(
            mask,
            "mode",
            {
                "rates": [*mode.derivatives, *_powers(mode)],
                "guards": [*mode.margins.values(), *mode.values.values()],
                "answers": list(mode.answers.values()),
                "relation": [],
            },
        )
        arguments = [casadi.SX.sym(label, len(symbols)) for label, symbols in program.arguments]
        *given, w, v = arguments
        rates, guards, answers, relation = to_casadi(program)(*arguments)
        rest = [casadi.substitute(item, casadi.vertcat(w, v), 0) for item in (rates, guards)]
        calm = lambda item: casadi.densify(casadi.substitute(item, v, 0))  # noqa: E731
        bound = [calm(relation), calm(casadi.jacobian(relation, w))]
        push = [calm(casadi.jacobian(rates, v)), calm(casadi.jacobian(answers, v))]
        order = list(mode.imposed)
        return ModeNumbers(
            equations=mode,
            rhs=casadi.Function("rhs", given, [casadi.densify(rest[0])]),
            guard=casadi.Function("guard", given, [casadi.densify(rest[1])]),
            relation=_pair(casadi.Function("relation", [*given, w], bound)),
            push=_widened(
                _pair(casadi.Function("push", [*given, w], push)),
                [order.index(name) for name in mode.imposed_rates],
                len(order),
            ),
            held=tuple(self.names.index(name) for name in order),
            bound=numpy.array([mode.states.index(state) for state in mode.bound], dtype=int),
        )


def _powers(mode: ModeEquations) -> list[sympy.Expr]:
    """Supplied and dissipated power; what a switching element takes is dissipated in any mode."""
    supplied, dissipated = [], list(mode.equations.dissipated.values())
    for name, power in mode.equations.supplied.items():
        if name in mode.imposed:
            dissipated.append(-power)
        else:
            supplied.append(power)
    return [sympy.Add(*supplied), sympy.Add(*dissipated)]


def _pair(function: Any) -> Callable[..., tuple[Array, Array]]:
    def evaluate(*arguments: Any) -> tuple[Array, Array]:
        first, second = function(*arguments)
        return first.full(), second.full()

    return evaluate


def _widened(
    function: Callable[..., tuple[Array, Array]], places: list[int], size: int
) -> Callable[..., tuple[Array, Array]]:
    """Give Jacobians by some of the rates a column for each value that is imposed."""

    def evaluate(*arguments: Any) -> tuple[Array, Array]:
        found = []
        for matrix in function(*arguments):
            wide = numpy.zeros((matrix.shape[0], size))
            wide[:, places] = matrix
            found.append(wide)
        return found[0], found[1]

    return evaluate
