"""Attractors as frozen values: what a model may end in, and from where."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from ..cycles import Amplitude
from ..simulation import Trajectory

SCHEMA = 1


@dataclass(frozen=True, eq=False)
class Attractor:
    """What runs end in.

    Attributes
    ----------
    kind : str
        ``"steady"``, ``"cycle"``, ``"unbounded"``, ``"stopped"`` (a run that ended early, for the
        reason in `notes`) or ``"unsettled"``.
    starts : tuple of str
        From which it was reached.
    stable : bool or None
        Of a steady state: whether small motions decay. Of a cycle: whether its Floquet
        multipliers say so. None where that is not known, or as good as neither.
    period : float or None
        s.
    events_per_period : float or None
        Changes of mode of all contacts.
    held : dict of str to float
        By contact: share of the time in the mode of code 0.
    amplitudes : dict of str to Amplitude
        Of each output, or of each state where the model has no outputs, in SI.
    units : dict of str to str
        Of these, SI.
    states : dict of str to float
        The steady state; a point of the cycle; where the run ended.
    modes : dict of str to str
        Of the contacts, where it is steady.
    isolated : bool
        False where a state is free to stand anywhere, or cycles of any size lie side by side.
    multipliers : tuple of complex or None
        Floquet multipliers, largest first.
    run : Trajectory
        Once round a cycle; else the last part of a run that ends here.
    notes : tuple of str
    """

    kind: str
    starts: tuple[str, ...]
    stable: bool | None
    period: float | None
    events_per_period: float | None
    held: dict[str, float]
    amplitudes: dict[str, Amplitude]
    units: dict[str, str]
    states: dict[str, float]
    modes: dict[str, str]
    isolated: bool
    multipliers: tuple[complex, ...] | None
    run: Trajectory = field(repr=False)
    notes: tuple[str, ...] = ()

    @property
    def frequency_hz(self) -> float | None:
        """One over the period, Hz."""
        return None if self.period is None else 1 / self.period

    @property
    def sticks(self) -> tuple[str, ...]:
        """Contacts that are held for a part of the cycle, and let go for another."""
        return tuple(name for name, share in self.held.items() if 0 < share < 1)

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI; None for what is no number."""
        return {
            "kind": self.kind,
            "starts": list(self.starts),
            "stable": self.stable,
            "period": number(self.period),
            "frequency_hz": number(self.frequency_hz),
            "events_per_period": number(self.events_per_period),
            "held": {name: number(share) for name, share in self.held.items()},
            "amplitudes": {
                name: {
                    "least": number(swing.least),
                    "most": number(swing.most),
                    "mean": number(swing.mean),
                    "peak_to_peak": number(swing.peak_to_peak),
                    "unit": self.units.get(name, ""),
                }
                for name, swing in self.amplitudes.items()
            },
            "states": {name: number(value) for name, value in self.states.items()},
            "modes": dict(self.modes),
            "isolated": self.isolated,
            "multipliers": None
            if self.multipliers is None
            else [{"real": number(m.real), "imag": number(m.imag)} for m in self.multipliers],
            "notes": list(self.notes),
        }


@dataclass(frozen=True, eq=False)
class Point:
    """The steady state that the linear verdict is about.

    Attributes
    ----------
    states, outputs : dict of str to float
    modes : dict of str to str
    stable : bool
        Whether all small motions decay.
    isolated : bool
    eigenvalues : tuple of complex
        Without those of states that drive nothing.
    """

    states: dict[str, float]
    outputs: dict[str, float]
    modes: dict[str, str]
    stable: bool
    isolated: bool
    eigenvalues: tuple[complex, ...]

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI."""
        return {
            "states": {name: number(value) for name, value in self.states.items()},
            "outputs": {name: number(value) for name, value in self.outputs.items()},
            "modes": dict(self.modes),
            "stable": self.stable,
            "isolated": self.isolated,
            "eigenvalues": [
                {"real": number(pole.real), "imag": number(pole.imag)} for pole in self.eigenvalues
            ],
        }


@dataclass(frozen=True, eq=False)
class BasinEdge:
    """The smallest push of a steady state along one direction that does not return.

    Attributes
    ----------
    along : str
        The direction, in words.
    returns, leaves : float
        Largest size that returned, smallest that did not; of the eigenvector, or of the given
        direction. `leaves` is inf where all sizes tried return.
    outputs : dict of str to float
        How far each output is off its steady value at the start of the smallest push that leaves,
        SI.
    energy : float or None
        Stored energy of that push above that of the steady state, J.
    to : int or None
        Place of the attractor that it leads to.
    tried : int
        Number of runs.
    """

    along: str
    returns: float
    leaves: float
    outputs: dict[str, float]
    energy: float | None
    to: int | None
    tried: int

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI; None for what is no number."""
        return {
            "along": self.along,
            "returns": number(self.returns),
            "leaves": number(self.leaves),
            "outputs": {name: number(value) for name, value in self.outputs.items()},
            "energy": number(self.energy),
            "to": self.to,
            "tried": self.tried,
        }


@dataclass(frozen=True, eq=False)
class Attractors:
    """What a model ends in, from several starts.

    Attributes
    ----------
    model : str
    parameters, inputs : dict of str to float
        SI values of the runs.
    point : Point or None
        The steady state that the linear verdict is about; None where none was found.
    found : tuple of Attractor
        That of the model's own start first.
    starts : dict of str to dict
        States of each start, by its name.
    ends : dict of str to int
        Place in `found` by start.
    edge : BasinEdge or None
        How hard a knock leaves the steady state.
    notes : tuple of str
    words : str
        A few plain sentences.
    """

    model: str
    parameters: dict[str, float]
    inputs: dict[str, float]
    point: Point | None
    found: tuple[Attractor, ...]
    starts: dict[str, dict[str, float]]
    ends: dict[str, int]
    edge: BasinEdge | None
    notes: tuple[str, ...]
    words: str

    @property
    def cycles(self) -> tuple[Attractor, ...]:
        """The cycles that do not repel, without families that lie side by side."""
        return tuple(
            item
            for item in self.found
            if item.kind == "cycle" and item.stable is not False and item.isolated
        )

    @property
    def steady(self) -> tuple[Attractor, ...]:
        """The steady states in which small motions decay."""
        return tuple(item for item in self.found if item.kind == "steady" and item.stable)

    @property
    def coexist(self) -> bool:
        """Whether a stable steady state lives beside a cycle, or two cycles or steady states do."""
        return len(self.steady) + len(self.cycles) > 1

    @property
    def beside(self) -> bool:
        """Whether a cycle lives beside a steady state that the linear verdict calls stable."""
        return bool(self.cycles and self.steady)

    @property
    def own(self) -> Attractor | None:
        """What the model's own start ends in."""
        return self.found[self.ends["own"]] if "own" in self.ends else None

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI; None for what is no number."""
        return {
            "schema": SCHEMA,
            "model": self.model,
            "parameters": {name: number(value) for name, value in self.parameters.items()},
            "inputs": {name: number(value) for name, value in self.inputs.items()},
            "point": None if self.point is None else self.point.to_json(),
            "attractors": [item.to_json() for item in self.found],
            "ends": dict(self.ends),
            "starts": {
                name: {key: number(value) for key, value in states.items()}
                for name, states in self.starts.items()
            },
            "coexist": self.coexist,
            "beside": self.beside,
            "edge": None if self.edge is None else self.edge.to_json(),
            "notes": list(self.notes),
            "words": self.words,
        }


def number(value: float | None) -> float | None:
    """Return a finite number, or None.

    Examples
    --------
    >>> number(2), number(float("nan")), number(None)
    (2.0, None, None)
    """
    return None if value is None or not math.isfinite(value) else float(value)
