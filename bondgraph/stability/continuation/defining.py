"""Defining systems: the equations that a Hopf or fold point fulfils, with two parameters free."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy

from ...errors import BondGraphError
from ..derivatives import null_vectors
from ..family import Family
from .curve import Frame

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Defining:
    """Hopf or fold points of a family with two free parameters, as solutions of equations.

    The unknowns are states and algebraic variables y, a vector v of the pencil with
    ``J v = i omega M v``, for a Hopf point its real and imaginary part and omega, and the two
    parameters.

    Attributes
    ----------
    family : Family
    kind : str
        ``"hopf"`` or ``"fold"``.
    start : (d,) array
        A first point.
    weights : (n + nz,) array
        Over the sizes of y: v is measured by them.
    phase : (n + nz,) array
        Fixes the phase of a complex v.

    References
    ----------
    Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed. (2004), section 10.3.
    """

    family: Family
    kind: str
    start: Array
    weights: Array
    phase: Array

    @property
    def size(self) -> int:
        """Number of states and algebraic variables."""
        return self.family.size

    def __call__(self, unknown: Array) -> tuple[Array, Array]:
        """Return what is left of the equations and its Jacobian."""
        residual, jacobian = self._function(unknown)
        return residual.full().ravel(), jacobian.full()

    def point(self, unknown: Array) -> Array:
        """Return the family's point within the unknowns."""
        return numpy.concatenate([unknown[: self.size], unknown[-2:]])

    def omega(self, unknown: Array) -> float:
        """Return the angular frequency, rad/s; zero at a fold."""
        return float(unknown[-3]) if self.kind == "hopf" else 0.0

    @cached_property
    def _function(self) -> Any:
        import casadi

        n = self.size
        unknown = casadi.SX.sym("unknown", len(self.start))
        x, free = unknown[:n], unknown[-2:]
        u, p = self.family.symbolic(free)
        rates = self.family.smooth.symbolic(x, u, p)
        mass = casadi.DM(numpy.diag(self.family.forms.mass))
        weights = casadi.DM(self.weights)
        real = unknown[n : 2 * n]
        if self.kind == "hopf":
            imag, omega = unknown[2 * n : 3 * n], unknown[3 * n]
            rows = [
                casadi.jtimes(rates, x, real) + omega * mass * imag,
                casadi.jtimes(rates, x, imag) - omega * mass * real,
                casadi.sumsqr(real / weights) + casadi.sumsqr(imag / weights) - 1,
                casadi.dot(casadi.DM(self.phase), imag / weights),
            ]
        else:
            rows = [casadi.jtimes(rates, x, real), casadi.sumsqr(real / weights) - 1]
        residual = casadi.vertcat(rates, *rows)
        jacobian = casadi.densify(casadi.jacobian(residual, unknown))
        return casadi.Function("defining", [unknown], [casadi.densify(residual), jacobian])


def defining(
    family: Family, kind: str, omega: float, ranges: tuple[tuple[float, float], ...]
) -> tuple[Defining, Frame]:
    """Return the equations of Hopf or fold points, with a first point found from the family's own.

    Parameters
    ----------
    family : Family
        With two free parameters, at such a point or near it.
    kind : {"hopf", "fold"}
    omega : float
        Angular frequency there, rad/s.
    ranges : ((float, float), (float, float))
        Of the parameters; lengths along the curve are measured by them.

    Returns
    -------
    Defining, Frame

    Raises
    ------
    BondGraphError
        Where no such point is found near by.
    """
    n, start = family.size, family.start
    scale = family.scale(ranges)
    sizes = scale[:n]
    _, slopes = family.slopes(start)
    v = null_vectors(slopes[:, :n] - 1j * omega * family.forms.mass, sizes)[0]
    largest = v[numpy.argmax(numpy.abs(v))]
    v = v * numpy.conj(largest) / abs(largest)
    if kind == "hopf":
        inner = numpy.concatenate([v.real * sizes, v.imag * sizes, [omega]])
        measured = numpy.concatenate([sizes, sizes, [omega]])
        phase = v.real.copy()
    else:
        real = v.real / numpy.linalg.norm(v.real)
        inner, measured, phase = real * sizes, sizes, numpy.zeros(n)
    first = numpy.concatenate([start[:n], inner, start[n:]])
    equations = Defining(family, kind, first, sizes, phase)
    frame = Frame(equations, numpy.concatenate([sizes, measured, scale[n:]]))
    for across in (-1, -2):  # hold one parameter, or the other where the first runs along the edge
        row = numpy.zeros(len(first))
        row[across] = 1.0
        found = frame.corrected(first, row)
        if found is not None:
            return Defining(family, kind, found, sizes, phase), frame
    raise BondGraphError(
        f"no {kind} point near {family.names[0]} = {start[n]:.6g}, {family.names[1]} = "
        f"{start[n + 1]:.6g}; start from an edge that was found along one of them"
    )
