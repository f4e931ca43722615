"""Families: the steady states of a graph with some parameters free, as equations of a curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy

from ..errors import SteadyStateError
from ..graph import BondGraph
from ..parameters import unknown_name
from ..resolver import Resolver
from ..smooth import Smooth
from ..steady import SteadyState
from ..values import parameter_values
from .derivatives import Forms

Array = numpy.ndarray


class Family:
    """The steady states of a graph in given modes, with some parameters or inputs free.

    A point is a vector y: states, algebraic variables behind them, then the free parameters.

    Parameters
    ----------
    graph : BondGraph
    point : SteadyState
        One of them.
    names : sequence of str
        Parameters or inputs that are free.
    overrides : mapping, optional
        Parameters given by the user, by name or symbol.
    forms : Forms, optional
        Of the same equations, with ``overrides`` and `names` held, where they are at hand.

    Raises
    ------
    ParameterError
        For a name that is neither parameter nor input.
    """

    def __init__(
        self,
        graph: BondGraph,
        point: SteadyState,
        names: Sequence[str],
        overrides: Mapping[Any, Any] | None = None,
        forms: Forms | None = None,
    ) -> None:
        self.table = {symbol.name: row for symbol, row in graph.parameters.items()}
        for name in names:
            if name not in self.table and name not in point.inputs:
                raise unknown_name("parameter", name, [*self.table, *point.inputs])
        self.graph, self.point, self.names = graph, point, tuple(names)
        self.overrides = {
            getattr(key, "name", key): value for key, value in (overrides or {}).items()
        }
        held = {*self.overrides, *(name for name in names if name in self.table)}
        self.forms = forms or Forms(Smooth(point.equations, graph, held=held))
        self.smooth = self.forms.smooth
        self.resolver = Resolver(graph.parameters)
        self._u = numpy.array(list(point.inputs.values()), dtype=float)
        self._p = self.smooth.vector(point.parameters)
        order = [*point.inputs, *self.smooth.names]
        self._places = [order.index(name) for name in names]

    @property
    def at(self) -> Array:
        """Values of the free parameters at the given point, SI."""
        return numpy.concatenate([self._u, self._p])[self._places]

    @property
    def start(self) -> Array:
        """The given point."""
        return numpy.array([*self.point.vector, *self.at])

    @property
    def size(self) -> int:
        """Number of states and algebraic variables."""
        return len(self.point.vector)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the free parameters, each its own."""
        inputs = {symbol.name: unit for symbol, unit in self.graph.inputs.items()}
        return tuple(
            self.table[name].unit if name in self.table else inputs.get(name, "")
            for name in self.names
        )

    def arguments(self, values: Any) -> tuple[Array, Array]:
        """Return inputs and parameter vector with the free ones at given values."""
        whole = numpy.concatenate([self._u, self._p])
        whole[self._places] = values
        return whole[: len(self._u)], whole[len(self._u) :]

    def symbolic(self, values: Any) -> tuple[Any, Any]:
        """Return inputs and parameter vector with CasADi expressions in place of the free ones."""
        import casadi

        whole = casadi.SX(numpy.concatenate([self._u, self._p]))
        for place, value in zip(self._places, casadi.vertsplit(values), strict=True):
            whole[place] = value
        return whole[: len(self._u)], whole[len(self._u) :]

    def split(self, y: Array) -> tuple[Array, Array, Array]:
        """Return states, inputs and parameter vector of a point."""
        return (y[: self.size], *self.arguments(y[self.size :]))

    def slopes(self, y: Array) -> tuple[Array, Array]:
        """Return the rates at a point, (n + nz,), and their derivatives by all of y."""
        rates, by_x, by_arguments = self.forms.slopes(*self.split(y))
        return rates, numpy.hstack([by_x, by_arguments[:, self._places]])

    def eigenvalues(self, y: Array) -> Array:
        """Return the eigenvalues at a point, by falling real part."""
        poles = numpy.linalg.eigvals(self.smooth.state_matrix(*self.split(y)))
        return poles[numpy.lexsort((-poles.imag, -poles.real))].astype(complex)

    def leaves(self, y: Array) -> str | None:
        """Say why a point is none of the family's; None where it is.

        A contact may leave its mode, or algebraic variables be no longer determined.
        """
        if self.point.algebraic:
            try:
                self.smooth.state_matrix(*self.split(y))
            except SteadyStateError as error:
                return str(error)
        return self.switches(y)

    def switches(self, y: Array) -> str | None:
        """Say which contact leaves its mode at a point; None where none does."""
        for name, found in self.smooth.contact_values(*self.split(y)).items():
            better = found.better_mode(self.point.modes[name])
            if better is not None:
                return f"{name!r} leaves mode {self.point.modes[name]!r} for {better!r}"
        return None

    def point_at(self, y: Array) -> SteadyState:
        """Return the full operating point.

        Raises
        ------
        ParameterError
            For values that the parameters' own rules refuse.
        """
        x, u, p = self.split(y)
        order, free = self.smooth.order, y[self.size :]
        changed = dict(self.overrides)
        for name, value in zip(self.names, free, strict=True):
            if name in self.table:
                changed[name] = float(value)
        point = self.point
        return replace(
            point,
            states=dict(zip(point.states, map(float, x[:order]), strict=True)),
            algebraic=dict(zip(point.algebraic, map(float, x[order:]), strict=True)),
            outputs=self.smooth.outputs(x, u, p),
            inputs=dict(zip(point.inputs, map(float, u), strict=True)),
            parameters=parameter_values(point.equations, changed, self.resolver),
        )

    def scale(self, ranges: Sequence[tuple[float, float]]) -> Array:
        """Return sizes to measure points by: the ranges of the parameters, states in proportion.

        States of one model may have sizes that differ by many powers of ten; balancing the
        Jacobian makes them comparable, and what they are at the start and how far they move over
        the ranges makes them numbers near one. Entries that vanish at this very point, as they do
        at a fold, are taken from beside it.
        """
        import scipy.linalg

        widths = numpy.array([high - low for low, high in ranges])
        n = self.size
        if not n:
            return widths
        aside = numpy.concatenate([0.05 * numpy.abs(self.start[:n]), 0.05 * widths])
        whole = [numpy.nan_to_num(self.slopes(self.start + k * aside)[1]) for k in (0, -1, 1)]
        largest = numpy.abs(whole).max(axis=0)[:, :n]
        sizes = numpy.diag(scipy.linalg.matrix_balance(largest, permute=False)[1]).copy()
        reach = max(
            numpy.abs(self.start[:n] / sizes).max(),
            # beside a fold states move far for little: the least of the three tells
            min(_moved(matrix, sizes, widths) for matrix in whole),
        )
        return numpy.concatenate([sizes * (reach if reach > 0 else 1.0), widths])


def _moved(slopes: Array, sizes: Array, widths: Array) -> float:
    """Return how far steady states move over ranges of the parameters, in their sizes."""
    n = len(sizes)
    scaled = slopes[:, :n] * sizes / sizes[:, None]
    found = numpy.linalg.lstsq(scaled, slopes[:, n:] / sizes[:, None], rcond=1e-12)[0]
    return float(numpy.abs(found * widths).max(initial=0.0))
