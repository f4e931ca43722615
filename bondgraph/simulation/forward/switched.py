"""Sensitivities of switched models: events at which the state itself may jump.

Between events it is as with frictions, the algebraic variables of a mode solved for in each call.
At an event the state goes through the jump into the next mode, whose derivative is taken by
differences along each direction: x before moves by S + f dt, the time by dt, parameters by P.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy

from ..buffered import evaluator
from ..implicit import Implicit
from ..mode_set import ModeSet
from ..switched import imposed_before, jump, mask_of
from .replay import PythonReplay
from .tangents import ModeTangent, tangent_of
from .value import NON_FINITE, UNTOLD, Array, Travelled, Undefined

# Differences of jumps: most are linear in the state, so that only rounding speaks against long ones.
SHARE = 1e-3
# A jump is met to so much of each state's size, sharper than runs ask for.
SHARP = 1e-4
SAME = 1e-6


class SwitchedTangents:
    """The derivatives of the modes of a switched model; see `TangentTable`.

    Parameters
    ----------
    modes : ModeSet
    sizes : (int, int, int)
        Numbers of states, inputs and parameters.
    """

    def __init__(self, modes: ModeSet, sizes: tuple[int, int, int]) -> None:
        self.modes = modes
        self.n, self.m, self.np = sizes
        self.k = len(modes.names)
        self._made: dict[int, tuple[ModeTangent, Implicit]] = {}

    def _mode(self, mask: int) -> tuple[ModeTangent, Implicit]:
        if mask not in self._made:
            import casadi

            arguments, results = self.modes.expressions(mask, ("rates", "guards", "residual"))
            implicit = Implicit(arguments, [results[2]])
            moved = casadi.vertcat(*arguments[6:])
            rates, guards, held = (casadi.substitute(part, moved, 0) for part in results)
            given = arguments[: 6 if held.numel() else 5]
            tangent = tangent_of(given, rates[: self.n], guards[: self.k], held)
            self._made[mask] = tangent, implicit
        return self._made[mask]

    def mode(self, mask: int) -> ModeTangent:
        """Return the derivatives of a mode."""
        return self._mode(mask)[0]

    def calls(self, mask: int) -> tuple[Callable[..., Array], Callable[..., Array]]:
        """Return rates and surface of a mode as functions of ``(t, x, u, p, s)``."""
        tangent, implicit = self._mode(mask)
        implicit.forget()
        rates, surface = evaluator(tangent.rates), evaluator(tangent.surface)
        if tangent.rates.n_in() == 5:
            return rates, surface

        def solved(function: Callable[..., Array]) -> Callable[..., Array]:
            def call(t: float, x: Array, u: Array, p: Array, s: Array) -> Array:
                return function(t, x, u, p, s, implicit.solve(t, x, u[: self.m], p, s))

            return call

        return solved(rates), solved(surface)


class SwitchedReplay(PythonReplay):
    """One replay of a switched model.

    Parameters
    ----------
    table : SwitchedTangents
    travelled : Travelled
    x0 : (n,) array
        The state before the jump at the start.
    """

    def __init__(self, table: SwitchedTangents, travelled: Travelled, x0: Array) -> None:
        super().__init__(table, travelled, lambda t, x, codes, S, seeds: S)  # type: ignore[arg-type]
        self.modes = table.modes
        self.state[: self.n] = x0
        sizes = numpy.abs(self.record[:, 3:]).max(axis=0, initial=0.0)
        sizes = numpy.maximum(sizes, numpy.abs(x0))
        self.sizes = numpy.where(sizes > 0, sizes, max(sizes.max(initial=0.0), 1.0))

    def rows_due(self, last: int) -> int:
        """Rows after events: one for each rebound, and one where modes changed."""
        if self.t_eval is not None:
            return 0
        batch = self.given.events[self.events_done : last]
        rebounds = int((batch[:, 1] == batch[:, 2]).sum())
        return rebounds + int(not self.begun or len(batch) > rebounds)

    def stand(self, t: float, row: Array, then: Array) -> None:
        """The jump at a given time: at the start, or where an input jumps."""
        self._jump(t, row, then, int(row[2]), numpy.zeros(self.q))

    def cross(self, t: float, row: Array, then: Array, last: int) -> None:
        """The jump at an event, whose time moves."""
        self._jump(t, row, then, last, self.crossing(t, last))

    def _jump(self, t: float, row: Array, then: Array, last: int, dt: Array) -> None:
        n, p = self.n, self.given.parameters
        via = then.copy()
        batch = self.given.events[self.events_done : last]
        rebounds = [int(switch) for switch, before, after in batch if before == after]
        via[rebounds] = 0
        x, S = self.state[:n].copy(), self.state[n:].reshape(n, self.q)
        free = not rebounds and not len(self.modes.numbers(mask_of(via)).bound)
        here = x if free else self._after(t, x, p, via, rebounds)
        if not numpy.all(numpy.abs(here - row[3:]) <= SAME * self.sizes):
            raise Undefined(UNTOLD, t, int(batch[0, 0]) if len(batch) else 0)
        before = self.K[0, :n] if self.begun else numpy.zeros(n)
        S += before[:, None] * dt
        if not free:  # a mode that binds no state takes it as it is
            moved = S.copy()
            for c in range(self.q):
                S[:, c] = self._slope(
                    t, x, via, rebounds, (float(dt[c]), moved[:, c], self.seeds[:, c])
                )
        self.state[:n] = row[3:]
        after = self.functions(then)[0](t, row[3:], self.inputs(t)[0], p, then)[:n]
        S -= after[:, None] * dt
        if not numpy.isfinite(S).all():
            raise Undefined(NON_FINITE, t, -1)

    def _slope(
        self,
        t: float,
        x: Array,
        via: Array,
        rebounds: Sequence[int],
        way: tuple[float, Array, Array],
    ) -> Array:
        """Derivative of the state after the jump along one direction in (t, x, p)."""
        p = self.given.parameters
        dt, dx, dp = way
        parts = [
            numpy.abs(dx / self.sizes).max(initial=0.0),
            numpy.abs(dp[p != 0] / p[p != 0]).max(initial=0.0),
            abs(dt) / max(float(self.record[:, 1].max()), 1e-300),
        ]
        if not max(parts) > 0:
            return numpy.zeros(self.n)
        step = SHARE / max(parts)

        def at(share: float) -> Array:
            moved = t + share * dt, x + share * dx, p + share * dp
            return self._after(*moved, via, rebounds)

        near, far = at(step) - at(-step), at(2 * step) - at(-2 * step)
        return (8 * near - far) / (12 * step)

    def _after(self, t: float, x: Array, p: Array, via: Array, rebounds: Sequence[int]) -> Array:
        """The state after the jump into a mode, from which some stops rebound."""
        numbers = self.modes.numbers(mask_of(via))
        place = t, self.inputs(t)[0], p, via.astype(float)
        before = imposed_before(numbers, place, x, SHARP * self.sizes)
        if before is None:
            before = imposed_before(numbers, place, x, self.sizes)
        if before is None:
            return numpy.full(self.n, numpy.nan)
        after = numpy.zeros(len(before))
        for j in rebounds:
            index = numbers.held.index(j)
            after[index] = -self.modes.impact(j, p)[0] * before[index]
        start = numpy.concatenate([x, [0.0, 0.0]])
        return jump(numbers, place, start, before, after, len(via)).x[:-2]
