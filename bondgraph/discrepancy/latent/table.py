"""Own parameters of a model as coordinates: logarithms of what is positive."""

from __future__ import annotations

from collections.abc import Mapping

import numpy

from ...simulation import CompiledModel
from ...values import parameter_values

Array = numpy.ndarray

STEP = 1e-5


class Table:
    """Coordinates of some parameters of a model's table, and the equations' vector in them.

    Parameters
    ----------
    model : CompiledModel
    names : tuple of str
        That may change; others depend on them by the table.
    given : mapping of str to float
        Values of parameters, SI, where the coordinates start.

    Attributes
    ----------
    model : CompiledModel
    used : tuple of str
        Parameters of the equations that depend on the coordinates.
    start : (p,) array
    """

    def __init__(self, model: CompiledModel, names: tuple[str, ...], given: Mapping[str, float]):
        self.model, self.names, self._given = model, names, dict(given)
        values = parameter_values(model.equations, self._given, model.resolver)
        symbols = {symbol.name: symbol for symbol in model.equations.graph.parameters}
        first = numpy.array([values[name] for name in names])
        self._log = numpy.array([bool(symbols[name].is_positive) for name in names], dtype=bool)
        self._log &= first > 0
        self._size = numpy.where(self._log, 1.0, numpy.where(first == 0, 1.0, numpy.abs(first)))
        self.start = numpy.where(self._log, numpy.log(numpy.where(self._log, first, 1.0)), first)
        self.start = self.start / self._size
        self._all = [symbol.name for symbol in model.equations.parameters]
        moved = self._raw_slopes(self.start)
        self._rows = numpy.flatnonzero(numpy.abs(moved).sum(axis=1) > 0)
        self.used = tuple(self._all[row] for row in self._rows)

    def given(self, values: Array) -> dict[str, float]:
        """Return parameters by name, SI."""
        plain = values * self._size
        plain = numpy.where(self._log, numpy.exp(numpy.where(self._log, plain, 0.0)), plain)
        return self._given | dict(zip(self.names, plain.tolist(), strict=True))

    def resolved(self, values: Array) -> dict[str, float]:
        """Return all parameters of the table, SI."""
        return parameter_values(self.model.equations, self.given(values), self.model.resolver)

    def vector(self, values: Array) -> Array:
        """Return the parameters of the equations in their order."""
        known = self.resolved(values)
        return numpy.array([known[name] for name in self._all])

    def slopes(self, values: Array) -> Array:
        """Return derivatives of `used` by the coordinates, shape (len(used), p)."""
        return self._raw_slopes(values)[self._rows]

    def _raw_slopes(self, values: Array) -> Array:
        columns = [
            (self.vector(values + step) - self.vector(values - step)) / (2 * STEP)
            for step in STEP * numpy.eye(len(values))
        ]
        return numpy.array(columns).reshape(len(values), len(self._all)).T

    def prior(self, values: Array, loose: float) -> Array:
        """Return rows that hold the coordinates near where they started, residual last."""
        count = len(values)
        return numpy.column_stack([numpy.eye(count), self.start - values]) / loose
