"""The misfit at a point, and its linear rows segment by segment."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy

from .chain import Link, compressed
from .shots import Gun, Segment, Shot
from .unknowns import Unknowns

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Point:
    """Where a fit stands.

    Attributes
    ----------
    z : (q,) array
        Coordinates of all unknowns.
    starts : tuple of (k - 1, n) array
        By recording: start states of its segments but the first.
    """

    z: Array
    starts: tuple[Array, ...]


@dataclass(frozen=True, eq=False)
class Misfit:
    """The misfit at a point.

    Attributes
    ----------
    cost : float
        Loss of residuals, continuity and priors; infinite where a run failed.
    links : tuple of tuple of Link
        By recording and segment.
    prior : (m, q + 1) array
        Rows of the priors.
    shots : tuple of tuple of Shot
    gap : float
        Largest break between segments, in shares of the state's range.
    why : str
        Why a run failed.
    """

    cost: float
    links: tuple[tuple[Link, ...], ...] = ()
    prior: Array | None = None
    shots: tuple[tuple[Shot, ...], ...] = ()
    gap: float = 0.0
    why: str = ""


@dataclass(frozen=True, eq=False)
class Problem:
    """What is to be lowered.

    Attributes
    ----------
    gun : Gun
    unknowns : Unknowns
    segments : tuple of tuple of Segment
        By recording.
    sigma : mapping of str to float
        Noise by signal.
    loss : callable
    scale : (n,) array
        Range of each state.
    tightness : float
        Standard deviation allowed at the joints of segments, in shares of `scale`.
    deadline : float
        Of `time.monotonic`.
    """

    gun: Gun
    unknowns: Unknowns
    segments: tuple[tuple[Segment, ...], ...]
    sigma: Mapping[str, float]
    loss: Callable[[Array], tuple[Array, Array]]
    scale: Array
    tightness: float
    deadline: float

    @property
    def states(self) -> tuple[str, ...]:
        """Names of all states of the model."""
        return tuple(state.name for state in self.gun.model.equations.states)

    def given(self, point: Point, segment: Segment, k: int) -> tuple[dict, dict]:
        """Return the parameters and the start states of a segment by name."""
        unknowns = self.unknowns
        values = unknowns.values(point.z)
        parameters = dict(zip(unknowns.parameters, values.tolist(), strict=False))
        if k:
            starts = point.starts[segment.recording][k - 1]
            return parameters, dict(zip(self.states, starts.tolist(), strict=True))
        own = values[unknowns.own(segment.recording)]
        return parameters, dict(zip(unknowns.states, own.tolist(), strict=True))

    def shoot(self, point: Point, segment: Segment, k: int) -> Shot | str:
        """Run one segment at a point."""
        left = self.deadline - time.monotonic()
        if left <= 0:
            return "time budget"
        return self.gun(segment, *self.given(point, segment, k), left)

    def __call__(self, point: Point) -> Misfit:
        """Return the misfit at a point."""
        shots = []
        for row in self.segments:
            made = []
            for k, segment in enumerate(row):
                shot = self.shoot(point, segment, k)
                if isinstance(shot, str):
                    return Misfit(float("inf"), why=shot)
                made.append(shot)
            shots.append(tuple(made))
        return self.weighed(point, tuple(shots))

    def weighed(self, point: Point, shots: tuple[tuple[Shot, ...], ...]) -> Misfit:
        """Return the misfit of runs already made."""
        cost, gap, links = 0.0, 0.0, []
        for row, starts in zip(shots, point.starts, strict=True):
            chain = []
            for k, shot in enumerate(row):
                following = starts[k] if k < len(row) - 1 else None
                link, loss, broken = self._link(point, shot, k, following)
                cost, gap = cost + loss, max(gap, broken)
                chain.append(link)
            links.append(tuple(chain))
        prior = self.prior_rows(point.z)
        cost += float(prior[:, -1] @ prior[:, -1])
        if not numpy.isfinite(cost):
            return Misfit(float("inf"), why="the misfit overflows")
        return Misfit(cost, tuple(links), prior, shots, gap)

    def _link(
        self, point: Point, shot: Shot, k: int, following: Array | None
    ) -> tuple[Link, float, float]:
        """Return the rows of a segment, its loss, and how far its end is from the next start."""
        slopes = self.unknowns.slopes(point.z)[: len(self.unknowns.parameters)]
        own = len(self.states) if k else len(self.unknowns.states)
        chain_rule = numpy.concatenate([numpy.ones(own), slopes])
        loss, rows = 0.0, [numpy.zeros((0, own + len(slopes) + 1))]
        for name, residual in shot.residuals.items():
            there = numpy.isfinite(residual)
            r = residual[there] / self.sigma[name]
            value, weight = self.loss(r)
            loss += float(value.sum())
            by = shot.slopes[name][:, there] * (chain_rule[:, None] / self.sigma[name])
            rows.append(compressed((numpy.vstack([by, r]) * numpy.sqrt(weight)).T))
        data = compressed(numpy.concatenate(rows))
        if following is None:
            return Link(own, data, None, numpy.zeros(0)), loss, 0.0
        allowed = self.tightness * self.scale
        broken = shot.x_end - following
        onward = numpy.column_stack([shot.s_end * chain_rule, broken]) / allowed[:, None]
        loss += float(onward[:, -1] @ onward[:, -1])
        return Link(own, data, onward, -1 / allowed), loss, float(max(abs(broken / self.scale)))

    def prior_rows(self, z: Array) -> Array:
        """Return (u - mean)/std of all unknowns that have a prior, and slopes."""
        rows = []
        for i, item in enumerate(self.unknowns.items):
            if item.prior is not None:
                row = numpy.zeros(len(z) + 1)
                row[i], row[-1] = 1 / item.prior[1], (z[i] - item.prior[0]) / item.prior[1]
                rows.append(row)
        return numpy.array(rows).reshape(-1, len(z) + 1)

    def with_(self, **changes: object) -> Problem:
        """Return the problem with other numbers."""
        return replace(self, **changes)  # type: ignore[arg-type]


def placed(rows: Array, own: slice, q: int, total: int) -> Array:
    """Put rows over (own initial states, q parameters, one) into columns of all unknowns.

    Examples
    --------
    >>> placed(numpy.array([[5.0, 1.0, 9.0]]), slice(2, 3), 1, 3).tolist()
    [[1.0, 0.0, 5.0, 9.0]]
    """
    n = own.stop - own.start
    out = numpy.zeros((len(rows), total + 1))
    out[:, own], out[:, :q], out[:, -1] = rows[:, :n], rows[:, n : n + q], rows[:, -1]
    return out


def stacked(parts: Sequence[Array], width: int) -> Array:
    """Stack rows and compress them."""
    return compressed(numpy.concatenate([numpy.zeros((0, width)), *parts]))
