"""Steady states: points where nothing changes, found by solving."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy
import sympy

from .elements import C, EndStop, Storage
from .equations import Equations, derive
from .errors import BondGraphError, SimulationError, SteadyStateError
from .graph import BondGraph
from .modes import CODES, SLIP_BACKWARD, SLIP_FORWARD, STICK, contacts, in_mode
from .parameters import unknown_name
from .smooth import ContactValues, Smooth
from .values import algebraic_guess, algebraic_names, initial_values, parameter_values
from .views import HtmlView

MAX_ITERATIONS = 100
MAX_MODE_CHANGES = 20
MAX_FIRST_MODES = 256
# The search that Newton falls back on: steps in time, each longer than the one before.
RELAXATIONS = 300
GROWTH = 1.2

Rates = Callable[[numpy.ndarray], numpy.ndarray]


@dataclass(frozen=True, eq=False)
class SteadyState(HtmlView):
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
    algebraic : dict of str to float
        Values of the algebraic variables that the equations keep.
    """

    states: dict[str, float]
    outputs: dict[str, float]
    inputs: dict[str, float]
    parameters: dict[str, float]
    modes: dict[str, str]
    equations: Equations
    isolated: bool
    algebraic: dict[str, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        modes = f", modes={self.modes}" if self.modes else ""
        return f"SteadyState({self.equations.name!r}, states={self.states}{modes})"

    @property
    def vector(self) -> list[float]:
        """States and algebraic variables, as the functions of `bondgraph.smooth.Smooth` take them."""
        return [*self.states.values(), *self.algebraic.values()]


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
        Start of the search by state; the initial state unless given. Algebraic
        variables, by name, start at zero unless given.

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
    check_guess(graph, guess)
    fixed = dict(modes or {})
    current = {**first_modes(graph, parameters, guess, fixed), **fixed}
    tried = set()
    for _ in range(MAX_MODE_CHANGES):
        key = tuple(sorted(current.items()))
        if key in tried:
            break
        tried.add(key)
        point, wrong = _solve(graph, parameters, inputs, current, guess)
        wrong = {name: mode for name, mode in wrong.items() if name not in fixed}
        if not wrong:
            return point
        current |= wrong
    raise SteadyStateError(
        f"model {graph.name!r} has no steady state that agrees with its contacts' modes near the "
        f"start; give modes={{...}} or another guess",
        elements=list(current),
    )


def given_point(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, float] | None,
    modes: Mapping[str, str] | None,
    at: Mapping[Any, float],
) -> SteadyState:
    """Take a point as given, without solving; states not named keep their initial value.

    Algebraic variables are solved for; what is given of them is where the search starts.

    Returns
    -------
    SteadyState
        Not an equilibrium, but with everything evaluated there.

    Raises
    ------
    SteadyStateError
        When the algebraic variables have no solution at these states.
    """
    chosen = {**first_modes(graph, parameters, at, dict(modes or {})), **(modes or {})}
    equations = derive(in_mode(graph, chosen))
    values = parameter_values(equations, parameters)
    start = initial_values(equations, values, at)
    given = input_values(equations, inputs)
    smooth = Smooth(equations, graph, held=values)
    u, p = list(given.values()), smooth.vector(values)
    x = smooth.consistent(start, u, p, algebraic_guess(equations, at))
    if x is None:
        names = [symbol.name for symbol in equations.algebraic]
        raise SteadyStateError(
            f"model {equations.name!r}: no values of the algebraic variables ({', '.join(names)}) "
            f"fulfil their equations at this point; give a guess of them beside the states",
            elements=names,
        )
    return _point(smooth, x, (given, values, chosen), True)


def input_values(equations: Equations, inputs: Mapping[Any, float] | None) -> dict[str, float]:
    """Return a finite value for each input, zero unless given.

    Raises
    ------
    ParameterError
        For a name that is no input.
    SimulationError
        For a value that is not finite.
    """
    values = {symbol.name: 0.0 for symbol in equations.inputs}
    for key, value in (inputs or {}).items():
        name = getattr(key, "name", key)
        if name not in values:
            raise unknown_name("input", str(name), values)
        if not isinstance(value, int | float) or not numpy.isfinite(value):
            raise SimulationError(
                f"input {name!r} is {value!r}; a steady state needs a finite number"
            )
        values[name] = float(value)
    return values


def first_modes(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None,
    start: Mapping[Any, float] | None,
    fixed: Mapping[str, str],
) -> dict[str, str]:
    """Return the mode of each open contact at the start: its direction, or stick where it rests.

    A contact without slip stays stuck unless more than its breakaway pulls at it.
    """
    names = [name for name in contacts(graph) if name not in fixed]
    if not names:
        return {}
    equations = derive(graph)
    if equations.switches:
        return first_possible(graph, fixed)
    values = parameter_values(equations, parameters)
    x = initial_values(equations, values, start)
    numbers = {state.name: value for state, value in zip(equations.states, x, strict=True)} | values
    slips = {
        contact.name: _at(equations, contact.slip, numbers)
        for contact in equations.contacts
        if contact.name in names
    }
    found = {name: SLIP_BACKWARD if slip < 0 else SLIP_FORWARD for name, slip in slips.items()}
    resting = [name for name, slip in slips.items() if slip == 0]
    if resting:
        numbers |= {f"{name}.direction": float(CODES[mode]) for name, mode in found.items()}
        held = derive(in_mode(graph, dict.fromkeys(resting, STICK)))
        limits = {contact.name: contact.breakaway for contact in equations.contacts}
        for name in resting:
            effort = _at(held, held.ports[f"{name}.e"], numbers)
            margin = _at(held, limits[name], numbers) - abs(effort)
            at_rest = ContactValues(graph[name], 0.0, effort, (margin, 0.0, 0.0))
            found[name] = at_rest.better_mode(STICK) or STICK
    return found


def first_possible(graph: BondGraph, fixed: Mapping[str, str]) -> dict[str, str]:
    """Return modes whose equations exist, near those in which nothing is held."""
    free = {name: list(graph[name].modes)[::-1] for name in contacts(graph) if name not in fixed}
    choices = itertools.islice(itertools.product(*free.values()), MAX_FIRST_MODES)
    refusal: BondGraphError | None = None
    for labels in choices:
        modes = dict(zip(free, labels, strict=True))
        try:
            derive(in_mode(graph, {**modes, **fixed}))
        except BondGraphError as error:
            refusal = error
            continue
        return modes
    raise SteadyStateError(
        f"model {graph.name!r} can be in no set of modes: {refusal}", elements=list(free)
    )


def _at(equations: Equations, expression: sympy.Expr, numbers: Mapping[str, float]) -> float:
    """Evaluate an expression; inputs and what else has no value count as zero."""
    expanded = equations.substituted(expression)
    given = {symbol: numbers.get(symbol.name, 0.0) for symbol in expanded.free_symbols}
    return float(expanded.evalf(17, subs=given))


def check_guess(graph: BondGraph, guess: Mapping[Any, float] | None) -> None:
    """Refuse a guess for what is a state in no mode, nor an output, nor algebraic."""
    known = [
        *(
            f"{name}.{'q' if isinstance(element, C) else 'p'}"
            for name, element in graph.of(Storage)
        ),
        *graph.outputs,
    ]
    names = [str(getattr(key, "name", key)) for key in guess or {}]
    if all(name in known for name in names):
        return
    implicit = algebraic_names(derive(graph))
    for name in names:
        if name not in known and name not in implicit:
            raise unknown_name("state", name, known)


def _point(
    smooth: Smooth,
    x: Any,
    given: tuple[dict[str, float], dict[str, float], Mapping[str, str]],
    isolated: bool,
) -> SteadyState:
    """Name everything at a point; ``given`` holds inputs, parameters and modes."""
    equations = smooth.equations
    inputs, values, modes = given
    return SteadyState(
        _named(equations.states, x[: smooth.order]),
        smooth.outputs(x, list(inputs.values()), smooth.vector(values)),
        inputs,
        values,
        dict(modes),
        equations,
        isolated,
        _named(equations.algebraic, x[smooth.order :]),
    )


def _named(symbols: tuple[sympy.Symbol, ...], x: Any) -> dict[str, float]:
    return {symbol.name: float(value) for symbol, value in zip(symbols, x, strict=True)}


def _solve(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None,
    inputs: Mapping[Any, float] | None,
    modes: Mapping[str, str],
    guess: Mapping[Any, float] | None,
) -> tuple[SteadyState, dict[str, str]]:
    """Solve in given modes; return the point and the modes its contacts would rather be in."""
    equations = derive(in_mode(graph, modes))
    values = parameter_values(equations, parameters)
    given = input_values(equations, inputs)
    smooth = Smooth(equations, graph, held=values)
    known = {state.name for state in equations.states} | set(equations.outputs)
    known |= algebraic_names(equations)
    hints = {
        key: value for key, value in (guess or {}).items() if getattr(key, "name", key) in known
    }
    u, p = list(given.values()), smooth.vector(values)
    states = initial_values(equations, values, hints)
    z = algebraic_guess(equations, hints)
    x, isolated = find_rest(smooth, modes, (states, z), u, p)
    point = _point(smooth, x, (given, values, modes), isolated)
    better = {
        name: found.better_mode(modes[name])
        for name, found in smooth.contact_values(x, u, p).items()
    }
    return point, {name: mode for name, mode in better.items() if mode is not None}


def find_rest(
    smooth: Smooth,
    modes: Mapping[str, str],
    start: tuple[Any, Any],
    u: Any,
    p: Any,
) -> tuple[numpy.ndarray, bool]:
    """Find a point where nothing changes, in given modes, from states and algebraic variables.

    Parameters
    ----------
    smooth : Smooth
        Of the equations in the modes.
    modes : mapping of str to str
    start : (sequence of float, sequence of float)
        First states, and a guess of the algebraic variables.
    u, p : sequence of float
        Inputs and parameter vector.

    Returns
    -------
    x : (n + nz,) array
    isolated : bool
        See `solve_rates`.

    Raises
    ------
    SteadyStateError
    """
    states, z = start
    first = smooth.consistent(states, u, p, z)
    if first is None:  # none at these states; there may be at others
        first = numpy.array([*states, *z])
    first = _against_stops(smooth, modes, first, u, p)
    try:
        return solve_rates(smooth, first, u, p)
    except SteadyStateError:
        return solve_rates(smooth, _relaxed(smooth, first, u, p), u, p)


def _against_stops(
    smooth: Smooth, modes: Mapping[str, str], start: numpy.ndarray, u: Any, p: Any
) -> numpy.ndarray:
    """Move states so that end stops in contact have no gap; no rate would tell."""
    names = [
        n
        for n, mode in modes.items()
        if isinstance(smooth.element(n), EndStop) and mode == "contact"
    ]
    x = start

    def gaps(x: numpy.ndarray) -> numpy.ndarray:
        values = smooth.contact_values(x, u, p)
        return numpy.array(
            [values[n].margins[list(values[n].element.modes).index("free")] for n in names]
        )

    for _ in range(MAX_ITERATIONS if names and len(x) else 0):
        open_gaps = gaps(x)
        if not open_gaps.any() or not numpy.isfinite(open_gaps).all():
            break
        sizes = 1e-6 * numpy.maximum(numpy.abs(x), 1e-3)
        columns = [
            (gaps(x + h * e) - open_gaps) / h for h, e in zip(sizes, numpy.eye(len(x)), strict=True)
        ]
        step = numpy.linalg.lstsq(numpy.array(columns).T, -open_gaps, rcond=1e-9)[0]
        x = x + step
        if numpy.abs(step).max() <= 1e-14 * numpy.abs(x).max(initial=0.0):
            break
    return x


def solve_rates(smooth: Smooth, start: Any, u: Any, p: Any) -> tuple[numpy.ndarray, bool]:
    """Find states at which all rates are zero, by damped Newton.

    Algebraic variables are solved for along with them. A singular Jacobian takes the
    shortest step in scaled states.

    Parameters
    ----------
    smooth : Smooth
    start, u, p : sequence of float
        First states and algebraic variables, inputs, parameter vector.

    Returns
    -------
    x : (n + nz,) array
    isolated : bool
        Whether the Jacobian has full rank there.

    Raises
    ------
    SteadyStateError
    """
    x = numpy.array(start, dtype=float)
    residual = smooth.rates(x, u, p)
    for _ in range(MAX_ITERATIONS):
        newton = _Newton(smooth.jacobian(x, u, p), residual)
        if not numpy.isfinite(newton.step).all():
            if not residual.any():  # at rest, where a law has no slope
                return x, newton.isolated
            break
        if not newton.solvable(x):
            break
        if newton.small(x) and newton.balanced(x, residual):
            # taken all the same: near the root a step doubles the digits
            return x + newton.step, newton.isolated
        size, trial = _damped(lambda y: smooth.rates(y, u, p), x, newton)
        if size == 0.0:
            if newton.balanced(x, residual) or newton.spent(residual, u):
                return x, newton.isolated
            break
        x, residual = x + size * newton.step, trial
    left = numpy.abs(residual).max(initial=0.0)
    raise SteadyStateError(
        f"model {smooth.equations.name!r}: no steady state found near the start (largest rate "
        f"left: {left:.3g}); a free motion may have none, otherwise give another guess"
    )


def _relaxed(smooth: Smooth, start: Any, u: Any, p: Any) -> numpy.ndarray:
    """Let the states run towards a steady state, by implicit Euler steps of growing length.

    Residuals have no mass: a step is one of Newton for them.
    """
    x = numpy.array(start, dtype=float)
    rates, matrix = smooth.rates(x, u, p), smooth.jacobian(x, u, p)
    if not (numpy.isfinite(rates).all() and numpy.isfinite(matrix).all()):
        return x
    moving = numpy.arange(len(x)) < smooth.order
    mass = numpy.diag(moving.astype(float))
    fastest = _fastest(smooth, x, u, p)
    step = 0.1 / fastest if 0 < fastest < numpy.inf else 1.0
    for _ in range(RELAXATIONS):
        change = numpy.linalg.lstsq(mass - step * matrix, step * rates, rcond=None)[0]
        trial = smooth.rates(x + change, u, p)
        if not numpy.isfinite(trial).all():
            step /= 10
            continue
        newton = _Newton(matrix, rates)
        if newton.balanced(x, rates):
            break
        x, rates = x + change, trial
        matrix = smooth.jacobian(x, u, p)
        if not numpy.isfinite(matrix).all():
            break
        step *= GROWTH
    return x


def _fastest(smooth: Smooth, x: numpy.ndarray, u: Any, p: Any) -> float:
    """Return the largest size of an eigenvalue; zero where algebraic variables hide it."""
    try:
        matrix = smooth.state_matrix(x, u, p)
    except SteadyStateError:
        return 0.0
    return float(numpy.abs(numpy.linalg.eigvals(matrix)).max(initial=0.0))


class _Newton:
    """One Newton step, with sizes measured in states scaled to balance the Jacobian."""

    def __init__(self, matrix: numpy.ndarray, residual: numpy.ndarray) -> None:
        import scipy.linalg

        self.isolated = True
        self.step = numpy.full(len(residual), numpy.nan)
        if not matrix.size:
            self.step = numpy.zeros(0)
        elif numpy.isfinite(matrix).all() and numpy.isfinite(residual).all():
            self.matrix, transform = scipy.linalg.matrix_balance(matrix, permute=False)
            self.scale = numpy.diag(transform)
            self.rows = _largest(self.matrix)
            solution, _, rank, _ = numpy.linalg.lstsq(
                self.matrix, -residual / self.scale, rcond=1e-12
            )
            self.step = solution * self.scale
            self.isolated = bool(rank == len(matrix))
        self.residual = residual

    def solvable(self, x: numpy.ndarray) -> bool:
        """Whether the rates can all be zero, where the Jacobian is singular.

        A combination of rates that no state moves has to be zero by itself: a part that drifts
        along, or two imposed speeds that differ, have no steady state however far one goes.
        """
        if self.isolated or not len(x):
            return True
        columns, sizes, _ = numpy.linalg.svd(self.matrix)
        left = columns[:, sizes <= 1e-12 * sizes.max(initial=0.0)]
        still = numpy.abs(left)
        state, rate = x / self.scale, self.residual / self.scale
        moved = numpy.abs(self.matrix) @ numpy.abs(state)
        constant = numpy.abs(rate - self.matrix @ state)
        drift = numpy.abs(left.T @ rate)
        return bool(numpy.all(drift <= 1e-6 * (still.T @ constant) + 1e-12 * (still.T @ moved)))

    def worth(self, residual: numpy.ndarray) -> float:
        """Size of a residual, each row measured by its own Jacobian row."""
        if not len(residual):
            return 0.0
        return float(numpy.linalg.norm(residual / self.scale / self.rows))

    def small(self, x: numpy.ndarray) -> bool:
        """Whether the step is small beside the states."""
        if not len(x):
            return True
        reach = numpy.abs(x / self.scale).max()
        return bool(numpy.abs(self.step / self.scale).max() <= 1e-8 * reach)

    def balanced(self, x: numpy.ndarray, residual: numpy.ndarray) -> bool:
        """Whether the rates are rounding noise beside the terms they are made of."""
        if not len(x):
            return True
        sizes = numpy.abs(x / self.scale)
        terms = numpy.abs(self.matrix) @ sizes
        floor = 1e-13 * numpy.abs(self.matrix).max() * sizes.max()
        return bool(numpy.all(numpy.abs(residual / self.scale) <= 1e-9 * terms + floor))

    def spent(self, residual: numpy.ndarray, u: Any) -> bool:
        """Whether only rounding of what the inputs add up to is left, where no step helps any more.

        Inputs may cancel altogether; then the states, all zero, tell no size.
        """
        largest = numpy.abs(numpy.asarray(u, dtype=float)).max(initial=0.0)
        return self.isolated and bool(numpy.abs(residual).max(initial=0.0) <= 1e-14 * largest)


def _damped(rates: Rates, x: numpy.ndarray, newton: _Newton) -> tuple[float, numpy.ndarray]:
    """Return the share of a step that lessens the residual, and what it leaves; zero where none."""
    size, before = 1.0, newton.worth(newton.residual)
    while size > 1e-6:
        trial = rates(x + size * newton.step)
        if numpy.isfinite(trial).all() and newton.worth(trial) <= (1 - size / 4) * before:
            return size, trial
        size /= 2
    return 0.0, newton.residual


def _largest(matrix: numpy.ndarray) -> numpy.ndarray:
    rows = numpy.abs(matrix).max(axis=1, initial=0.0)
    return numpy.where(rows > 0, rows, 1.0)
