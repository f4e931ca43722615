"""What leads from inputs to outputs: zeros, gains, transfer functions and responses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy

from ..errors import ParameterError
from ..steady import SteadyState
from .frequency import FrequencyResponse, checked_frequencies, frequency_values, quotient
from .gain import static_gain
from .grids import frequency_grid, time_grid
from .realisation import Realisation, check_channels, place_of, realisation
from .response import TimeResponse, checked_times, impulse_values, step_values
from .transfer import TransferFunction, transfer_of
from .zeros import invariant_zeros

if TYPE_CHECKING:
    import sympy


class Transfers:
    """Base of `LinearSystem`: its methods that need inputs and outputs.

    An input whose rate a dependent storage needs is one input here, not two.
    """

    A: numpy.ndarray
    B: numpy.ndarray
    C: numpy.ndarray
    D: numpy.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    at: SteadyState

    def poles(self) -> numpy.ndarray:
        """Return the eigenvalues of A."""
        raise NotImplementedError

    @property
    def input_units(self) -> tuple[str, ...]:
        """SI unit of each input."""
        raise NotImplementedError

    @property
    def output_units(self) -> tuple[str, ...]:
        """SI unit of each output."""
        raise NotImplementedError

    @property
    def sources(self) -> tuple[str, ...]:
        """The inputs, without rates of inputs that a dependent storage needs."""
        rates = {rate.name for rate in self.at.equations.input_rates.values()}
        return tuple(name for name in self.inputs if name not in rates)

    def zeros(
        self, output: str | None = None, input: str | sympy.Symbol | None = None
    ) -> numpy.ndarray:
        """Return the finite invariant zeros, of the whole system or of one channel.

        Parameters
        ----------
        output : str, optional
        input : str or Symbol, optional
            Give both or none.

        Returns
        -------
        (z,) complex array
            1/s. Modes that no input moves, or no output shows, are among them.

        Raises
        ------
        BondGraphError
            Where the system has no inputs or outputs.
        ParameterError
            For a name that is not known.
        """
        whole = self._realisation()
        if output is None and input is None:
            return invariant_zeros(whole)
        return invariant_zeros(whole.channel(*self._channel(output, input)))

    def dcgain(self) -> numpy.ndarray:
        """Return where each output settles for a constant input of one.

        Returns
        -------
        (k, m) array
            By output and source. Infinite, with its sign, where an integrator lies
            between them. An unstable system has a gain too, but does not settle.

        Raises
        ------
        BondGraphError
            Where the system has no inputs or outputs.
        """
        return static_gain(self._realisation())

    def transfer_function(self, output: str, input: str | sympy.Symbol) -> TransferFunction:
        """Return the transfer function of one channel, in numbers.

        Parameters
        ----------
        output : str
        input : str or Symbol

        Returns
        -------
        TransferFunction
            Without the modes that the channel does not see; for symbols, see `symbolic`.

        Raises
        ------
        BondGraphError
            Where the system has no inputs or outputs.
        ParameterError
            For a name that is not known.
        """
        row, column = self._channel(output, input)
        return transfer_of(
            self._realisation().channel(row, column),
            self.outputs[row],
            self.sources[column],
            quotient(self.output_units[row], self._source_units()[column]),
        )

    def step_response(self, time: Any = None) -> TimeResponse:
        """Return how the outputs answer a step of one SI unit of each input.

        Parameters
        ----------
        time : (nt,) sequence of float, optional
            s, increasing, from zero or later; from the poles unless given.

        Returns
        -------
        TimeResponse
            Away from the operating point, exact at these times.

        Raises
        ------
        BondGraphError
            Where the system has no inputs or outputs, or the response overflows.
        """
        whole = self._realisation()
        times = time_grid(self.poles()) if time is None else checked_times(time)
        return self._response("step", times, *step_values(whole, times))

    def impulse_response(self, time: Any = None) -> TimeResponse:
        """Return how the outputs answer an impulse of area one of each input.

        Parameters
        ----------
        time : (nt,) sequence of float, optional
            s, increasing, from zero or later; from the poles unless given.

        Returns
        -------
        TimeResponse
            Away from the operating point, exact at these times. What D passes on is an
            impulse itself, and stands in ``direct``.

        Raises
        ------
        BondGraphError
            Where the system has no inputs or outputs, or the response overflows.
        """
        whole = self._realisation()
        times = time_grid(self.poles()) if time is None else checked_times(time)
        return self._response("impulse", times, *impulse_values(whole, times))

    def frequency_response(self, omega: Any = None) -> FrequencyResponse:
        """Return outputs over inputs along the imaginary axis.

        Parameters
        ----------
        omega : (nw,) sequence of float, optional
            rad/s; from the poles and zeros unless given.

        Returns
        -------
        FrequencyResponse

        Raises
        ------
        BondGraphError
            Where the system has no inputs or outputs.
        """
        whole = self._realisation()
        if omega is None:
            grid = frequency_grid(numpy.concatenate([self.poles(), invariant_zeros(whole)]))
        else:
            grid = checked_frequencies(omega)
        values = frequency_values(whole, grid)
        names = self.outputs, self.sources, self.output_units, self._source_units()
        return FrequencyResponse(grid, values, *names)

    def _realisation(self) -> Realisation:
        check_channels(self)
        return realisation(self)

    def _channel(self, output: Any, input: Any) -> tuple[int, int]:
        check_channels(self)
        if output is None or input is None:
            raise ParameterError("a channel has an output and an input: give both, or none for all")
        return (
            place_of("output", output, self.outputs, self.sources),
            place_of("input", input, self.sources, self.outputs),
        )

    def _source_units(self) -> tuple[str, ...]:
        known = dict(zip(self.inputs, self.input_units, strict=True))
        return tuple(known[name] for name in self.sources)

    def _response(
        self, kind: str, time: numpy.ndarray, values: numpy.ndarray, direct: numpy.ndarray
    ) -> TimeResponse:
        names = self.outputs, self.sources, self.output_units, self._source_units()
        return TimeResponse(kind, time, values, *names, direct)
