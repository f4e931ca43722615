"""A branch: the steady state of a graph as one parameter or input changes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy

from ..errors import SteadyStateError
from ..graph import BondGraph
from ..parameters import unknown_name
from ..resolver import Resolver
from ..smooth import Smooth
from ..steady import SteadyState, solve_rates
from ..values import initial_values, parameter_values
from .derivatives import Forms


class Branch:
    """The steady state of a graph in given modes, as one parameter or input changes.

    Parameters
    ----------
    graph : BondGraph
    point : SteadyState
        Where the branch starts.
    name : str
        Parameter or input that changes.
    overrides : mapping, optional
        Parameters given by the user, by name or symbol.

    Raises
    ------
    ParameterError
        For a name that is neither parameter nor input.
    """

    def __init__(
        self,
        graph: BondGraph,
        point: SteadyState,
        name: str,
        overrides: Mapping[Any, Any] | None = None,
    ) -> None:
        equations = point.equations
        table = {symbol.name: row for symbol, row in graph.parameters.items()}
        if name not in table and name not in point.inputs:
            raise unknown_name("parameter", name, [*table, *point.inputs])
        self.graph, self.point, self.name = graph, point, name
        self.overrides = {
            getattr(key, "name", key): value for key, value in (overrides or {}).items()
        }
        self.is_input = name not in table
        self.unit = _input_unit(graph, name) if self.is_input else table[name].unit
        self.smooth = Smooth(equations, graph, held={*self.overrides, name})
        self.forms = Forms(self.smooth)
        self.resolver = Resolver(graph.parameters)
        self._u = numpy.array(list(point.inputs.values()))
        self._p = self.smooth.vector(point.parameters)
        order: Iterable[str] = point.inputs if self.is_input else self.smooth.names
        self.index = list(order).index(name)

    @property
    def at(self) -> float:
        """The parameter's value at the start, SI."""
        return float((self._u if self.is_input else self._p)[self.index])

    @property
    def start(self) -> numpy.ndarray:
        """The states at the start, and algebraic variables behind them."""
        return numpy.array(self.point.vector)

    def arguments(self, value: float) -> tuple[numpy.ndarray, numpy.ndarray]:
        """Return inputs and parameter vector with the changed value in place."""
        u, p = self._u.copy(), self._p.copy()
        (u if self.is_input else p)[self.index] = value
        return u, p

    def solve(self, value: float, guess: numpy.ndarray) -> numpy.ndarray:
        """Return the steady state at a value of the parameter.

        Raises
        ------
        SteadyStateError
            Where there is none near the guess, or a contact leaves its mode.
        """
        u, p = self.arguments(value)
        x, _ = solve_rates(self.smooth, guess, u, p)
        for name, found in self.smooth.contact_values(x, u, p).items():
            better = found.better_mode(self.point.modes[name])
            if better is not None:
                raise SteadyStateError(
                    f"{name!r} leaves mode {self.point.modes[name]!r} for {better!r}",
                    elements=[name],
                )
        if self.point.algebraic:
            self.smooth.state_matrix(x, u, p)  # to say where they are not determined
        return x

    def eigenvalues(self, value: float, x: numpy.ndarray) -> numpy.ndarray:
        """Return the eigenvalues at a steady state of the branch, by falling real part."""
        poles = numpy.linalg.eigvals(self.smooth.state_matrix(x, *self.arguments(value)))
        return poles[numpy.lexsort((-poles.imag, -poles.real))].astype(complex)

    def point_at(self, value: float, x: numpy.ndarray) -> SteadyState:
        """Return the full operating point at a steady state of the branch."""
        u, p = self.arguments(value)
        equations, order = self.point.equations, self.smooth.order
        changed = {**self.overrides} if self.is_input else {**self.overrides, self.name: value}
        return replace(
            self.point,
            states=dict(zip(self.point.states, map(float, x[:order]), strict=True)),
            algebraic=dict(zip(self.point.algebraic, map(float, x[order:]), strict=True)),
            outputs=self.smooth.outputs(x, u, p),
            inputs=dict(zip(self.point.inputs, map(float, u), strict=True)),
            parameters=parameter_values(equations, changed, self.resolver),
        )

    def second_guess(self, value: float) -> numpy.ndarray:
        """Return the model's own initial states at a value, for a search that lost its way."""
        point = self.point_at(value, self.start)
        states = initial_values(point.equations, point.parameters)
        z = list(self.point.algebraic.values())
        found = self.smooth.consistent(states, *self.arguments(value), z)
        return numpy.array([*states, *z]) if found is None else found


def _input_unit(graph: BondGraph, name: str) -> str:
    return next((unit for symbol, unit in graph.inputs.items() if symbol.name == name), "")
