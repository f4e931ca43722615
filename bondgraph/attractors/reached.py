"""What a model's own start ends in along one parameter, as frozen values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy

from ..cycles import Amplitude
from .value import SCHEMA, number

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class ReachPoint:
    """What the model's own start ends in, at one value of the parameter.

    Attributes
    ----------
    value : float
        SI.
    outcome : str
        ``"steady"``, ``"cycle"``, ``"unbounded"``, ``"unsettled"``, ``"stopped"``, or
        ``"refused"`` where the run could not begin.
    stable : bool or None
        Whether the steady state is linearly stable; None where there is none.
    entered : dict of str to int
        Changes into the mode of code 0, such as stick, by contact, in the first part of the run.
    margins : dict of str to float
        Least distance of each dry friction's slip from zero in that part, SI; zero where it sticks.
    frequency_hz : float or None
    held : dict of str to float
        By contact: share of a period in the mode of code 0.
    amplitudes : dict of str to Amplitude
        Of each output over a period, SI.
    note : str
    """

    value: float
    outcome: str
    stable: bool | None = None
    entered: dict[str, int] = field(default_factory=dict)
    margins: dict[str, float] = field(default_factory=dict)
    frequency_hz: float | None = None
    held: dict[str, float] = field(default_factory=dict)
    amplitudes: dict[str, Amplitude] = field(default_factory=dict)
    note: str = ""

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI; None for what is no number."""
        return {
            "value": number(self.value),
            "outcome": self.outcome,
            "stable": self.stable,
            "entered": dict(self.entered),
            "margins": {name: number(value) for name, value in self.margins.items()},
            "frequency_hz": number(self.frequency_hz),
            "held": {name: number(value) for name, value in self.held.items()},
            "amplitudes": {
                name: {
                    "least": number(swing.least),
                    "most": number(swing.most),
                    "mean": number(swing.mean),
                    "peak_to_peak": number(swing.peak_to_peak),
                }
                for name, swing in self.amplitudes.items()
            },
            "note": self.note,
        }


@dataclass(frozen=True, eq=False)
class Change:
    """Where the outcome changes.

    Attributes
    ----------
    value : float
        Middle of the bracket, SI.
    low, high : float
        The bracket.
    before, after : ReachPoint
        At the bracket's ends, by rising value.
    """

    value: float
    low: float
    high: float
    before: ReachPoint
    after: ReachPoint

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI."""
        return {
            "value": self.value,
            "low": self.low,
            "high": self.high,
            "before": {"outcome": self.before.outcome, "frequency_hz": self.before.frequency_hz},
            "after": {"outcome": self.after.outcome, "frequency_hz": self.after.frequency_hz},
        }


@dataclass(frozen=True, eq=False)
class Reach:
    """What a model's own start ends in along one parameter.

    Attributes
    ----------
    model, name : str
        The parameter or input that varies.
    unit : str
        Its own, for display.
    units : dict of str to str
        Of the outputs, SI.
    span : float
        Length of the first part of the runs, s.
    points : tuple of ReachPoint
        By rising value, evenly spaced.
    changes : tuple of Change
        One between neighbours that end differently: in another outcome, or another cycle.
    notes : tuple of str
    words : str
    """

    model: str
    name: str
    unit: str
    units: dict[str, str]
    span: float
    points: tuple[ReachPoint, ...]
    changes: tuple[Change, ...]
    notes: tuple[str, ...]
    words: str

    @property
    def values(self) -> Array:
        """Values of the parameter, SI, (n,) array."""
        return numpy.array([point.value for point in self.points])

    @property
    def outcomes(self) -> tuple[str, ...]:
        """Outcome at each."""
        return tuple(point.outcome for point in self.points)

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI; None for what is no number."""
        return {
            "schema": SCHEMA,
            "model": self.model,
            "name": self.name,
            "unit": self.unit,
            "units": dict(self.units),
            "span": number(self.span),
            "points": [point.to_json() for point in self.points],
            "changes": [change.to_json() for change in self.changes],
            "notes": list(self.notes),
            "words": self.words,
        }
