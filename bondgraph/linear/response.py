"""Step and impulse responses, by the matrix exponential."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import BondGraphError
from .realisation import Realisation, place_of

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class TimeResponse:
    """How outputs move away from the operating point when one input at a time does.

    Attributes
    ----------
    kind : str
        ``"step"`` of one SI unit, or ``"impulse"`` of area one, at time zero.
    time : (nt,) array
        s.
    values : (k, m, nt) array
        By output and input, in SI; right behind the jump where there is one at time zero.
    outputs, inputs : tuple of str
    output_units, input_units : tuple of str
    direct : (k, m) array
        Area of an impulse of the output itself at time zero, which no value can show: D of
        an impulse response, and of a step where an output follows the rate of an input.

    Examples
    --------
    >>> found = TimeResponse("step", numpy.arange(2.0), numpy.ones((1, 1, 2)), ("x",), ("F",),
    ...                      ("m",), ("N",), numpy.zeros((1, 1)))
    >>> found["x", "F"].tolist(), found.unit("x", "F")
    ([1.0, 1.0], 'm')
    """

    kind: str
    time: Array
    values: Array
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    output_units: tuple[str, ...]
    input_units: tuple[str, ...]
    direct: Array

    def __getitem__(self, names: tuple[Any, Any]) -> Array:
        """Return the values of one channel: ``response["x", "F"]``, output first."""
        row, column = self._places(*names)
        return self.values[row, column]

    def unit(self, output: str, input: str) -> str:
        """Return the unit of a channel's values: that of the output, for an input of one SI unit.

        Parameters
        ----------
        output, input : str

        Returns
        -------
        str
            Empty where it is not known.
        """
        return self.output_units[self._places(output, input)[0]]

    def _places(self, output: Any, input: Any) -> tuple[int, int]:
        return (
            place_of("output", output, self.outputs, self.inputs),
            place_of("input", input, self.inputs, self.outputs),
        )


def step_values(given: Realisation, time: Array) -> tuple[Array, Array]:
    """Return the response to a step of each input, and what of it is an impulse.

    Parameters
    ----------
    given : Realisation
    time : (nt,) array
        Increasing, from zero or later.

    Returns
    -------
    values : (k, m, nt) array
    direct : (k, m) array

    Raises
    ------
    BondGraphError
        Where an output would be no impulse but the rate of one, or the response overflows.
    """
    _check_rates(given, 2, "step")
    n, m = given.B.shape
    # the inputs are constant states
    a = numpy.block([[given.A, given.B], [numpy.zeros((m, n + m))]])
    c = numpy.hstack([given.C, given.direct[0]])
    start = numpy.vstack([numpy.zeros((n, m)), numpy.eye(m)])
    direct = given.direct[1] if len(given.direct) > 1 else numpy.zeros_like(given.direct[0])
    return _propagated(a, start, c, time), direct


def impulse_values(given: Realisation, time: Array) -> tuple[Array, Array]:
    """Return the response to an impulse of each input, and what of it is one itself.

    Parameters
    ----------
    given : Realisation
    time : (nt,) array
        Increasing, from zero or later.

    Returns
    -------
    values : (k, m, nt) array
    direct : (k, m) array

    Raises
    ------
    BondGraphError
        Where an output would be the rate of an impulse, or the response overflows.
    """
    _check_rates(given, 1, "impulse")
    return _propagated(given.A, given.B, given.C, time), given.direct[0].copy()


def checked_times(time: Any) -> Array:
    """Return times as an array; refuse what is not increasing from zero or later.

    Raises
    ------
    BondGraphError
    """
    times = numpy.asarray(time, dtype=float)
    fine = times.ndim == 1 and times.size and numpy.isfinite(times).all()
    if not fine or times[0] < 0 or (numpy.diff(times) <= 0).any():
        raise BondGraphError(
            "times of a response must be finite, increasing and not negative: the step or "
            "impulse is at time zero"
        )
    return times


def _check_rates(given: Realisation, most: int, kind: str) -> None:
    if len(given.direct) > most:
        raise BondGraphError(
            f"the {kind} response has no values: an output follows the rate of an input, which is "
            f"worse than an impulse; take frequency_response, or another output"
        )


def _propagated(a: Array, start: Array, c: Array, time: Array) -> Array:
    """Return ``c exp(a t) start`` at increasing times, of shape (k, m, nt)."""
    import scipy.linalg

    out = numpy.empty((len(c), start.shape[1], len(time)))
    known: dict[float, Array] = {}
    x, before = start, 0.0
    with numpy.errstate(all="ignore"):
        for place, (now, step) in enumerate(zip(time, _steps(time), strict=True)):
            if step:
                if step not in known:
                    known[step] = scipy.linalg.expm(a * step)
                x = known[step] @ x
            out[:, :, place] = c @ x
            if not numpy.isfinite(out[:, :, place]).all():
                raise BondGraphError(
                    f"the response overflows between t = {before:.6g} s and {now:.6g} s; "
                    f"the system is unstable: ask for a shorter time"
                )
            before = now
    return out


def _steps(time: Array) -> list[float]:
    """Return steps between times, from zero on; those of an even grid are one number."""
    steps = numpy.diff(time, prepend=0.0)
    inner = steps[1:]
    if len(inner) and numpy.ptp(inner) <= 1e-9 * inner.mean():
        steps[1:] = (time[-1] - time[0]) / len(inner)
    return [float(step) for step in steps]
