"""Boundaries: edges of stability followed in two parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy

from ...errors import BondGraphError
from ...graph import BondGraph
from ..derivatives import Derivatives
from ..edges import Edge
from ..family import Family
from ..onset import Onset, onset
from ..vary import Vary
from .curve import CLOSED, Curve, Frame, between, follow
from .defining import Defining, defining

Array = numpy.ndarray

MOST_POINTS = 800
STEP = 0.03
# Beside the largest eigenvalue: another mode with a larger growth rate is unstable already.
OTHERS = 1e-8
# Where a frequency falls to zero.
STILL = "bogdanov-takens"


@dataclass(frozen=True)
class Special:
    """A point where a boundary changes its nature.

    Attributes
    ----------
    kind : str
        ``"bautin"``: between soft and hard onset. ``"bogdanov-takens"``: the frequency falls to
        zero, a Hopf boundary ends on a fold. ``"cusp"``: two folds meet.
    values : (float, float)
        Of the two parameters, SI.
    frequency_hz : float
    """

    kind: str
    values: tuple[float, float]
    frequency_hz: float


@dataclass(frozen=True, eq=False)
class Boundary:
    """A curve of Hopf or fold points in the plane of two parameters.

    Attributes
    ----------
    kind : str
        ``"hopf"`` or ``"fold"``.
    parameters : (str, str)
    units : (str, str)
        Each parameter's own, for display.
    values : (m, 2) array
        SI, in order along the curve.
    frequency_hz : (m,) array
        Zero along folds.
    first_lyapunov : (m,) array
        See `Onset`; nan along folds and where there is none.
    edge_of_stability : (m,) array of bool
        Whether every other mode decays there.
    special : tuple of Special
    ends : (str, str)
        Why the curve ends at its first and its last point; see `Path`.
    """

    kind: str
    parameters: tuple[str, str]
    units: tuple[str, str]
    values: Array
    frequency_hz: Array
    first_lyapunov: Array
    edge_of_stability: Array
    special: tuple[Special, ...]
    ends: tuple[str, str]

    def swapped(self) -> Boundary:
        """Return the same curve with its parameters in the other order."""
        return replace(
            self,
            parameters=self.parameters[::-1],
            units=self.units[::-1],
            values=self.values[:, ::-1],
            special=tuple(replace(item, values=item.values[::-1]) for item in self.special),
        )

    def to_json(self) -> dict[str, Any]:
        """Return the curve as plain values; what is no number is None."""
        return {
            "kind": self.kind,
            "parameters": list(self.parameters),
            "values": self.values.tolist(),
            "frequency_hz": self.frequency_hz.tolist(),
            "first_lyapunov": [v if math.isfinite(v) else None for v in self.first_lyapunov],
            "edge_of_stability": self.edge_of_stability.tolist(),
            "special": [
                {"kind": s.kind, "values": list(s.values), "frequency_hz": s.frequency_hz}
                for s in self.special
            ],
            "ends": list(self.ends),
        }


def follow_edge(
    graph: BondGraph,
    edge: Edge,
    across: Vary,
    along: Vary,
    parameters: Mapping[Any, Any] | None = None,
) -> Boundary:
    """Follow an edge of stability in two parameters, both ways.

    Parameters
    ----------
    graph : BondGraph
    edge : Edge
        Found along the first parameter.
    across, along : Vary
        Ranges in SI, of the edge's own parameter and of the second one; the curve ends where it
        leaves them.
    parameters : mapping, optional
        Those that the edge was found with.

    Returns
    -------
    Boundary

    Raises
    ------
    ParameterError
        For unknown names.
    BondGraphError
        Where the edge is not one that can be followed.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import Vary, assess
    >>> graph = bicycle_brake.graph()
    >>> edge = assess(graph, vary=["V0=0.25:1.5:50"]).edges[0]
    >>> found = follow_edge(graph, edge, Vary("V0", 0.25, 1.5), Vary("v_s", 0.03, 0.2))
    >>> found.kind, found.ends, bool((abs(found.frequency_hz - 200.460451) < 1e-6).all())
    ('hopf', ('limit', 'limit'), True)
    """
    if edge.parameter != across.name:
        raise BondGraphError(
            f"the edge was found along {edge.parameter!r}, not {across.name!r}; give its own "
            f"parameter first"
        )
    names = (across.name, along.name)
    family = Family(graph, edge.point, names, {**(parameters or {}), across.name: edge.value})
    ranges = tuple((min(v.lo, v.hi), max(v.lo, v.hi)) for v in (across, along))
    omega = 2 * math.pi * edge.frequency_hz
    equations, frame = defining(family, edge.kind, omega, ranges)
    halves = [_half(equations, frame, ranges, sense) for sense in (-1.0, 1.0)]
    back, ahead = halves
    if back.end == CLOSED:
        points = back.points
    else:
        points = numpy.vstack([back.points[:0:-1], ahead.points])
    told = _Told(equations, family)
    first = numpy.array([told.lyapunov(y) for y in points])
    return Boundary(
        edge.kind,
        names,
        (family.units[0], family.units[1]),
        points[:, -2:],
        numpy.array([abs(equations.omega(y)) / (2 * math.pi) for y in points]),
        first,
        numpy.array([told.bare(y) for y in points], dtype=bool),
        _special(equations, frame, told, points, halves),
        (back.end, ahead.end),
    )


def _half(
    equations: Defining, frame: Frame, ranges: tuple[tuple[float, float], ...], sense: float
) -> Curve:
    """Follow the curve one way until a parameter leaves its range or the frequency is zero."""
    family = equations.family

    def within(y: Array) -> str | None:
        return family.leaves(equations.point(y))

    # the edge runs mostly along the second parameter: it was found across it
    along = numpy.zeros(len(equations.start))
    along[-1] = sense
    tangent = frame.tangent(equations.start, along)
    if tangent is not None and abs(tangent[-1]) < 1e-9:
        along[-2] = sense
    borders = {-2: ranges[0], -1: ranges[1]}
    if equations.kind == "hopf":
        borders[-3] = (0.0, math.inf)
    curve = follow(
        frame, equations.start, along, within, borders=borders, longest=STEP, most=MOST_POINTS
    )
    still = equations.kind == "hopf" and curve.points[-1][-3] <= 1e-9 * equations.start[-3]
    return replace(curve, end=STILL) if still else curve


@dataclass(frozen=True, eq=False)
class _Told:
    """What is asked of each point of a boundary."""

    equations: Defining
    family: Family

    def onset(self, y: Array) -> Onset | None:
        """Return the normal form at a Hopf point."""
        omega = self.equations.omega(y)
        if self.equations.kind != "hopf" or omega <= 0:
            return None
        point = self.family.point_at(self.equations.point(y))
        name, sizes = self.family.names[0], self.equations.weights
        return onset(self.family.forms, point, omega, name, sizes)

    def lyapunov(self, y: Array) -> float:
        """Return the first Lyapunov coefficient, nan where there is none."""
        found = self.onset(y)
        return math.nan if found is None else found.first_lyapunov

    def bare(self, y: Array) -> bool:
        """Whether no other mode grows."""
        poles = self.family.eigenvalues(self.equations.point(y))
        omega = self.equations.omega(y)
        scale = numpy.abs(poles).max()
        for target in {1j * omega, -1j * omega}:
            poles = numpy.delete(poles, numpy.argmin(numpy.abs(poles - target)))
        return bool((poles.real <= OTHERS * scale).all())

    def bend(self, y: Array) -> float:
        """Return the quadratic coefficient of a fold, zero at a cusp."""
        at, left, v = self._null(y)
        return float((left @ at.second(v, v)).real)

    def double(self, y: Array) -> float:
        """Return the product of left and right null vector, zero where zero is a double eigenvalue."""
        _, left, v = self._null(y)
        order = self.family.smooth.order
        return float(left[:order] @ v[:order])

    def _null(self, y: Array) -> tuple[Derivatives, Array, Array]:
        """Return the derivatives, and the left and right null vector at a fold."""
        n, point = self.family.size, self.equations.point(y)
        at = self.family.forms.at(*self.family.split(point))
        scale = self.equations.weights
        balanced = at.jacobian * scale[None, :] / scale[:, None]
        left = numpy.linalg.svd(balanced)[0][:, -1] / scale
        # the sign of a null vector is free: what the parameters do to the rates fixes it
        sides = left @ self.family.slopes(point)[1][:, n:]
        return at, left * numpy.sign(sides[numpy.argmax(numpy.abs(sides))]), y[n : 2 * n]


def _special(
    equations: Defining, frame: Frame, told: _Told, points: Array, halves: Sequence[Curve]
) -> tuple[Special, ...]:
    """Find where the onset changes between soft and hard, where folds meet, where omega ends."""
    tests: dict[str, Callable[[Array], float]] = {"bautin": told.lyapunov}
    if equations.kind == "fold":
        tests = {"cusp": told.bend, "bogdanov-takens": told.double}
    found: list[Special] = []
    for kind, height in tests.items():
        heights = numpy.array([height(y) for y in points])
        for k in numpy.flatnonzero(heights[:-1] * heights[1:] < 0):
            y = _zero(frame, (points[k], points[k + 1]), height)
            if y is not None:
                found.append(_named(kind, equations, y))
    for half, y in zip(halves, (points[0], points[-1]), strict=True):
        if half.end == STILL:
            found.append(_named(STILL, equations, y))
    return tuple(found)


def _zero(
    frame: Frame, ends: tuple[Array, Array], height: Callable[[Array], float]
) -> Array | None:
    from scipy.optimize import brentq

    try:
        share = float(brentq(lambda s: height(between(frame, *ends, s)), 0.0, 1.0, xtol=1e-10))
        y, sides = between(frame, *ends, share), [abs(height(end)) for end in ends]
    except (BondGraphError, ValueError, RuntimeError):
        return None
    # a pole changes its sign as well
    return y if abs(height(y)) <= 1e-3 * max(sides) else None


def _named(kind: str, equations: Defining, y: Array) -> Special:
    values = float(y[-2]), float(y[-1])
    return Special(kind, values, abs(equations.omega(y)) / (2 * math.pi))
