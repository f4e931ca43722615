"""Linearisation: steady state, A B C D, poles, damping, participation.

A graph with contacts is linearised in one mode, where it is an ordinary smooth
graph. The steady state is found by solving; nothing is typed in.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from .codegen.program import Program
from .codegen.to_casadi import to_casadi
from .equations import Equations, derive
from .errors import BondGraphError, SimulationError, SteadyStateError
from .graph import TIME, BondGraph
from .modes import LABELS, SLIP_BACKWARD, SLIP_FORWARD, STICK, contacts, in_mode
from .parameters import unknown_name
from .values import initial_values, parameter_values

MAX_ITERATIONS = 100
MAX_MODE_CHANGES = 20


@dataclass(frozen=True, eq=False)
class SteadyState:
    """A point where nothing changes, in one mode.

    Attributes
    ----------
    states : dict of str to float
    outputs : dict of str to float
    inputs : dict of str to float
    parameters : dict of str to float
        SI values used.
    modes : dict of str to str
        Mode of each contact at this point.
    equations : Equations
        Those of the mode: without contacts.
    isolated : bool
        Whether the point is the only one near by; False where a state is free,
        such as the position of an unconstrained mass.
    """

    states: dict[str, float]
    outputs: dict[str, float]
    inputs: dict[str, float]
    parameters: dict[str, float]
    modes: dict[str, str]
    equations: Equations
    isolated: bool


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
            raise BondGraphError("python-control is not installed; pip install 'halfarrow[control]'") from None
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


def steady_state(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, float] | None = None,
    modes: Mapping[str, str] | None = None,
    guess: Mapping[Any, float] | None = None,
) -> SteadyState:
    """Find a point where nothing changes.

    Parameters
    ----------
    graph : BondGraph
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    inputs : mapping, optional
        Constant inputs, zero unless given.
    modes : mapping of str to str, optional
        Fix the mode of contacts. Those not named start in the direction they
        slip in at the initial state, and change until the point agrees with
        its modes.
    guess : mapping, optional
        Start of the search by state; the initial state unless given.

    Returns
    -------
    SteadyState

    Raises
    ------
    SteadyStateError
        When there is none near the start, or sources depend on time.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> point = steady_state(bicycle_brake.graph(), {"mu_s": 0.42})
    >>> round(point.outputs["slip"], 9), point.modes
    (0.9, {'friction': 'slip+'})
    """
    fixed = dict(modes or {})
    current = {**_first_modes(graph, parameters, guess, fixed), **fixed}
    tried = set()
    for _ in range(MAX_MODE_CHANGES):
        key = tuple(sorted(current.items()))
        if key in tried:
            break
        tried.add(key)
        point = _solve(graph, parameters, inputs, current, guess)
        wrong = _disagreeing(graph, point, {name for name in current if name not in fixed})
        if not wrong:
            return point
        current |= wrong
    raise SteadyStateError(
        f"model {graph.name!r} has no steady state that agrees with its contacts' modes near the start; "
        f"give modes={{...}} or another guess",
        elements=list(current),
    )


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
        (others keep their initial value) and need not be an equilibrium.
    inputs : mapping, optional
        Constant inputs.
    modes : mapping of str to str, optional
        Modes of the contacts.

    Returns
    -------
    LinearSystem

    Raises
    ------
    SteadyStateError

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> v = One("v")
    >>> system = linearize(assemble("msd", Se("F", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 0.5))))
    >>> system.poles().round(6).tolist()
    [(-0.125+1.996089j), (-0.125-1.996089j)]
    """
    if isinstance(at, SteadyState):
        point = at
    elif at is not None:
        chosen = {**_first_modes(graph, parameters, at, dict(modes or {})), **(modes or {})}
        point = _point(graph, parameters, inputs, chosen, at)
    else:
        point = steady_state(graph, parameters, inputs, modes)
    system = _Smooth(point.equations, point.parameters, point.inputs)
    a, b, c, d = system.matrices(numpy.array(list(point.states.values())))
    names = tuple(symbol.name for symbol in point.equations.inputs)
    return LinearSystem(a, b, c, d, tuple(point.states), names, tuple(point.equations.outputs), point)


class _Smooth:
    """Numeric rates, Jacobians and outputs of equations without contacts."""

    def __init__(self, equations: Equations, values: Mapping[str, float], inputs: Mapping[str, float]) -> None:
        import casadi

        if equations.algebraic:
            names = ", ".join(symbol.name for symbol in equations.algebraic)
            raise SteadyStateError(
                f"model {equations.name!r} keeps algebraic variables ({names}); "
                f"add a compliance or inertia where they arise",
                elements=[symbol.name for symbol in equations.algebraic],
            )
        self.equations = equations
        self.p = [values[symbol.name] for symbol in equations.parameters]
        self.u = [inputs.get(symbol.name, 0.0) for symbol in equations.inputs]
        program = Program.pruned(
            "smooth",
            [("t", [TIME]), ("x", equations.states), ("u", equations.inputs), ("p", equations.parameters)],
            equations.assignments,
            {"rates": equations.derivatives, "outputs": equations.outputs.values()},
        )
        if TIME in set().union(*(expression.free_symbols for _, expression in program.assignments), set()):
            raise SteadyStateError(
                f"model {equations.name!r} has a source that depends on time, so there is no steady state; "
                f"make the source an input"
            )
        function = to_casadi(program)
        x, u = casadi.SX.sym("x", len(equations.states)), casadi.SX.sym("u", len(equations.inputs))
        rates, outputs = function(0, x, u, self.p)
        jacobians = [casadi.densify(casadi.jacobian(of, by)) for of in (rates, outputs) for by in (x, u)]
        self._values = casadi.Function("values", [x, u], [rates, outputs])
        self._jacobians = casadi.Function("jacobians", [x, u], jacobians)

    def rates(self, x: numpy.ndarray) -> numpy.ndarray:
        return numpy.array(self._values(x, self.u)[0]).ravel()

    def outputs(self, x: numpy.ndarray) -> dict[str, float]:
        found = numpy.array(self._values(x, self.u)[1]).ravel()
        return dict(zip(self.equations.outputs, map(float, found), strict=True))

    def matrices(self, x: numpy.ndarray) -> tuple[numpy.ndarray, ...]:
        found = tuple(numpy.array(matrix) for matrix in self._jacobians(x, self.u))
        if not all(numpy.isfinite(matrix).all() for matrix in found):
            raise SteadyStateError(f"model {self.equations.name!r}: the Jacobian is not finite at this point")
        return found


def _input_values(equations: Equations, inputs: Mapping[Any, float] | None) -> dict[str, float]:
    values = {symbol.name: 0.0 for symbol in equations.inputs}
    for key, value in (inputs or {}).items():
        name = getattr(key, "name", key)
        if name not in values:
            raise unknown_name("input", str(name), values)
        if not isinstance(value, int | float) or not numpy.isfinite(value):
            raise SimulationError(f"input {name!r} is {value!r}; a steady state needs a finite number")
        values[name] = float(value)
    return values


def _point(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, float] | None,
    modes: Mapping[str, str],
    at: Mapping[Any, float] | None,
) -> SteadyState:
    """Take a point as given, without solving."""
    equations = derive(in_mode(graph, modes))
    values = parameter_values(equations, parameters)
    start = initial_values(equations, values, at)
    given = _input_values(equations, inputs)
    outputs = _Smooth(equations, values, given).outputs(numpy.array(start))
    return SteadyState(_named(equations, start), outputs, given, values, dict(modes), equations, True)


def _named(equations: Equations, x: Any) -> dict[str, float]:
    return {state.name: float(value) for state, value in zip(equations.states, x, strict=True)}


def _solve(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, float] | None,
    modes: Mapping[str, str],
    guess: Mapping[Any, float] | None,
) -> SteadyState:
    equations = derive(in_mode(graph, modes))
    values = parameter_values(equations, parameters)
    given = _input_values(equations, inputs)
    smooth = _Smooth(equations, values, given)
    known = {state.name for state in equations.states} | set(equations.outputs)
    start = initial_values(
        equations, values, {key: value for key, value in (guess or {}).items() if getattr(key, "name", key) in known}
    )
    x, isolated = _newton(smooth.rates, lambda x: smooth.matrices(x)[0], numpy.array(start), graph.name)
    return SteadyState(_named(equations, x), smooth.outputs(x), given, values, dict(modes), equations, isolated)


def _newton(
    rates: Callable[[numpy.ndarray], numpy.ndarray],
    jacobian: Callable[[numpy.ndarray], numpy.ndarray],
    x: numpy.ndarray,
    name: str,
) -> tuple[numpy.ndarray, bool]:
    """Damped Newton; a singular Jacobian takes the shortest step in scaled states."""
    isolated = True
    for _ in range(MAX_ITERATIONS):
        residual, matrix = rates(x), jacobian(x)
        step, isolated = _step(matrix, residual)
        if not numpy.isfinite(step).all():
            break
        size = 1.0
        while size > 1e-6:
            trial = rates(x + size * step)
            if numpy.isfinite(trial).all() and _worth(trial, matrix) <= (1 - size / 4) * _worth(residual, matrix):
                break
            size /= 2
        if size <= 1e-6:
            size = 0.0
        x = x + size * step
        if _converged(rates(x), matrix, x, size * step):
            return x, isolated
        if size == 0.0:
            break
    raise SteadyStateError(
        f"model {name!r}: no steady state found near the start (largest rate left: {numpy.abs(rates(x)).max():.3g}); "
        f"a free motion may have none, otherwise give another guess"
    )


def _step(matrix: numpy.ndarray, residual: numpy.ndarray) -> tuple[numpy.ndarray, bool]:
    import scipy.linalg

    if not matrix.size:
        return numpy.zeros(0), True
    balanced, transform = scipy.linalg.matrix_balance(matrix, permute=False)
    scale = numpy.diag(transform)
    solution, _, rank, _ = numpy.linalg.lstsq(balanced, -residual / scale, rcond=1e-12)
    return solution * scale, bool(rank == len(matrix))


def _worth(residual: numpy.ndarray, matrix: numpy.ndarray) -> float:
    """Size of a residual, each row measured by its own Jacobian row."""
    rows = numpy.abs(matrix).max(axis=1, initial=0.0)
    return float(numpy.linalg.norm(residual / numpy.where(rows > 0, rows, 1.0)))


def _converged(residual: numpy.ndarray, matrix: numpy.ndarray, x: numpy.ndarray, step: numpy.ndarray) -> bool:
    """Whether the rates are rounding noise beside the terms they are made of."""
    terms = numpy.abs(matrix) @ (numpy.abs(x) + numpy.abs(step))
    settled = numpy.abs(step) <= 1e-10 * (numpy.abs(x) + 1e-300)
    small = numpy.abs(residual) <= 1e-12 * terms + 1e-300
    return bool(numpy.all(small) or (numpy.all(settled | (step == 0)) and numpy.all(numpy.abs(residual) <= 1e-9 * terms + 1e-300)))


def _first_modes(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None,
    start: Mapping[Any, float] | None,
    fixed: Mapping[str, str],
) -> dict[str, str]:
    """Direction in which each open contact slips at the start."""
    names = [name for name in contacts(graph) if name not in fixed]
    if not names:
        return {}
    equations = derive(graph)
    values = parameter_values(equations, parameters)
    x = initial_values(equations, values, start)
    numbers = {state.name: value for state, value in zip(equations.states, x, strict=True)} | values
    found = {}
    for contact in equations.contacts:
        if contact.name in names:
            slip = equations.substituted(contact.slip)
            value = slip.evalf(17, subs={symbol: numbers.get(symbol.name, 0.0) for symbol in slip.free_symbols})
            found[contact.name] = SLIP_BACKWARD if value < 0 else SLIP_FORWARD
    return found


def _disagreeing(graph: BondGraph, point: SteadyState, free: set[str]) -> dict[str, str]:
    """Return better modes for contacts whose slip or effort contradicts theirs."""
    if not free:
        return {}
    held = derive(graph, stuck=[name for name, mode in point.modes.items() if mode == STICK])
    wrong = {}
    for contact in held.contacts:
        if contact.name not in free:
            continue
        slip, effort, limit = _contact_values(point, contact.name, held)
        mode = point.modes[contact.name]
        if mode == STICK and abs(effort) > limit:
            wrong[contact.name] = LABELS[1 if effort > 0 else -1]
        elif mode != STICK and slip * (1 if mode == SLIP_FORWARD else -1) <= 0:
            wrong[contact.name] = STICK
    return wrong


def _contact_values(point: SteadyState, name: str, held: Equations) -> tuple[float, float, float]:
    """Evaluate slip, effort and breakaway of a contact at a point, in the mode's own equations."""
    equations = point.equations
    contact = next(item for item in held.contacts if item.name == name)
    numbers = {**point.states, **point.parameters, **point.inputs}
    results = []
    for expression in (equations.ports[f"{name}.f"], equations.ports[f"{name}.e"], contact.breakaway):
        value = equations.substituted(expression)
        results.append(float(value.evalf(17, subs={symbol: numbers[symbol.name] for symbol in value.free_symbols})))
    return results[0], results[1], results[2]
