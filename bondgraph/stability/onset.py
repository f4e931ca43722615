"""Onset: whether a vibration starts softly or hard where a steady state loses its stability."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy

from ..linear import linearize_at
from ..smooth import Smooth
from ..steady import SteadyState
from .derivatives import Derivatives, Forms, null_vectors

Array = numpy.ndarray

SOFT, HARD, DEGENERATE = "soft", "hard", "degenerate"
# Beside the terms it is the sum of, a smaller coefficient is nothing but rounding.
ROUNDING = 1e-10


@dataclass(frozen=True)
class Onset:
    """The normal form of a Hopf point, ``dz/dt = (i omega + slope d) z + cubic z |z|^2``.

    Here d is what the parameter is beyond the edge, and the motion is twice the real part of
    ``z q``, with q the eigenvector of length one in states in SI.

    Attributes
    ----------
    kind : str
        ``"soft"`` (supercritical): behind the edge a vibration lives whose size grows from
        nothing. ``"hard"`` (subcritical): before the edge an unstable vibration stands around the
        stable steady state; at the edge the motion leaves at once for whatever is farther off.
        ``"degenerate"``: the cubic term is zero and does not decide, as in a linear model.
    first_lyapunov : float
        Real part of `cubic` over omega: negative soft, positive hard. The size depends on the
        units of the states, the sign does not.
    cubic : complex
    slope : complex
        Derivative of the eigenvalue by the parameter, 1/s per SI unit.
    shares : mapping of str to complex
        Amplitude of each output for z = 1/2, with its phase.

    References
    ----------
    Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed. (2004), section 5.4: equations
    (5.62) and the normalisation of the eigenvectors.

    Examples
    --------
    >>> soft = Onset("soft", -0.5, complex(-1, 0), complex(1, 0), {"v": 1.0})
    >>> soft.side, soft.amplitude("v", 0.04)
    ('above', 0.4)
    """

    kind: str
    first_lyapunov: float
    cubic: complex
    slope: complex
    shares: Mapping[str, complex] = field(default_factory=dict)

    @property
    def side(self) -> str | None:
        """On which side of the edge the small vibration lives: ``"above"``, ``"below"`` or None."""
        if self.kind == DEGENERATE or not self.slope.real:
            return None
        return "above" if -self.slope.real / self.cubic.real > 0 else "below"

    def amplitude(self, output: str, distance: float) -> float:
        """Return the amplitude of the small vibration at a distance from the edge.

        To leading order, for small distances. At a hard onset it is how far the motion must be
        pushed to leave the steady state.

        Parameters
        ----------
        output : str
        distance : float
            Of the parameter from the edge, in its SI unit, whatever its sign.

        Returns
        -------
        float
            nan where the onset is degenerate.
        """
        if self.kind == DEGENERATE:
            return math.nan
        size = math.sqrt(abs(self.slope.real * distance / self.cubic.real))
        return 2 * size * abs(self.shares[output])


def onset(
    forms: Forms, point: SteadyState, omega: float, parameter: str, sizes: Array | None = None
) -> Onset | None:
    """Return the normal form at a Hopf point.

    Parameters
    ----------
    forms : Forms
        Of the point's equations; a parameter that moves others by being derived from must not
        be held.
    point : SteadyState
        At the edge.
    omega : float
        Angular frequency of the crossing pair, rad/s.
    parameter : str
        That crosses the edge; a parameter or an input.
    sizes : (n + nz,) array, optional
        To measure states by; those that balance the Jacobian unless given.

    Returns
    -------
    Onset or None
        None where there is no third derivative, or another eigenvalue stands at zero or at a
        multiple of the frequency.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import assess
    >>> edge = assess(bicycle_brake.graph(), vary=["V0=0.25:1.5:50"]).edges[0]
    >>> edge.onset.kind
    'hard'
    """
    import scipy.linalg

    smooth = forms.smooth
    at = forms.at(point.vector, list(point.inputs.values()), smooth.vector(point.parameters))
    order = smooth.order
    mass = forms.mass
    if sizes is None:
        sizes = numpy.diag(scipy.linalg.matrix_balance(at.jacobian, permute=False)[1])
    try:
        right, left = null_vectors(at.jacobian - 1j * omega * mass, sizes)
        q, p = right * sizes, left / sizes
        q = q / numpy.linalg.norm(q[:order])
        p = p / (p @ mass @ q)
        told = _cubic(at, mass, q, p, omega, sizes)
        slope = _slope(at, q, p, _place(smooth, point, parameter), sizes)
    except numpy.linalg.LinAlgError:
        return None
    if told is None or slope is None or not numpy.isfinite([told[0], told[1], slope]).all():
        return None
    cubic, terms = told
    first = cubic.real / omega
    small = abs(cubic.real) <= ROUNDING * terms
    kind = DEGENERATE if small else (SOFT if first < 0 else HARD)
    outputs = linearize_at(smooth, point)
    shares = dict(zip(outputs.outputs, map(complex, outputs.C @ q[:order]), strict=True))
    return Onset(kind, 0.0 if small else first, cubic, slope, shares)


def _place(smooth: Smooth, point: SteadyState, parameter: str) -> int:
    """Return where a parameter or an input stands among inputs and parameters."""
    inputs = list(point.inputs)
    if parameter in inputs:
        return inputs.index(parameter)
    return len(inputs) + smooth.names.index(parameter)


def _cubic(
    at: Derivatives, mass: Array, q: Array, p: Array, omega: float, sizes: Array
) -> tuple[complex, float] | None:
    """Return the cubic coefficient, and the sizes of its terms added up."""
    conjugate = q.conj()
    steady = _solved(at.jacobian, at.second(q, conjugate), sizes)
    double = _solved(2j * omega * mass - at.jacobian, at.second(q, q), sizes)
    if steady is None or double is None:
        return None
    terms = numpy.array(
        [
            p @ at.third(q, q, conjugate),
            -2 * (p @ at.second(q, steady)),
            p @ at.second(conjugate, double),
        ]
    )
    return complex(terms.sum() / 2), float(numpy.abs(terms).sum() / 2)


def _solved(matrix: Array, right: Array, sizes: Array) -> Array | None:
    """Solve in measured states; None where the matrix is singular and it matters."""
    if not right.any():
        return numpy.zeros(len(right), dtype=complex)
    scaled, wanted = matrix * sizes[None, :] / sizes[:, None], right / sizes
    found = numpy.linalg.lstsq(scaled, wanted, rcond=1e-13)[0]
    if numpy.abs(scaled @ found - wanted).max() > 1e-7 * numpy.abs(wanted).max():
        return None
    return numpy.asarray(found * sizes)


def _slope(at: Derivatives, q: Array, p: Array, place: int, sizes: Array) -> complex | None:
    """Return the derivative of the crossing eigenvalue by a parameter, the steady state moving."""
    by_parameter = at.by_arguments[:, place]
    moved = _solved(at.jacobian, -by_parameter, sizes)
    if moved is None:
        return None
    whole = at.gradient(p, q)
    n = len(at.x)
    return complex(whole[n + place] + whole[:n] @ moved)
