"""Responses of candidates along a recording, segment by segment.

A long run of a wrong model drifts away from the data, and what a candidate does along it tells
nothing of what it would do along the true motion. Short segments that each begin where the data
say stay near it: their initial states are fitted and then projected off like parameters.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy

from ...errors import BondGraphError, SimulationError
from ...simulation import CompiledModel, Samples, sensitivities, simulate
from .score import Scores, basis_of, chosen, scored

Array = numpy.ndarray

FITS = 3  # of the initial states of a segment
FEWEST = 8  # samples of a segment
LEAST = 15  # samples of the shortest segments tried
MARGIN = 50  # samples of an input beside a segment: band-limited ones are felt as far as 20


@dataclass(frozen=True, eq=False)
class Record:
    """What is known of one recording.

    Attributes
    ----------
    t : (nt,) array, s
        Increasing.
    values : mapping of str to (nt,) array
        Measured signals by name of the model, SI; NaN marks a gap.
    noise : mapping of str to float
        Standard deviation of each.
    inputs, initial : mapping
        As for `bondgraph.simulate`.
    """

    t: Array
    values: Mapping[str, Array]
    noise: Mapping[str, float]
    inputs: Mapping[str, Any] = field(default_factory=dict)
    initial: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Segmented:
    """Responses of parameters and candidates, and the residual, reduced to what scores need.

    Attributes
    ----------
    reduced : (m, p + q + 1) array
        Triangular factor of the responses of p parameters and q candidates, and of the residual,
        each sample weighted by its noise and each segment cleared of its initial states. All
        products between columns are those of the samples.
    free, coefficients : tuple of str
        Parameters and candidates.
    length : float
        Of a segment, s.
    count : int
        Samples, less the initial states that were fitted to them.
    skipped : tuple of (int, float, str)
        Recording, start and reason of each segment that could not be run.
    """

    reduced: Array
    free: tuple[str, ...]
    coefficients: tuple[str, ...]
    length: float
    count: int
    skipped: tuple[tuple[int, float, str], ...]

    @property
    def parts(self) -> tuple[Array, Array, Array]:
        """Residual, responses of candidates and of parameters, as `scored` takes them."""
        p = len(self.free)
        return self.reduced[:, -1], self.reduced[:, p:-1], self.reduced[:, :p]

    def scores(self) -> Scores:
        """Score each candidate."""
        return scored(*self.parts)

    def chosen(self, **options: Any) -> list[tuple[int, float]]:
        """Take candidates one after the other; see `chosen`."""
        return chosen(*self.parts, **options)

    @property
    def share(self) -> float:
        """The best candidate's share of what lies above the noise; 0 where nothing does."""
        found = self.scores()
        above = found.rest - self.count
        if above <= 0:
            return 0.0
        return float(min(found.gain.max(initial=0.0) / above, 1.0))


def segmented(
    model: CompiledModel,
    records: Sequence[Record],
    free: Sequence[str],
    coefficients: Sequence[str],
    length: float,
    *,
    parameters: Mapping[str, float] | None = None,
    rtol: float = 1e-6,
    time_budget: float = 600.0,
) -> Segmented:
    """Follow recordings in segments and gather the responses of parameters and candidates.

    Parameters
    ----------
    model : CompiledModel
        With each candidate in it, multiplied by a coefficient that is zero.
    records : sequence of Record
    free : sequence of str
        The model's own parameters that may explain the residual.
    coefficients : sequence of str
        Parameters that are the candidates' coefficients.
    length : float
        Of a segment, s.
    parameters : mapping, optional
        Values of the model's parameters.
    rtol : float
    time_budget : float
        Seconds for all.

    Returns
    -------
    Segmented

    Raises
    ------
    SimulationError
        Where no segment could be run, or the seconds were used up.

    Notes
    -----
    Segments begin from the states of one run over the whole recording; Gauss-Newton steps of
    least norm, measured in the states' ranges, bring each to its data. The factor is gathered
    segment by segment, so that memory does not grow with the recording.

    References
    ----------
    Bock, Randwertproblemmethoden zur Parameteridentifizierung, Bonner Mathematische Schriften 183
    (1987): multiple shooting.

    Examples
    --------
    A mass that slows down by v' = -v^2, and a model of it without any drag:

    >>> import sympy
    >>> from bondgraph import I, One, R, assemble
    >>> c, d = sympy.symbols("c d", real=True)
    >>> v = One("v")
    >>> probes = R("probe", effort=lambda f: c * f * abs(f) + d * f)
    >>> graph = assemble("mass", v >> (I("m", 1, initial=1), probes), parameters={c: 0.0, d: 0.0},
    ...     outputs={"speed": v.f})
    >>> t = numpy.linspace(0, 3, 61)
    >>> record = Record(t, {"speed": 1 / (1 + t)}, {"speed": 1e-3})
    >>> found = segmented(CompiledModel(graph), [record], [], ["c", "d"], 0.5)
    >>> found.scores().order()[0], round(float(found.scores().coefficient[0]), 1)
    (0, 1.0)
    """
    deadline = time.monotonic() + time_budget
    names = (*free, *coefficients)
    width = len(names) + 1
    reduced, count = numpy.zeros((0, width)), 0
    skipped: list[tuple[int, float, str]] = []
    states = [state.name for state in model.equations.states]
    for number, record in enumerate(records):
        begun = _begun(model, record, parameters, length, rtol)
        for rows, x0, scale in begun:
            if time.monotonic() > deadline:
                raise SimulationError(
                    "the seconds allowed were used up before all segments were followed; raise "
                    "time_budget, or give fewer candidates"
                )
            segment = _Segment(model, record, rows, states, names, parameters or {}, rtol)
            try:
                block, own = segment.block(x0, scale)
            except BondGraphError as error:
                skipped.append((number, float(record.t[rows.start]), str(error)))
                continue
            reduced = numpy.asarray(numpy.linalg.qr(numpy.vstack([reduced, block]), mode="r"))
            count += len(block) - own
    if not count:
        why = skipped[0][2] if skipped else "recordings are shorter than a segment"
        raise SimulationError(f"no segment of {length:g} s could be followed: {why}")
    return Segmented(reduced, tuple(free), tuple(coefficients), length, count, tuple(skipped))


def _begun(
    model: CompiledModel,
    record: Record,
    parameters: Mapping[str, float] | None,
    length: float,
    rtol: float,
) -> Iterator[tuple[slice, Array, Array]]:
    """Cut a recording; give each segment's rows, where one run over all is there, and ranges."""
    t = record.t
    edges = [0]
    while edges[-1] < len(t) - 1:
        end = int(numpy.searchsorted(t, t[edges[-1]] + length * (1 + 1e-9), side="right")) - 1
        edges.append(min(max(end, edges[-1] + FEWEST - 1), len(t) - 1))
    run = simulate(
        model, (t[0], t[-1]), parameters, record.initial, record.inputs, t_eval=t, rtol=rtol
    )
    if not run.x.shape[1]:
        raise SimulationError(f"the run over the recording did not begin: {run.outcome.advice}")
    scale = numpy.ptp(run.x, axis=1)
    scale = numpy.where(scale > 0, scale, numpy.maximum(numpy.abs(run.x[:, 0]), 1e-12))
    for start, end in itertools.pairwise(edges):
        at = min(start, run.x.shape[1] - 1)  # a run that stopped early lends its last state
        if end - start + 1 >= FEWEST:
            yield slice(start, end + 1), run.x[:, at].copy(), scale


@dataclass(frozen=True, eq=False)
class _Segment:
    model: CompiledModel
    record: Record
    rows: slice
    states: list[str]
    names: tuple[str, ...]
    parameters: Mapping[str, float]
    rtol: float

    def block(self, x: Array, scale: Array) -> tuple[Array, int]:
        """Return responses and residual cleared of the initial states, and how many those are."""
        best = self.followed(x)
        for _ in range(FITS):
            step = _least(best[1] * scale, best[2]) * scale
            try:
                new = self.followed(x + step)
            except BondGraphError:
                break
            if not numpy.sum(new[2] ** 2) < numpy.sum(best[2] ** 2):
                break
            x, best = x + step, new
        responses, starts, residual = best
        basis = basis_of(starts)
        whole = numpy.column_stack([responses, residual])
        return whole - basis @ (basis.T @ whole), basis.shape[1]

    def followed(self, x: Array) -> tuple[Array, Array, Array]:
        """Return responses, those to the initial states, and the residual, all weighted."""
        t = self.record.t[self.rows]
        inputs = {name: within(given, t[0], t[-1]) for name, given in self.record.inputs.items()}
        found = sensitivities(
            self.model,
            (t[0], t[-1]),
            (*self.names, *self.states),
            self.parameters,
            dict(zip(self.states, x.tolist(), strict=True)),
            inputs,
            t,
            self.rtol,
        )
        run = found.trajectory
        if not run.outcome.ok:
            raise SimulationError(f"{run.outcome.value} at {run.t_end:g} s")
        columns, residuals = [], []
        for name, values in self.record.values.items():
            measured, noise = values[self.rows], self.record.noise[name]
            there = ~numpy.isnan(measured)
            columns.append(found[name][:, there].T / noise)
            residuals.append((measured - run[name])[there] / noise)
        table, residual = numpy.vstack(columns), numpy.concatenate(residuals)
        if not (numpy.isfinite(table).all() and numpy.isfinite(residual).all()):
            raise SimulationError("a response is not finite")
        return table[:, : len(self.names)], table[:, len(self.names) :], residual


def within(given: Any, start: float, end: float) -> Any:
    """Return what of an input matters between two times; a run looks at all that it is given.

    Examples
    --------
    >>> len(within(Samples(numpy.arange(1000.0), numpy.zeros(1000)), 500, 510).times)
    111
    """
    if isinstance(given, tuple):
        given = Samples(*given)
    if not isinstance(given, Samples):
        return given
    first, last = numpy.searchsorted(given.times, [start, end])
    part = slice(max(int(first) - MARGIN, 0), int(last) + MARGIN + 1)
    return replace(given, times=given.times[part], values=given.values[part])


def _least(columns: Array, residual: Array) -> Array:
    """Least-squares step of least norm."""
    return numpy.linalg.lstsq(columns, residual, rcond=1e-8)[0]


def best_length(
    model: CompiledModel,
    records: Sequence[Record],
    free: Sequence[str],
    coefficients: Sequence[str],
    *,
    lengths: Sequence[float] | None = None,
    **options: Any,
) -> Segmented:
    """Follow recordings in segments of several lengths; return those of which most is explained.

    Long segments see weak effects; short ones stay near the motion where an effect is strong. The
    better they do, the more of what lies above the noise the best candidate explains.

    Parameters
    ----------
    model, records, free, coefficients, options
        As for `segmented`.
    lengths : sequence of float, optional
        To try, s; a third of the longest recording, a ninth and so on, down to 15 samples,
        unless given.

    Returns
    -------
    Segmented
    """
    tried, failure = [], SimulationError("no length of segments was given")
    for length in lengths or _ladder(records):
        try:
            tried.append(segmented(model, records, free, coefficients, length, **options))
        except SimulationError as error:
            failure = error
    if not tried:
        raise failure
    return max(tried, key=lambda item: item.share)


def _ladder(records: Sequence[Record]) -> list[float]:
    whole = max(float(record.t[-1] - record.t[0]) for record in records)
    steps = numpy.concatenate([numpy.diff(record.t) for record in records])
    shortest = LEAST * float(numpy.median(steps))
    lengths = [whole]
    while lengths[-1] / 3 > shortest:
        lengths.append(lengths[-1] / 3)
    return lengths[1:] or lengths
