"""The march: a smooth model integrated from stretch to stretch, the last good point kept.

Many output times make one call of the integrator. Where that fails, the output
times are reached one by one, and between two of them the stretch is halved until
what stops the run stands at a known time.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy

from .dae import SmoothFunctions, solve_algebraic
from .folds import polished, turns
from .outcome import Outcome
from .pieces import Piece
from .plugin import Failed, Plugin, Stretch
from .problem import Options

Array = numpy.ndarray

BLOCK = 100  # output times a call: the clock is looked at in between
FEWEST = 4  # with less, a call for each output time is cheaper than another integrator
PATTERNS = 64
STEPS = 5000  # between two output times, before a stretch is halved
STALL = 1e-11  # share of a run: where it takes more steps than STEPS, the run gets nowhere
BOUND = 1e100
CORRECTIONS = 5
# Of the size first estimated: what stays below is rounding, and no measure of anything.
LEAST = 1e-12
# Beside the largest so far, a smallest singular value of the residuals' Jacobian below the first of
# these shares explains why a run stops; one below the second stops it where steps get nowhere.
SINGULAR, LOST = 1e-2, 1e-6


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
    sizes : ((n,) array, (nz,) array)
        First estimate of how large both become.
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
        sizes: tuple[Array, Array],
        options: Options,
    ) -> None:
        self._functions, self._plugin, self._p, self._options = functions, plugin, p, options
        self._sizes = sizes
        self._floors = LEAST * sizes[0], LEAST * sizes[1]
        self._seen = numpy.abs(x), numpy.abs(z)
        self._sign = 0.0
        self._rows_scale = numpy.ones(functions.nz)
        self._best = 0.0
        self._turned = False
        self._began = time.monotonic()
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
        if not self._functions.nz:
            return
        if part.jumps and self.t > self._start:
            found = solve_algebraic(self._functions, self.t, self.x, part.u, self._p, self.z)
            if found is None:
                raise _Stopped(Outcome.SINGULAR)
            self.z = found
        signs, matrices = self._turns(part, numpy.array([self.t]), self.x, self.z)
        self._sign = float(signs[0])
        if not self._best:
            self._weigh(part)
        self._best = max(self._best, self._determined(matrices[0]))

    def _weigh(self, part: Piece) -> None:
        """Take the scale of each residual, and how well determined all are, from this point."""
        if not self._functions.nz:
            return
        matrix = self._turns(part, numpy.array([self.t]), self.x, self.z)[1][0]
        largest = numpy.abs(matrix * self._sizes[1]).max(axis=1)
        self._rows_scale = numpy.where(largest > 0, largest, 1.0)
        self._best = self._determined(matrix)

    def _through(self, part: Piece, inner: list[float]) -> None:
        """Pass through a piece and keep rows at the times inside it."""
        targets = [*inner, part.end]
        while targets:
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
        shares = [round((target - self.t) / length, 14) for target in block[:-1]]
        pattern = (*shares, 1.0)
        if numpy.diff((0.0, *pattern)).min() <= 0:
            return False
        try:
            got, z = self._stretch(part, pattern, numpy.array(block))
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
        step = length = target - self.t
        smallest = 16 * numpy.finfo(float).eps * max(abs(self.t), abs(target))
        while self.t < target:
            self._check()
            whole = step >= target - self.t
            end = target if whole else self.t + step
            try:
                got, z = self._stretch(part, (1.0,), numpy.array([end]), cut=step < length)
            except Failed as failure:
                self.steps += failure.steps
                step = (end - self.t) / (2 if failure.work else 4)
                stalled = failure.work and (step <= self._stall or self._lost(part))
                if step <= smallest or stalled:
                    raise _Stopped(self._reason(part, step)) from None
                continue
            self._arrive(end, got, z)
            if got.steps < STEPS / 2:
                step *= 2

    def _stretch(
        self, part: Piece, pattern: tuple[float, ...], times: Array, *, cut: bool = False
    ) -> tuple[Stretch, Array]:
        """Integrate over a stretch and check what came out, or raise Failed.

        A stretch cut short after a failure does not tell the size of algebraic variables.
        """
        got = self._integrated(part, pattern, times)
        for _ in range(CORRECTIONS):
            if self._fits(got, cut):
                break
            self.steps += got.steps
            self._weigh(part)
            got = self._integrated(part, pattern, times)
        if numpy.abs(got.x).max(initial=0.0) > BOUND:
            raise Failed(got.steps)
        return got, self._consistent(part, times, got)

    def _integrated(self, part: Piece, pattern: tuple[float, ...], times: Array) -> Stretch:
        return self._plugin(
            pattern,
            (self.t, float(times[-1]) - self.t),
            self.x,
            self.z,
            (part.u + part.slope * (self.t - part.start), part.slope),
            self._p,
            self._sizes,
            min(STEPS, max(self._options.max_steps - self.steps, 1)),
        )

    def _consistent(self, part: Piece, times: Array, got: Stretch) -> Array:
        if not self._functions.nz:
            return got.z
        u = part.u[:, None] + part.slope[:, None] * (times - part.start)
        z = polished(self._functions, times, got.x, u, self._p, got.z)
        if z is None:
            raise Failed(got.steps)
        signs, matrices = self._turns(part, times, got.x, z)
        if (signs * self._sign < 0).any():
            self._turned = True
            raise Failed(got.steps)
        self._sign = self._sign or float(signs[-1])
        self._best = max(self._best, self._determined(matrices[-1]))
        return z

    def _fits(self, got: Stretch, cut: bool) -> bool:
        """Whether the sizes estimated fit what came out so far; where not, correct them."""
        fits = True
        corrected = []
        sides = zip(self._sizes, self._floors, self._seen, (got.x, got.z), strict=True)
        for index, (size, floor, seen, values) in enumerate(sides):
            largest = numpy.fmax(seen, numpy.abs(values).max(axis=1, initial=0.0))
            low = numpy.fmax(numpy.fmax(largest, 1e-6 * size), floor)
            wrong = (size > 100 * low) & (largest > 0)
            if cut and index:
                wrong[:] = False
            fits = fits and not wrong.any()
            corrected.append(numpy.where(wrong, low, size))
        self._sizes = corrected[0], corrected[1]
        return fits

    def _arrive(self, t: float, got: Stretch, z: Array) -> None:
        self.t, self.x, self.z = t, got.x[:, -1], z[:, -1]
        self.work = self.work + got.work[:, -1]
        self.steps += got.steps
        self._seen = (
            numpy.fmax(self._seen[0], numpy.abs(got.x).max(axis=1, initial=0.0)),
            numpy.fmax(self._seen[1], numpy.abs(z).max(axis=1, initial=0.0)),
        )
        self._sizes = (
            numpy.fmax(self._sizes[0], self._seen[0]),
            numpy.fmax(self._sizes[1], self._seen[1]),
        )

    def _check(self) -> None:
        if self.steps >= self._options.max_steps:
            raise _Stopped(Outcome.STEP_LIMIT)
        if time.monotonic() - self._began > self._options.time_budget:
            raise _Stopped(Outcome.TIME_BUDGET)

    def _reason(self, part: Piece, step: float) -> Outcome:
        """Tell why not even the shortest stretch can be integrated from here."""
        u = part.u + part.slope * (self.t - part.start)
        ahead, x = self.t, self.x
        rates = self._functions.rates(self.t, self.x, self.z, u, self._p)[0].full().ravel()
        if numpy.abs(self.x).max(initial=0.0) > BOUND**0.5:
            return Outcome.DIVERGED
        for reach in step * 2.0 ** numpy.arange(8):
            found = self._functions.rates(ahead, x, self.z, u, self._p)
            if not all(numpy.isfinite(value.full()).all() for value in found):
                return Outcome.NON_FINITE
            ahead, x = self.t + reach, self.x + reach * rates
        if self._turned or self._lost(part, SINGULAR):
            return Outcome.SINGULAR
        return Outcome.STEP_UNDERFLOW

    def _lost(self, part: Piece, share: float = LOST) -> bool:
        """Whether the residuals hardly determine the algebraic variables any more."""
        if not self._functions.nz:
            return False
        matrix = self._turns(part, numpy.array([self.t]), self.x, self.z)[1][0]
        return self._determined(matrix) <= share * self._best

    def _turns(self, part: Piece, times: Array, x: Array, z: Array) -> tuple[Array, Array]:
        u = part.u[:, None] + part.slope[:, None] * (times - part.start)
        shape = (-1, len(times))
        return turns(self._functions, times, x.reshape(shape), u, self._p, z.reshape(shape))

    def _determined(self, matrix: Array) -> float:
        """Return how well the residuals determine the algebraic variables."""
        scaled = matrix * self._sizes[1] / self._rows_scale[:, None]
        if not numpy.isfinite(scaled).all():
            return 0.0
        return float(numpy.linalg.svd(scaled, compute_uv=False).min())
