"""From the start to a minimum: single shots where they bear, segments where they do not."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy

from .descend import Log, descend, stages
from .outcome import FitOutcome
from .problem import Misfit, Point, Problem
from .segments import UNEXPLAINED, joined, parts_for, too_wild, unexplained
from .shots import cut

Array = numpy.ndarray

LOOSE, TIGHT, STAGES = 0.1, 1e-5, 9
# Segments in shares of their usual number, and steps between tightenings
ATTEMPTS = ((1.0, 4), (1.0, 15), (1.5, 8), (0.5, 8))
NEAR = 12  # other starts tried where the first does not run
LEVEL = 1e-7  # share of the misfit that a step must promise


@dataclass(frozen=True, eq=False)
class Found:
    """A point and how the search for it ended."""

    problem: Problem
    point: Point
    misfit: Misfit
    outcome: FitOutcome
    remark: str = ""

    @property
    def gap_closed(self) -> bool:
        """Whether every recording is one shot."""
        return all(len(row) == 1 for row in self.problem.segments)

    def again(self, problem: Problem, point: Point, misfit: Misfit, log: Log) -> Found:
        """Go on from a point with other weights."""
        point, misfit, outcome = descend(problem, point, misfit, log, "weights", 50, LEVEL)
        return replace(self, problem=problem, point=point, misfit=misfit, outcome=outcome)


def searched(problem: Problem, z: Array, parts: int | None, log: Log) -> Found:
    """Search from a start.

    Parameters
    ----------
    problem : Problem
        Of single shots.
    z : (q,) array
    parts : int or None
        Segments of each recording; None to decide here.
    log : Log

    Returns
    -------
    Found
    """
    recordings = problem.gun.recordings
    states = len(problem.states)
    if parts is not None and parts > 1:
        return _best(problem, z, [parts] * len(recordings), log)
    point = _single(problem, z)
    misfit = problem(point)
    log.add(problem, point, "start", misfit, 0.0)
    counts = [parts_for(recording, states) for recording in recordings]
    if parts is None and too_wild(misfit, problem):
        found = _best(problem, z, counts, log)
        if explained(found):
            return found
    one = _shot_at_once(problem, point, misfit, log)
    if parts is not None or log.full or max(counts) < 2 or explained(one):
        return one
    other = _best(problem, z, counts, log)
    return other if other.misfit.cost < one.misfit.cost else one


def explained(found: Found) -> bool:
    """Whether most of what the data do is in the model's run."""
    if not math.isfinite(found.misfit.cost):
        return False
    return unexplained(found.misfit, found.problem) < UNEXPLAINED


def _best(problem: Problem, z: Array, counts: Sequence[int], log: Log) -> Found:
    """Try segments, and where they leave much unexplained try others: there are many minima."""
    best = None
    for share, steps in ATTEMPTS:
        parts = [max(2, round(share * count)) for count in counts]
        found = _shot_in_parts(problem, z, parts, steps, log)
        if best is None or found.misfit.cost < best.misfit.cost:
            best = found
        if log.full or time.monotonic() > problem.deadline or explained(best):
            break
    assert best is not None
    return best


def _single(problem: Problem, z: Array) -> Point:
    n = len(problem.states)
    return Point(z, tuple(numpy.zeros((0, n)) for _ in problem.gun.recordings))


def _shot_at_once(problem: Problem, point: Point, misfit: Misfit, log: Log) -> Found:
    """Fit with single shots; where the start does not run, from the nearest that does."""
    rng = numpy.random.default_rng(0)
    first, tries = point, 0
    while not math.isfinite(misfit.cost) and tries < NEAR and not log.full:
        tries += 1
        moved = first.z + rng.normal(0, 0.2 * tries, len(first.z)) * _sizes(problem, first.z)
        z = numpy.clip(moved, problem.unknowns.lower, problem.unknowns.upper)
        point = Point(z, first.starts)
        misfit = problem(point)
        log.add(problem, point, "near the start", misfit, 0.0)
    if not math.isfinite(misfit.cost):
        return Found(problem, first, misfit, FitOutcome.NO_START, misfit.why)
    point, misfit, outcome = descend(problem, point, misfit, log, "single", log.limit, LEVEL)
    remark = "the start values do not run, another start near them was taken" if tries else ""
    return Found(problem, point, misfit, outcome, remark)


def _sizes(problem: Problem, z: Array) -> Array:
    logs = numpy.array([item.log for item in problem.unknowns.items], dtype=bool)
    return numpy.where(logs, 1.0, numpy.abs(z))


def _shot_in_parts(problem: Problem, z: Array, parts: Sequence[int], steps: int, log: Log) -> Found:
    """Fit with segments whose joints are tightened, then try a single shot from there."""
    begun = joined(problem, z, parts)
    if begun.why:
        none = Misfit(math.inf, why=begun.why)
        return Found(problem, _single(problem, z), none, FitOutcome.NO_START, begun.why)
    point, outcome = begun.point, FitOutcome.CONVERGED
    tight, misfit = begun.problem, Misfit(math.inf)
    for allowed in stages(LOOSE, TIGHT, STAGES):
        tight = begun.problem.with_(tightness=allowed)
        misfit = tight.weighed(point, misfit.shots) if misfit.shots else tight(point)
        if not math.isfinite(misfit.cost):
            return Found(tight, point, misfit, FitOutcome.NO_START, misfit.why)
        name = f"joints {allowed:.0e}"
        point, misfit, outcome = descend(tight, point, misfit, log, name, steps, 1e-3)
        if log.full or outcome is FitOutcome.TIME_BUDGET:
            return _joined_up(problem, Found(tight, point, misfit, outcome), log)
    found = _joined_up(problem, Found(tight, point, misfit, outcome), log)
    if found.gap_closed or log.full:
        return found
    point, misfit, outcome = descend(tight, point, misfit, log, "joints", 60, LEVEL)
    return _joined_up(problem, Found(tight, point, misfit, outcome), log)


def _joined_up(problem: Problem, found: Found, log: Log) -> Found:
    """Take the single shot where it comes as near as the segments did."""
    single = problem.with_(
        segments=tuple(cut(row, i, 1) for i, row in enumerate(problem.gun.recordings)),
        scale=found.problem.scale,
    )
    point = _single(problem, found.point.z)
    misfit = single(point)
    log.add(single, point, "one shot", misfit, 0.0)
    if math.isfinite(misfit.cost):
        point, misfit, outcome = descend(single, point, misfit, log, "one shot", 60, LEVEL)
        if misfit.cost <= 1.1 * found.misfit.cost:
            return Found(single, point, misfit, outcome)
    remark = f"left in segments, as one shot does not follow (largest break {found.misfit.gap:.1e})"
    return replace(found, remark=remark)
