"""Frequency responses, by solving at each frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import BondGraphError
from .realisation import Realisation, place_of

Array = numpy.ndarray
AT_ONCE = 2_000_000  # entries of the matrices that are solved together


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Outputs over inputs at frequencies.

    Attributes
    ----------
    omega : (nw,) array
        rad/s.
    values : (k, m, nw) complex array
        By output and input, in SI; infinite at a pole on the imaginary axis.
    outputs, inputs : tuple of str
    output_units, input_units : tuple of str

    Examples
    --------
    >>> half = FrequencyResponse(numpy.array([6.283]), numpy.full((1, 1, 1), -0.5j), ("x",), ("F",),
    ...                          ("m",), ("N",))
    >>> half.magnitude("x", "F").tolist(), half.phase("x", "F").tolist(), half.unit("x", "F")
    ([0.5], [-90.0], 'm/N')
    """

    omega: Array
    values: Array
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    output_units: tuple[str, ...]
    input_units: tuple[str, ...]

    @property
    def frequency_hz(self) -> Array:
        """Frequencies, Hz."""
        return self.omega / (2 * numpy.pi)

    def __getitem__(self, names: tuple[Any, Any]) -> Array:
        """Return the values of one channel: ``response["x", "F"]``, output first."""
        row, column = self._places(*names)
        return self.values[row, column]

    def magnitude(self, output: str, input: str) -> Array:
        """Return the magnitude of a channel.

        Parameters
        ----------
        output, input : str

        Returns
        -------
        (nw,) array
        """
        return numpy.abs(self[output, input])

    def phase(self, output: str, input: str) -> Array:
        """Return the phase of a channel, degrees.

        Parameters
        ----------
        output, input : str

        Returns
        -------
        (nw,) array
            Without jumps of a turn, beginning in (-180, 180].
        """
        values = self[output, input]
        phase = numpy.angle(values)
        fine = numpy.isfinite(values)
        phase[fine] = numpy.unwrap(phase[fine])
        return numpy.degrees(numpy.where(fine, phase, numpy.nan))

    def unit(self, output: str, input: str) -> str:
        """Return the unit of a channel: that of the output over that of the input.

        Parameters
        ----------
        output, input : str

        Returns
        -------
        str
            Empty where it is not known.
        """
        row, column = self._places(output, input)
        return quotient(self.output_units[row], self.input_units[column])

    def _places(self, output: Any, input: Any) -> tuple[int, int]:
        return (
            place_of("output", output, self.outputs, self.inputs),
            place_of("input", input, self.inputs, self.outputs),
        )


def quotient(above: str, below: str) -> str:
    """Write one unit over another; empty where one of them is not known.

    Examples
    --------
    >>> quotient("m", "N"), quotient("m/s", "N*s"), quotient("m", "")
    ('m/N', '(m/s)/(N*s)', '')
    """
    if not above or not below:
        return ""
    if above == below:
        return "1"
    top = f"({above})" if "/" in above else above
    return f"{top}/{f'({below})' if set('*/') & set(below) else below}"


def frequency_values(given: Realisation, omega: Array) -> Array:
    """Evaluate a realisation along the imaginary axis.

    Parameters
    ----------
    given : Realisation
    omega : (nw,) array
        rad/s.

    Returns
    -------
    (k, m, nw) complex array
    """
    size = max(AT_ONCE // max(given.order, 1) ** 2, 1)
    parts = [given.at(1j * omega[first : first + size]) for first in range(0, len(omega), size)]
    return numpy.moveaxis(numpy.concatenate(parts), 0, -1)


def checked_frequencies(omega: Any) -> Array:
    """Return frequencies as an array; refuse what is not finite or negative.

    Raises
    ------
    BondGraphError
    """
    found = numpy.asarray(omega, dtype=float)
    if found.ndim != 1 or not found.size or not numpy.isfinite(found).all() or (found < 0).any():
        raise BondGraphError("frequencies must be a row of finite numbers, rad/s, none negative")
    return found
