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

from .codegen.program import Program, ProgramError
from .codegen.to_casadi import to_casadi
from .consistent import consistent
from .elements import DryFriction, Switched
from .equations import Equations
from .errors import SteadyStateError
from .graph import TIME, BondGraph

Vector = Sequence[float] | numpy.ndarray

# Of the terms of a residual.
ROUNDING = 1e-13


@dataclass(frozen=True)
class ContactValues:
    """What one switching element does at a point.

    Attributes
    ----------
    element : Switched
    flow, effort : float
    margins : tuple of float
        What has to be positive for each mode to last, ordered as ``element.modes``.
    """

    element: Switched
    flow: float
    effort: float
    margins: tuple[float, ...]

    def better_mode(self, mode: str) -> str | None:
        """Return the mode the element would rather be in; None where it agrees.

        Examples
        --------
        >>> from bondgraph import Friction
        >>> belt = Friction("belt", kinetic=lambda speed: 3)
        >>> ContactValues(belt, -0.1, 2.0, (1.0, -0.1, 0.1)).better_mode("slip+")
        'stick'
        """
        code = self.element.code(mode)
        margin = self.margins[list(self.element.modes).index(mode)]
        moving = isinstance(self.element, DryFriction) and code
        if margin > 0 or (margin == 0 and not moving):
            return None
        return self.element.label(self.element.next_code(code, self.effort, self.flow))


class Smooth:
    """Rates, outputs, contacts and Jacobians of equations without open contacts.

    Where algebraic variables are kept they stand behind the states in every vector
    x, and what their equations leave behind the rates; a point is at rest where all
    of it is zero.

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
    order : int
        Number of states.

    Raises
    ------
    SteadyStateError
        If a source depends on time, or a law has no numeric form.

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

        self.equations = equations
        self.order = len(equations.states)
        laws = {
            name: element
            for name, element in graph.of(Switched)
            if not isinstance(equations.graph.elements[name], Switched)
        }
        self._laws = tuple(laws.values())
        self.contacts = tuple(laws)
        table = equations.graph.parameters
        derived = [
            symbol for symbol, row in table.items() if row.derived and symbol.name not in held
        ]
        free = [symbol for symbol in table if symbol not in derived]
        self.names = tuple(symbol.name for symbol in free)
        program = Program.pruned(
            "smooth",
            [
                ("t", [TIME]),
                ("x", (*equations.states, *equations.algebraic)),
                ("u", equations.inputs),
                ("p", free),
            ],
            [
                *((symbol, table[symbol].value) for symbol in in_dependence(derived, table)),
                *equations.assignments,
            ],
            {
                "rates": (*equations.derivatives, *equations.residuals),
                "outputs": equations.outputs.values(),
                "contacts": _contact_rows(equations, graph, laws),
            },
        )
        _check_autonomous(equations, program)
        x = casadi.SX.sym("x", self.order + len(equations.algebraic))
        u = casadi.SX.sym("u", len(equations.inputs))
        p = casadi.SX.sym("p", len(free))
        try:
            rates, outputs, rows = to_casadi(program)(0, x, u, p)
        except ProgramError as error:
            raise SteadyStateError(
                f"model {equations.name!r} cannot be turned into numbers: {error}"
            ) from None
        jacobians = [
            casadi.densify(casadi.jacobian(of, by)) for of in (rates, outputs) for by in (x, u)
        ]
        self._rates = casadi.Function("rates", [x, u, p], [rates])
        self._jacobian = casadi.Function("jacobian", [x, u, p], jacobians[:1])
        self._outputs = casadi.Function("outputs", [x, u, p], [outputs])
        self._contacts = casadi.Function("contacts", [x, u, p], [rows])
        self._jacobians = casadi.Function("jacobians", [x, u, p], jacobians)

    def vector(self, values: Mapping[str, float]) -> numpy.ndarray:
        """Order SI values by name as the parameter vector; nan where there is none."""
        return numpy.array([values.get(name, numpy.nan) for name in self.names])

    def rates(self, x: Vector, u: Vector, p: Vector) -> numpy.ndarray:
        """Return the rate of each state, shape (n,); behind them what is left of the residuals."""
        return self._rates(x, u, p).full().ravel()

    def jacobian(self, x: Vector, u: Vector, p: Vector) -> numpy.ndarray:
        """Return the Jacobian of `rates` in x."""
        return self._jacobian(x, u, p).full()

    def state_matrix(self, x: Vector, u: Vector, p: Vector) -> numpy.ndarray:
        """Return the Jacobian of the states' rates, algebraic variables following, shape (n, n).

        Raises
        ------
        SteadyStateError
            If the residuals do not determine the algebraic variables here.
        """
        if not self.equations.algebraic:
            return self.jacobian(x, u, p)
        return self.matrices(x, u, p)[0]

    def consistent(
        self, states: Vector, u: Vector, p: Vector, guess: Vector
    ) -> numpy.ndarray | None:
        """Return a point at given states: with algebraic variables that solve the residuals.

        Parameters
        ----------
        states : (n,) sequence of float
        u, p : sequence of float
        guess : (nz,) sequence of float
            Of the algebraic variables; see `bondgraph.consistent.consistent`.

        Returns
        -------
        (n + nz,) array or None
            None where no solution is found.
        """
        n = self.order
        fixed = numpy.array(states, dtype=float)

        def residual(z: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
            x = numpy.concatenate([fixed, z])
            left, slopes, _, terms = self._residual(x, u, p)
            return left, slopes[:, n:], terms

        found = consistent(residual, numpy.array(guess, dtype=float))
        return None if found is None else numpy.concatenate([fixed, found])

    def _residual(self, x: Vector, u: Vector, p: Vector) -> tuple[numpy.ndarray, ...]:
        """Return what is left of the residuals, slopes by x and u, and the size of the terms."""
        n = self.order
        left = self.rates(x, u, p)[n:]
        by_x, by_u = (matrix.full()[n:] for matrix in self._jacobians(x, u, p)[:2])
        terms = numpy.abs(by_x) @ numpy.abs(x) + numpy.abs(by_u) @ numpy.abs(numpy.asarray(u))
        return left, by_x, by_u, terms + numpy.abs(left)

    def symbolic(self, x: Any, u: Any, p: Any) -> Any:
        """Return the rates as a CasADi expression in symbolic arguments."""
        return self._rates(x, u, p)

    def symbolic_contacts(self, x: Any, u: Any, p: Any) -> Any:
        """Return flow, effort and margins of each switching element as a CasADi expression."""
        return self._contacts(x, u, p)

    def outputs(self, x: Vector, u: Vector, p: Vector) -> dict[str, float]:
        """Return the outputs by name."""
        found = self._outputs(x, u, p).full().ravel()
        return dict(zip(self.equations.outputs, map(float, found), strict=True))

    def element(self, name: str) -> Switched | None:
        """Return a switching element by its qualified name."""
        return dict(zip(self.contacts, self._laws, strict=True)).get(name)

    def contact_values(self, x: Vector, u: Vector, p: Vector) -> dict[str, ContactValues]:
        """Return flow, effort and margins of each switching element."""
        found = iter(self._contacts(x, u, p).full().ravel().tolist())
        values = {}
        for name, element in zip(self.contacts, self._laws, strict=True):
            flow, effort = next(found), next(found)
            margins = tuple(next(found) for _ in element.modes)
            values[name] = ContactValues(element, flow, effort, margins)
        return values

    def matrices(self, x: Vector, u: Vector, p: Vector) -> tuple[numpy.ndarray, ...]:
        """Return A, B, C and D; algebraic variables follow states and inputs.

        Raises
        ------
        SteadyStateError
            If one is not finite, or the residuals do not determine the algebraic
            variables here.
        """
        found = tuple(matrix.full() for matrix in self._jacobians(x, u, p))
        if not all(numpy.isfinite(matrix).all() for matrix in found):
            raise SteadyStateError(
                f"model {self.equations.name!r}: the Jacobian is not finite at this point; "
                f"a law has no slope there, such as an orifice without flow: take another point"
            )
        return self._eliminated(found, x, u, p) if self.equations.algebraic else found

    def _eliminated(
        self, found: tuple[numpy.ndarray, ...], x: Vector, u: Vector, p: Vector
    ) -> tuple[numpy.ndarray, ...]:
        """Let the algebraic variables follow, by the implicit function theorem."""
        n = self.order
        rates_x, rates_u, outputs_x, outputs_u = found
        right = numpy.hstack([rates_x[n:, :n], rates_u[n:]])
        try:
            follow = numpy.linalg.solve(rates_x[n:, n:], -right)
            determined = numpy.isfinite(follow).all() and self._determined(x, u, p)
        except numpy.linalg.LinAlgError:
            determined = False
        if not determined:
            names = [symbol.name for symbol in self.equations.algebraic]
            raise SteadyStateError(
                f"model {self.equations.name!r}: the algebraic variables ({', '.join(names)}) are "
                f"not determined at this point, the Jacobian of their equations is singular; add "
                f"a compliance or inertia where they arise, or take another point",
                elements=names,
            )
        by_x, by_u = follow[:, :n], follow[:, n:]
        return (
            rates_x[:n, :n] + rates_x[:n, n:] @ by_x,
            rates_u[:n] + rates_x[:n, n:] @ by_u,
            outputs_x[:, :n] + outputs_x[:, n:] @ by_x,
            outputs_u + outputs_x[:, n:] @ by_u,
        )

    def _determined(self, x: Vector, u: Vector, p: Vector) -> bool:
        """Whether the residuals' Jacobian stands while rounding moves the algebraic variables.

        At a fold it does not: there an error of rounding moves them so far that the
        Jacobian becomes another one.
        """
        n = self.order
        left, by_x, _, terms = self._residual(x, u, p)
        slopes = by_x[:, n:]
        moved = numpy.array(x, dtype=float)
        moved[n:] += numpy.linalg.solve(slopes, numpy.abs(left) + ROUNDING * terms)
        other = self._residual(moved, u, p)[1][:, n:]
        change = numpy.linalg.solve(slopes, other) - numpy.eye(len(slopes))
        return bool(numpy.abs(change).max() < 0.5)


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


def in_dependence(
    derived: list[sympy.Symbol], table: Mapping[sympy.Symbol, Any]
) -> list[sympy.Symbol]:
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


def own_variables(equations: Equations, graph: BondGraph) -> dict[sympy.Symbol, sympy.Expr]:
    """Return what the port variables of a graph's elements are in the equations' variables."""
    return {
        symbol: equations.ports[f"{name}.{key}"]
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
        if f"{name}.{key}" in equations.ports
    }


def _contact_rows(
    equations: Equations, graph: BondGraph, laws: Mapping[str, Switched]
) -> list[sympy.Expr]:
    """Write flow, effort and margins of each switching element in the mode's own variables.

    The symbols are those of the graph given, which may be built anew beside the equations'.
    """
    variables = own_variables(equations, graph)
    rows: list[sympy.Expr] = []
    for name, element in laws.items():
        rows += [equations.ports[f"{name}.f"], equations.ports[f"{name}.e"]]
        rows += [element.margin(code).xreplace(variables) for code in element.modes.values()]
    return rows
