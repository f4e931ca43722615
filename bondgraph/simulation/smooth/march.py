"""The march: a smooth model integrated from stretch to stretch, the last good point kept.

Many output times make one call of the integrator. Where that fails, the output
times are reached one by one, and between two of them the stretch is halved until
what stops the run stands at a known time.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy

from ..outcome import Outcome
from ..problem import Options
from .folds import Folds, polished
from .functions import SmoothFunctions, solve_algebraic
from .pieces import Piece
from .plugin import Failed, Plugin, Stretch
from .scales import Sizes

Array = numpy.ndarray

BLOCK = 100  # output times a call: the clock is looked at in between
FEWEST = 4  # with less, a call for each output time is cheaper than another integrator
PATTERNS = 64
# A call cannot be broken off: its steps are bounded by those that fit into the seconds left, which
# are exceeded by what one step less or more costs, and by one that takes longer than the last.
PACE, FASTEST = 3e-5, 1e-6
SCARCE = 8  # steps an output time below which output times are reached one by one
# CasADi's SUNDIALS interfaces take output times within 1e-9 of each other for one.
CLOSEST = 2e-9
STEPS = 5000  # between two output times, before a stretch is halved
STALL = 1e-11  # share of a run: where it takes more steps than STEPS, the run gets nowhere
BOUND = 1e100
# A run that gets nowhere stops where its residuals are as badly determined as this, beside the best.
LOST = 1e-6


class _Stopped(Exception):  # an answer within this module, not an error
    def __init__(self, outcome: Outcome) -> None:
        super().__init__(outcome.value)
        self.outcome = outcome


class March:
    """A run under way.

    Parameters
    ----------
    functions : SmoothFunctions
    plugin : Plugin
    p : (np,) array
    x, z : (n,), (nz,) array
        Consistent values at the start.
    sizes : Sizes
    options : Options
        For max_steps and time_budget.

    Attributes
    ----------
    t, x, z, work
        The last good point; work holds the energies supplied and dissipated, J.
    steps : int
    rows : list of (t, x, z, work)
        Output rows.
    """

    def __init__(
        self,
        functions: SmoothFunctions,
        plugin: Plugin,
        p: Array,
        x: Array,
        z: Array,
        sizes: Sizes,
        options: Options,
    ) -> None:
        self._functions, self._plugin, self._p, self._options = functions, plugin, p, options
        self._sizes = sizes
        self._folds = Folds(functions, p)
        self._began = time.monotonic()
        self._pace = PACE * (1 + functions.n + functions.nz)  # s a step, till it is known
        self.t = self._start = self._stall = 0.0
        self.x, self.z, self.work = x, z, numpy.zeros(2)
        self.steps = 0
        self.rows: list[tuple[float, Array, Array, Array]] = []

    def run(self, parts: Sequence[Piece], times: Array) -> Outcome:
        """Integrate through all pieces; tell how it ended.

        Parameters
        ----------
        parts : sequence of Piece
        times : (nt,) array
            Output times, rising.
        """
        self.t = self._start = parts[0].start
        self._stall = STALL * (parts[-1].end - self._start)
        try:
            for part in parts:
                self._enter(part)
                first, last = numpy.searchsorted(times, (part.start, part.end))
                inner = [float(value) for value in times[first:last]]
                if inner and inner[0] == part.start:
                    self._keep(self.t, self.x, self.z, self.work)
                    inner = inner[1:]
                self._through(part, inner)
            if len(times) and times[-1] == parts[-1].end:
                self._keep(self.t, self.x, self.z, self.work)
        except _Stopped as stop:
            return stop.outcome
        return Outcome.FINISHED

    def _keep(self, t: float, x: Array, z: Array, work: Array) -> None:
        self.rows.append((t, x, z, work))

    def _enter(self, part: Piece) -> None:
        """Make the algebraic variables consistent with the inputs after a jump."""
        if part.jumps and self.t > self._start:
            found = solve_algebraic(self._functions, self.t, self.x, part.curve[0], self._p, self.z)
            if found is None:
                raise _Stopped(Outcome.SINGULAR)
            self.z = found
        self._folds.enter(*self._here(part))

    def _here(self, part: Piece) -> tuple[float, Array, Array, Array, Array]:
        """Return the last good point, and the sizes of its algebraic variables."""
        return self.t, self.x, part.at(self.t), self.z, self._sizes.z

    def _through(self, part: Piece, inner: list[float]) -> None:
        """Pass through a piece and keep rows at the times inside it."""
        targets = [*inner, part.end]
        while targets:
            self._check()
            block = targets[:BLOCK]
            if not self._at_once(part, block):
                for target in block:
                    self._reach(part, target)
                    if target < part.end:
                        self._keep(self.t, self.x, self.z, self.work)
            targets = targets[len(block) :]

    def _at_once(self, part: Piece, block: list[float]) -> bool:
        """Integrate to many output times by one call; False where that is not done."""
        if len(block) < FEWEST or self._plugin.built >= PATTERNS:
            return False
        length = block[-1] - self.t
        limit = self._steps_left() // len(block)
        if limit < STEPS:
            limit = 1 << max(int(limit).bit_length() - 1, 0)  # few integrators serve all
        if limit < SCARCE:
            return False
        shares = [round((target - self.t) / length, 14) for target in block[:-1]]
        pattern = (*shares, 1.0)
        if numpy.diff((0.0, *pattern)).min() <= CLOSEST:
            return False
        try:
            got, z = self._stretch(part, pattern, numpy.array(block), limit)
        except Failed as failure:
            self.steps += failure.steps
            self._check()
            return False
        works = self.work[:, None] + got.work
        for index, target in enumerate(block):
            if target < part.end:
                self._keep(target, got.x[:, index], z[:, index], works[:, index])
        self._arrive(block[-1], got, z)
        return True

    def _reach(self, part: Piece, target: float) -> None:
        """Integrate to one time by as many stretches as it takes."""
        step = target - self.t
        smallest = 16 * numpy.finfo(float).eps * max(abs(self.t), abs(target))
        while self.t < target:
            self._check()
            whole = step >= target - self.t
            end = target if whole else self.t + step
            try:
                limit = max(min(self._steps_left(), STEPS), SCARCE)
                if limit < STEPS:
                    limit = 1 << (limit.bit_length() - 1)
                got, z = self._stretch(part, (1.0,), numpy.array([end]), limit)
            except Failed as failure:
                self.steps += failure.steps
                step = (end - self.t) / (2 if failure.work else 4)
                stalled = failure.work and (
                    step <= self._stall or self._folds.near(*self._here(part), LOST)
                )
                if step <= smallest or stalled:
                    raise _Stopped(self._reason(part, step)) from None
                continue
            self._arrive(end, got, z)
            if got.steps < STEPS / 2:
                step *= 2

    def _steps_left(self) -> int:
        """Steps that the limits leave, of which one counts those that fit into the seconds left."""
        seconds = self._options.time_budget - (time.monotonic() - self._began)
        fitting = min(max(seconds, 0.0) / self._pace, self._options.max_steps)
        return int(max(min(fitting, self._options.max_steps - self.steps), 1))

    def _stretch(
        self, part: Piece, pattern: tuple[float, ...], times: Array, limit: int = STEPS
    ) -> tuple[Stretch, Array]:
        """Integrate over a stretch and check what came out, or raise Failed."""
        entered = time.monotonic()
        try:
            got = self._call(part, pattern, times, min(limit, STEPS))
        except Failed as failure:
            self._timed(failure.steps, entered)
            raise
        self._timed(got.steps, entered)
        if numpy.abs(got.x).max(initial=0.0) > BOUND:
            raise Failed(got.steps)
        return got, self._consistent(part, times, got)

    def _timed(self, steps: int, entered: float) -> None:
        """Learn from a call how long a step takes."""
        if steps >= SCARCE:
            self._pace = max((time.monotonic() - entered) / steps, FASTEST)

    def _call(self, part: Piece, pattern: tuple[float, ...], times: Array, limit: int) -> Stretch:
        return self._plugin(
            pattern,
            (self.t, float(times[-1]) - self.t),
            self.x,
            self.z,
            part.since(self.t),
            self._p,
            (self._sizes.x, self._sizes.z),
            min(limit, max(self._options.max_steps - self.steps, 1)),
        )

    def _consistent(self, part: Piece, times: Array, got: Stretch) -> Array:
        if not self._functions.nz:
            return got.z
        u = part.along(times)
        z = polished(self._functions, times, got.x, u, self._p, got.z)
        last = float(times[-1]), got.x[:, -1], u[:, -1]
        if z is None or not self._folds.keeps(*last, z[:, -1], self._sizes.z):
            raise Failed(got.steps)
        return z

    def _arrive(self, t: float, got: Stretch, z: Array) -> None:
        self.t, self.x, self.z = t, got.x[:, -1], z[:, -1]
        self.work = self.work + got.work[:, -1]
        self.steps += got.steps
        self._sizes.saw(got.x, z)

    def _check(self) -> None:
        if self.steps >= self._options.max_steps:
            raise _Stopped(Outcome.STEP_LIMIT)
        if time.monotonic() - self._began > self._options.time_budget:
            raise _Stopped(Outcome.TIME_BUDGET)

    def _reason(self, part: Piece, step: float) -> Outcome:
        """Tell why not even the shortest stretch can be integrated from here."""
        t, x, u, z, _ = self._here(part)
        if numpy.abs(x).max(initial=0.0) > BOUND**0.5:
            return Outcome.DIVERGED
        rates = self._functions.rates(t, x, z, u, self._p)[0].full().ravel()
        for reach in (0.0, *(step * 2.0 ** numpy.arange(8))):
            found = self._functions.rates(t + reach, x + reach * rates, z, u, self._p)
            if not all(numpy.isfinite(value.full()).all() for value in found):
                return Outcome.NON_FINITE
        if self._folds.turned or self._folds.near(*self._here(part)):
            return Outcome.SINGULAR
        return Outcome.STEP_UNDERFLOW
