"""Derivatives of signals: outputs and port variables in the equations of each sample's mode."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy

from ...codegen.to_casadi import to_casadi
from ...parameters import unknown_name

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
        self._made: dict[tuple[int, str], casadi.Function] = {}

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
        slopes = self._slopes(mask, name)(*at).full().reshape(n + len(seeds), -1)
        by_x = numpy.einsum("nt,nqt->qt", slopes[:n], moved)
        return by_x + numpy.einsum("pt,pq->qt", slopes[n:], seeds)

    def _slopes(self, mask: int, name: str) -> casadi.Function:
        if (mask, name) not in self._made:
            self._made[mask, name] = self._differentiated(mask, name)
        return self._made[mask, name]

    def _differentiated(self, mask: int, name: str) -> casadi.Function:
        import casadi

        model = self._model
        try:
            expression = model.expression(model.in_mask(mask), name)
        except KeyError:
            raise unknown_name("signal", name, model.names) from None
        function = to_casadi(model.signal_program(mask, [expression]))
        given = [casadi.SX.sym(label, function.numel_in(i)) for i, label in enumerate("txups")]
        still = [casadi.SX.zeros(function.size_in(i)) for i in range(5, function.n_in())]
        signal = function(*given, *still)
        slope = casadi.jacobian(signal, casadi.vertcat(given[1], given[3]))
        return casadi.Function("slopes", given, [casadi.densify(slope.T)])
