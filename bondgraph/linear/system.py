"""The linear system: matrices with names and units, and what they say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import BondGraphError
from ..steady import SteadyState


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """Linear state equations ``dx/dt = A x + B u``, ``y = C x + D u`` about a point.

    Attributes
    ----------
    A : (n, n) array
        Ordered as `states`, in SI.
    B : (n, m) array
    C : (k, n) array
    D : (k, m) array
    states, inputs, outputs : tuple of str
    at : SteadyState
        The operating point.
    """

    A: numpy.ndarray
    B: numpy.ndarray
    C: numpy.ndarray
    D: numpy.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    at: SteadyState

    def poles(self) -> numpy.ndarray:
        """Return the eigenvalues of A.

        Returns
        -------
        (n,) complex array
            Least stable first; of a pair, the one with positive imaginary
            part first.
        """
        return self._modes()[0]

    def damp(self) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
        """Return natural frequency, damping ratio and pole of each mode.

        Returns
        -------
        wn : (n,) array
            Natural frequency, rad/s.
        zeta : (n,) array
            Damping ratio; negative where unstable, nan for a pole at zero.
        poles : (n,) complex array
        """
        poles = self.poles()
        natural = numpy.abs(poles)
        with numpy.errstate(invalid="ignore", divide="ignore"):
            return natural, numpy.where(natural > 0, -poles.real / natural, numpy.nan), poles

    @property
    def stable(self) -> bool:
        """Whether all poles lie strictly in the left half plane."""
        return bool(numpy.all(self.poles().real < 0))

    def participation(self) -> numpy.ndarray:
        """Return how much each state takes part in each mode.

        Returns
        -------
        (n, n) array
            Row: state, column: pole as ordered by `poles`; columns sum to one.

        References
        ----------
        Perez-Arriaga, Verghese, Schweppe, Selective modal analysis, IEEE Trans.
        Power Apparatus and Systems 101 (1982) 3117-3125.
        """
        _, right, left = self._modes()
        shares = numpy.abs(left * right)
        total = shares.sum(axis=0)
        return shares / numpy.where(total > 0, total, 1.0)

    def shapes(self) -> numpy.ndarray:
        """Return the right eigenvectors.

        Returns
        -------
        (n, n) complex array
            Row: state, column: pole as ordered by `poles`.
        """
        return self._modes()[1]

    def to_control(self) -> Any:
        """Return the same system as a ``control.StateSpace``.

        Raises
        ------
        BondGraphError
            If python-control is not installed.
        """
        try:
            import control
        except ImportError:
            raise BondGraphError(
                "python-control is not installed; pip install 'halfarrow[control]'"
            ) from None
        return control.ss(
            self.A,
            self.B,
            self.C,
            self.D,
            states=[name.replace(".", "_") for name in self.states],
            inputs=list(self.inputs),
            outputs=list(self.outputs),
        )

    def _modes(self) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
        """Return poles, right and left eigenvectors (columns), least stable first."""
        if not self.states:
            empty = numpy.zeros((0, 0), dtype=complex)
            return numpy.zeros(0, dtype=complex), empty, empty
        import scipy.linalg

        scaled, transform = scipy.linalg.matrix_balance(self.A, permute=False)
        poles, left, right = scipy.linalg.eig(scaled, left=True, right=True)
        scale = numpy.diag(transform)
        order = numpy.lexsort((-poles.imag, numpy.round(-poles.real, 9)))
        right, left = right * scale[:, None], left.conj() / scale[:, None]
        return poles[order], right[:, order], left[:, order]
