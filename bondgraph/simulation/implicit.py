"""Functions of one mode whose algebraic variables are solved for in each call.

Newton starts from the values of the call before, so that a run stays on its branch. A run
forgets those of the run before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy

from ..consistent import consistent, newton
from .buffered import evaluator

Array = numpy.ndarray


class Implicit:
    """Results of a mode, as functions without its algebraic variables.

    Parameters
    ----------
    arguments : sequence of casadi.SX
        ``t, x, u, p, s, z, w, v``: z the algebraic variables, w imposed values and
        v their rates, which are zero while a mode lasts.
    results : sequence of casadi.SX
        The last is the residual that z makes zero.
    """

    def __init__(self, arguments: Sequence[Any], results: Sequence[Any]) -> None:
        import casadi

        *self._given, self._z, self._w, self._v = arguments
        *self._results, left = results
        self._left = left
        self._size = self._z.numel()
        self._last = numpy.zeros(self._size)
        calm = casadi.substitute(left, self._v, 0)
        slope = casadi.jacobian(calm, self._z)
        terms = casadi.fabs(slope) @ casadi.fabs(self._z) + casadi.fabs(calm)
        self._residual = self._function("residual", [calm, slope, terms])

    def _function(self, name: str, results: Sequence[Any]) -> Any:
        import casadi

        dense = [casadi.densify(casadi.substitute(e, self._v, 0)) for e in results]
        return casadi.Function(name, [*self._given, self._z, self._w], dense)

    def forget(self) -> None:
        """Start anew, from zero."""
        self._last = numpy.zeros(self._size)

    def solve(self, *given: Any) -> Array:
        """Return the algebraic variables at ``t, x, u, p, s`` and, where given, w; NaN where none fit."""
        if not self._size:
            return self._last
        place, w = given[:5], given[5] if len(given) > 5 else 0

        def residual(z: Array) -> tuple[Array, Array, Array]:
            left, slope, terms = self._residual(*place, z, w)
            return left.full().ravel(), slope.full(), terms.full().ravel()

        with numpy.errstate(all="ignore"):
            found = newton(residual, self._last)
            if found is None:
                found = consistent(residual, self._last)
        if found is None:
            return numpy.full(self._size, numpy.nan)
        self._last = found
        return found

    def calm(self, index: int) -> Callable[..., Array]:
        """Return a result as a function of ``t, x, u, p, s``, shape (size,)."""
        import casadi

        result = casadi.substitute(self._results[index], casadi.vertcat(self._w, self._v), 0)
        inside = [*self._given, self._z] if self._size else self._given
        function = evaluator(casadi.Function("calm", inside, [casadi.densify(result)]))
        if not self._size:
            return function
        return lambda *given: function(*given, self.solve(*given))

    def with_slope(self, index: int, by: str) -> Callable[..., tuple[Array, Array]]:
        """Return a result and its Jacobian by w or v, as a function of ``t, x, u, p, s, w``."""
        function = self._function("with_slope", [self._results[index], self._total(index, by)])

        def evaluate(*given: Any) -> tuple[Array, Array]:
            value, slope = function(*given[:5], self.solve(*given), given[5])
            return value.full().ravel(), slope.full()

        return evaluate

    def slopes(self, indices: Sequence[int], by: str) -> Callable[..., tuple[Array, ...]]:
        """Return Jacobians of results by w or v, as a function of ``t, x, u, p, s, w``."""
        function = self._function("slopes", [self._total(index, by) for index in indices])

        def evaluate(*given: Any) -> tuple[Array, ...]:
            found = function(*given[:5], self.solve(*given), given[5])
            return tuple(slope.full() for slope in found)

        return evaluate

    def _total(self, index: int, by: str) -> Any:
        """Jacobian of a result by w or v, what z does included."""
        import casadi

        moved = self._w if by == "w" else self._v
        result = self._results[index]
        direct = casadi.jacobian(result, moved)
        if not self._size or not moved.numel():
            return direct
        inner = casadi.jacobian(self._left, self._z)
        follows = casadi.solve(
            casadi.densify(inner), casadi.densify(casadi.jacobian(self._left, moved))
        )
        return direct - casadi.jacobian(result, self._z) @ follows
