"""Derivatives of the rates beyond the Jacobian, exact, along given directions."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy

from ..smooth import Smooth

Array = numpy.ndarray
Form = Callable[..., Any]


class Derivatives:
    """Derivatives of the rates of equations at a point, along directions.

    Directions may be complex: all forms are linear in each of them. Where algebraic variables
    are kept they stand behind the states, their residuals behind the rates.

    Parameters
    ----------
    smooth : Smooth
    x : (n + nz,) array
    u, p : array
        Inputs and parameter vector.

    Examples
    --------
    >>> from bondgraph import I, One, R, assemble, derive
    >>> drag = R("drag", effort=lambda f: f**3)
    >>> cart = assemble("cart", One("v") >> (I("m", 1), drag))
    >>> at = Derivatives(Smooth(derive(cart), cart), numpy.array([2.0]), [], [])
    >>> one = numpy.array([1.0])
    >>> at.second(one, one).real.tolist(), at.third(one, one, one).real.tolist()
    ([-12.0], [-6.0])
    """

    def __init__(self, smooth: Smooth, x: Array, u: Array, p: Array) -> None:
        self.smooth = smooth
        self.x = numpy.array(x, dtype=float)
        self.u = numpy.array(u, dtype=float)
        self.p = numpy.array(p, dtype=float)

    @cached_property
    def jacobian(self) -> Array:
        """Derivative of the rates by states and algebraic variables, (n + nz, n + nz) array."""
        return self.smooth.jacobian(self.x, self.u, self.p)

    @cached_property
    def by_arguments(self) -> Array:
        """Derivative of the rates by inputs and parameters, (n + nz, nu + np) array."""
        casadi, symbols, rates = self._symbols
        slope = casadi.jacobian(rates, casadi.vertcat(*symbols[1:]))
        return self._function("arguments", symbols, casadi.densify(slope))().full()

    def gradient(self, left: Array, right: Array) -> Array:
        """Return the derivative of ``left @ jacobian @ right`` by states, inputs and parameters.

        Parameters
        ----------
        left, right : (n + nz,) complex array

        Returns
        -------
        (n + nz + nu + np,) complex array
        """
        size = len(self.x) + len(self.u) + len(self.p)
        return _summed(self._gradient, size, left, right)

    def second(self, a: Array, b: Array) -> Array:
        """Return the second derivative of the rates along two directions.

        Parameters
        ----------
        a, b : (n + nz,) complex array

        Returns
        -------
        (n + nz,) complex array
        """
        return _summed(self._second, len(self.x), a, b)

    def third(self, a: Array, b: Array, c: Array) -> Array:
        """Return the third derivative of the rates along three directions."""
        return _summed(self._third, len(self.x), a, b, c)

    @cached_property
    def _symbols(self) -> tuple[Any, list[Any], Any]:
        import casadi

        sizes = len(self.x), len(self.u), len(self.p)
        symbols = [casadi.SX.sym(name, size) for name, size in zip("xup", sizes, strict=True)]
        return casadi, symbols, self.smooth.symbolic(*symbols)

    @cached_property
    def _gradient(self) -> Form:
        casadi, symbols, rates = self._symbols
        w, v = (casadi.SX.sym(name, len(self.x)) for name in "wv")
        form = casadi.dot(w, casadi.jtimes(rates, symbols[0], v))
        slope = casadi.gradient(form, casadi.vertcat(*symbols))
        return self._function("gradient", [*symbols, w, v], casadi.densify(slope))

    @cached_property
    def _second(self) -> Form:
        casadi, symbols, rates = self._symbols
        a, b = (casadi.SX.sym(name, len(self.x)) for name in "ab")
        form = casadi.jtimes(casadi.jtimes(rates, symbols[0], a), symbols[0], b)
        return self._function("second", [*symbols, a, b], casadi.densify(form))

    @cached_property
    def _third(self) -> Form:
        casadi, symbols, rates = self._symbols
        a, b, c = (casadi.SX.sym(name, len(self.x)) for name in "abc")
        form = rates
        for direction in (a, b, c):
            form = casadi.jtimes(form, symbols[0], direction)
        return self._function("third", [*symbols, a, b, c], casadi.densify(form))

    def _function(self, name: str, arguments: list[Any], result: Any) -> Form:
        import casadi

        function = casadi.Function(name, arguments, [result])
        return lambda *directions: function(self.x, self.u, self.p, *directions)


def _summed(form: Form, size: int, *vectors: Array) -> Array:
    """Evaluate a form that is linear in each of some complex vectors from its values at real ones."""
    total = numpy.zeros(size, dtype=complex)
    parts = [((1, numpy.real(vector)), (1j, numpy.imag(vector))) for vector in vectors]
    for chosen in itertools.product(*parts):
        if all(part.any() for _, part in chosen):
            factor = numpy.prod([unit for unit, _ in chosen])
            total += factor * form(*(part for _, part in chosen)).full().ravel()
    return total
