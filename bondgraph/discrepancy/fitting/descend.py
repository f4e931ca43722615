"""Levenberg-Marquardt on the chained rows, with bounds; failed runs are rejected steps."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy

from .chain import eliminated, followed, lengths
from .outcome import FitOutcome
from .problem import Misfit, Point, Problem, placed, stacked

Array = numpy.ndarray

LOG_STEP = 1.2  # a positive unknown changes by a factor of 3.3 in one step at most
LEVEL = 1e-7  # share of the misfit that a step must promise


@dataclass(frozen=True, eq=False)
class Iteration:
    """One step of a fit.

    Attributes
    ----------
    number : int
    stage : str
    cost : float
        Misfit after it.
    damping : float
    taken : bool
    values : dict of str to float
        Of the parameters.
    why : str
        Why a run failed, where it did.
    """

    number: int
    stage: str
    cost: float
    damping: float
    taken: bool
    values: dict[str, float] = field(default_factory=dict)
    why: str = ""


@dataclass(eq=False)
class Log:
    """Steps so far, how many more are allowed, and whom to tell."""

    limit: int
    progress: Callable[[Iteration], object] | None = None
    steps: list[Iteration] = field(default_factory=list)

    def add(self, problem: Problem, point: Point, stage: str, misfit: Misfit, lam: float) -> None:
        """Log the step that led to a misfit, infinite where it was not taken."""
        values = problem.unknowns.values(point.z)
        named = dict(zip(problem.unknowns.parameters, values.tolist(), strict=False))
        step = Iteration(
            len(self.steps) + 1, stage, misfit.cost, lam, not misfit.why, named, misfit.why
        )
        self.steps.append(step)
        if self.progress is not None:
            self.progress(step)

    @property
    def full(self) -> bool:
        """Whether no more steps are allowed."""
        return len(self.steps) >= self.limit


def normal_rows(problem: Problem, misfit: Misfit) -> Array:
    """Return the rows over all unknowns of the data alone, start states of segments eliminated."""
    return _reduced(problem, misfit, 0.0)[0]


def _reduced(problem: Problem, misfit: Misfit, lam: float) -> tuple[Array, list]:
    unknowns = problem.unknowns
    q, total = len(unknowns.parameters), len(unknowns.items)
    parts, backs = [], []
    for place, links in enumerate(misfit.links):
        rows, back = eliminated(links, q, lam)
        parts.append(placed(rows, unknowns.own(place), q, total))
        backs.append(back)
    return stacked(parts, total + 1), backs


def step_from(problem: Problem, point: Point, misfit: Misfit, lam: float) -> tuple[Point, float]:
    """Return the point a damped step leads to, within bounds, and the drop it promises."""
    unknowns = problem.unknowns
    rows, backs = _reduced(problem, misfit, lam)
    assert misfit.prior is not None
    rows = numpy.concatenate([rows, misfit.prior])
    free = _free(rows, point.z, unknowns.lower, unknowns.upper)
    step = numpy.zeros(len(point.z))
    size = numpy.sqrt((rows[:, :-1] ** 2).sum(axis=0))
    size[size == 0] = 1.0
    damped = numpy.diag(lam**0.5 * size)
    left = numpy.concatenate([rows[:, :-1], damped])[:, free] / size[free]
    right = numpy.concatenate([-rows[:, -1], numpy.zeros(len(size))])
    logs = numpy.array([item.log for item in unknowns.items])
    low = numpy.maximum(unknowns.lower - point.z, numpy.where(logs, -LOG_STEP, -numpy.inf))
    high = numpy.minimum(unknowns.upper - point.z, numpy.where(logs, LOG_STEP, numpy.inf))
    if free.any():
        step[free] = (
            _within(left, right, low[free] * size[free], high[free] * size[free]) / size[free]
        )
    z = numpy.clip(point.z + step, unknowns.lower, unknowns.upper)
    step = z - point.z
    q = len(unknowns.parameters)
    starts, after = [], 0.0
    for place, (links, back) in enumerate(zip(misfit.links, backs, strict=True)):
        own = step[unknowns.own(place)]
        steps = followed(back, own, step[:q])
        after += lengths(links, [own, *steps], step[:q])
        moved = numpy.array(steps).reshape(point.starts[place].shape)
        starts.append(point.starts[place] + moved)
    rest = misfit.prior @ numpy.append(step, 1.0)
    before = sum(
        lengths(links, [numpy.zeros(link.own) for link in links], numpy.zeros(q))
        for links in misfit.links
    )
    before += float(misfit.prior[:, -1] @ misfit.prior[:, -1])
    return Point(z, tuple(starts)), before - after - float(rest @ rest)


def _within(left: Array, right: Array, low: Array, high: Array) -> Array:
    """Solve least squares in a box; one that is cut off where it leaves the box may promise a rise."""
    step: Array = numpy.linalg.lstsq(left, right, rcond=1e-13)[0]
    if ((step < low) | (step > high)).any() and (low < high).all():
        from scipy.optimize import lsq_linear

        step = lsq_linear(left, right, (low, high), method="bvls").x
    return numpy.clip(step, low, high)


def _free(rows: Array, z: Array, lower: Array, upper: Array) -> Array:
    """Return which unknowns may move: all but those that their bound holds back."""
    slope = rows[:, :-1].T @ rows[:, -1]
    held = ((z <= lower) & (slope > 0)) | ((z >= upper) & (slope < 0))
    return ~held


def descend(
    problem: Problem, point: Point, misfit: Misfit, log: Log, stage: str, most: int, level: float
) -> tuple[Point, Misfit, FitOutcome]:
    """Lower the misfit until no step promises more than a share of it.

    Parameters
    ----------
    problem : Problem
    point : Point
    misfit : Misfit
        There, finite.
    log : Log
    stage : str
        For the log.
    most : int
        Steps of this stage.
    level : float
        Share of the misfit.

    Returns
    -------
    Point
    Misfit
    FitOutcome
    """
    lam, grow = 1e-3, 2.0
    for _ in range(most):
        if log.full:
            return point, misfit, FitOutcome.STEP_LIMIT
        if time.monotonic() > problem.deadline:
            return point, misfit, FitOutcome.TIME_BUDGET
        there, promised = step_from(problem, point, misfit, lam)
        # much damped steps promise little wherever they are
        little = level if lam <= 1e-2 else 1e-4 * level
        if promised <= little * misfit.cost or misfit.cost == 0:
            return point, misfit, _level(problem, point, misfit, level)
        trial = problem(there)
        log.add(problem, there, stage, trial, lam)
        gain = (misfit.cost - trial.cost) / promised
        if gain > 1e-4:
            drop = misfit.cost - trial.cost
            done = drop < level * misfit.cost and gain > 0.25 and lam <= 1e-2
            point, misfit = there, trial
            lam, grow = max(lam * max(1 / 5, 1 - (2 * gain - 1) ** 3), 1e-12), 2.0
            if done:
                return point, misfit, FitOutcome.CONVERGED
        else:
            lam, grow = lam * grow, grow * 2
            if lam > 1e14:
                return point, misfit, _level(problem, point, misfit, level)
    return point, misfit, FitOutcome.STEP_LIMIT


def _level(problem: Problem, point: Point, misfit: Misfit, level: float) -> FitOutcome:
    """Tell a minimum from a place where damping alone has made steps short."""
    _, promised = step_from(problem, point, misfit, 1e-6)
    level_here = promised <= max(1e-3, 100 * level) * misfit.cost
    return FitOutcome.CONVERGED if level_here else FitOutcome.STALLED


def stages(first: float, last: float, count: int) -> Iterator[float]:
    """Yield ever tighter joints.

    Examples
    --------
    >>> [round(float(part), 6) for part in stages(0.1, 0.001, 3)]
    [0.1, 0.01, 0.001]
    """
    yield from numpy.geomspace(first, last, count)
