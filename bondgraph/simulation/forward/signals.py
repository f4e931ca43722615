"""Derivatives of signals: outputs and port variables in the equations of each sample's mode."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy

from ...codegen.to_casadi import to_casadi
from ...parameters import unknown_name
from ..implicit import Implicit

if TYPE_CHECKING:
    import casadi

    from ..compiled import CompiledModel

Array = numpy.ndarray


class SignalSlopes:
    """Slopes of named signals, made when first asked for.

    Parameters
    ----------
    model : CompiledModel
    """

    def __init__(self, model: CompiledModel) -> None:
        self._model = model
        self._made: dict[tuple[int, str], Callable[..., Array]] = {}

    def __call__(
        self, mask: int, name: str, at: tuple[Array, ...], moved: Array, seeds: Array
    ) -> Array:
        """Return the derivatives of a signal at many samples of one mode.

        Parameters
        ----------
        mask : int
        name : str
        at : tuple of arrays
            ``(t, x, u, p, s)``, of shape (size, nt); algebraic variables follow
            the states in x.
        moved : (n, q, nt) array
            Derivatives of x.
        seeds : (np, q) array
            Derivatives of the parameters.

        Returns
        -------
        (q, nt) array

        Raises
        ------
        ParameterError
            For a name that is not known.
        """
        n = len(moved)
        slopes = self._slopes(mask, name)(*at)
        by_x = numpy.einsum("nt,nqt->qt", slopes[:n], moved)
        return by_x + numpy.einsum("pt,pq->qt", slopes[n:], seeds)

    def _slopes(self, mask: int, name: str) -> Callable[..., Array]:
        if (mask, name) not in self._made:
            self._made[mask, name] = self._differentiated(mask, name)
        return self._made[mask, name]

    def _differentiated(self, mask: int, name: str) -> Callable[..., Array]:
        """Return a function of (t, x, u, p, s) to the slopes by x and p, shape (n + np, nt)."""
        import casadi

        model = self._model
        try:
            expression = model.expression(model.in_mask(mask), name)
        except KeyError:
            raise unknown_name("signal", name, model.names) from None
        function = to_casadi(model.signal_program(mask, [expression]))
        given = [casadi.SX.sym(label, function.numel_in(i)) for i, label in enumerate("txups")]
        still = [casadi.SX.zeros(function.size_in(i)) for i in range(5, function.n_in())]
        by = casadi.vertcat(given[1], given[3])
        if function.n_in() == 5 or not function.numel_in(5):
            slope = casadi.jacobian(function(*given, *still), by)
            made = casadi.Function("slopes", given, [casadi.densify(slope.T)])
            return lambda *at: made(*at).full().reshape(by.numel(), -1)
        return _with_solved(self._model, mask, function)


def _with_solved(
    model: CompiledModel, mask: int, function: casadi.Function
) -> Callable[..., Array]:
    """Return the slopes of a signal in a mode that has algebraic variables, which move too."""
    import casadi

    arguments, (held,) = model.mode_set.expressions(mask, ["residual"])
    implicit = Implicit(arguments, [held])
    given, by = arguments[:6], casadi.vertcat(arguments[1], arguments[3])
    moved = casadi.vertcat(*arguments[6:])
    signal, held = (casadi.substitute(part, moved, 0) for part in (function(*arguments), held))
    z = arguments[5]
    follows = casadi.solve(
        casadi.densify(casadi.jacobian(held, z)), casadi.densify(casadi.jacobian(held, by))
    )
    slope = casadi.jacobian(signal, by) - casadi.jacobian(signal, z) @ follows
    made = casadi.Function("slopes", given, [casadi.densify(slope.T)])

    def evaluate(*at: Array) -> Array:
        implicit.forget()
        found = [implicit.solve(*(part[:, i] for part in at)) for i in range(at[0].shape[1])]
        return made(*at, numpy.array(found).T).full().reshape(by.numel(), -1)

    return evaluate
