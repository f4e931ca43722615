"""Courses of a model's states that follow recordings, with the model's own parameters fitted along.

How much the model may err is found from the data: the error whose likelihood is greatest.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy

from ...equations import derive
from ...errors import BondGraphError, SimulationError
from ...simulation import CompiledModel, simulate
from .functions import Functions, Points
from .grid import Grid, grid_of
from .linear import Along, along
from .smooth import Smoothed, Weights, smoothed
from .table import Table

Array = numpy.ndarray

ERRORS = (1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)  # of a rate, each sample its own
EASING = (0.3, 0.3, 0.1, 0.1, 0.03, 0.03, 0.01, 0.01, 3e-3, 1e-3)
ROUNDS = 6
SECTION = 4096  # times that are smoothed at once
MOST = 24576  # times in all that are screened
ENOUGH = 8400  # times in all that a fit is eased in on
TURN = 0.3  # rad of the fastest oscillation in a step
LOOSE = 0.4  # of own parameters, standard deviation of their logarithm
LEAST_TURN = 1e-9
SEEN = 0.02  # of what is told best
PATIENCE = 4.0  # seconds for the first course
LONGEST = 0.5  # step of a parameter's logarithm
REST = 1e-2  # error of rates that no site reaches, over that of those which one does


@dataclass(frozen=True, eq=False)
class Record:
    """One recording in the model's terms.

    Attributes
    ----------
    name : str
    t : (ns,) array, s
    measured : (ns, ny) array
        SI; NaN at gaps.
    noise : (ny,) array
    inputs : mapping
    initial : mapping of str to float
        What is known of the start.
    guess : mapping of str to float
        Where a run may start that is the first course.
    """

    name: str
    t: Array
    measured: Array
    noise: Array
    inputs: Mapping[str, Any] = field(default_factory=dict)
    initial: Mapping[str, float] = field(default_factory=dict)
    guess: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Course:
    """States along one recording, or a section of one.

    Attributes
    ----------
    record : Record
    grid : Grid
    x : (nt, n) array
    start : (n,) array
        What is believed of the first state; NaN where nothing is known.
    """

    record: Record
    grid: Grid
    x: Array
    start: Array


@dataclass(frozen=True, eq=False)
class Relaxed:
    """Recordings followed by a model that may err.

    Attributes
    ----------
    functions : Functions
    table : Table
    values : (p,) array
        Coordinates of the own parameters.
    courses : tuple of Course
    error : float
        Of the model, as a share of rates, each sample its own.
    ways : (n, n) array
        Covariance of the directions in which the model errs, for an error of one.
    likelihood : float
        Twice the negative logarithm, but for a constant.
    """

    functions: Functions
    table: Table
    values: Array
    courses: tuple[Course, ...]
    error: float
    ways: Array
    likelihood: float

    def linear(self) -> Iterator[tuple[Course, Along, Points, Points]]:
        """Yield each course with the model linearised along it."""
        for course in self.courses:
            found = along(
                self.functions,
                course.grid,
                course.x,
                self.table.vector(self.values),
                course.record.measured,
            )
            yield course, *found

    def said(self, course: Course) -> Array:
        """Return the outputs along a course at the times of its record, (ns, ny)."""
        at, grid = course.grid.samples, course.grid
        p = self.table.vector(self.values)
        return self.functions.at(grid.t[at], course.x[at], grid.before[at], p).outputs

    def weights(self, course: Course, error: float | None = None) -> Weights:
        """Return what the smoother trusts."""
        error = self.error if error is None else error
        interval = float(numpy.median(numpy.diff(course.record.t)))
        start = numpy.where(
            numpy.isfinite(course.start), 1e-3 * numpy.ptp(course.x, axis=0), numpy.inf
        )
        start = numpy.where(start > 0, start, numpy.inf)
        return Weights(error**2 * interval * self.ways, course.record.noise, start)

    def moved(self, course: Course, found: Along, error: float | None = None) -> Smoothed:
        """Smooth one course."""
        off = numpy.where(numpy.isfinite(course.start), course.start - course.x[0], 0.0)
        h = numpy.diff(course.grid.t)
        return smoothed(found, h, course.grid.samples, self.weights(course, error), off)


def relaxed(
    model: CompiledModel,
    records: Sequence[Record],
    outputs: Sequence[str],
    free: Sequence[str],
    sites: Sequence[str],
    errs: Sequence[bool],
    parameters: Mapping[str, float] | None = None,
    runs: CompiledModel | None = None,
    rounds: int = ROUNDS,
) -> Relaxed:
    """Follow recordings with a model that may err at some sites, its own parameters free.

    Parameters
    ----------
    model : CompiledModel
    records : sequence of Record
    outputs : sequence of str
        The measured ones.
    free : sequence of str
        Own parameters that may be wrong.
    sites : sequence of str
        Parameters whose value is zero: efforts and flows.
    errs : sequence of bool
        Through which of them the model may err.
    parameters : mapping, optional
        Values to start from.
    runs : CompiledModel, optional
        The model without probes, whose run is the first course.
    rounds : int
        Of smoothing; with none the courses are the model's own runs, and it hardly errs.

    Returns
    -------
    Relaxed

    Raises
    ------
    SimulationError
        Where the model keeps algebraic variables, or does not run from any start.
    """
    table = Table(model, tuple(free), dict(parameters or {}))
    functions = Functions(derive(model.equations.graph), outputs, table.used + tuple(sites))
    courses = _spread(
        [part for record in records for part in _begun(runs or model, functions, record, table)]
    )
    found = Relaxed(functions, table, table.start, courses, 1.0, numpy.eye(1), numpy.inf)
    found = replace(found, ways=_ways(found, errs))
    best = found
    if not rounds:
        return replace(found, error=ERRORS[0])
    for number in range(rounds):
        errors = (1.0, 0.1) if number == 0 else ERRORS
        found = _stepped(found, errors, moving=False)
        better = found.likelihood < best.likelihood - 1e-3 * abs(best.likelihood)
        if number < 2 or better:
            best = found
        if number >= 2 and not better:
            break
    return best


def followed(found: Relaxed, record: Record) -> Course:
    """Follow another recording with the same parameters and the same error; its first section."""
    model = found.table.model
    course = next(_begun(model, found.functions, record, found.table))
    alone = replace(found, courses=(course,))
    for _ in range(2):
        try:
            alone = _stepped(alone, (max(found.error, ERRORS[1]),), moving=False)
        except SimulationError:
            break
    return alone.courses[0]


def eased(
    model: CompiledModel,
    records: Sequence[Record],
    outputs: Sequence[str],
    free: Sequence[str],
    parameters: Mapping[str, float],
    ways: Mapping[tuple[str, str], float],
) -> Relaxed:
    """Fit parameters while the model's error is made ever smaller.

    With a large error the states stay near the data and the fit is nearly linear; with a small one
    it is that of the model's own run. A fit of runs alone, from the same start, is often caught in
    a minimum on the way.

    Parameters
    ----------
    model : CompiledModel
    records, outputs, free, parameters
        As for `relaxed`.
    ways : mapping of (str, str) to float
        Covariance of the directions in which the model errs, by pairs of states.

    Returns
    -------
    Relaxed
    """
    table = Table(model, tuple(free), dict(parameters))
    functions = Functions(derive(model.equations.graph), outputs, table.used)
    parts = _spread(
        [part for record in records for part in _begun(model, functions, record, table)],
        ENOUGH,
    )
    found = Relaxed(functions, table, table.start, parts, 1.0, numpy.eye(1), numpy.inf)
    size = numpy.concatenate([lines.rates for _, lines, _, _ in found.linear()])
    least = REST * numpy.sqrt((size**2).mean(axis=0))
    spread = numpy.diag(numpy.maximum(least, 1e-9 * least.max(initial=1e-300)) ** 2)
    names = [state.name for state in model.equations.states]
    for i, one in enumerate(names):
        for j, other in enumerate(names):
            spread[i, j] += ways.get((one, other), 0.0)
    found = replace(found, ways=spread)
    unseen = _unseen(found)
    found = _stepped(found, (1.0,), moving=False)
    found = _stepped(found, (0.3,), moving=False)
    for error in EASING:
        found = _stepped(found, (error,), moving=True, unseen=unseen)
    return found


def _begun(
    model: CompiledModel, functions: Functions, record: Record, table: Table
) -> Iterator[Course]:
    """Lay grids, with the model's own run as the first course, where it runs."""
    given = table.given(table.start)
    step = TURN / max(_turning(functions, table, record), LEAST_TURN)
    whole = grid_of(functions.equations, record.t, record.inputs, step)
    names = [state.name for state in functions.equations.states]
    own = {symbol.name for symbol in model.equations.graph.parameters}
    known = dict(record.initial)
    guess = {**_first_states(functions, whole, record, table), **record.guess}
    start = numpy.array([known.get(name, numpy.nan) for name in names])
    try:
        run = simulate(
            model,
            (record.t[0], record.t[-1]),
            {name: value for name, value in given.items() if name in own},
            known | {name: value for name, value in guess.items() if name in names},
            record.inputs,
            t_eval=record.t,
            time_budget=PATIENCE,
        )
        x = numpy.array([numpy.interp(whole.t, run.t, row) for row in run.x]).T
        sound = numpy.isfinite(x).all() and len(run.t) > 1
    except BondGraphError:
        sound = False
    if not sound:
        x = numpy.tile(numpy.nan_to_num(start), (len(whole), 1)).reshape(len(whole), len(names))
    for first in range(0, max(len(whole) - 1, 1), SECTION):
        last = min(first + SECTION, len(whole) - 1)
        if first and last - first < SECTION // 8:
            break
        if len(whole) - 1 - last < SECTION // 8:
            last = len(whole) - 1
        inside = (whole.samples >= first) & (whole.samples <= last)
        part = slice(first, last + 1)
        grid = Grid(
            whole.t[part], whole.samples[inside] - first, whole.before[part], whole.after[part]
        )
        section = replace(record, t=record.t[inside], measured=record.measured[inside])
        begun = start if first == 0 else numpy.full(len(names), numpy.nan)
        yield Course(section, grid, x[part], begun)


def _first_states(
    functions: Functions, grid: Grid, record: Record, table: Table
) -> dict[str, float]:
    """Return states that give the first samples, those not needed as the model has them."""
    names = [state.name for state in functions.equations.states]
    x = numpy.array(table.model.initial_state(table.resolved(table.start), dict(record.initial)))
    at = functions.at(grid.t[:1], x[None], grid.after[:1], table.vector(table.start))
    off = record.measured[0] - at.outputs[0]
    there = numpy.isfinite(off)
    free = [i for i, name in enumerate(names) if name not in record.initial]
    seen = at.outputs_x[0][there][:, free] / record.noise[there, None]
    if seen.size and numpy.isfinite(seen).all():
        x[free] += numpy.linalg.lstsq(seen, off[there] / record.noise[there], rcond=1e-9)[0]
    return dict(zip(names, x.tolist(), strict=True))


def _spread(courses: Sequence[Course], most: int = MOST) -> tuple[Course, ...]:
    """Keep sections of all recordings, no more than are needed to screen.

    The first of each recording stays, for where it starts; of the others those in which the
    recording moves most.
    """
    total = sum(len(course.grid) for course in courses)
    if total <= most:
        return tuple(courses)
    firsts = [
        i for i, c in enumerate(courses) if not i or c.record.name != courses[i - 1].record.name
    ]
    others = [i for i in range(len(courses)) if i not in firsts]
    others.sort(key=lambda i: -_movement(courses[i].record))
    kept, room = set(firsts), most - sum(len(courses[i].grid) for i in firsts)
    for i in others:
        if room < len(courses[i].grid):
            break
        kept.add(i)
        room -= len(courses[i].grid)
    return tuple(courses[i] for i in sorted(kept))


def _movement(record: Record) -> float:
    return float(numpy.nansum(numpy.nanvar(record.measured, axis=0) / record.noise**2))


def _turning(functions: Functions, table: Table, record: Record) -> float:
    """Return the fastest oscillation that is hardly damped, rad/s, at the model's start."""
    x = numpy.array(
        table.model.initial_state(table.resolved(table.start), dict(record.initial))
    ).reshape(1, -1)
    u = grid_of(functions.equations, record.t[:2], record.inputs).after[:1]
    found = functions.at(record.t[:1], x, u, table.vector(table.start))
    poles = numpy.linalg.eigvals(found.rates_x[0]) if found.rates_x.size else numpy.zeros(0)
    swings = numpy.abs(poles.imag) > 0.5 * numpy.abs(poles.real)
    interval = float(numpy.median(numpy.diff(record.t)))
    slow = numpy.abs(poles.imag) * interval < 3.0  # faster ones than samples tell are not followed
    return float(numpy.abs(poles.imag[swings & slow]).max(initial=0.0))


def _ways(found: Relaxed, errs: Sequence[bool]) -> Array:
    """Return directions of the model's error: efforts and flows at the sites, each by its size."""
    pushes, rates = [], []
    for _, course, before, _ in found.linear():
        rates.append(course.rates)
        pushes.append(before.rates_p[:, :, before.rates_p.shape[2] - len(errs) :])
    size = numpy.sqrt((numpy.concatenate(rates) ** 2).mean(axis=0))
    size = numpy.maximum(size, 1e-9 * size.max(initial=1e-300))
    push = numpy.sqrt((numpy.concatenate(pushes) ** 2).mean(axis=0))
    signs = numpy.sign(numpy.concatenate(pushes).sum(axis=0))
    ways = numpy.diag((REST * size) ** 2)
    for j in numpy.flatnonzero(errs):
        share = float((push[:, j] / size).max(initial=0.0))
        if share > 0:
            way = push[:, j] * signs[:, j] / share
            ways += numpy.outer(way, way)
    return ways


def _stepped(
    found: Relaxed, errors: Sequence[float], *, moving: bool, unseen: Array | None = None
) -> Relaxed:
    """Move states and parameters once, with the error that is likeliest."""
    linear = [(course, _own(found, lines)) for course, lines, _, _ in found.linear()]
    prior = found.table.prior(found.values, LOOSE)
    best: tuple[float, float, Array, list[Smoothed]] | None = None
    for error in errors:
        try:
            parts = [found.moved(course, lines, error) for course, lines in linear]
        except SimulationError:
            continue
        rows = numpy.concatenate([prior, *(part.rows for part in parts)])
        change = _least(rows)
        rest = float(((rows[:, -1] - rows[:, :-1] @ change) ** 2).sum())
        count = sum(part.count for part in parts)
        likelihood = count * numpy.log(max(rest, 1e-300) / count)
        likelihood += sum(part.log_det for part in parts)
        if best is None or likelihood < best[0]:
            best = likelihood, error, change, parts
    if best is None:
        raise SimulationError("no error of the model lets its states be smoothed")
    likelihood, error, change, parts = best
    if unseen is not None:
        change = change - unseen.T @ (unseen @ change)
    longest = float(numpy.abs(change).max(initial=0.0))
    change = change * (min(1.0, LONGEST / longest) if moving and longest > 0 else 0.0)
    courses = tuple(
        replace(course, x=course.x + part.moves[..., -1] + part.moves[..., :-1] @ change)
        for (course, _), part in zip(linear, parts, strict=True)
    )
    return replace(
        found,
        values=found.values + change,
        courses=courses,
        error=error,
        likelihood=float(likelihood),
    )


def _unseen(found: Relaxed) -> Array | None:
    """Return directions of the own parameters that runs do not tell, shape (k, p).

    Forces, masses and stiffnesses of one scale, say, where no effort is known. Along a course that
    is not the model's own run they seem to be told, by how far it errs; so the course is the run.
    """
    try:
        parts = [
            found.moved(course, _own(found, lines), 1.0).rows[:, :-1]
            for course, lines, _, _ in found.linear()
        ]
    except SimulationError:
        return None
    _, size, across = numpy.linalg.svd(
        numpy.linalg.qr(numpy.concatenate(parts), mode="r"), full_matrices=False
    )
    return numpy.asarray(across[size < SEEN * size.max(initial=0.0)])


def _own(found: Relaxed, lines: Along) -> Along:
    """Return the model with the own parameters' coordinates as what may change."""
    slopes = found.table.slopes(found.values)
    used = slopes.shape[0]
    return lines.with_columns(lines.forced[:, :, :used] @ slopes, lines.felt[:, :, :used] @ slopes)


def _least(rows: Array) -> Array:
    if rows.shape[1] == 1:
        return numpy.zeros(0)
    size = numpy.linalg.norm(rows[:, :-1], axis=0)
    size[size == 0] = 1.0
    return numpy.linalg.lstsq(rows[:, :-1] / size, rows[:, -1], rcond=1e-10)[0] / size
