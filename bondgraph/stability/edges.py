"""Edges: where an eigenvalue crosses the imaginary axis along a branch."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi
import numpy

from ..errors import SteadyStateError
from ..linear import Mode, growths, linearize_at, modal_table
from ..steady import SteadyState
from .branch import Branch

FOLD_ITERATIONS = 50
BISECTIONS = 12


@dataclass(frozen=True, eq=False)
class Edge:
    """A crossing of the imaginary axis.

    Attributes
    ----------
    kind : str
        ``"hopf"`` where a complex pair crosses, ``"fold"`` where a real
        eigenvalue does: a fold of the branch, or another exchange of stability.
    parameter : str
    value : float
        Of the parameter, SI.
    unit : str
        The parameter's own unit, for display.
    frequency_hz : float
        Of the crossing pair; zero at a fold.
    boundary : bool
        Whether the steady state is stable on one side; False where another
        mode is unstable already.
    unstable_above : bool or None
        On which side the crossing mode grows; None at the end of a branch.
    mode : Mode
        The crossing mode: its carriers, and feeds that balance here.
    point : SteadyState
        The operating point at the edge.
    first_lyapunov : None
        The coefficient that tells a soft onset from a hard one is not computed
        yet, so it is always None.
    """

    kind: str
    parameter: str
    value: float
    unit: str
    frequency_hz: float
    boundary: bool
    unstable_above: bool | None
    mode: Mode = field(repr=False)
    point: SteadyState = field(repr=False)
    first_lyapunov: None = None


def find_edges(
    branch: Branch,
    values: numpy.ndarray,
    states: numpy.ndarray,
    eigenvalues: numpy.ndarray,
    reasons: Mapping[int, str],
) -> tuple[Edge, ...]:
    """Find all crossings between neighbouring points of a branch.

    The real parts, sorted, are continuous functions of the parameter, so that
    each change of sign encloses a root whatever the order of the modes.

    Parameters
    ----------
    branch : Branch
    values : (m,) array
    states : (m, n + nz) array
        Algebraic variables stand behind the states.
    eigenvalues : (m, n) complex array
        Each row by falling real part; nan at gaps.
    reasons : mapping of int to str
        Gaps by index.

    Returns
    -------
    tuple of Edge
        By rising value.
    """
    signs = numpy.zeros(eigenvalues.shape, dtype=int)
    good = [index for index in range(len(values)) if index not in reasons]
    signs[good] = growths(eigenvalues[good])
    found: list[Edge] = []
    for run in _runs(good):
        for order in range(eigenvalues.shape[1]):
            for low, high, x in _brackets(branch, values, states, eigenvalues, signs, run, order):
                _add(found, _root(branch, low, high, order, x))
        for inside, outside in ((run[0], run[0] - 1), (run[-1], run[-1] + 1)):
            if 0 <= outside < len(values) and len(run) > 1:
                _add(found, _fold(branch, values[inside], values[outside], states[inside]))
    return tuple(sorted(found, key=lambda edge: edge.value))


def _runs(good: list[int]) -> list[list[int]]:
    """Split indices into runs of neighbours."""
    runs: list[list[int]] = []
    for index in good:
        if runs and runs[-1][-1] == index - 1:
            runs[-1].append(index)
        else:
            runs.append([index])
    return runs


def _add(found: list[Edge], edge: Edge | None) -> None:
    """Keep an edge unless it is there already: a pair crosses twice."""
    if edge is None:
        return
    for known in found:
        near = abs(known.value - edge.value) <= 1e-9 * max(abs(edge.value), 1e-300)
        alike = abs(known.frequency_hz - edge.frequency_hz) <= 1e-6 * edge.frequency_hz
        if near and alike and known.kind == edge.kind:
            return
    found.append(edge)


def _brackets(
    branch: Branch,
    values: numpy.ndarray,
    states: numpy.ndarray,
    eigenvalues: numpy.ndarray,
    signs: numpy.ndarray,
    run: list[int],
    order: int,
) -> list[tuple[float, float, numpy.ndarray]]:
    """Return the intervals in which a sorted real part changes sign, each with a start."""
    marked = [index for index in run if signs[index, order] != 0]
    brackets = []
    for left, right in itertools.pairwise(marked):
        if signs[left, order] != signs[right, order]:
            brackets.append((values[left], values[right], states[left]))
    for at in run[1:-1] if order == 0 else ():
        trio = slice(at - 1, at + 2)
        if _dips(eigenvalues[trio, 0].real, signs[trio, 0]):
            turn = _turn(branch, values[trio], states[at], int(signs[at, 0]))
            if turn is not None:
                brackets.append((values[at - 1], turn, states[at - 1]))
                brackets.append((turn, values[at + 1], states[at]))
    return brackets


def _dips(heights: numpy.ndarray, signs: numpy.ndarray) -> bool:
    """Whether three samples of one sign may hide a dip through zero."""
    if not (signs[0] != 0 and (signs == signs[0]).all()):
        return False
    before, at, after = numpy.abs(heights)
    return bool(at <= min(before, after) and at <= 2 * max(before - at, after - at))


def _turn(branch: Branch, values: numpy.ndarray, x: numpy.ndarray, sign: int) -> float | None:
    """Return a parameter between samples at which the greatest real part is past zero."""
    from scipy.optimize import minimize_scalar

    def height(value: float) -> float:
        return sign * float(branch.eigenvalues(value, branch.solve(value, x))[0].real)

    try:
        ends = (float(values.min()), float(values.max()))
        lowest = minimize_scalar(height, bounds=ends, method="bounded")
    except SteadyStateError:
        return None
    return float(lowest.x) if lowest.fun < 0 else None


def _root(branch: Branch, low: float, high: float, order: int, x: numpy.ndarray) -> Edge | None:
    from scipy.optimize import brentq

    guess = x

    def real_part(value: float) -> float:
        nonlocal guess
        guess = branch.solve(value, guess)
        return float(branch.eigenvalues(value, guess)[order].real)

    scale = max(abs(low), abs(high))
    try:
        ends = real_part(low), real_part(high)
        value = float(brentq(real_part, low, high, xtol=1e-15 * scale, rtol=1e-14, maxiter=200))
        x = branch.solve(value, guess)
    except (SteadyStateError, ValueError, RuntimeError):
        return None
    upper = ends[1] if high > low else ends[0]
    return _edge(branch, value, x, branch.eigenvalues(value, x)[order], upper > 0)


def _edge(
    branch: Branch,
    value: float,
    x: numpy.ndarray,
    crossing: complex,
    unstable_above: bool | None,
) -> Edge:
    """Describe a crossing at a solved point."""
    point = branch.point_at(value, x)
    modes = modal_table(linearize_at(branch.smooth, point))
    target = complex(crossing.real, abs(crossing.imag))
    mode = min(modes, key=lambda item: abs(item.eigenvalue - target))
    others = [item.eigenvalue.real for item in modes if item.eigenvalue.conjugate() != target]
    scale = max(abs(item.eigenvalue) for item in modes)
    return Edge(
        "hopf" if mode.eigenvalue.imag else "fold",
        branch.name,
        value,
        branch.unit,
        mode.frequency_hz,
        max(others, default=0.0) <= 1e-10 * scale,
        unstable_above,
        mode,
        point,
    )


def _fold(branch: Branch, inside: float, outside: float, x: numpy.ndarray) -> Edge | None:
    """Return the fold at which a branch ends between two samples, if it is one."""
    lost = outside
    for _ in range(BISECTIONS):
        middle = (inside + lost) / 2
        try:
            x = branch.solve(middle, x)
            inside = middle
        except SteadyStateError as error:
            if error.elements:
                return None  # a contact leaves its mode: the branch is cut, not folded
            lost = middle
    solved = _solve_fold(branch, inside, x)
    if solved is None:
        return None
    value, x = solved
    low, high = sorted((inside, outside))
    margin = 1e-6 * (high - low)
    if not low - margin <= value <= high + margin:
        return None
    poles = branch.eigenvalues(value, x)
    return _edge(branch, value, x, poles[numpy.argmin(numpy.abs(poles))], None)


def _solve_fold(
    branch: Branch, value: float, x: numpy.ndarray
) -> tuple[float, numpy.ndarray] | None:
    """Solve for a point where the Jacobian has a null vector, by Newton on all at once."""
    size = len(x)
    _, _, rows = numpy.linalg.svd(_scaled(branch.smooth.jacobian(x, *branch.arguments(value))))
    scale = _column_scale(branch.smooth.jacobian(x, *branch.arguments(value)))
    null = rows[-1] / scale
    system = _fold_system(branch, null)
    unknown = numpy.concatenate([x, null, [value]])
    for _ in range(FOLD_ITERATIONS):
        residual, matrix = (part.full() for part in system(unknown))
        if not (numpy.isfinite(residual).all() and numpy.isfinite(matrix).all()):
            return None
        columns = _column_scale(matrix)
        step = numpy.linalg.lstsq(matrix / columns, -residual.ravel(), rcond=1e-15)[0] / columns
        unknown = unknown + step
        if numpy.all(numpy.abs(step) <= 1e-12 * (numpy.abs(unknown) + 1e-12 / columns)):
            return float(unknown[-1]), unknown[:size]
    return None


def _fold_system(branch: Branch, weights: numpy.ndarray) -> casadi.Function:
    """Build residual and Jacobian of ``rates = 0, A v = 0, w v = 1`` in states, v, parameter."""
    size = len(weights)
    unknown = casadi.SX.sym("unknown", 2 * size + 1)
    x, v, value = unknown[:size], unknown[size : 2 * size], unknown[-1]
    u, p = (casadi.SX(vector) for vector in branch.arguments(0.0))
    index = branch.index
    if branch.is_input:
        u[index] = value
    else:
        p[index] = value
    rates = branch.smooth.symbolic(x, u, p)
    slope = casadi.jtimes(rates, x, v)
    norm = casadi.dot(casadi.DM(weights), v) / float(weights @ weights) - 1
    residual = casadi.vertcat(rates, slope, norm)
    return casadi.Function("fold", [unknown], [residual, casadi.jacobian(residual, unknown)])


def _column_scale(matrix: numpy.ndarray) -> numpy.ndarray:
    norms = numpy.linalg.norm(matrix, axis=0)
    return numpy.where(norms > 0, norms, 1.0)


def _scaled(matrix: numpy.ndarray) -> numpy.ndarray:
    return matrix / _column_scale(matrix)
