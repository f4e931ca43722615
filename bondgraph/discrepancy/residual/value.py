"""What a model leaves of a recording: measured less simulated, at the recording's times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy

from ...errors import MeasurementError

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Residuals:
    """Gaps between measured and simulated signals over common times.

    Parameters
    ----------
    t : (nt,) array-like, s
        Strictly increasing.
    measured, simulated : mapping of str to (nt,) array-like
        Of the same signals and in the same unit; NaN in `measured` marks a gap in the recording.
    units : mapping of str to str, optional
    inputs, states : mapping of str to (nt,) array-like, optional
        What the gap may depend on: imposed signals and simulated ones.
    name : str

    Raises
    ------
    MeasurementError
        For columns of other lengths, signals that are not in both, simulated values that are not
        finite, or no signal at all.

    Examples
    --------
    >>> found = Residuals([0, 1], {"v": [1.0, 3.0]}, {"v": [1.0, 2.5]}, {"v": "m/s"})
    >>> found.gap("v").tolist()
    [0.0, 0.5]
    """

    t: Any
    measured: Mapping[str, Any]
    simulated: Mapping[str, Any]
    units: Mapping[str, str] = field(default_factory=dict)
    inputs: Mapping[str, Any] = field(default_factory=dict)
    states: Mapping[str, Any] = field(default_factory=dict)
    name: str = "residuals"

    def __post_init__(self) -> None:
        t = numpy.array(self.t, dtype=float).ravel()
        if len(t) < 2 or not (numpy.diff(t) > 0).all():
            raise MeasurementError(f"{self.name}: times must be two or more, and increase")
        if not self.measured or set(self.measured) != set(self.simulated):
            odd = ", ".join(sorted(set(self.measured) ^ set(self.simulated))) or "none at all"
            raise MeasurementError(
                f"{self.name}: signals must be both measured and simulated; not so: {odd}"
            )
        object.__setattr__(self, "t", t)
        for kind in ("measured", "simulated", "inputs", "states"):
            columns = {
                key: self._column(kind, key, v, len(t)) for key, v in getattr(self, kind).items()
            }
            object.__setattr__(self, kind, MappingProxyType(columns))

    def _column(self, kind: str, key: str, values: Any, count: int) -> Array:
        column = numpy.array(values, dtype=float).ravel()
        where = f"{self.name}, {kind} {key!r}"
        if len(column) != count:
            raise MeasurementError(f"{where}: {len(column)} values for {count} times")
        good = numpy.isfinite(column)
        if kind == "simulated" and not good.all():
            raise MeasurementError(
                f"{where}: not finite at t = {self.t[numpy.argmin(good)]:g} s; "
                "simulate to the end of the recording"
            )
        if not good.any():
            raise MeasurementError(f"{where}: no finite value")
        column[~good] = numpy.nan
        return column

    def __len__(self) -> int:
        return len(self.t)

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the signals compared."""
        return tuple(self.measured)

    def gap(self, signal: str) -> Array:
        """Return measured less simulated, of shape (nt,); NaN where nothing was measured.

        Raises
        ------
        MeasurementError
            For a signal that was not compared.
        """
        if signal not in self.measured:
            raise MeasurementError(
                f"{self.name}: {signal!r} was not compared; there is {', '.join(self.signals)}"
            )
        return self.measured[signal] - self.simulated[signal]

    def along(self, name: str) -> Array:
        """Return a signal that gaps may depend on, of shape (nt,); ``|v|`` is the size of v.

        A compared signal is given as simulated: the noise of the measured one is in the gap too,
        and would look like a dependence.

        Raises
        ------
        MeasurementError
            For an unknown name.
        """
        if len(name) > 2 and name[0] == name[-1] == "|":
            return numpy.abs(self.along(name[1:-1]))
        for columns in (self.inputs, self.simulated, self.states):
            if name in columns:
                return columns[name]
        known = ", ".join(dict.fromkeys((*self.inputs, *self.simulated, *self.states)))
        raise MeasurementError(f"{self.name}: no signal {name!r}; there is {known}")

    def unit(self, name: str) -> str:
        """Return the unit of a signal; empty where it is not known."""
        return self.units.get(name.strip("|"), "")
