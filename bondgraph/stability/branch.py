"""A branch: the steady state of a graph as one parameter or input changes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy

from ..errors import SteadyStateError
from ..graph import BondGraph
from ..steady import SteadyState, solve_rates
from ..values import initial_values
from .family import Family


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
        self.family = Family(graph, point, [name], overrides)
        self.point, self.name = point, name
        self.smooth = self.family.smooth
        self.unit = self.family.units[0]

    @property
    def at(self) -> float:
        """The parameter's value at the start, SI."""
        return float(self.family.at[0])

    @property
    def start(self) -> numpy.ndarray:
        """The states at the start, and algebraic variables behind them."""
        return numpy.array(self.point.vector)

    def arguments(self, value: float) -> tuple[numpy.ndarray, numpy.ndarray]:
        """Return inputs and parameter vector with the changed value in place."""
        return self.family.arguments([value])

    def solve(self, value: float, guess: numpy.ndarray) -> numpy.ndarray:
        """Return the steady state at a value of the parameter.

        Raises
        ------
        SteadyStateError
            Where there is none near the guess, or a contact leaves its mode.
        """
        u, p = self.arguments(value)
        x, _ = solve_rates(self.smooth, guess, u, p)
        if self.point.algebraic:
            self.smooth.state_matrix(x, u, p)  # to say where they are not determined
        left = self.family.switches(numpy.append(x, value))
        if left is not None:
            raise SteadyStateError(left, elements=list(self.point.modes))
        return x

    def eigenvalues(self, value: float, x: numpy.ndarray) -> numpy.ndarray:
        """Return the eigenvalues at a steady state of the branch, by falling real part."""
        return self.family.eigenvalues(numpy.append(x, value))

    def point_at(self, value: float, x: numpy.ndarray) -> SteadyState:
        """Return the full operating point at a steady state of the branch."""
        return self.family.point_at(numpy.append(x, value))

    def second_guess(self, value: float) -> numpy.ndarray:
        """Return the model's own initial states at a value, for a search that lost its way."""
        point = self.point_at(value, self.start)
        states = initial_values(point.equations, point.parameters)
        z = list(self.point.algebraic.values())
        found = self.smooth.consistent(states, *self.arguments(value), z)
        return numpy.array([*states, *z]) if found is None else found
