"""The linear system: matrices with names and units, its poles and modes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from ..steady import SteadyState
from ..views import HtmlView, LatexView
from .chosen import input_units, output_units, state_units, with_inputs, with_outputs
from .damping import DampingRow, damping_rows
from .modal import Mode, modal_table
from .shapes import ModeShape, mode_shapes
from .transfers import Transfers

if TYPE_CHECKING:
    import sympy

    from ..symbolic import SymbolicSystem


@dataclass(frozen=True, eq=False)
class LinearSystem(Transfers, HtmlView, LatexView):
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

    Examples
    --------
    >>> import sympy
    >>> from bondgraph import C, I, One, R, Se, assemble, linearize
    >>> F, spring = sympy.Symbol("F"), C("k", stiffness=8)
    >>> parts = Se("push", F) >> One("v") >> (I("m", 2), spring, R("b", 0.5))
    >>> system = linearize(assemble("msd", parts, inputs={F: "N"}, outputs={"x": (spring.q, "m")}))
    >>> print(system.transfer_function("x", "F"), system.dcgain().tolist())
    (0.5) / (s^2 + 0.25*s + 4) [[0.125]]
    """

    A: numpy.ndarray
    B: numpy.ndarray
    C: numpy.ndarray
    D: numpy.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    at: SteadyState

    def __repr__(self) -> str:
        sizes = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"LinearSystem({self.at.equations.name!r}, {sizes})"

    @property
    def state_units(self) -> tuple[str, ...]:
        """SI unit of each state; empty where it is not known."""
        return state_units(self)

    @property
    def input_units(self) -> tuple[str, ...]:
        """SI unit of each input; empty where it is not known."""
        return input_units(self)

    @property
    def output_units(self) -> tuple[str, ...]:
        """SI unit of each output; empty where it is not known."""
        return output_units(self)

    def with_outputs(self, *names: str) -> LinearSystem:
        """Return the same system with states and port variables as outputs too.

        Parameters
        ----------
        *names : str
            Such as ``"mass.p"`` or ``"spring.e"``.

        Returns
        -------
        LinearSystem

        Raises
        ------
        ParameterError
            For a name that is not known.
        """
        return with_outputs(self, names)

    def with_inputs(self, *names: str | sympy.Symbol) -> LinearSystem:
        """Return the same system with parameters as inputs too, such as a constant source's.

        Parameters
        ----------
        *names : str or Symbol
            Parameters that are derived from them follow.

        Returns
        -------
        LinearSystem

        Raises
        ------
        ParameterError
            For a name that is not known.
        """
        return with_inputs(self, names)

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

    def element_participation(self) -> dict[str, numpy.ndarray]:
        """Return how much each element takes part in each mode.

        Returns
        -------
        dict of str to (n,) array
            By element, a share for each pole as ordered by `poles`: the sum of its
            states' participation factors.
        """
        totals: dict[str, numpy.ndarray] = {}
        for state, shares in zip(self.states, self.participation(), strict=True):
            name = state.rpartition(".")[0] or state
            totals[name] = totals.get(name, 0.0) + shares
        return totals

    def damping_table(self) -> tuple[DampingRow, ...]:
        """Return each pole as a named row: frequency, damping and the elements that carry it.

        Returns
        -------
        tuple of DampingRow
            In the order of `poles`.
        """
        return damping_rows(self.states, self.poles(), self.participation())

    def modes(self) -> tuple[Mode, ...]:
        """Return what each mode is: who carries it, who stores its energy, who feeds it.

        Returns
        -------
        tuple of Mode
            In the order of `poles`; see `modal_table`.
        """
        return modal_table(self)

    def mode_shapes(self) -> tuple[ModeShape, ...]:
        """Return each mode as motion of the named junctions.

        Returns
        -------
        tuple of ModeShape
            In the order of `poles`; a flow for each 1-junction, an effort for each 0-junction.
        """
        return mode_shapes(self)

    def shapes(self) -> numpy.ndarray:
        """Return the right eigenvectors.

        Returns
        -------
        (n, n) complex array
            Row: state, column: pole as ordered by `poles`.
        """
        return self._modes()[1]

    def left_shapes(self) -> numpy.ndarray:
        """Return the left eigenvectors w, ``w A = pole w``.

        Returns
        -------
        (n, n) complex array
            Row: state, column: pole as ordered by `poles`.
        """
        return self._modes()[2]

    def symbolic(
        self, at: Mapping[Any, Any] | None = None, parameters: Mapping[Any, Any] | None = None
    ) -> SymbolicSystem:
        """Return the same model in symbols, in the mode of the operating point.

        Parameters
        ----------
        at : mapping, optional
            What of states, inputs and algebraic variables to give a number, such as
            ``system.at.states``; the rest stays in symbols.
        parameters : mapping, optional
            What to put in place of parameters.

        Returns
        -------
        SymbolicSystem

        Raises
        ------
        SymbolicError
            Where the model is too large.
        """
        from ..symbolic import symbolic_system

        equations = self.at.equations
        own = {symbol.name for symbol in equations.inputs}
        return symbolic_system(
            equations,
            at,
            parameters=parameters,
            inputs=[name for name in self.inputs if name not in own],
            outputs=[name for name in self.outputs if name not in equations.outputs],
        )

    def to_control(self) -> Any:
        """Return the same system as a ``control.StateSpace``; dots in names become underscores.

        Returns
        -------
        control.StateSpace

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
            inputs=[name.replace(".", "_") for name in self.inputs],
            outputs=[name.replace(".", "_") for name in self.outputs],
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
