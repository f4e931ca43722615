"""Linearisation: steady state, A B C D, poles, damping, participation.

A graph with contacts is linearised in one mode, where it is an ordinary smooth
graph. The steady state is found by solving; nothing is typed in.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from .errors import BondGraphError, ParameterError
from .graph import BondGraph
from .parameters import unknown_name
from .smooth import Smooth
from .steady import SteadyState, given_point, steady_state
from .values import parameter_values

__all__ = ["LinearSystem", "SteadyState", "linearize", "linearize_at", "steady_state"]


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

    def left_shapes(self) -> numpy.ndarray:
        """Return the left eigenvectors w, ``w A = pole w``.

        Returns
        -------
        (n, n) complex array
            Row: state, column: pole as ordered by `poles`.
        """
        return self._modes()[2]

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


def linearize(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None = None,
    at: SteadyState | Mapping[Any, float] | None = None,
    inputs: Mapping[Any, float] | None = None,
    modes: Mapping[str, str] | None = None,
) -> LinearSystem:
    """Linearise about a steady state or a given point.

    Parameters
    ----------
    graph : BondGraph
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    at : SteadyState or mapping, optional
        Where; found by `steady_state` unless given. A mapping gives states
        (others keep their initial value) and need not be an equilibrium. A
        SteadyState has its own parameters, inputs and modes: what else is given of
        them must agree.
    inputs : mapping, optional
        Constant inputs.
    modes : mapping of str to str, optional
        Modes of the contacts.

    Returns
    -------
    LinearSystem
        In the states alone: algebraic variables follow states and inputs.

    Raises
    ------
    SteadyStateError
    ParameterError
        For a parameter, input or mode that differs from a given SteadyState's.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> v = One("v")
    >>> system = linearize(assemble("msd", Se("F", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 0.5))))
    >>> system.poles().round(6).tolist()
    [(-0.125+1.99609j), (-0.125-1.99609j)]
    """
    if isinstance(at, SteadyState):
        _check_agreement(at, parameters, inputs, modes)
        point = at
    elif at is not None:
        point = given_point(graph, parameters, inputs, modes, at)
    else:
        point = steady_state(graph, parameters, inputs, modes)
    smooth = Smooth(point.equations, graph, held=point.parameters)
    return linearize_at(smooth, point)


def linearize_at(smooth: Smooth, point: SteadyState) -> LinearSystem:
    """Linearise functions that are at hand about a point of theirs.

    Parameters
    ----------
    smooth : Smooth
        Of the point's equations.
    point : SteadyState

    Returns
    -------
    LinearSystem
    """
    a, b, c, d = smooth.matrices(
        point.vector, list(point.inputs.values()), smooth.vector(point.parameters)
    )
    names = tuple(symbol.name for symbol in point.equations.inputs)
    outputs = tuple(point.equations.outputs)
    return LinearSystem(a, b, c, d, tuple(point.states), names, outputs, point)


def _check_agreement(
    point: SteadyState,
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, float] | None,
    modes: Mapping[str, str] | None,
) -> None:
    """Refuse what differs from the values that a steady state was found with."""
    values = parameter_values(point.equations, parameters) if parameters else {}
    named = [str(getattr(key, "name", key)) for key in parameters or {}]
    wanted: list[tuple[str, dict[str, Any], Mapping[str, Any]]] = [
        ("parameter", {name: values[name] for name in named}, point.parameters),
        ("input", {str(getattr(k, "name", k)): v for k, v in (inputs or {}).items()}, point.inputs),
        ("mode of", dict(modes or {}), point.modes),
    ]
    for kind, given, had in wanted:
        for name, value in given.items():
            if name not in had:
                raise unknown_name(kind, name, had)
            if value != had[name]:
                raise ParameterError(
                    f"{kind} {name!r} is {value!r}, but the steady state given in at=... was found "
                    f"with {had[name]!r}; leave it out, or find the steady state with it",
                    elements=[name],
                )
