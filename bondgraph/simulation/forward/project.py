"""Contacts that stick at a given time: at the start of a run, or where an input jumps."""

from __future__ import annotations

from collections.abc import Callable

import numpy

from ..buffered import evaluator
from .tangents import TangentTable
from .value import NON_FINITE, Undefined

Array = numpy.ndarray


class Projector:
    """Takes sensitivities onto the motions that stuck contacts allow.

    A changed parameter or state would let a contact slip that sticks at a given
    time; friction would bring it to rest at once. In the limit of a small change
    it moves the state along the direction of its force, as far as the slip was off.

    Parameters
    ----------
    table : TangentTable
    parameters : (np,) array
    inputs : callable
        Time to inputs, those after a jump.
    """

    def __init__(
        self, table: TangentTable, parameters: Array, inputs: Callable[[float], Array]
    ) -> None:
        self.table, self.parameters, self.inputs = table, parameters, inputs

    def __call__(self, t: float, x: Array, codes: Array, S: Array, seeds: Array) -> Array:
        """Return the sensitivities projected.

        Parameters
        ----------
        t : float
        x : (n,) array
        codes : (k,) array
            Of the mode that begins; 0 where a contact sticks.
        S : (n, q) array
        seeds : (np, q) array
            Derivatives of the parameters.

        Returns
        -------
        (n, q) array

        Raises
        ------
        Undefined
            Where rates are not finite.
        """
        stuck = numpy.flatnonzero(codes == 0)
        free = numpy.where(codes == 0, 1.0, codes)
        by_x, by_p = self._slopes(t, x, free)
        off = (by_x @ S + by_p @ seeds)[stuck]
        if not off.any() or not numpy.isfinite(off).all():
            return S  # sensitivities that have overflowed stay so, and are seen for that
        pushes = numpy.empty((len(x), len(stuck)))
        held = self._rates(t, x, codes)
        for column, j in enumerate(stuck):
            loose = codes.copy()
            loose[j] = 1.0
            pushes[:, column] = self._rates(t, x, loose) - held
        along = by_x[stuck] @ pushes
        if not numpy.isfinite(along).all():
            raise Undefined(NON_FINITE, t, -1)
        return S - pushes @ numpy.linalg.lstsq(along, off, rcond=1e-12)[0]

    def _mask(self, codes: Array) -> int:
        return sum(1 << int(j) for j in numpy.flatnonzero(codes == 0))

    def _rates(self, t: float, x: Array, codes: Array) -> Array:
        function = evaluator(self.table.mode(self._mask(codes)).rates)
        return function(t, x, self.inputs(t), self.parameters, codes)[: self.table.n]

    def _slopes(self, t: float, x: Array, codes: Array) -> tuple[Array, Array]:
        """Return the Jacobians of the guards of slipping contacts, by states and by parameters."""
        mode, n, k = self.table.mode(self._mask(codes)), self.table.n, self.table.k
        u = numpy.concatenate([self.inputs(t), numpy.zeros(n + self.table.m)])
        values = evaluator(mode.surface)(t, x, u, self.parameters, codes)[4 * k :]
        assert mode.surface_entries is not None
        matrix = numpy.zeros((k, n + self.table.np))
        matrix[mode.surface_entries.rows, mode.surface_entries.columns] = values
        return matrix[:, :n], matrix[:, n:]
