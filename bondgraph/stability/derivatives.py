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


def null_vectors(matrix: Array, sizes: Array) -> tuple[Array, Array]:
    """Return right and left null vectors of a matrix that is singular, or nearly so.

    Found in states measured by their sizes, where units do not count, and returned in them.

    Parameters
    ----------
    matrix : (n, n) complex array
    sizes : (n,) array

    Returns
    -------
    right, left : (n,) complex array
        ``matrix @ (right * sizes)`` and ``(left / sizes) @ matrix`` vanish; the right one has
        length one.

    Examples
    --------
    >>> right, left = null_vectors(numpy.array([[1.0, -1.0], [2.0, -2.0]]), numpy.ones(2))
    >>> bool(abs(right[0] - right[1]) < 1e-15), bool(abs(left[0] + 2 * left[1]) < 1e-15)
    (True, True)
    """
    scaled = matrix * sizes[None, :] / sizes[:, None]
    rows = numpy.abs(scaled).max(axis=1, keepdims=True)
    rows[rows == 0] = 1.0
    columns, _, right = numpy.linalg.svd(scaled / rows)
    return right[-1].conj(), columns[:, -1].conj() / rows[:, 0]


class Forms:
    """Derivatives of the rates of some equations as functions, each built when first asked for.

    Parameters
    ----------
    smooth : Smooth

    Examples
    --------
    >>> from bondgraph import I, One, R, assemble, derive
    >>> cart = assemble("cart", One("v") >> (I("m", 1), R("drag", 2)))
    >>> Forms(Smooth(derive(cart), cart)).slopes([3.0], [], [])[0].tolist()
    [-6.0]
    """

    def __init__(self, smooth: Smooth) -> None:
        self.smooth = smooth

    def at(self, x: Any, u: Any, p: Any) -> Derivatives:
        """Return the derivatives at a point."""
        return Derivatives(self, *(numpy.array(part, dtype=float) for part in (x, u, p)))

    def slopes(self, x: Any, u: Any, p: Any) -> tuple[Array, Array, Array]:
        """Return the rates, and their derivatives by x and by inputs and parameters.

        Returns
        -------
        rates : (n + nz,) array
        by_x : (n + nz, n + nz) array
        by_arguments : (n + nz, nu + np) array
        """
        rates, by_x, by_arguments = self._slopes(x, u, p)
        return rates.full().ravel(), by_x.full(), by_arguments.full()

    @property
    def mass(self) -> Array:
        """The matrix M of ``M dx/dt = rates``: one for each state, zero for algebraic variables."""
        size = self.smooth.order + len(self.smooth.equations.algebraic)
        return numpy.diag((numpy.arange(size) < self.smooth.order).astype(float))

    @cached_property
    def _symbols(self) -> tuple[Any, list[Any], Any]:
        import casadi

        smooth = self.smooth
        size = smooth.order + len(smooth.equations.algebraic)
        sizes = size, len(smooth.equations.inputs), len(smooth.names)
        symbols = [casadi.SX.sym(name, size) for name, size in zip("xup", sizes, strict=True)]
        return casadi, symbols, smooth.symbolic(*symbols)

    @cached_property
    def _slopes(self) -> Form:
        casadi, symbols, rates = self._symbols
        by_x = casadi.jacobian(rates, symbols[0])
        by_arguments = casadi.jacobian(rates, casadi.vertcat(*symbols[1:]))
        return casadi.Function(
            "slopes", symbols, [rates, *map(casadi.densify, (by_x, by_arguments))]
        )

    @cached_property
    def gradient(self) -> Form:
        """Derivative of ``w J v`` by all arguments, as a function of x, u, p, w, v."""
        casadi, symbols, rates = self._symbols
        w, v = self._directions("wv")
        form = casadi.dot(w, casadi.jtimes(rates, symbols[0], v))
        slope = casadi.gradient(form, casadi.vertcat(*symbols))
        return casadi.Function("gradient", [*symbols, w, v], [casadi.densify(slope)])

    @cached_property
    def second(self) -> Form:
        """Second derivative of the rates along two directions, of x, u, p, a, b."""
        return self._form("ab")

    @cached_property
    def third(self) -> Form:
        """Third derivative of the rates along three directions, of x, u, p, a, b, c."""
        return self._form("abc")

    def _form(self, names: str) -> Form:
        casadi, symbols, form = self._symbols
        directions = self._directions(names)
        for direction in directions:
            form = casadi.jtimes(form, symbols[0], direction)
        return casadi.Function("form", [*symbols, *directions], [casadi.densify(form)])

    def _directions(self, names: str) -> list[Any]:
        casadi, symbols, _ = self._symbols
        return [casadi.SX.sym(name, symbols[0].numel()) for name in names]


class Derivatives:
    """Derivatives of the rates at a point, along directions.

    Directions may be complex: all forms are linear in each of them. Where algebraic variables
    are kept they stand behind the states, their residuals behind the rates.

    Parameters
    ----------
    forms : Forms
    x : (n + nz,) array
    u, p : array
        Inputs and parameter vector.

    Examples
    --------
    >>> from bondgraph import I, One, R, assemble, derive
    >>> drag = R("drag", effort=lambda f: f**3)
    >>> cart = assemble("cart", One("v") >> (I("m", 1), drag))
    >>> at = Forms(Smooth(derive(cart), cart)).at([2.0], [], [])
    >>> one = numpy.array([1.0])
    >>> at.second(one, one).real.tolist(), at.third(one, one, one).real.tolist()
    ([-12.0], [-6.0])
    """

    def __init__(self, forms: Forms, x: Array, u: Array, p: Array) -> None:
        self.forms, self.x, self.u, self.p = forms, x, u, p

    @cached_property
    def _slopes(self) -> tuple[Array, Array, Array]:
        return self.forms.slopes(self.x, self.u, self.p)

    @property
    def jacobian(self) -> Array:
        """Derivative of the rates by states and algebraic variables, (n + nz, n + nz) array."""
        return self._slopes[1]

    @property
    def by_arguments(self) -> Array:
        """Derivative of the rates by inputs and parameters, (n + nz, nu + np) array."""
        return self._slopes[2]

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
        return self._summed(self.forms.gradient, size, left, right)

    def second(self, a: Array, b: Array) -> Array:
        """Return the second derivative of the rates along two directions.

        Parameters
        ----------
        a, b : (n + nz,) complex array

        Returns
        -------
        (n + nz,) complex array
        """
        return self._summed(self.forms.second, len(self.x), a, b)

    def third(self, a: Array, b: Array, c: Array) -> Array:
        """Return the third derivative of the rates along three directions."""
        return self._summed(self.forms.third, len(self.x), a, b, c)

    def _summed(self, form: Form, size: int, *vectors: Array) -> Array:
        """Evaluate a form that is linear in complex vectors from its values at real ones."""
        total = numpy.zeros(size, dtype=complex)
        parts = [((1, numpy.real(vector)), (1j, numpy.imag(vector))) for vector in vectors]
        for chosen in itertools.product(*parts):
            if all(part.any() for _, part in chosen):
                factor = numpy.prod([unit for unit, _ in chosen])
                found = form(self.x, self.u, self.p, *(part for _, part in chosen))
                total += factor * found.full().ravel()
        return total
