"""Inputs between samples, late or limited; and what sensors make of outputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy
from scipy.interpolate import CubicSpline

Array = numpy.ndarray


@dataclass(frozen=True)
class Drive:
    """An input as samples.

    Attributes
    ----------
    t : (nt,) array, s, equally spaced from zero
    values : (nt,) array
    hold : ``"linear"`` or ``"zero"`` between samples
    """

    t: Array
    values: Array
    hold: str = "linear"

    def function(self, delay: float = 0.0, limit: float = float("inf")) -> Callable:
        """Return the input at a time of step ``i``, late by a delay and no more than a limit.

        Before the first sample it was what it is there.
        """
        step = float(self.t[1] - self.t[0])
        values: Sequence[float] = self.values.tolist()
        last, held = len(values) - 2, self.hold == "zero"

        def at(t: float, middle: float) -> float:
            # a jump belongs to a whole step or to none of it
            place = ((middle if held else t) - delay) / step
            if place <= 0:
                u = values[0]
            else:
                i = min(int(place), last + held)
                u = values[i] if held else values[i] + (place - i) * (values[i + 1] - values[i])
            return max(-limit, min(limit, u))

        return at


def sensed(t: Array, column: Array, effect: str, c: Mapping[str, float]) -> Array:
    """Return what a sensor with an offset, a limit or a delay says."""
    if effect == "sensor_bias":
        return column + c["offset"]
    if effect == "saturation":
        return numpy.clip(column, -c["limit"], c["limit"])
    if effect == "transport_delay":
        late = CubicSpline(t, column)(numpy.maximum(t - c["delay"], t[0]))
        return numpy.asarray(late)
    raise ValueError(f"a sensor has no {effect}")
