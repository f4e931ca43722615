"""What all runs of a search share: the compiled model, its inputs, the equations of its modes."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy
import sympy

from ..codegen.program import Program
from ..elements import Switched
from ..equations import Equations, derive
from ..errors import SteadyStateError
from ..graph import TIME, BondGraph
from ..modes import in_mode
from ..simulation import CompiledModel, Outcome, Trajectory, simulate
from ..smooth import Smooth
from ..steady import input_values
from ..values import parameter_values

Array = numpy.ndarray

# More steps than these in one stage, or steps too small, and a smooth model is tried as a stiff one.
MOST_STEPS = 2_000_000
STIFF = (Outcome.STEP_LIMIT, Outcome.STEP_UNDERFLOW)


class Chart:
    """The equations of one set of modes as numbers, and the way back to the model's own states.

    Parameters
    ----------
    graph : BondGraph
        With its contacts open.
    modes : mapping of str to str
    names : tuple of str
        States of the model, some of which may be bound in these modes.
    free : set of str
        States that drive nothing; here they stand still.
    held : mapping of str to float
        Any values of the parameters.
    """

    def __init__(
        self,
        graph: BondGraph,
        modes: Mapping[str, str],
        names: tuple[str, ...],
        free: frozenset[str],
        held: Mapping[str, float],
    ) -> None:
        import casadi

        from ..codegen.to_casadi import to_casadi

        self.modes = dict(modes)
        own = derive(in_mode(graph, modes))
        self.states = tuple(state.name for state in own.states)
        self.equations = dataclasses.replace(
            own,
            derivatives=tuple(
                sympy.S.Zero if state.name in free else rate
                for state, rate in zip(own.states, own.derivatives, strict=True)
            ),
        )
        self.smooth = Smooth(self.equations, graph, held=held)
        self.moving = numpy.array([name not in free for name in self.states], dtype=bool)
        symbols = {state.name: state for state in own.states}
        rows = [symbols.get(name, own.ports.get(name, sympy.S.Zero)) for name in names]
        program = Program.pruned(
            "whole",
            [
                ("t", [TIME]),
                ("x", (*own.states, *own.algebraic)),
                ("u", own.inputs),
                ("p", own.parameters),
            ],
            own.assignments,
            {"out": rows},
        )
        x = casadi.SX.sym("x", len(own.states) + len(own.algebraic))
        u = casadi.SX.sym("u", len(own.inputs))
        p = casadi.SX.sym("p", len(own.parameters))
        found = casadi.densify(to_casadi(program)(0, x, u, p))
        self._whole = casadi.Function("whole", [x, u, p], [found])
        self._parameters = tuple(symbol.name for symbol in own.parameters)

    def whole(self, x: Array, u: Array, values: Mapping[str, float]) -> Array:
        """Return the model's own states at a point of these modes."""
        p = [values[name] for name in self._parameters]
        return self._whole(x, u, p).full().ravel()


class Bench:
    """A model with constant inputs, on which many runs are made.

    Parameters
    ----------
    graph : BondGraph or CompiledModel
    inputs : mapping, optional
        Constant; zero unless given.

    Attributes
    ----------
    model : CompiledModel
    inputs : dict of str to float
    names : tuple of str
        The model's states.
    free : frozenset of str
        States that drive nothing, such as the position of a mass without a spring.

    Raises
    ------
    SteadyStateError
        For a model whose sources depend on time: it has no steady state.
    """

    def __init__(
        self, graph: BondGraph | CompiledModel, inputs: Mapping[Any, float] | None = None
    ) -> None:
        self.model = graph if isinstance(graph, CompiledModel) else CompiledModel(graph)
        equations = self.model.equations
        self.graph = equations.graph
        own = {symbol.name for symbol in self.graph.inputs}
        given = input_values(equations, inputs)
        self.inputs = {name: value for name, value in given.items() if name in own}
        self.names = tuple(state.name for state in equations.states)
        needed = _needed(equations, self.graph)
        if TIME in needed:
            raise SteadyStateError(
                f"model {equations.name!r} has a source that depends on time, so it has no steady state "
                f"that a cycle could live beside; make the source a constant or an input"
            )
        self.free = frozenset(s.name for s in equations.states if s not in needed)
        self.moving = numpy.array([name not in self.free for name in self.names], dtype=bool)
        self._charts: dict[tuple[tuple[str, str], ...], Chart] = {}

    def values(self, parameters: Mapping[Any, Any] | None) -> dict[str, float]:
        """Return all parameters in SI."""
        return parameter_values(self.model.equations, parameters, self.model.resolver)

    def with_input(self, name: str, value: float) -> Bench:
        """Return the same bench with another value of an input."""
        other = copy.copy(self)
        other.inputs = {**self.inputs, name: value}
        return other

    def chart(self, modes: Mapping[str, str], held: Mapping[str, float]) -> Chart:
        """Return the equations of a set of modes, derived when first asked for."""
        key = tuple(sorted(modes.items()))
        if key not in self._charts:
            self._charts[key] = Chart(self.graph, modes, self.names, self.free, held)
        return self._charts[key]

    def start(self, values: Mapping[str, float], initial: Mapping[Any, Any] | None = None) -> Array:
        """Return the states that a run begins with, (n,) array."""
        return numpy.array(self.model.initial_state(dict(values), initial), dtype=float)

    def scales(self, values: Mapping[str, float], x: Array) -> Array:
        """Return each state's size for unit energy, zero where it is not known."""
        equations = self.model.equations
        u = [self.inputs.get(symbol.name, 0.0) for symbol in equations.inputs]
        p = [values[symbol.name] for symbol in equations.parameters]
        solved = numpy.append(x, numpy.zeros(len(equations.algebraic)))
        return self.model.measured(0.0, solved, numpy.array(u), numpy.array(p))[1][: len(x)]

    def run(
        self,
        values: Mapping[str, float],
        x: Array,
        span: tuple[float, float],
        *,
        rows: Any = None,
        rtol: float = 1e-8,
        seconds: float = 600.0,
        guess: Mapping[str, float] | None = None,
        max_step: float = numpy.inf,
    ) -> Trajectory:
        """Simulate from given states."""
        initial = {**(guess or {}), **dict(zip(self.names, map(float, x), strict=True))}
        numbers = (self.model, span, values, initial, self.inputs, rows, rtol)
        limits: dict[str, Any] = {"time_budget": max(seconds, 0.05), "max_step": max_step}
        run = simulate(*numbers, max_steps=MOST_STEPS, **limits)
        if run.outcome in STIFF and run.solver == "dopri5" and not self.model.contact_names:
            stiff = simulate(*numbers, solver="rosenbrock", **limits)
            return stiff if stiff.t_end > run.t_end else run
        return run


def _needed(equations: Equations, graph: BondGraph) -> set[Any]:
    """Return all symbols that rates, residuals and modes depend on."""
    own = equations.own_symbols
    roots = [*equations.derivatives, *equations.residuals]
    for contact in equations.contacts:
        roots += [contact.breakaway, contact.slip, contact.effort]
    for _, element in graph.of(Switched):
        for part in dataclasses.fields(element):
            value = getattr(element, part.name, None)
            if isinstance(value, sympy.Expr) and not isinstance(value, sympy.Symbol):
                roots.append(value.xreplace(own))
            elif isinstance(value, sympy.Symbol) and value in own:
                roots.append(own[value])
    needed: set[Any] = set().union(*(sympy.sympify(root).free_symbols for root in roots), set())
    for symbol, expression in reversed(equations.assignments):
        if symbol in needed:
            needed |= expression.free_symbols
    return needed
