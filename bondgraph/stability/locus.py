"""Loci: the eigenvalues of a steady state followed along one parameter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import SteadyStateError
from ..graph import BondGraph
from ..steady import SteadyState
from .branch import Branch
from .continuation import Path, follow_path
from .edges import Edge, same
from .family import Family
from .vary import Vary

# The search looks at least this closely, whatever number of points is asked for.
MIN_STEPS = 50


@dataclass(frozen=True)
class Gap:
    """A point of a locus without a steady state.

    Attributes
    ----------
    value : float
        Of the parameter, SI.
    reason : str
    """

    value: float
    reason: str


@dataclass(frozen=True, eq=False)
class Locus:
    """Eigenvalues along one parameter.

    Attributes
    ----------
    name : str
    unit : str
        The parameter's own unit, for display.
    values : (m,) array
        In SI.
    eigenvalues : (m, n) complex array
        Each column follows one eigenvalue; nan at gaps.
    states : (m, n) array
        The steady states; nan at gaps.
    at : float
        The parameter's value at the operating point, SI.
    crossings : tuple of Edge
        Everywhere an eigenvalue crosses the imaginary axis, by rising value.
    path : Path
        The branch through the operating point, followed round its folds.
    gaps : tuple of Gap
    """

    name: str
    unit: str
    values: numpy.ndarray
    eigenvalues: numpy.ndarray
    states: numpy.ndarray
    at: float
    crossings: tuple[Edge, ...]
    path: Path
    gaps: tuple[Gap, ...]

    @property
    def edges(self) -> tuple[Edge, ...]:
        """The crossings that part stable from unstable."""
        return tuple(edge for edge in self.crossings if edge.boundary)

    @property
    def range(self) -> Vary:
        """The range followed, SI."""
        return Vary(self.name, float(self.values[0]), float(self.values[-1]), len(self.values))

    @property
    def nearest(self) -> Edge | None:
        """The edge of stability nearest to the operating point.

        Of those that its own branch meets first, if it meets any.
        """
        first = [edge for edge in self.path.first if edge is not None]
        return min(first or self.edges, key=lambda edge: abs(edge.value - self.at), default=None)


def trace(
    graph: BondGraph,
    point: SteadyState,
    vary: Vary,
    parameters: Mapping[Any, Any] | None = None,
) -> Locus:
    """Follow the eigenvalues of a steady state along one parameter.

    A point without a steady state becomes a named gap; the rest goes on.

    Parameters
    ----------
    graph : BondGraph
    point : SteadyState
        Where the branch starts; its modes are kept.
    vary : Vary
    parameters : mapping, optional
        The parameters that the point was found with. A derived one given here
        keeps its number along the locus.

    Returns
    -------
    Locus

    Raises
    ------
    ParameterError
        For an unknown name, a wrong unit, or an end that is not admissible.

    Examples
    --------
    >>> from bondgraph import steady_state
    >>> from bondgraph.models import bicycle_brake
    >>> graph = bicycle_brake.graph()
    >>> locus = trace(graph, steady_state(graph), Vary("V0", 0.25, 1.5))
    >>> [(edge.kind, round(edge.value, 6)) for edge in locus.edges]
    [('hopf', 0.322324)]
    """
    branch = Branch(graph, point, vary.name, parameters)
    vary = vary.in_si(branch.unit)
    _check_ends(branch, vary)
    finer = math.ceil(MIN_STEPS / (vary.n - 1))
    values = numpy.linspace(vary.lo, vary.hi, (vary.n - 1) * finer + 1)
    states, reasons = _walk(branch, values)
    order = len(point.states)
    eigenvalues = numpy.full((len(values), order), numpy.nan, dtype=complex)
    for index, x in enumerate(states):
        if index not in reasons:
            eigenvalues[index] = branch.eigenvalues(values[index], x)
    path = follow_path(branch.family, vary.lo, vary.hi)
    others = _other_paths(branch, values, states, reasons)
    return Locus(
        vary.name,
        branch.unit,
        values[::finer],
        track(eigenvalues)[::finer],
        states[::finer, :order],
        branch.at,
        _together([path, *others]),
        path,
        tuple(Gap(float(values[i]), reasons[i]) for i in sorted(reasons) if i % finer == 0),
    )


def track(eigenvalues: numpy.ndarray) -> numpy.ndarray:
    """Sort the eigenvalues of neighbouring points so that each column is continuous.

    Parameters
    ----------
    eigenvalues : (m, n) complex array
        In any order along the second axis; rows of nan are gaps.

    Returns
    -------
    (m, n) complex array

    Examples
    --------
    >>> track(numpy.array([[1, 5], [4, 2], [3, 3.1]])).real.tolist()
    [[1.0, 5.0], [2.0, 4.0], [3.0, 3.1]]
    """
    from scipy.optimize import linear_sum_assignment

    sorted_rows = numpy.array(eigenvalues, dtype=complex)
    last: list[numpy.ndarray] = []
    for index, row in enumerate(sorted_rows):
        if numpy.isnan(row).any():
            continue
        if last:
            expected = 2 * last[-1] - last[-2] if len(last) > 1 else last[-1]
            cost = numpy.abs(expected[:, None] - row[None, :])
            sorted_rows[index] = row[linear_sum_assignment(cost)[1]]
        last = [*last[-1:], sorted_rows[index]]
    return sorted_rows


def _other_paths(
    branch: Branch, values: numpy.ndarray, states: numpy.ndarray, reasons: Mapping[int, str]
) -> list[Path]:
    """Follow the branches that were found behind gaps."""
    first = int(numpy.argmin(numpy.abs(values - branch.at)))
    paths = []
    for run in _runs([index for index in range(len(values)) if index not in reasons]):
        if run[0] <= first <= run[-1]:
            continue
        middle = run[len(run) // 2]
        family = branch.family
        point = family.point_at(numpy.append(states[middle], values[middle]))
        there = Family(family.graph, point, family.names, family.overrides, family.forms)
        paths.append(follow_path(there, values[0], values[-1]))
    return paths


def _runs(good: list[int]) -> list[list[int]]:
    """Split indices into runs of neighbours."""
    runs: list[list[int]] = []
    for index in good:
        if runs and runs[-1][-1] == index - 1:
            runs[-1].append(index)
        else:
            runs.append([index])
    return runs


def _together(paths: list[Path]) -> tuple[Edge, ...]:
    """Return the crossings of all paths once, by rising value."""
    found: list[Edge] = []
    for edge in (edge for path in paths for edge in path.edges):
        if not any(same(edge, known) for known in found):
            found.append(edge)
    return tuple(sorted(found, key=lambda edge: edge.value))


def _walk(branch: Branch, values: numpy.ndarray) -> tuple[numpy.ndarray, dict[int, str]]:
    """Solve from the operating point outwards; return the points and the reasons of gaps."""
    states = numpy.full((len(values), len(branch.start)), numpy.nan)
    reasons: dict[int, str] = {}
    first = int(numpy.argmin(numpy.abs(values - branch.at)))
    for indices in (range(first, len(values)), range(first - 1, -1, -1)):
        guess = branch.start if numpy.isnan(states[first]).any() else states[first]
        left = ""
        for index in indices:
            try:
                states[index] = guess = _solved(branch, values[index], guess)
                left = ""
            except SteadyStateError as error:
                # past the end of its mode a contact's law need not have a solution at all
                left = str(error) if error.elements else left
                reasons[index] = left or "no steady state found near the last one"
    return states, reasons


def _solved(branch: Branch, value: float, guess: numpy.ndarray) -> numpy.ndarray:
    try:
        return branch.solve(value, guess)
    except SteadyStateError as error:
        if error.elements:  # a contact leaves its mode: another start would not help
            raise
        try:
            return branch.solve(value, branch.second_guess(value))
        except SteadyStateError:
            raise error from None


def _check_ends(branch: Branch, vary: Vary) -> None:
    """Refuse a range whose ends the parameter's own rules refuse."""
    family = branch.family
    if vary.name not in family.table:
        return
    for value in (vary.lo, vary.hi):
        family.resolver({**family.overrides, vary.name: value}, partial=True)
