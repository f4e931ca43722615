"""Smooth numbers: the equations of one mode as functions of states, inputs and parameters.

Parameters are arguments, so a model is derived and differentiated once and then
evaluated along a whole branch of steady states.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy
import sympy

from .codegen.program import Program
from .codegen.to_casadi import to_casadi
from .elements import Friction
from .equations import Equations
from .errors import SteadyStateError
from .graph import TIME, BondGraph
from .modes import SLIP_BACKWARD, SLIP_FORWARD, STICK

Vector = Sequence[float] | numpy.ndarray


@dataclass(frozen=True)
class ContactValues:
    """What one contact does at a point.

    Attributes
    ----------
    slip, effort : float
        Flow and effort of the contact.
    limit : float
        Largest effort while stuck.
    """

    slip: float
    effort: float
    limit: float

    def better_mode(self, mode: str) -> str | None:
        """Return the mode the contact would rather be in; None where it agrees.

        Examples
        --------
        >>> ContactValues(slip=-0.1, effort=2.0, limit=3.0).better_mode("slip+")
        'stick'
        """
        if mode == STICK:
            if abs(self.effort) <= self.limit:
                return None
            return SLIP_FORWARD if self.effort > 0 else SLIP_BACKWARD
        return None if self.slip * (1 if mode == SLIP_FORWARD else -1) > 0 else STICK


class Smooth:
    """Rates, outputs, contacts and Jacobians of equations without open contacts.

    Parameters
    ----------
    equations : Equations
        Of the graph in one mode.
    graph : BondGraph
        The graph whose contacts are open, for their breakaway.
    held : collection of str
        Derived parameters that are given as numbers all the same. Other derived
        parameters are computed from those they depend on.

    Attributes
    ----------
    equations : Equations
    contacts : tuple of str
    names : tuple of str
        Order of the parameter vector.

    Raises
    ------
    SteadyStateError
        If algebraic variables are kept or a source depends on time.

    Examples
    --------
    >>> from bondgraph import I, One, R, Se, assemble, derive
    >>> v = One("v")
    >>> cart = assemble("cart", Se("F", 6) >> v >> (I("m", 2), R("b", 4)))
    >>> Smooth(derive(cart), cart).rates([1.0], [], []).tolist()
    [4.0]
    """

    def __init__(self, equations: Equations, graph: BondGraph, held: Collection[str] = ()) -> None:
        import casadi

        _check_explicit(equations)
        self.equations = equations
        laws = {
            name: element
            for name, element in graph.of(Friction)
            if not isinstance(equations.graph.elements[name], Friction)
        }
        self.contacts = tuple(laws)
        table = equations.graph.parameters
        derived = [
            symbol for symbol, row in table.items() if row.derived and symbol.name not in held
        ]
        free = [symbol for symbol in table if symbol not in derived]
        self.names = tuple(symbol.name for symbol in free)
        program = Program.pruned(
            "smooth",
            [("t", [TIME]), ("x", equations.states), ("u", equations.inputs), ("p", free)],
            [
                *((symbol, table[symbol].value) for symbol in _ordered(derived, table)),
                *equations.assignments,
            ],
            {
                "rates": equations.derivatives,
                "outputs": equations.outputs.values(),
                "contacts": _contact_rows(equations, graph, laws),
            },
        )
        _check_autonomous(equations, program)
        x = casadi.SX.sym("x", len(equations.states))
        u = casadi.SX.sym("u", len(equations.inputs))
        p = casadi.SX.sym("p", len(free))
        rates, outputs, rows = to_casadi(program)(0, x, u, p)
        jacobians = [
            casadi.densify(casadi.jacobian(of, by)) for of in (rates, outputs) for by in (x, u)
        ]
        self._rates = casadi.Function("rates", [x, u, p], [rates])
        self._state_matrix = casadi.Function("state_matrix", [x, u, p], jacobians[:1])
        self._outputs = casadi.Function("outputs", [x, u, p], [outputs])
        self._contacts = casadi.Function("contacts", [x, u, p], [rows])
        self._jacobians = casadi.Function("jacobians", [x, u, p], jacobians)

    def vector(self, values: Mapping[str, float]) -> numpy.ndarray:
        """Order SI values by name as the parameter vector; nan where there is none."""
        return numpy.array([values.get(name, numpy.nan) for name in self.names])

    def rates(self, x: Vector, u: Vector, p: Vector) -> numpy.ndarray:
        """Return the rate of each state, shape (n,)."""
        return self._rates(x, u, p).full().ravel()

    def state_matrix(self, x: Vector, u: Vector, p: Vector) -> numpy.ndarray:
        """Return the Jacobian of the rates, shape (n, n)."""
        return self._state_matrix(x, u, p).full()

    def symbolic(self, x: Any, u: Any, p: Any) -> Any:
        """Return the rates as a CasADi expression in symbolic arguments."""
        return self._rates(x, u, p)

    def outputs(self, x: Vector, u: Vector, p: Vector) -> dict[str, float]:
        """Return the outputs by name."""
        found = self._outputs(x, u, p).full().ravel()
        return dict(zip(self.equations.outputs, map(float, found), strict=True))

    def contact_values(self, x: Vector, u: Vector, p: Vector) -> dict[str, ContactValues]:
        """Return slip, effort and limit of each contact."""
        found = self._contacts(x, u, p).full().reshape(-1, 3)
        return {
            name: ContactValues(*map(float, row))
            for name, row in zip(self.contacts, found, strict=True)
        }

    def matrices(self, x: Vector, u: Vector, p: Vector) -> tuple[numpy.ndarray, ...]:
        """Return A, B, C and D.

        Raises
        ------
        SteadyStateError
            If one is not finite.
        """
        found = tuple(matrix.full() for matrix in self._jacobians(x, u, p))
        if not all(numpy.isfinite(matrix).all() for matrix in found):
            raise SteadyStateError(
                f"model {self.equations.name!r}: the Jacobian is not finite at this point"
            )
        return found


def _check_explicit(equations: Equations) -> None:
    if equations.algebraic:
        names = [symbol.name for symbol in equations.algebraic]
        raise SteadyStateError(
            f"model {equations.name!r} keeps algebraic variables ({', '.join(names)}); "
            f"add a compliance or inertia where they arise",
            elements=names,
        )


def _check_autonomous(equations: Equations, program: Program) -> None:
    expressions: Iterable[Any] = [
        *(expression for _, expression in program.assignments),
        *(expression for _, result in program.results for expression in result),
    ]
    if any(TIME in expression.free_symbols for expression in expressions):
        raise SteadyStateError(
            f"model {equations.name!r} has a source that depends on time, "
            f"so there is no steady state; make the source an input"
        )


def _ordered(derived: list[sympy.Symbol], table: Mapping[sympy.Symbol, Any]) -> list[sympy.Symbol]:
    """Order derived parameters so that each stands after those it depends on."""
    placed: dict[sympy.Symbol, None] = {}

    def place(symbol: sympy.Symbol) -> None:
        for inner in sorted(table[symbol].value.free_symbols, key=lambda item: item.name):
            if inner in derived and inner not in placed:
                place(inner)
        placed[symbol] = None

    for symbol in derived:
        if symbol not in placed:
            place(symbol)
    return list(placed)


def _contact_rows(
    equations: Equations, graph: BondGraph, laws: Mapping[str, Friction]
) -> list[sympy.Expr]:
    """Write slip, effort and breakaway of each contact in the mode's own variables."""
    variables = {
        symbol: equations.ports[f"{name}.{key}"]
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
        if f"{name}.{key}" in equations.ports
    }
    rows: list[sympy.Expr] = []
    for name, element in laws.items():
        rows += [equations.ports[f"{name}.f"], equations.ports[f"{name}.e"]]
        rows.append(element.breakaway.xreplace(variables))
    return rows
