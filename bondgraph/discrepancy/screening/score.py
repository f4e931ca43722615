"""Score test: how much of a residual each candidate would explain that the parameters cannot.

Every candidate has a response, the derivative of all measured signals by its coefficient at zero.
What the model's own parameters can do is taken off responses and residual first, so that a
candidate gets no credit for a mere change of parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy

Array = numpy.ndarray

# A response of which less is left after the projection is one of the parameters' own.
LEAST_LEFT = 1e-6


@dataclass(frozen=True, eq=False)
class Scores:
    """What each candidate explains, to first order.

    Attributes
    ----------
    gain : (q,) array
        Drop of the sum of squared weighted residuals; 0 where nothing is left of a response.
    coefficient, std : (q,) arrays
        Where the drop is reached, and its standard deviation for residuals of unit variance
        without memory. NaN where nothing is left.
    left : (q,) array
        Norm of a response after the projection over that before.
    correlation : (q, q) array
        Cosines between projected responses; 0 with one of which nothing is left.
    rest : float
        Sum of squares of the residual after the parameters have done what they can.
    """

    gain: Array
    coefficient: Array
    std: Array
    left: Array
    correlation: Array
    rest: float

    @property
    def share(self) -> Array:
        """The gain as a share of what the parameters leave, (q,) array."""
        return self.gain / self.rest if self.rest > 0 else numpy.zeros(len(self.gain))

    def order(self) -> list[int]:
        """Return the candidates by falling gain."""
        return numpy.argsort(-self.gain, kind="stable").tolist()


def scored(residual: Array, responses: Array, parameters: Array | None = None) -> Scores:
    """Score candidates on a residual.

    Parameters
    ----------
    residual : (ns,) array
        Measured minus simulated, over the noise's standard deviation; all signals and recordings
        one after the other, gaps left out.
    responses : (ns, q) array
        Derivatives of the simulated signals by the candidates' coefficients, weighted alike.
    parameters : (ns, p) array, optional
        The same by the model's free parameters and initial states.

    Returns
    -------
    Scores

    References
    ----------
    Rao, Large sample tests of statistical hypotheses concerning several parameters, Proceedings
    of the Cambridge Philosophical Society 44 (1948) 50-57.

    Examples
    --------
    >>> t = numpy.linspace(0, 1, 50)
    >>> found = scored(3 * t**2, numpy.array([t**2, t]).T, numpy.ones((50, 1)))
    >>> found.order()[0], round(float(found.coefficient[0]), 9)
    (0, 3.0)
    """
    before = numpy.linalg.norm(responses, axis=0)
    basis = None if parameters is None else basis_of(parameters)
    r, s = (_off(basis, residual), _off(basis, responses))
    norms = numpy.linalg.norm(s, axis=0)
    left = numpy.divide(norms, before, out=numpy.zeros_like(norms), where=before > 0)
    seen = left > LEAST_LEFT
    unit = s / numpy.where(seen, norms, 1.0) * seen
    along = unit.T @ r
    nothing = numpy.where(seen, 1.0, numpy.nan)
    scale = numpy.where(seen, norms, 1.0)
    return Scores(
        gain=along**2,
        coefficient=along / scale * nothing,
        std=nothing / scale,
        left=left,
        correlation=unit.T @ unit,
        rest=float(r @ r),
    )


def basis_of(parameters: Array) -> Array:
    """Return an orthonormal basis of what parameters can do, (ns, rank) array.

    Columns are measured each by its own size, so that units do not decide the rank.

    Examples
    --------
    >>> basis_of(numpy.array([[1.0, 1e9], [0.0, 0.0]])).shape
    (2, 1)
    """
    size = numpy.linalg.norm(parameters, axis=0)
    scaled = parameters[:, size > 0] / size[size > 0]
    if not scaled.shape[1]:
        return numpy.zeros((len(parameters), 0))
    u, values, _ = numpy.linalg.svd(scaled, full_matrices=False)
    kept: Array = u[:, values > 1e-10 * values[0]]
    return kept


def chosen(
    residual: Array,
    responses: Array,
    parameters: Array | None = None,
    *,
    most: int = 3,
    least: float = 10.0,
    groups: Sequence[Sequence[int]] | None = None,
) -> list[tuple[int, float]]:
    """Take candidates one after the other, each the best on what those before it leave.

    Parameters
    ----------
    residual, responses, parameters
        As for `scored`.
    most : int
        How many at most.
    least : float
        Least gain worth a candidate.
    groups : sequence of sequence of int, optional
        Columns that belong to one candidate, such as the coefficients of a law of several terms;
        each column is one by itself unless given.

    Returns
    -------
    list of (int, float)
        Candidate (index of its group) and gain.

    Notes
    -----
    Orthogonal matching pursuit (Pati, Rezaiifar, Krishnaprasad 1993): those taken are projected
    off together with the parameters.

    Examples
    --------
    >>> t = numpy.linspace(0, 1, 200)
    >>> s = numpy.array([t, t**2, numpy.sin(40 * t)]).T
    >>> [index for index, _ in chosen(90 * t**2 + 30 * numpy.sin(40 * t), s, least=1)]
    [1, 2]
    """
    sets = [[i] for i in range(responses.shape[1])] if groups is None else groups
    parts = [] if parameters is None else [parameters]
    taken: list[tuple[int, float]] = []
    while len(taken) < most:
        basis = basis_of(numpy.hstack(parts)) if parts else None
        r, s = _off(basis, residual), _off(basis, responses)
        gains = [
            -1.0 if any(index == i for i, _ in taken) else _drop(r, s[:, columns])
            for index, columns in enumerate(sets)
        ]
        best = int(numpy.argmax(gains))
        if gains[best] < least:
            break
        taken.append((best, gains[best]))
        parts.append(responses[:, list(sets[best])])
    return taken


def _drop(residual: Array, responses: Array) -> float:
    """Return what several columns together take off the sum of squares."""
    basis = basis_of(responses)
    return float(numpy.sum((basis.T @ residual) ** 2))


def _off(basis: Array | None, values: Array) -> Array:
    return values if basis is None else values - basis @ (basis.T @ values)
