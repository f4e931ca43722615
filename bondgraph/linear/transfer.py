"""Transfer functions in numbers: zeros, poles and gain of one channel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import BondGraphError
from .ranks import compressed
from .realisation import EPS, Realisation
from .zeros import cleared, ordered, zeros_of_like_size

Array = numpy.ndarray
_TOO_LARGE = (
    "the transfer function has coefficients beyond floating-point numbers: too many fast poles; "
    "take frequency_response, which has no polynomials"
)


@dataclass(frozen=True, eq=False)
class TransferFunction:
    """A quotient of polynomials in s, from one input to one output.

    Attributes
    ----------
    output, input : str
    zeros, poles : complex array
        Roots above and below, 1/s. Modes that the input does not move or the
        output does not show are left out.
    gain : float
        Quotient of the leading coefficients, in SI.
    unit : str
        Of the output over that of the input; empty where it is not known.

    Examples
    --------
    >>> found = TransferFunction("x", "F", numpy.array([]), numpy.array([-1.0, -2.0]), 6.0)
    >>> found.numerator.tolist(), found.denominator.tolist(), float(found(0).real)
    ([6.0], [1.0, 3.0, 2.0], 3.0)
    """

    output: str
    input: str
    zeros: Array
    poles: Array
    gain: float
    unit: str = ""

    @property
    def numerator(self) -> Array:
        """Coefficients by falling powers of s."""
        return numpy.atleast_1d(self.gain * _coefficients(self.zeros))

    @property
    def denominator(self) -> Array:
        """Coefficients by falling powers of s; the first is one."""
        return numpy.atleast_1d(_coefficients(self.poles))

    def __call__(self, s: Any) -> Any:
        """Evaluate at complex frequencies, 1/s.

        Parameters
        ----------
        s : complex or array of complex

        Returns
        -------
        complex or array of complex
            Infinite at a pole.
        """
        points = numpy.asarray(s, dtype=complex)[..., None]
        # factors in turn, so that many large ones do not overflow
        count = max(len(self.zeros), len(self.poles))
        above = numpy.ones((*points.shape[:-1], count), dtype=complex)
        below = above.copy()
        above[..., : len(self.zeros)] = points - self.zeros
        below[..., : len(self.poles)] = points - self.poles
        with numpy.errstate(divide="ignore", invalid="ignore"):
            found = self.gain * numpy.prod(above / below, axis=-1)
        return numpy.where((below == 0).any(axis=-1), numpy.inf, found)[()]

    def __str__(self) -> str:
        above, below = (_polynomial(part) for part in (self.numerator, self.denominator))
        return f"({above}) / ({below})"


def transfer_of(given: Realisation, output: str, input: str, unit: str) -> TransferFunction:
    """Return the transfer function of a realisation of one channel.

    Parameters
    ----------
    given : Realisation
        Of one input and one output.
    output, input, unit : str

    Returns
    -------
    TransferFunction

    Raises
    ------
    BondGraphError
        For so many poles that the gain is no floating-point number.
    """
    scaled = given.scaled()
    small = minimal(scaled.plant)
    none = numpy.zeros(0, dtype=complex)
    poles = cleared(numpy.linalg.eigvals(small.A), small.A) if small.order else none
    if not (small.order or any(part.any() for part in small.direct)):
        return TransferFunction(output, input, none, none, 0.0, unit)
    zeros = zeros_of_like_size(small)
    # away from all roots, where nothing cancels
    far = 2.0 * float(numpy.abs(numpy.concatenate([zeros, poles])).max(initial=0.5))
    shape = TransferFunction(output, input, zeros, poles, 1.0)
    gain = float((small.at(numpy.array([far]))[0, 0, 0] / shape(far)).real)
    gain *= _power(scaled.rate, len(poles) - len(zeros)) / float(scaled.into[0] * scaled.out[0])
    zeros, poles = (ordered(roots * scaled.rate) for roots in (zeros, poles))
    return TransferFunction(output, input, zeros, poles, gain, unit)


def _power(rate: float, degree: int) -> float:
    try:
        found = rate**degree
    except OverflowError:
        found = float("inf")
    if not 0 < found < float("inf"):
        raise BondGraphError(_TOO_LARGE)
    return found


def minimal(given: Realisation) -> Realisation:
    """Return a realisation without states that the inputs do not move or the outputs do not show.

    Parameters
    ----------
    given : Realisation
        Of entries of like size; see `Realisation.scaled`.

    Returns
    -------
    Realisation
        Of the same transfer. Ranks are decided near the rounding error: what is
        nearly cancelled is kept.
    """
    if not given.order:
        return given
    a, b, c = _moved(given.A, given.B, given.C)
    a, c, b = (part.T for part in _moved(a.T, c.T, b.T))
    return Realisation(a, b, c, given.direct)


def _moved(a: Array, b: Array, c: Array) -> tuple[Array, Array, Array]:
    """Keep the states that inputs move, by the controllability staircase."""
    n = len(a)
    tolerance = 20 * EPS * n
    turn = numpy.eye(n)
    done, block = 0, b
    while done < n:
        mixed, rank = compressed(block, tolerance)
        if not rank:
            break
        turn[:, done:] = turn[:, done:] @ mixed
        previous, done = done, done + rank
        turned = turn.T @ a @ turn
        block = turned[done:, previous:done]
    kept = turn[:, :done]
    return kept.T @ a @ kept, kept.T @ b, c @ kept


def _coefficients(roots: Array) -> Array:
    """Multiply out; coefficients that are no more than rounding are zero."""
    found = numpy.real(numpy.poly(roots))
    terms = numpy.real(numpy.poly(-numpy.abs(roots)))
    if not numpy.isfinite(terms).all():
        raise BondGraphError(_TOO_LARGE)
    return numpy.where(numpy.abs(found) > 20 * EPS * (len(roots) + 1) * terms, found, 0.0)


def _polynomial(coefficients: Array) -> str:
    """Write a polynomial in s with six digits."""
    degree = len(coefficients) - 1
    terms = []
    for place, value in enumerate(coefficients):
        power = degree - place
        if value or degree == 0:
            name = {0: "", 1: "s"}.get(power, f"s^{power}")
            plain = f"{value:.6g}"
            bare = plain in ("1", "-1") and name
            terms.append(plain[:-1] + name if bare else "*".join(filter(None, (plain, name))))
    return " + ".join(terms).replace("+ -", "- ")
