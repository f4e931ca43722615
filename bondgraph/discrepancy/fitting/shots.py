"""One segment of a recording, run with its derivatives; a run that fails is an answer, no error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy

from ...errors import BondGraphError
from ...simulation import CompiledModel, Sensitivities, Trajectory, sensitivities
from .recordings import Recording

Array = numpy.ndarray

# A contact that hardly moves where a run starts may stick in what, at this tolerance, is a touch
# without a derivative: finer runs tell, or one from beside it. Shares of rtol, and of each state
AGAIN = ((1.0, 0.0), (1e-2, 0.0), (1e-2, 1e-6), (1e-2, -1e-6), (1e-2, 1e-5), (1e-2, -1e-4))


@dataclass(frozen=True)
class Segment:
    """Samples of a recording that one run goes through.

    Attributes
    ----------
    recording : int
    first, last : int
        Samples, last excluded.
    start, end : float
        Of the run, s.
    """

    recording: int
    first: int
    last: int
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class Shot:
    """What a run through a segment gave.

    Attributes
    ----------
    residuals : mapping of str to (nt,) array
        Model less data, SI; NaN at gaps.
    slopes : mapping of str to (k, nt) array
        Of the signals, by own start states, then by parameters.
    x_end : (n,) array
    s_end : (n, k) array
    trajectory : Trajectory
    """

    residuals: Mapping[str, Array]
    slopes: Mapping[str, Array]
    x_end: Array
    s_end: Array
    trajectory: Trajectory


@dataclass(frozen=True, eq=False)
class Gun:
    """Runs segments of recordings.

    Attributes
    ----------
    model : CompiledModel
    recordings : tuple of Recording
    rtol : float
    fixed : mapping
        Parameters of all runs that are not sought.
    initial : mapping
        Initial states known in all recordings.
    ties : mapping of str to mapping of str to float
        Start states that are sums of others, each by a factor.
    """

    model: CompiledModel
    recordings: tuple[Recording, ...]
    rtol: float
    fixed: Mapping[str, Any]
    initial: Mapping[str, Any]
    ties: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def __call__(
        self,
        segment: Segment,
        parameters: Mapping[str, float],
        states: Mapping[str, float],
        seconds: float,
    ) -> Shot | str:
        """Run a segment.

        Parameters
        ----------
        segment : Segment
        parameters : mapping of str to float
            Those sought.
        states : mapping of str to float
            Start states sought.
        seconds : float
            Wall-clock limit.

        Returns
        -------
        Shot or str
            Why there is none.
        """
        shot: Shot | str = ""
        for share, aside in AGAIN:
            moved = {
                name: value * (1 + aside * (1 + 0.3 * place) * (-1) ** place)
                for place, (name, value) in enumerate(states.items())
            }
            shot = self._shot(segment, parameters, moved, seconds, max(self.rtol * share, 1e-12))
            if not isinstance(shot, str) or "grazing" not in shot:
                break
        return shot

    def _shot(
        self,
        segment: Segment,
        parameters: Mapping[str, float],
        states: Mapping[str, float],
        seconds: float,
        rtol: float,
    ) -> Shot | str:
        recording = self.recordings[segment.recording]
        times = recording.t[segment.first : segment.last]
        known = {**self.initial, **recording.initial} if segment.first == 0 else {}
        ties = self.ties if segment.first == 0 else {}
        begun = {**known, **states}
        tied = {
            name: sum(factor * begun.get(other, 0.0) for other, factor in shares.items())
            for name, shares in ties.items()
        }
        try:
            with numpy.errstate(all="ignore"):
                found = sensitivities(
                    self.model,
                    (segment.start, segment.end),
                    [*states, *parameters, *tied],
                    {**self.fixed, **parameters},
                    {**begun, **tied},
                    recording.inputs,
                    times,
                    rtol,
                    max_steps=20 * len(recording.t) + 1_000_000,
                    time_budget=seconds,
                )
                run = found.trajectory
                if not run.outcome.ok:
                    return f"{recording.name}: {run.outcome.value} at {run.t_end:g} s"
                residuals, slopes = {}, {}
                for name, column in recording.data.items():
                    part = column[segment.first : segment.last]
                    if numpy.isfinite(part).any():
                        signal, slopes[name] = _told(found, name)
                        residuals[name] = signal - part
        except BondGraphError as error:
            return f"{recording.name}: {error}"
        follow = _following(list(states), len(parameters), ties)
        slopes = {name: follow @ rows for name, rows in slopes.items()}
        shot = Shot(residuals, slopes, run.x_end, found.x_end @ follow.T, run)
        return shot if _finite(shot) else f"{recording.name}: derivatives are not finite"


def _following(
    states: list[str], parameters: int, ties: Mapping[str, Mapping[str, float]]
) -> Array:
    """Return what adds the slopes by tied start states to those by the states they follow."""
    own = len(states) + parameters
    follow = numpy.hstack([numpy.eye(own), numpy.zeros((own, len(ties)))])
    for column, shares in enumerate(ties.values(), start=own):
        for name, factor in shares.items():
            if name in states:
                follow[states.index(name), column] = factor
    return follow


def _told(found: Sensitivities, name: str) -> tuple[Array, Array]:
    """Return a signal and its slopes; a state's own are at hand."""
    run = found.trajectory
    expression = run.model.equations.outputs.get(name)
    state = name if expression is None else getattr(expression, "name", "")
    if state in run.states:
        place = run.states.index(state)
        return run.x[place], found.x[place]
    return run[name], found[name]


def _finite(shot: Shot) -> bool:
    parts = (shot.x_end, shot.s_end, *shot.slopes.values())
    return all(numpy.isfinite(part).all() and abs(part).max(initial=0) < 1e100 for part in parts)


def cut(recording: Recording, place: int, parts: int) -> tuple[Segment, ...]:
    """Cut a recording into segments of equally many samples, each of which ends where the next starts.

    Parameters
    ----------
    recording : Recording
    place : int
        Its number.
    parts : int

    Returns
    -------
    tuple of Segment

    Examples
    --------
    >>> rows = Recording("r", numpy.arange(10.0), {}, {}, {})
    >>> [(part.start, part.end) for part in cut(rows, 0, 2)]
    [(0.0, 5.0), (5.0, 9.0)]
    """
    t = recording.t
    edges = numpy.unique(numpy.linspace(0, len(t), parts + 1).round().astype(int))
    if len(edges) > 2 and edges[-1] - edges[-2] < 2:  # a run needs a length
        edges = numpy.delete(edges, -2)
    ends = [*t[edges[1:-1]], t[-1]]
    return tuple(
        Segment(place, int(first), int(last), float(t[first]), float(end))
        for first, last, end in zip(edges[:-1], edges[1:], ends, strict=True)
    )
