"""Screening: which effects, alone or by twos, make the recordings likelier."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy

from ...errors import SimulationError
from ..candidates import Effect
from ..candidates.features import Shape
from .columns import Candidate, Columns, columns_of
from .functions import Points
from .linear import Along
from .probes import Probed
from .relax import ERRORS, LOOSE, Course, Relaxed

Array = numpy.ndarray

LEAST_LEFT = 1e-3  # of a response, once the own parameters have done what they can
DAMPED = 0.1  # of critical
RIDGE = 1e-12  # of columns that are alike


@dataclass(frozen=True, eq=False)
class Reduced:
    """Everything that scores need of one size of the model's error.

    Attributes
    ----------
    error : float
    factor : (m, c + 1) array
        Columns of candidates and the residual, cleared of the own parameters; products between
        them are those of the samples.
    own : (p, c + 1) array
        Changes of the own parameters that go with the columns and the residual.
    log_det : float
    count : int
    """

    error: float
    factor: Array
    own: Array
    log_det: float
    count: int

    def likelihood(self, rest: float) -> float:
        """Return twice the negative log likelihood for a sum of squares that is left."""
        return self.count * float(numpy.log(max(rest, 1e-300) / self.count)) + self.log_det

    @functools.cached_property
    def gram(self) -> Array:
        """Products of all columns, (c + 1, c + 1)."""
        return self.factor.T @ self.factor

    @functools.cached_property
    def rest(self) -> float:
        """Sum of squares without any candidate."""
        return float(self.factor[:, -1] @ self.factor[:, -1])


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """Effects that may be missing together.

    Attributes
    ----------
    candidates : tuple of Candidate
    amounts : tuple of array
        Of each one's columns.
    gain : float
        Drop of the Bayesian information criterion.
    error : float
        Of the model that is left.
    own : (p,) array
        Changes of the own parameters that go with it, in their coordinates.
    """

    candidates: tuple[Candidate, ...]
    amounts: tuple[Array, ...]
    gain: float
    error: float
    own: Array

    @property
    def label(self) -> str:
        """Effects and sites."""
        return " + ".join(item.label for item in self.candidates)


@dataclass(frozen=True, eq=False)
class Sketch:
    """What a screening finds.

    Attributes
    ----------
    singles, pairs : tuple of Hypothesis
        Best first; of each effect at each site the best form only.
    relaxed : Relaxed
    columns : Columns
    reduced : tuple of Reduced
    """

    singles: tuple[Hypothesis, ...]
    pairs: tuple[Hypothesis, ...]
    relaxed: Relaxed
    columns: Columns
    reduced: tuple[Reduced, ...]


def sketched(found: Relaxed, probed: Probed, effects: Iterable[Effect], pairs: int = 6) -> Sketch:
    """Score all effects at all sites.

    Parameters
    ----------
    found : Relaxed
        Of the probed graph.
    probed : Probed
    effects : iterable of Effect
    pairs : int
        How many of the best get a second one beside them.

    Returns
    -------
    Sketch

    Raises
    ------
    SimulationError
        Where nothing can be scored.
    """
    known = tuple(effects)
    columns = columns_of(found, probed, known)
    errors = [error for error in ERRORS if error <= found.error * 1.01] or [found.error]
    reduced = []
    for error in errors:
        try:
            reduced.append(products(found, columns, error))
        except SimulationError:
            continue
    if not reduced:
        raise SimulationError("no size of the model's error lets effects be scored")
    base = min(item.likelihood(item.rest) for item in reduced)
    singles = [_single(reduced, columns, index, base) for index in range(len(columns.groups))]
    best: dict[str, tuple[int, Hypothesis]] = {}
    for index, item in enumerate(singles):
        if item is not None and (item.label not in best or item.gain > best[item.label][1].gain):
            best[item.label] = index, item
    order = _without_twins(sorted(best.values(), key=lambda pair: -pair[1].gain), columns, reduced)
    # what is of the wrong sign alone may be of the right one beside another
    beside = [i for i, _ in order] + [i for i, item in enumerate(singles) if item is None]
    seconds = [
        item
        for index, first in order[:pairs]
        for item in _with_second(reduced, columns, index, beside, base)
    ]
    inertia = next((each for each in known if each.name == "added_inertia"), None)
    return Sketch(
        tuple(_completed(item, probed, inertia) for _, item in order),
        tuple(_distinct(sorted(seconds, key=lambda item: -item.gain))),
        found,
        columns,
        tuple(reduced),
    )


def _completed(item: Hypothesis, probed: Probed, inertia: Effect | None) -> Hypothesis:
    """Add an inertia to what a compliance sets free of its source and nothing else would move.

    Without it the junction's flow would follow from efforts at once. How fast it swings is not
    told to first order: it starts in the middle of what the recording shows, lightly damped.
    """
    (first,), (amounts,) = item.candidates, item.amounts
    behind = probed.probes[first.probe].behind
    if behind is None or inertia is None:
        return item
    signals = first.signals
    slow = numpy.sqrt(numpy.mean(signals.effort_rate**2)) / (numpy.std(signals.effort) or 1.0)
    fast = 0.5 / float(numpy.median(numpy.diff(signals.t)))
    swing = float(numpy.sqrt(max(slow, 1 / signals.duration) * fast))
    stiffness = first.starts(amounts.tolist())["stiffness"]
    coupling = {"stiffness": stiffness, "damping": 2 * DAMPED * stiffness / swing}
    mass = {"inertance": stiffness / swing**2}
    pair = (
        replace(first, shape=replace(first.shape, starts=lambda amounts, signals: coupling)),
        replace(first, effect=inertia, site=behind, shape=Shape((), lambda a, s: mass), pair=()),
    )
    return replace(item, candidates=pair, amounts=(amounts, numpy.zeros(0)))


def _without_twins(
    order: Sequence[tuple[int, Hypothesis]], columns: Columns, reduced: Sequence[Reduced]
) -> list[tuple[int, Hypothesis]]:
    """Leave out sites that are the same place: a spring's own junction, and between its ends.

    The junction is kept, and told which pair it lies between.
    """
    gram = reduced[-1].gram
    kept: list[tuple[int, Hypothesis]] = []
    for index, item in order:
        for at, (other, known) in enumerate(kept):
            one, two = columns.candidates[index], columns.candidates[other]
            if one.effect is two.effect and _same(
                gram, columns.groups[index], columns.groups[other]
            ):
                pair, own = sorted((one, two), key=lambda each: len(each.site.at), reverse=True)
                if len(pair.site.at) == 2 and len(own.site.at) == 1:
                    first = (other, known) if two is own else (index, item)
                    named = replace(first[1].candidates[0], pair=pair.site.at)
                    kept[at] = first[0], replace(first[1], candidates=(named,))
                    break
        else:
            kept.append((index, item))
    return kept


def _same(gram: Array, one: Sequence[int], other: Sequence[int]) -> bool:
    if len(one) != len(other):
        return False
    cosines = [
        gram[i, j] / numpy.sqrt(gram[i, i] * gram[j, j]) if gram[i, i] * gram[j, j] > 0 else 0.0
        for i, j in zip(one, other, strict=True)
    ]
    return bool(numpy.min(numpy.abs(cosines)) > 1 - 1e-6)


def products(found: Relaxed, columns: Columns, error: float) -> Reduced:
    """Return the triangular factor of all columns for one size of the model's error."""
    p = len(found.table.names)
    prior = found.table.prior(found.values, LOOSE)
    width = p + len(columns.probes) + 1
    rows = numpy.zeros((len(prior), width))
    rows[:, :p], rows[:, -1] = prior[:, :p], prior[:, -1]
    log_det, count = 0.0, 0
    used = len(found.table.used)
    slopes = found.table.slopes(found.values)
    for (course, lines, before, after), values in zip(found.linear(), columns.values, strict=True):
        forced, felt = responses(course, lines, (before, after), values, columns, used)
        table = lines.with_columns(
            numpy.concatenate([lines.forced[:, :, :used] @ slopes, forced], axis=2),
            numpy.concatenate([lines.felt[:, :, :used] @ slopes, felt], axis=2),
        )
        part = found.moved(course, table, error)
        rows = numpy.asarray(numpy.linalg.qr(numpy.vstack([rows, part.rows]), mode="r"))
        log_det, count = log_det + part.log_det, count + part.count
    size = numpy.linalg.norm(rows[:, :p], axis=0)
    basis, left, _ = numpy.linalg.svd(
        rows[:, :p] / numpy.where(size > 0, size, 1.0), full_matrices=False
    )
    basis = basis[:, left > 1e-10 * left.max(initial=1e-300)] if p else numpy.zeros((len(rows), 0))
    rest = rows[:, p:]
    whole = numpy.linalg.norm(rest, axis=0)
    own = numpy.linalg.lstsq(rows[:, :p] / numpy.where(size > 0, size, 1.0), rest, rcond=1e-8)[0]
    own = own / numpy.where(size > 0, size, 1.0)[:, None]
    cleared = rest - basis @ (basis.T @ rest)
    # what the own parameters can do as well is none of a candidate's
    cleared[:, :-1] *= (numpy.linalg.norm(cleared, axis=0) > LEAST_LEFT * whole)[:-1]
    return Reduced(error, cleared, own, log_det, count)


def responses(
    course: Course,
    lines: Along,
    points: tuple[Points, Points],
    values: tuple[Array, Array],
    columns: Columns,
    used: int,
) -> tuple[Array, Array]:
    """Return what columns add to each step, and to what is said.

    What acts by the rate of a column, z' = A z + b c', is z = y + b c with y' = A y + (A b - b') c.
    """
    at, by, rates = course.grid.samples, used + columns.probes, columns.rates
    sides, shifted = [], []
    for point, value in zip(points, values, strict=True):
        push = point.rates_p[:, :, by] * value[:, None, :]
        if rates.any():
            turned = numpy.gradient(point.rates_p[:, :, by[rates]], course.grid.t, axis=0)
            shifted.append(push[:, :, rates].copy())
            push[:, :, rates] = point.rates_x @ shifted[-1] - turned * value[:, None, rates]
        sides.append(push)
    felt = points[0].outputs_p[at][:, :, by] * values[0][at][:, None, :]
    if rates.any():
        felt[:, :, rates] = points[0].outputs_x[at] @ shifted[0][at]
        direct = points[0].outputs_p[:, :, by[rates]]
        if direct.any():
            rising = numpy.gradient(values[0][:, rates], course.grid.t, axis=0)
            felt[:, :, rates] += direct[at] * rising[at][:, None, :]
    return lines.pushed(*sides), felt


def _amounts(gram: Array, cross: Array, signed: Sequence[bool]) -> Array:
    """Least squares from products of columns; what is not signed stays positive.

    Lawson and Hanson's active sets, for the few columns of a hypothesis.
    """
    size = numpy.sqrt(numpy.diag(gram))
    if not size.all():
        return numpy.zeros(len(size))
    scaled = gram / numpy.outer(size, size) + RIDGE * numpy.eye(len(size))
    wanted = cross / size
    held = numpy.array([not free for free in signed])
    active = held.copy()
    x = numpy.zeros(len(size))
    for _ in range(3 * len(size) + 1):
        free = numpy.flatnonzero(~active)
        while len(free):
            step = numpy.zeros(len(size))
            step[free] = numpy.linalg.solve(scaled[numpy.ix_(free, free)], wanted[free])
            low = free[held[free] & (step[free] <= 0)]
            if not len(low):
                x = step
                break
            share = min(x[i] / (x[i] - step[i]) if x[i] > step[i] else 0.0 for i in low)
            x = x + share * (step - x)
            active[low[x[low] <= 1e-12]] = True
            x[active] = 0.0
            free = numpy.flatnonzero(~active)
        slope = (wanted - scaled @ x) * active
        if slope.max(initial=0.0) <= 1e-10 * abs(wanted).max(initial=1e-300):
            break
        active[int(numpy.argmax(slope))] = False
    return numpy.asarray(x / size)


def _hypothesis(
    reduced: Sequence[Reduced], columns: Columns, chosen: Sequence[int], base: float
) -> Hypothesis | None:
    """Fit candidates together at each size of the error; return the likeliest."""
    best = None
    where = [index for one in chosen for index in columns.groups[one]]
    signed = [free for one in chosen for free in columns.candidates[one].signed]
    for item in reduced:
        gram, cross = item.gram[numpy.ix_(where, where)], item.gram[where, -1]
        amounts = _amounts(gram, cross, signed)
        left = item.rest - float(2 * cross @ amounts - amounts @ gram @ amounts)
        likelihood = item.likelihood(max(left, 1e-12 * item.rest))
        if best is None or likelihood < best[0]:
            best = likelihood, item, amounts
    assert best is not None
    likelihood, item, amounts = best
    if not numpy.any(amounts):
        return None
    parts, at = [], 0
    for one in chosen:
        parts.append(amounts[at : at + len(columns.groups[one])])
        at += len(columns.groups[one])
    if not all(numpy.any(part) for part in parts):
        return None
    terms = sum(len(columns.candidates[one].effect.fitted) for one in chosen)
    gain = base - likelihood - terms * float(numpy.log(item.count))
    found = tuple(columns.candidates[one] for one in chosen)
    own = item.own[:, -1] - item.own[:, where] @ amounts
    return Hypothesis(found, tuple(parts), gain, item.error, own)


def _single(
    reduced: Sequence[Reduced], columns: Columns, index: int, base: float
) -> Hypothesis | None:
    return _hypothesis(reduced, columns, [index], base)


def _with_second(
    reduced: Sequence[Reduced], columns: Columns, first: int, others: Sequence[int], base: float
) -> list[Hypothesis]:
    """Return a candidate with others beside it, at the errors that suit it and at smaller ones."""
    alone = _single(reduced, columns, first, base)
    assert alone is not None
    near = [item for item in reduced if item.error <= alone.error][-2:]
    found = [_hypothesis(near, columns, [first, other], base) for other in others if other != first]
    return [item for item in found if item is not None]


def _distinct(items: Sequence[Hypothesis]) -> list[Hypothesis]:
    seen: set[frozenset[str]] = set()
    kept = []
    for item in items:
        key = frozenset(candidate.label for candidate in item.candidates)
        if key not in seen:
            seen.add(key)
            kept.append(item)
    return kept
