"""The replay of ``replay.c`` once more, in Python: change both together.

It runs where there is no compiler and where an input is a Python callable. Sums are taken in the
same order, so both give the same bits, and a test asks for that.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy

from ..inputs import InputTable
from ..stepper import EPSILON, TINY, A, B, C, D, _weighted
from .tangents import Entries, TangentTable
from .value import AMBIGUOUS, GRAZING, NON_FINITE, Array, Projection, Replayed, Travelled, Undefined

TOGETHER, AGREE, LEAST = 1e3, 1e-6, 1e-12
RATE_STEP = 1e-6  # relative, for the rate of an input that is a Python function
Active = tuple[Array, Array, Array]


class PythonReplay:
    """One replay in Python.

    Parameters
    ----------
    table : TangentTable
    travelled : Travelled
    project : callable
        See `bondgraph.simulation.forward.project.Projector`.
    """

    def __init__(self, table: TangentTable, travelled: Travelled, project: Projection) -> None:
        self.table, self.given, self.project = table, travelled, project
        self.n, self.q = table.n, travelled.seeds.shape[1]
        self.seeds, self.record, self.t_eval = travelled.seeds, travelled.record, travelled.t_eval
        self.moved = numpy.any(self.seeds != 0, axis=1)
        self.state = numpy.concatenate([self.record[0, 3:], travelled.start.ravel()])
        self.codes = numpy.array(travelled.codes, dtype=float)
        self.K = numpy.zeros((7, self.n * (1 + self.q)))
        self.knot, self.events_done, self.begun, self.next_eval = -1, 0, False, 0
        self.rows: list[Array] = []
        self.event_rows = numpy.zeros((len(travelled.events), self.q))
        self.made: dict[int, tuple[Callable[..., Array], Callable[..., Array], Active, Active]] = {}

    def to_the_end(self, deadline: float, too_late: Callable[[], Exception]) -> Replayed:
        """Make every step once more; see `NativeReplay.to_the_end`."""
        with numpy.errstate(all="ignore"):
            for index, row in enumerate(self.record[:-1]):
                self.arrive(row, at_end=False)
                self.travel(row, float(self.record[index + 1, 0]))
                if time.monotonic() > deadline:
                    raise too_late()
            self.arrive(self.record[-1], at_end=True)
        while self.t_eval is not None and self.next_eval < len(self.t_eval):
            if self.t_eval[self.next_eval] > self.record[-1, 0]:
                break
            self.put_row(self.state[self.n :])
            self.next_eval += 1
        rows = numpy.array(self.rows).reshape(len(self.rows), self.n, self.q)
        if len(rows) != self.given.rows:  # a run stopped in the middle of a step
            raise too_late()
        return Replayed(rows, self.state[self.n :].reshape(self.n, self.q), self.event_rows)

    # ------------------------------------------------------------------ model

    def inputs(self, t: float) -> tuple[Array, Array]:
        """Inputs at t, which lies in the interval after the present knot, and their slopes."""
        table = self.given.inputs
        if not isinstance(table, InputTable):
            step = RATE_STEP * max(abs(t), 1e-3)
            u, ahead, behind = (
                numpy.asarray(table(at), dtype=float) for at in (t, t + step, t - step)
            )
            return u, (ahead - behind) / (2 * step)
        i, knots = self.knot, table.knots
        left, since = table.values[max(i, 0)], t - knots[max(i, 0)]
        slope, bend, twist = table.shapes[i if i >= 0 else -1]  # none after the last knot
        value = left + since * (slope + since * (bend + since * twist))
        return value, slope + since * (2 * bend + since * (3 * twist))

    def functions(
        self, codes: Array
    ) -> tuple[Callable[..., Array], Callable[..., Array], Active, Active]:
        """Rates and surface of the mode of these codes, and the entries that count."""
        mask = sum(1 << int(j) for j in numpy.flatnonzero(codes == 0))
        if mask not in self.made:
            mode = self.table.mode(mask)
            self.made[mask] = (
                *self.table.calls(mask),
                self.active(mode.rates_entries),
                self.active(mode.surface_entries),
            )
        return self.made[mask]

    def active(self, entries: Entries | None) -> Active:
        """Return indices, rows and columns of the entries that count."""
        if entries is None:
            return (numpy.zeros(0, dtype=int),) * 3
        index, rows, columns = entries.active(self.n, self.moved).T
        return index, rows, columns

    def spread(self, active: Active, values: Array, S: Array, size: int) -> Array:
        """Sums of entries times columns of S and P, entry after entry."""
        index, rows, columns = active
        moving = numpy.concatenate([S.reshape(self.n, self.q), self.seeds])
        into = numpy.zeros((size, self.q))
        numpy.add.at(into, rows, values[index, None] * moving[columns])
        return into

    def rates(self, t: float, state: Array) -> Array:
        """Slopes of x and S."""
        function, _, active, _ = self.mode
        n = self.n
        found = function(t, state[:n], self.inputs(t)[0], self.given.parameters, self.codes)
        return numpy.concatenate([found[:n], self.spread(active, found[n:], state[n:], n).ravel()])

    # ------------------------------------------------------------------ a step

    def travel(self, row: Array, t_new: float) -> None:
        """Make a step, and the output rows in it."""
        self.last = row
        t, h = float(row[0]), float(row[1])
        x, K = self.state, self.K
        for i in range(1, 6):
            y = x + h * _weighted(A[i][:-1], K[: i - 1]) if i > 1 else x
            K[i] = self.rates(t + h * C[i], y + h * A[i][-1] * K[i - 1])
        fresh = x + h * _weighted(B[:-1], K[:5]) + h * B[-1] * K[5]
        K[6] = self.rates(t + h, fresh)
        if not numpy.isfinite(fresh).all():
            raise Undefined(NON_FINITE, t, -1)
        if self.t_eval is None:
            self.put_row(fresh[self.n :])
        elif self.next_eval < len(self.t_eval) and self.t_eval[self.next_eval] < t_new:
            self.put_inside(t, h, t_new, fresh)
        self.state = fresh
        K[0] = K[6]

    def put_inside(self, t: float, h: float, t_new: float, fresh: Array) -> None:
        """Output rows on the interpolant of S."""
        assert self.t_eval is not None
        x, K = self.state, self.K
        rise = fresh - x
        bend = h * K[0] - rise
        turn, last = rise - h * K[6] - bend, h * _weighted(D, K)
        while self.next_eval < len(self.t_eval) and self.t_eval[self.next_eval] < t_new:
            part = (float(self.t_eval[self.next_eval]) - t) / h
            rest = 1 - part
            row = x + part * (rise + rest * (bend + part * (turn + rest * last)))
            self.put_row(row[self.n :])
            self.next_eval += 1

    def put_row(self, S: Array) -> None:
        """Write one row of output."""
        self.rows.append(S.copy())

    # ------------------------------------------------------------------ events

    def stand(self, t: float, row: Array, then: Array) -> None:
        """The modes at a given time: contacts that begin to stick then allow no slip."""
        if numpy.any((then == 0) & ((self.codes != 0) | (not self.begun))):
            S = self.state[self.n :].reshape(self.n, self.q)
            self.state[self.n :] = self.project(t, row[3:], then, S, self.seeds).ravel()

    def rows_due(self, last: int) -> int:
        """Rows of a run without output times that stand after its events up to `last`."""
        return int(self.t_eval is None and (not self.begun or last > self.events_done))

    def arrive(self, row: Array, *, at_end: bool) -> None:
        """At the start of a step, or at the end of all: events there, and jumps of inputs."""
        t, last = float(row[0]), int(row[2])
        knot, jump = (self.knot, False) if at_end else self.next_knot(t)
        if self.begun and not jump and last == self.events_done:
            self.knot = knot
            return
        then = self.codes.copy()
        for switch, _, after in self.given.events[self.events_done : last]:
            then[switch] = after
        due = self.rows_due(last)
        if self.begun and not jump:
            self.cross(t, row, then, last)
        else:
            self.knot = knot
            self.stand(t, row, then)
        self.events_done, self.knot, self.begun, self.codes = last, knot, True, then
        self.mode = self.functions(then)
        for _ in range(due):
            self.put_row(self.state[self.n :])
        if not at_end:
            self.K[0] = self.rates(t, self.state)

    def next_knot(self, t: float) -> tuple[int, bool]:
        """The knot that is passed at time t; whether an input jumps there."""
        table, knot, jump = self.given.inputs, self.knot, False
        if not isinstance(table, InputTable):
            return knot, False
        while knot + 1 < len(table.knots) and table.knots[knot + 1] <= t:
            knot += 1
            jump |= knot > 0 and self.begun and bool(table.jumps[knot])
        return knot, jump

    def cross(self, t: float, row: Array, then: Array, last: int) -> None:
        """The event of the switches of the log up to `last`: derivative of its time, jump of S."""
        n = self.n
        x, before = self.state[:n], self.K[0, :n]
        dt = self.crossing(t, last)
        p, u = self.given.parameters, self.inputs(t)[0]
        after = self.functions(then)[0](t, x, u, p, then)[:n]
        S = self.state[n:].reshape(n, self.q)
        S += (before - after)[:, None] * dt

    def crossing(self, t: float, last: int) -> Array:
        """Derivative of the time of an event, by whichever of its switches fired, shape (q,)."""
        n, k, p = self.n, len(self.codes), self.given.parameters
        x, before = self.state[:n], self.K[0, :n]
        u, slope = self.inputs(t)
        found = self.mode[1](t, x, numpy.concatenate([u, before, slope]), p, self.codes)
        start, h = float(self.last[0]), float(self.last[1])
        u, slope = self.inputs(start)
        moves = numpy.concatenate([u, self.K[1, :n], slope])
        earlier = self.mode[1](start, self.last[3:], moves, p, self.codes)
        rate, turn = found[k : 2 * k], numpy.abs(found[k : 2 * k] - earlier[k : 2 * k]) / h
        falls = rate < -LEAST * found[2 * k : 3 * k]
        falls &= rate * rate > self.given.noise * found[3 * k : 4 * k] * turn
        away = numpy.abs(found[:k] / rate)
        switches = [int(event[0]) for event in self.given.events[self.events_done : last]]
        falling = [j for j in switches if falls[j]]
        if not falling:
            raise Undefined(GRAZING, t, switches[0])
        fired = min(falling, key=lambda j: away[j])
        crossings = -self.spread(self.mode[3], found[4 * k :], self.state[n:], k) / rate[:, None]
        dt = crossings[fired]
        for j in switches:
            if j != fired and away[j] <= TOGETHER * EPSILON * max(abs(t), TINY):
                other = crossings[j]
                allowed = AGREE * numpy.maximum(numpy.abs(other), numpy.abs(dt))
                if not numpy.all(numpy.abs(other - dt) <= allowed):
                    raise Undefined(AMBIGUOUS, t, j)
        self.event_rows[self.events_done : last] = dt
        return dt
