"""The integrator of ``driver.c`` and ``kernel.c`` once more, in Python: change both together.

It runs where there is no compiler, and where an input is a Python callable. The same algorithm with
the same names, so that either may be read beside the other; the reasons stand in the C. Sums are
taken in the same order, so both give the same bits, and a test asks for that.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from .outcome import Outcome

if TYPE_CHECKING:
    from .problem import Options, Problem

__all__ = ["Stepper"]

FAC_MIN, FAC_MAX, SAFETY, BETA = 0.2, 5.0, 0.9, 0.04
# A first step may grow so often, by so much, where it is shorter than such a share of the run.
MAX_GROWTHS, GROWTH, SHORT = 8, 32.0, 1e-9
WOBBLE = 1.0 / 1048576.0
MAX_BAD, MAX_SHRINKS, MAX_HALVINGS = 20, 6, 6
EPSILON, TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)

# Dormand and Prince (1980): nodes, stages, error, and Shampine's dense output.
C = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0)
A = tuple(
    np.array(row)
    for row in (
        [],
        [1 / 5],
        [3 / 40, 9 / 40],
        [44 / 45, -56 / 15, 32 / 9],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
    )
)
B = np.array([35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84])
E = np.array(
    [71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40],
)
D = np.array(
    [
        -12715105075 / 11282082432,
        0,
        87487479700 / 32700410799,
        -10690763975 / 1880347072,
        701980252875 / 199316789632,
        -1453857185 / 822651844,
        69997945 / 29380423,
    ]
)
Array = np.ndarray
Model = Callable[[float, Array, Array, Array, Array], Array]


class _End(Exception):
    """The run is over."""

    def __init__(self, outcome: Outcome) -> None:
        super().__init__(outcome)
        self.outcome = outcome


class _Retry(Exception):
    """The step is to be tried again, with the length now in `h`."""


def _ulp(t: float) -> float:
    return EPSILON * max(abs(t), TINY)


def _weighted(weights: Array, rows: Array) -> Array:
    """Sum of rows with weights, added one after the other."""
    return np.add.reduce(weights[:, None] * rows, axis=0)


def _differences(rows: Array) -> Array:
    """Newton's forward differences of orders 0 to 4."""
    found = [rows[0]]
    while len(rows) > 1:
        rows = rows[1:] - rows[:-1]
        found.append(rows[0])
    return np.array(found)


def _signs(values: Array) -> Array:
    return np.where(values < 0, -1, 1)


class Stepper:
    """One run of the event-driven integrator.

    Parameters
    ----------
    problem, options
        As for `hybrid.integrate`, checked already.
    model : callable
        mask of stuck switches -> (rhs, guard), each ``(t, x, u, p, s) -> array``.
    """

    def __init__(
        self, problem: Problem, options: Options, model: Callable[[int], tuple[Model, Model]]
    ) -> None:
        self.n, self.k = problem.modes.n, problem.modes.k
        n, k = self.n, self.k
        self.model = model
        self.parameters = problem.parameters
        self.options = options
        self.inputs, self.knots, self.values, self.shapes, self.jumps = problem.input_table()
        self.t_eval: Array | None = options.t_eval
        self.weights, self.energy0 = problem.weights_or_zero(), float(problem.energy0)
        self.t, self.t_end = float(problem.t_span[0]), float(problem.t_span[1])
        self.t_begin = self.t
        self.x = np.concatenate([problem.x0, [0.0, 0.0]])
        self.energy = abs(self.energy0)
        self.floor = np.maximum(
            1e-3 * np.abs(problem.x0), 1e-7 * self.weights * math.sqrt(2 * self.energy)
        )
        self.knot = -1
        while self.knot + 1 < len(self.knots) and self.knots[self.knot + 1] <= self.t:
            self.knot += 1

        scatter = 0.5 + np.modf(np.arange(n) * 0.6180339887498949)[0]
        self.wobble = WOBBLE * np.where(np.arange(n) % 2, -scatter, scatter)
        self.code = np.zeros(k, dtype=int)
        self.K = np.zeros((7, n + 2))
        self.dense = np.zeros((5, n + 2))
        self.sample = np.zeros((5, 2 * k))
        self.noise = np.zeros(k)
        self.armed = np.zeros(k, dtype=bool)
        self.armed_low = np.zeros(k, dtype=bool)
        self.fired = np.zeros(k, dtype=bool)
        self.fresh = np.zeros(k, dtype=bool)
        window = 64 + 8 * k
        self.instants: deque[float] = deque(maxlen=window)

        self.h, self.log_error = 0.0, math.log(1e-4)
        self.bad = self.shrinks = self.halvings = self.futile = self.growths = 0
        self.h_first = self.last_error = 0.0
        self.after_rejection = self.started = self.keep_step = False
        self.steps = self.rejected = self.evaluations = self.next_eval = 0
        self.record: list[Array] | None = [] if options.record else None
        self.rows: list[Array] = []
        self.row_codes: list[Array] = []
        self.events: list[tuple[float, int, int, int, Array]] = []

    def run(self) -> Outcome:
        """Integrate to the end, or to whatever stops it."""
        deadline = time.monotonic() + self.options.time_budget
        # Overflow in a trial step is judged by its result, not announced.
        with np.errstate(all="ignore"):
            try:
                if not np.isfinite(self.x).all():
                    raise _End(Outcome.NON_FINITE)
                self.classify()
                while True:
                    self.step()
                    if time.monotonic() > deadline:
                        raise _End(Outcome.TIME_BUDGET)
            except _End as end:
                self.finish()
                return end.outcome

    # ------------------------------------------------------------------ model

    def input_at(self, t: float) -> Array:
        """Inputs at t, which lies in the interval after the present knot."""
        if self.inputs is not None:
            return np.asarray(self.inputs(t), dtype=float)
        i = self.knot
        if i < 0 or i + 1 >= len(self.knots):
            return self.values[max(i, 0)] if len(self.values) else np.zeros(0)
        s, (slope, bend, twist) = t - self.knots[i], self.shapes[i]
        return self.values[i] + s * (slope + s * (bend + s * twist))

    def functions(self, code: Array) -> tuple[Model, Model]:
        """Of the mode in which exactly the switches with code 0 stick."""
        return self.model(sum(1 << int(j) for j in np.flatnonzero(code == 0)))

    def rhs(self, t: float, x: Array) -> Array:
        """Slope and powers in the present mode."""
        self.evaluations += 1
        return self.mode[0](t, x, self.input_at(t), self.parameters, self.s)

    def guard(self, t: float, x: Array) -> Array:
        """Guards g and a in the present mode."""
        return self.mode[1](t, x, self.input_at(t), self.parameters, self.s)

    def measure(self, code: Array) -> tuple[Array, Array]:
        """Guards of a mode at the present point, and how far rounding can move each."""
        guard = self.functions(code)[1]
        u, s, x = self.input_at(self.t), code.astype(float), self.x[: self.n]
        g = np.array(guard(self.t, x, u, self.parameters, s))
        wobbled = x + self.wobble * np.maximum(np.abs(x), 1e3 * self.floor)
        moved = np.abs(guard(self.t, wobbled, u, self.parameters, s) - g)
        moved = np.where(np.isfinite(moved), moved / WOBBLE, 0.0)
        return g, 64 * EPSILON * (moved + np.abs(g))

    # ------------------------------------------------------------------ one step

    def stages(self, h: float) -> None:
        """x_new one step of length h after x; needs K[0], fills K[1] to K[5]."""
        n, K, x = self.n, self.K, self.x
        for i in range(1, 6):
            y = x + h * _weighted(A[i][:-1], K[: i - 1]) if i > 1 else x
            y = y + h * A[i][-1] * K[i - 1]
            K[i] = self.rhs(self.t + h * C[i], y[:n])
        self.x_new = x + h * _weighted(B[:-1], K[:5]) + h * B[-1] * K[5]

    def last_stage(self, h: float) -> bool:
        """K[6]; false when the step holds a NaN or an infinity."""
        self.K[6] = self.rhs(self.t + h, self.x_new[: self.n])
        return bool(np.isfinite(self.x_new).all() and np.isfinite(self.K[6]).all())

    def allowed(self, other: Array) -> Array:
        """Error allowed in each state between the present one and another."""
        size = np.maximum(np.maximum(np.abs(self.x[: self.n]), np.abs(other)), self.floor)
        return self.options.atol + self.options.rtol * size

    def error_norm(self, h: float) -> float:
        """Largest component of the error estimate, in units of what the tolerances allow."""
        if self.n == 0:
            return 0.0
        error = np.abs(h * _weighted(E, self.K)[: self.n])
        return float(np.max(error / np.maximum(self.allowed(self.x_new[: self.n]), TINY)))

    def make_dense(self, h: float) -> None:
        """Coefficients of the interpolant over the step."""
        rise = self.x_new - self.x
        bend = h * self.K[0] - rise
        self.dense[0], self.dense[1], self.dense[2] = self.x, rise, bend
        self.dense[3] = rise - h * self.K[6] - bend
        self.dense[4] = h * _weighted(D, self.K)

    def interpolate(self, part: float) -> Array:
        """All components at a fraction of the step."""
        d, rest = self.dense, 1 - part
        return d[0] + part * (d[1] + rest * (d[2] + part * (d[3] + rest * d[4])))

    def first_step(self) -> None:
        """Step length after a start or an event."""
        x, slope_now = self.x[: self.n], self.K[0, : self.n]
        remaining = self.t_end - self.t
        small = 0.01 * self.h if self.h > 0 else 1e-6 * remaining
        size, slope = self._ratio(x, self.allowed(x)), self._ratio(slope_now, self.allowed(x))
        if slope > 0 and size > 0:
            small = min(small, 0.01 * size / slope)
        small = min(small, self.options.max_step, remaining)
        for _ in range(12 if small > 0 else 0):
            reached = x + small * slope_now
            new = self.rhs(self.t + small, reached)[: self.n]
            if np.isfinite(new).all():
                allowed = self.allowed(reached)
                slope = self._ratio(slope_now, allowed)
                turn = self._ratio(new - slope_now, allowed) / small
                self.h = 100 * small
                if slope > 0 and turn > 0:
                    rate = turn / slope
                    self.h = min(self.h, (10 * rate / slope) ** 0.2 / rate)
                return
            small *= 0.1
        self.h = small

    @staticmethod
    def _ratio(values: Array, allowed: Array) -> float:
        """Largest |value|/allowed, where anything at all is allowed."""
        some = allowed > 0
        return float(np.max(np.abs(values[some]) / allowed[some])) if some.any() else 0.0

    # ------------------------------------------------------------------ events inside a step

    def lowest(self, g: Array) -> float:
        """The lowest guard; one that never rose yet counts only beyond rounding."""
        g = g[: self.k]
        return float(np.min(np.where(self.armed_low, g, g + self.noise)))

    def level_dense(self, tau: float) -> float:
        """Lowest guard on the interpolant."""
        return self.lowest(self.guard(self.t + tau, self.interpolate(tau / self.h_used)[: self.n]))

    def level_true(self, tau: float) -> float:
        """Lowest guard after a step of length tau, left in x_new; those below zero in `fired`."""
        self.stages(tau)
        probe = self.guard(self.t + tau, self.x_new[: self.n])
        self.reached = tau
        level = self.lowest(probe)
        if level < 0:
            g = probe[: self.k]
            self.fired = np.where(self.armed_low, g, g + self.noise) < 0
        return level

    def arm_until(self, at: int) -> None:
        """armed_low: which guards are armed at sample `at`."""
        rose = self.sample[1 : at + 1, : self.k] > self.noise
        self.armed_low = self.armed | rose.any(axis=0)

    def first_below(self) -> int:
        """Index of the first sample with a guard below zero, 5 if none."""
        for c in range(1, 5):
            self.arm_until(c - 1)
            if self.lowest(self.sample[c]) < 0:
                return c
        self.arm_until(4)
        return 5

    def curves(self) -> tuple[Array, Array]:
        """Forward differences, (5, k), of a and of the breakaway force (0 when slipping)."""
        a = self.sample[:, self.k :]
        b = np.where(self.code != 0, 0.0, self.sample[:, : self.k] + np.abs(a))
        return _differences(a), _differences(b)

    def find_dip(self, before: int, curves: tuple[Array, Array]) -> tuple[int, float] | None:
        """A dip below zero between samples above it: the sample before, the fraction."""
        a, b = curves
        rough = np.abs(a[4]) + np.abs(b[4])
        bend = _weighted(np.array([1.0, 2.0, 3.0]), np.abs(a[2:]) + np.abs(b[2:]))
        for j in range(self.k):
            g = self.sample[:before, j]
            rose = np.flatnonzero(self.armed[j] | (g > self.noise[j]))
            start = int(rose[0]) if len(rose) else before
            if start >= before or g[start:].min() > 0.25 * bend[j]:
                continue
            found = _lowest_inside(a[:, j], b[:, j], int(self.code[j]), start, before - 1)
            if found is None or found[1] > 0.1 * rough[j]:
                continue
            z = found[0]
            self.arm_until(int(z))
            if self.level_dense(0.25 * z * self.h_used) < 0:
                return int(z), 0.25 * z
        return None

    def guards_unresolved(self, first: int, curves: tuple[Array, Array]) -> bool:
        """Whether a dip below zero could hide between samples before `first`."""
        a, b = curves
        rough = np.abs(a[4]) + np.abs(b[4])
        change = np.abs(np.diff(self.sample[:, self.k :], axis=0)).max(axis=0)
        least = self.sample[:first, : self.k].min(axis=0)
        return bool(np.any(self.armed & (rough > 0.1 * change) & (rough > 0.1 * least)))

    def locate(self, h: float, low: float, high: float) -> bool:
        """The event in (low, high]; false when the step was cut at `high` instead."""
        limit, tol = high, 2 * _ulp(max(abs(self.t), abs(self.t + h)))
        f_low, f_high = self.level_dense(low), self.level_dense(high)
        reach, slope = 1e-6 * h, 0.0
        if f_low >= 0 > f_high:
            slope = (f_low - f_high) / (high - low)
            low, f_low, high, f_high = _narrow(self.level_dense, low, f_low, high, f_high, 1e-9 * h)

        f = self.level_true(high)
        if slope > 0:
            reach = max(4 * tol, min(reach, 4 * abs(f) / slope))
        if f < 0:
            f_low = -1.0
            while f_low < 0:
                f_high = f
                low = max(high - reach, 0.0)
                f_low = f = (
                    self.level_true(low) if low > 0 else max(self.lowest(self.sample[0]), 0.0)
                )
                if f < 0:
                    high = low
                reach *= 32
        else:
            f_high = 0.0
            while f_high >= 0:
                if high >= limit:
                    self.h_used = limit
                    return False
                low, f_low = high, f
                high = min(low + reach, limit)
                f_high = f = self.level_true(high)
                reach *= 32
        low, f_low, high, f_high = _narrow(self.level_true, low, f_low, high, f_high, tol)
        if self.reached != low:
            self.stages(low)
        self.h_used = low
        return True

    def search(self, h: float) -> bool:
        """Whether the step of length h ends, now, in an event."""
        k = self.k
        self.make_dense(h)
        self.h_used = h
        for c in range(1, 4):
            self.sample[c] = self.guard(self.t + 0.25 * c * h, self.interpolate(0.25 * c)[: self.n])
        self.sample[4] = self.guard(self.t + h, self.x_new[: self.n])

        first, curves = self.first_below(), self.curves()
        if self.halvings < MAX_HALVINGS and self.guards_unresolved(first, curves):
            self.halvings += 1
            self.h = 0.5 * h
            raise _Retry
        dip = self.find_dip(first, curves)
        if dip is not None:
            low, part = dip
        elif first < 5:
            self.arm_until(first - 1)
            low, part = first - 1, 0.25 * first
            suspicious = ~self.armed_low & (self.sample[first, :k] < -self.noise)
            if suspicious.any() and self.shrinks < MAX_SHRINKS and h > 1000 * _ulp(self.t):
                self.shrinks += 1
                self.h = 0.125 * h
                raise _Retry
        else:
            self.armed = self.armed_low
            return False

        found = self.locate(h, 0.25 * low * h, part * h)
        if not self.last_stage(self.h_used):
            self.bad += 1
            self.h = 0.25 * h
            raise _Retry
        self.make_dense(self.h_used)
        self.sample[4] = self.guard(self.t + self.h_used, self.x_new[: self.n])
        self.armed = self.armed_low | (self.sample[4, :k] > self.noise)
        return found

    # ------------------------------------------------------------------ phases

    def put_row(self, t: float, x: Array) -> None:
        """Write one row of output."""
        self.rows.append(np.concatenate([[t], x]))
        self.row_codes.append(self.code)

    def release(self, code: Array) -> None:
        """Release from `code`, one after the other, the switches that do not hold."""
        k = self.k
        while True:
            g, noise = self.measure(code)
            if not np.isfinite(g).all():
                raise _End(Outcome.NON_FINITE)
            load = np.abs(g[k:])
            excess = np.where((code == 0) & (g[:k] < -noise[:k]), -g[:k] / load, 0.0)
            if not excess.max() > 0:
                return
            worst = int(np.argmax(excess))
            code[worst] = _signs(g[k + worst])

    def adopt(self, code: Array) -> None:
        """Take over new codes: log what changed, and the state on the new side."""
        changed = np.flatnonzero(code != self.code)
        if self.started and len(self.events) + len(changed) > self.options.max_events:
            raise _End(Outcome.EVENT_LIMIT)
        if self.started:
            for j in changed:
                self.events.append((self.t, int(j), int(self.code[j]), int(code[j]), self.x))
        new = len(changed) > 0 or not self.started
        self.code, self.s = code, code.astype(float)
        if new and self.t_eval is None:
            self.put_row(self.t, self.x)
        if len(changed):
            self.keep_step = False
        self.started = True
        self.restart()

    def classify(self) -> None:
        """Codes from the slips themselves, at the start and where an input jumped."""
        k = self.k
        code = np.ones(k, dtype=int)
        if k:
            slip, noise = (values[k:] for values in self.measure(code))
            if not np.isfinite(slip).all():
                raise _End(Outcome.NON_FINITE)
            speed = np.abs(slip)
            if self.started:
                self.knot -= 1
                before = self.measure(code)[0][k:]
                self.knot += 1
                speed = np.where(self.code == 0, np.abs(slip - before), speed)
            self.fresh = speed <= 64 * noise
            code = np.where(self.fresh, 0, _signs(slip))
            self.release(code)
        self.adopt(code)

    def settle(self) -> None:
        """New codes at an event: what was overloaded slips, what came to rest is tried as stuck."""
        k = self.k
        slips = self.code != 0
        rests = slips & self.armed_low & (self.sample[0, :k] <= self.noise)
        code = np.where(self.fired & ~slips, _signs(self.sample[0, k:]), self.code)
        code = np.where((self.fired | rests) & slips, 0, code)
        self.fresh = self.fired | rests | ~slips
        self.release(code)

        window = self.instants.maxlen or 0
        crowded = len(self.instants) == window and self.t - self.instants[0] <= 1e-12 * (
            self.t_end - self.t_begin
        ) + 1000 * _ulp(self.t)
        early = bool(np.any(self.fired & ~self.armed_low))
        self.futile = self.futile + 1 if early else 0
        if crowded or self.futile > 16 + 4 * k:
            raise _End(Outcome.CHATTERING)
        self.instants.append(self.t)
        self.adopt(code)

    def restart(self) -> None:
        """Slope, guards and step size of the present mode at the present point."""
        self.mode = self.functions(self.code)
        self.K[0] = self.rhs(self.t, self.x[: self.n])
        if not np.isfinite(self.K[0]).all():
            raise _End(Outcome.NON_FINITE)
        if self.k:
            self.sample[0], noise = self.measure(self.code)
            g = self.sample[0, : self.k]
            off = np.where((self.code != 0) & self.fresh, np.abs(g), -g)
            self.noise = np.maximum(noise[: self.k], 1.1 * off)
            self.armed = g > self.noise
        self.growths = 0
        if not self.keep_step:
            self.first_step()
            self.h = max(self.h, 100 * _ulp(self.t))
            self.growths = MAX_GROWTHS
            self.log_error = math.log(1e-4)
        self.keep_step = self.after_rejection = False
        self.bad = self.shrinks = self.halvings = 0

    def control(self, h: float, error: float, clipped: bool) -> None:
        """Proposal for the step after one of length h."""
        log_error = math.log(max(error, TINY))
        slowed = math.exp((0.2 - 0.75 * BETA) * log_error - BETA * self.log_error)
        proposal = h / max(1 / FAC_MAX, min(1 / FAC_MIN, slowed / SAFETY))
        if self.after_rejection:
            proposal = min(proposal, h)
        elif clipped:
            proposal = max(proposal, self.h)
        self.h = proposal
        self.log_error = max(log_error, math.log(1e-4))
        self.after_rejection = False

    def reject(self, h: float) -> None:
        """Note a step that was not taken, and the length to try instead."""
        self.rejected += 1
        self.after_rejection = True
        self.h = h

    def is_short(self, h: float) -> bool:
        """Whether a first step is so short that its error may be rounding."""
        return h < SHORT * (self.t_end - self.t_begin)

    def forgiven(self, h: float) -> float:
        """The error with states measured by the energy at the end of the step, which was rest before.

        What grows from zero with a high power of time has no small relative error in any step.
        """
        n, floor = self.n, self.floor
        amplitude = 1e-7 * math.sqrt(2 * abs(self.energy0 + self.x_new[n] - self.x_new[n + 1]))
        self.floor = np.maximum(floor, self.weights * amplitude)
        error = self.error_norm(h)
        self.floor = floor
        return error

    def after_error(self, h: float, error: float) -> float:
        """The length to try after one whose error was too large.

        What begins to slip at no speed may be given a first step so short that its error is rounding,
        of which a longer step has less: longer ones are tried as long as that does not make it worse.
        """
        shorter = h / min(1 / FAC_MIN, error**0.2 / SAFETY)
        first = self.growths == MAX_GROWTHS
        if self.growths and (self.is_short(h) if first else error < 2 * self.last_error):
            if first:
                self.h_first = shorter
            self.growths -= 1
            self.last_error = error
            return GROWTH * h
        if self.growths and not first:
            shorter = self.h_first
        self.growths = 0
        return shorter

    def next_stop(self) -> float:
        """The time that no step may cross."""
        ahead = self.knot + 1
        return min(float(self.knots[ahead]), self.t_end) if ahead < len(self.knots) else self.t_end

    def step(self) -> None:
        """Try one step; take it, with the event at its end, if it is good."""
        stop = self.next_stop()
        if self.t >= self.t_end:
            raise _End(Outcome.FINISHED)
        if self.t >= stop:
            self.cross_knot()
            return
        if self.steps + self.rejected >= self.options.max_steps:
            raise _End(Outcome.STEP_LIMIT)

        h = min(self.h, self.options.max_step)
        clipped = self.t + 1.01 * h >= stop
        if clipped:
            h = stop - self.t
        elif not h > 10 * _ulp(self.t):
            raise _End(Outcome.NON_FINITE if self.bad else Outcome.STEP_UNDERFLOW)

        self.stages(h)
        if not self.last_stage(h):
            self.reject(0.25 * h)
            self.bad += 1
            if self.bad > MAX_BAD:
                raise _End(Outcome.NON_FINITE)
            return
        error = self.error_norm(h)
        if error > 1 and ((self.growths and self.is_short(h)) or self.energy == 0):
            error = self.forgiven(h)
        if not error <= 1:
            self.reject(self.after_error(h, error))
            return
        if np.any(np.abs(self.x_new[: self.n]) > self.options.bound):
            raise _End(Outcome.DIVERGED)

        self.h_used = h
        event = False
        try:
            if self.k:
                event = self.search(h)
            elif self.t_eval is not None:
                self.make_dense(h)
        except _Retry:
            self.reject(self.h)
            if self.bad > MAX_BAD:
                raise _End(Outcome.NON_FINITE) from None
            return
        self.t_new = stop if clipped and self.h_used == h else self.t + self.h_used
        self.control(h, error, clipped)
        self.emit()
        self.commit()
        if event:
            self.settle()

    def emit(self) -> None:
        """Output rows of the step just taken."""
        if self.t_eval is None:
            self.put_row(self.t_new, self.x_new)
            return
        while self.next_eval < len(self.t_eval) and self.t_eval[self.next_eval] < self.t_new:
            t = float(self.t_eval[self.next_eval])
            self.put_row(t, self.interpolate((t - self.t) / self.h_used))
            self.next_eval += 1

    def commit(self) -> None:
        """The end of the step becomes the present point."""
        n = self.n
        if self.record is not None:
            self.record.append(
                np.concatenate([[self.t, self.h_used, len(self.events)], self.x[:n]])
            )
        self.x = self.x_new
        self.K[0] = self.K[6]
        self.sample[0] = self.sample[4]
        self.t = self.t_new
        self.steps += 1
        self.bad = self.halvings = self.growths = 0
        self.energy = max(self.energy, abs(self.energy0 + self.x[n] - self.x[n + 1]))
        amplitude = 1e-7 * math.sqrt(2 * self.energy)
        self.floor = np.maximum(
            self.floor, np.maximum(1e-3 * np.abs(self.x[:n]), self.weights * amplitude)
        )
        if self.armed.all():
            self.shrinks = self.futile = 0

    def cross_knot(self) -> None:
        """Into the next interval of the input table; only a jump needs more than that."""
        self.knot += 1
        if self.jumps[self.knot]:
            self.keep_step = True
            self.classify()

    def finish(self) -> None:
        """Output rows at the very end."""
        times = self.t_eval if self.t_eval is not None else ()
        while self.next_eval < len(times) and times[self.next_eval] <= self.t:
            self.put_row(float(times[self.next_eval]), self.x)
            self.next_eval += 1


def _narrow(
    level: Callable[[float], float],
    low: float,
    f_low: float,
    high: float,
    f_high: float,
    tol: float,
) -> tuple[float, float, float, float]:
    """Narrow low (level >= 0) and high (level < 0) to about 2 tol, by Chandrupatla's method."""
    a, fa, b, fb = low, f_low, high, f_high
    c, fc = a, fa
    part = fa / (fa - fb)
    for _ in range(80):
        width = abs(b - a)
        if width <= 2 * tol:
            break
        least = tol / width
        part = min(1 - least, max(least, part))
        x = a + part * (b - a)
        f = level(x)
        if (f >= 0) == (fa >= 0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, f
        part = _inverse_quadratic(a, fa, b, fb, c, fc)
    return (a, fa, b, fb) if fa >= 0 else (b, fb, a, fa)


def _inverse_quadratic(a: float, fa: float, b: float, fb: float, c: float, fc: float) -> float:
    """Where between a and b three points put the zero, 1/2 where that is not safe."""
    if c == b or fc in (fa, fb):
        return 0.5
    xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
    if not (phi * phi < xi and (1 - phi) * (1 - phi) < 1 - xi):
        return 0.5
    across = fa / (fb - fa) * fc / (fb - fc)
    return across + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)


def _quartic(d: Array, z: Array) -> Array:
    """Value at z quarters of the step of the curve with these forward differences."""
    return d[0] + z * (d[1] + (z - 1) / 2 * (d[2] + (z - 2) / 3 * (d[3] + (z - 3) / 4 * d[4])))


def _lowest_inside(
    a: Array, b: Array, code: int, start: int, stop: int
) -> tuple[float, float] | None:
    """Where between two samples, in quarters of the step, a guard is lowest, and how low."""

    def on_curve(z: Array) -> Array:
        return code * _quartic(a, z) if code else _quartic(b, z) - np.abs(_quartic(a, z))

    z = 0.125 * np.arange(8 * start, 8 * stop + 1)
    g = on_curve(z)
    at = int(np.argmin(g))
    if at in (0, len(g) - 1):
        return None
    left, least, right = (float(value) for value in g[at - 1 : at + 2])
    tilt, turn = 0.5 * (right - left), left - 2 * least + right
    shift = tilt / turn if turn > 0 else 0.0
    return float(z[at]) - 0.125 * shift, least - 0.5 * tilt * shift
