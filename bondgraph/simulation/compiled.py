"""A model made ready to run: numeric functions of each structural mode, on demand.

Parameters are inputs of the functions, so one compiled model serves all values.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy
import sympy

from ..causality import CausalGraph, assign_causality
from ..codegen.program import Program
from ..codegen.to_casadi import to_casadi
from ..codegen.to_numpy import to_numpy
from ..dimensions import infer
from ..elements import C, Storage
from ..equations import Equations, derive
from ..errors import SimulationError
from ..graph import TIME, BondGraph
from ..parameters import Resolver
from .dae import SmoothFunctions, smooth_functions
from .table import ModeFunctions, ModeTable

Array = numpy.ndarray


class CompiledModel:
    """A graph's equations with their numeric functions, reusable over runs.

    Modes are derived and compiled when a run first meets them, and kept here.

    Parameters
    ----------
    graph : BondGraph or CausalGraph

    Attributes
    ----------
    equations : Equations
        With all contacts slipping.
    modes : ModeTable
        Functions by structural mode: the bit mask of stuck contacts.
    resolver : Resolver
        Evaluates the parameter table.

    Raises
    ------
    SimulationError
        If the equations keep algebraic variables while contacts have modes.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> CompiledModel(mass_on_belt.graph()).contact_names
    ('contact',)
    """

    def __init__(self, graph: BondGraph | CausalGraph) -> None:
        self._causal = graph if isinstance(graph, CausalGraph) else assign_causality(graph)
        self._equations: dict[int, Equations] = {}
        self.equations = self.in_mask(0)
        self.contact_names = tuple(contact.name for contact in self.equations.contacts)
        self.resolver = Resolver(self.equations.graph.parameters)
        sizes = (len(self.equations.states), len(self.equations.inputs), len(self.contact_names))
        self.modes = ModeTable(*sizes, self._functions)
        self._signals: dict[tuple[int, tuple[str, ...]], Callable[..., Any]] = {}

    def in_mask(self, mask: int) -> Equations:
        """Return the equations of a structural mode, derived on first use.

        Parameters
        ----------
        mask : int
            Bit j is set where contact j is stuck.
        """
        if mask not in self._equations:
            stuck = (
                []
                if mask == 0
                else [name for bit, name in enumerate(self.contact_names) if mask >> bit & 1]
            )
            equations = derive(self._causal, stuck=stuck)
            if equations.algebraic and equations.contacts:
                names = ", ".join(symbol.name for symbol in equations.algebraic)
                raise SimulationError(
                    f"model {equations.name!r} keeps algebraic variables ({names}) beside contacts "
                    f"with modes, and no integrator here follows both; add a compliance or inertia "
                    f"where they arise, or smooth the contacts",
                    elements=[symbol.name for symbol in equations.algebraic],
                )
            self._equations[mask] = equations
        return self._equations[mask]

    def signals(self, mask: int, names: tuple[str, ...]) -> Callable[..., Any]:
        """Return a NumPy function of named signals in a structural mode.

        Parameters
        ----------
        mask : int
        names : tuple of str
            Outputs, states, port variables such as ``mass.f``, parameters.

        Returns
        -------
        callable
            ``(t, x, u, p, s)``, each of shape (size, ...), to one array of
            shape (len(names), ...). Algebraic variables follow the states in x.
        """
        key = (mask, names)
        if key not in self._signals:
            equations = self.in_mask(mask)
            results = [self.expression(equations, name) for name in names]
            function = to_numpy(self._program(equations, "signals", results))
            self._signals[key] = lambda *arguments: function(*arguments)[0]
        return self._signals[key]

    def expression(self, equations: Equations, name: str) -> sympy.Expr:
        """Return the expression behind a signal's name, or raise KeyError."""
        solved = {symbol.name: symbol for symbol in (*equations.states, *equations.algebraic)}
        for table in (equations.outputs, solved, equations.ports):
            if name in table:
                return table[name]
        for symbol in (*equations.inputs, *equations.parameters):
            if symbol.name == name:
                return symbol
        raise KeyError(name)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all signals: outputs, states, inputs, port and algebraic variables."""
        equations = self.equations
        names = [
            *equations.outputs,
            *(symbol.name for symbol in (*equations.states, *equations.inputs)),
        ]
        implicit = (symbol.name for symbol in equations.algebraic)
        return tuple(dict.fromkeys([*names, *equations.ports, *implicit]))

    @functools.cached_property
    def units(self) -> Mapping[str, str | None]:
        """Inferred units of states and port variables, by name."""
        return infer(self.equations.graph).units

    @functools.cached_property
    def smooth(self) -> SmoothFunctions:
        """Functions for the integrators of smooth models, contacts and modes aside."""
        return smooth_functions(self.equations, self._parameters())

    @functools.cached_property
    def stored(self) -> Callable[..., Array] | None:
        """Stored energy as a function of ``(t, x, u, p, s)``, x with the algebraic variables.

        Laws without a known potential are integrated numerically from zero;
        None where a storage is modulated and has no potential.
        """
        energies = self.equations.energies
        unknown = [name for name, energy in energies.items() if energy is None]
        if not all(self._has_own_law(name) for name in unknown):
            return None
        known = [energy for energy in energies.values() if energy is not None]
        closed = to_numpy(self._program(self.equations, "stored", [sympy.Add(*known)]))
        rest = [self._numeric_energy(name) for name in unknown]

        def total(*arguments: Any) -> Array:
            return closed(*arguments)[0][0] + sum(part(*arguments) for part in rest)

        return total

    @functools.cached_property
    def stiffness_at(self) -> Callable[..., Array]:
        """Slope of each state's own law, as a function of ``(t, x, u, p, s)``, of shape (n, ...)."""
        equations = self.equations
        elements = {
            f"{name}.{_letter(item)}": (name, item) for name, item in equations.graph.of(Storage)
        }
        local = {**_own_symbols(equations)}
        slopes = []
        for state in equations.states:
            _, element = elements[state.name]
            slope = sympy.diff(element.law, element.state).xreplace(local)
            # a law that jumps has no slope there that a number could tell
            slopes.append(slope.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero))
        function = to_numpy(self._program(equations, "stiffness", slopes))
        return lambda *arguments: function(*arguments)[0]

    def _has_own_law(self, name: str) -> bool:
        element = self.equations.graph.elements[name]
        assert isinstance(element, Storage)
        return not element.law.free_symbols - {element.state} - set(self.equations.graph.parameters)

    def _numeric_energy(self, name: str) -> Callable[..., Array]:
        element = self.equations.graph.elements[name]
        assert isinstance(element, Storage)
        p = self.equations.parameters
        law = to_numpy(
            Program("law", (("q", (element.state,)), ("p", p)), (), (("e", (element.law,)),))
        )
        state_program = self._program(
            self.equations, "state", [self.expression(self.equations, f"{name}.{_letter(element)}")]
        )
        state = to_numpy(state_program)
        nodes, weights = numpy.polynomial.legendre.leggauss(32)

        def energy(*arguments: Any) -> Array:
            q = state(*arguments)[0][0]
            points = 0.5 * q[..., None] * (nodes + 1)
            parameters = numpy.asarray(arguments[3])
            values = law(points[None], parameters.reshape(-1, *([1] * points.ndim)))[0][0]
            return 0.5 * q * (values * weights).sum(axis=-1)

        return energy

    def _functions(self, mask: int) -> ModeFunctions:
        equations = self.in_mask(mask)
        supplied = sympy.Add(*equations.supplied.values())
        dissipated = sympy.Add(*equations.dissipated.values())
        rhs = self._program(equations, "rhs", [*equations.derivatives, supplied, dissipated])
        margins, values = [], []
        for contact in equations.contacts:
            if contact.stuck:
                margins.append(contact.breakaway - sympy.Abs(contact.effort))
                values.append(contact.effort)
            else:
                margins.append(contact.direction * contact.slip)
                values.append(contact.slip)
        guard = self._program(equations, "guard", [*margins, *values])
        return ModeFunctions(to_casadi(rhs), to_casadi(guard) if equations.contacts else None)

    def _program(self, equations: Equations, name: str, results: Iterable[sympy.Expr]) -> Program:
        return Program.pruned(
            name,
            [
                ("t", [TIME]),
                ("x", (*equations.states, *equations.algebraic)),
                ("u", equations.inputs),
                ("p", self._parameters()),
                ("s", equations.directions),
            ],
            equations.assignments,
            {"out": results},
        )

    def _parameters(self) -> tuple[sympy.Symbol, ...]:
        """The parameter vector is the same in all modes."""
        return self._equations[0].parameters


def _letter(element: Storage) -> str:
    return "q" if isinstance(element, C) else "p"


def _own_symbols(equations: Equations) -> dict[sympy.Basic, sympy.Expr]:
    """Map the elements' own symbols to the equations' variables."""
    return {
        symbol: equations.ports[f"{name}.{key}"]
        for name, element in equations.graph.elements.items()
        for key, symbol in element.symbols.items()
        if f"{name}.{key}" in equations.ports
    }
