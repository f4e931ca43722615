"""The integrator on switched models: from event to event, with a search for the next modes."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

import numpy

from ...elements import DryFriction, EndStop
from ...errors import BondGraphError, SimulationError
from ..mode_set import ModeSet
from ..outcome import Outcome
from ..problem import Options, Problem
from ..stepper import EPSILON, TINY, E, Model, Stepper, _End, _weighted
from .search import Found, ModeSearch, Point, mask_of

log = logging.getLogger(__name__)

Array = numpy.ndarray

# Energies may be off by so much more than states: they are for the audit.
AUDIT = 100.0
# Margins of more than this part of the largest so far are no matter of rounding.
CLEAR = 1e-6
ZENO_BOUNCES = 8
# Bounces that get closer end here: what is left of them lasts less than this part of the run.
ZENO_REST = 1e-6


class SwitchedStepper(Stepper):
    """A run whose modes hold and bind states.

    Steps, interpolation and the location of events are those of `Stepper`; what happens at an
    event is decided by `ModeSearch`.

    Parameters
    ----------
    problem, options, model
        As for `Stepper`.
    switched : ModeSet
    """

    def __init__(
        self,
        problem: Problem,
        options: Options,
        model: Callable[[int], tuple[Model, Model]],
        switched: ModeSet,
    ) -> None:
        super().__init__(problem, options, model)
        self.switched = switched
        self.search_modes = ModeSearch(switched)
        self.deadline = time.monotonic() + options.time_budget
        self.impacts: dict[int, list[float]] = {}
        self.widest = numpy.zeros(self.k)

    def classify(self) -> None:
        """Modes at the start, and where an input jumped."""
        if self.started and self._untouched():
            self.fresh = numpy.zeros(self.k, dtype=bool)
            self.adopt(self.code)
            return
        codes = self._commanded(self.code if self.started else self._first())
        self._enter(codes)

    def _untouched(self) -> bool:
        """Whether a jump of inputs leaves all as it is: no state bound, every margin far from zero."""
        if any(element.commanded for element in self.switched.elements):
            return False
        if len(self.switched.numbers(mask_of(self.code)).bound):
            return False
        margins = self.guard(self.t, self.x[: self.n])[: self.k]
        self.widest = numpy.maximum(self.widest, numpy.abs(margins))
        return bool((margins > CLEAR * self.widest).all())

    def settle(self) -> None:
        """Modes after an event: what fired changes, and what follows from that."""
        codes = self.code.copy()
        for j in numpy.flatnonzero(self.fired):
            codes[j] = self._after(int(j))
        self._watch()
        self._enter(codes)

    def _after(self, j: int) -> int:
        """The code that a switch changes to when its margin is used up."""
        value = float(self.sample[0, self.k + j])
        return self.switched.elements[j].next_code(int(self.code[j]), value, value)

    def _first(self) -> Array:
        """Codes to begin a search with, in the first mode that can be."""
        start = numpy.ones(self.k, dtype=int)
        found = self._possible(start)
        if found is None:
            raise SimulationError(
                f"model {self.switched.base.name!r} can be in no set of modes: {self.search_modes.refusal}"
            )
        margins, values, noise = self.search_modes.guards(found, self._point(), self.x[: self.n])
        for j, element in enumerate(self.switched.elements):
            if isinstance(element, DryFriction):
                slips = found[j] != 0 and abs(values[j]) > noise[j]
                found[j] = (1 if values[j] > 0 else -1) if slips else 0
            elif (
                isinstance(element, EndStop)
                and margins[j] < -noise[j] - 1e-9 * abs(margins[j])
                and found[j]
            ):
                raise SimulationError(
                    f"EndStop {self.switched.names[j]!r} starts beyond its stop, with a gap of {margins[j]:g}; "
                    f"give initial states with a gap of zero or more",
                    elements=[self.switched.names[j]],
                )
            elif not element.commanded:
                found[j] = found[j] if margins[j] > noise[j] else 1 - found[j]
        return found

    def _possible(self, start: Array) -> Array | None:
        """A set of modes whose equations exist, near a first one."""
        search = self.search_modes
        for codes in search.nearby(start, commands=True):
            try:
                self.switched.numbers(mask_of(numpy.array(codes)))
            except BondGraphError as error:
                search.refusal = str(error)
                continue
            return numpy.array(codes, dtype=int)
        return None

    def _commanded(self, codes: Array) -> Array:
        """Codes in which commanded switches stand as their signals say."""
        codes = codes.copy()
        if any(element.commanded for element in self.switched.elements):
            margins, _, _ = self.search_modes.guards(codes, self._point(), self.x[: self.n])
            for j, element in enumerate(self.switched.elements):
                if element.commanded and margins[j] < 0:
                    codes[j] = 1 - codes[j]
        return codes

    def _point(self) -> Point:
        scale = numpy.maximum(numpy.abs(self.x[: self.n]), 1e3 * self.floor)
        ahead = min(self.h if self.h > 0 else numpy.inf, 1e-3 * (self.t_end - self.t_begin))
        return Point(
            t=self.t,
            x=self.x,
            u=self.input_at(self.t),
            p=self.parameters,
            scale=scale,
            probe=1e-3 * max(min(ahead, self.t_end - self.t), 1e4 * EPSILON * abs(self.t)),
            tick=8 * EPSILON * max(abs(self.t), TINY),
            deadline=self.deadline,
        )

    def _enter(self, natural: Array) -> None:
        try:
            now = self.code if self.started else None
            found = self.search_modes.find(natural, self._point(), now)
        except TimeoutError:
            raise _End(Outcome.TIME_BUDGET) from None
        if found is None:
            log.warning("no consistent mode at t = %g: %s", self.t, self.search_modes.refusal)
            raise _End(Outcome.NO_MODE)
        self._bounce(found)
        moved = found.jump.moved
        self.x = found.jump.x
        margins, _, noise = self.search_modes.guards(found.codes, self._point(), self.x[: self.n])
        self.fresh = numpy.abs(margins) <= 4 * noise
        self.adopt(found.codes)
        if moved and self.keep_step:
            self.keep_step = False
            self.restart()

    def _bounce(self, found: Found) -> None:
        """Log impacts that leave a stop free, and end a run in which they pile up."""
        for j in found.rebounds:
            if self.started and self.code[j] == 1:
                if len(self.events) >= self.options.max_events:
                    raise _End(Outcome.EVENT_LIMIT)
                self.events.append((self.t, j, 1, 1, found.jump.x))
                if self.t_eval is None:
                    self.put_row(self.t, found.jump.x)
            times = self.impacts.setdefault(j, [])
            times.append(self.t)
            del times[: -ZENO_BOUNCES - 1]
            gaps = numpy.diff(times)
            if len(gaps) == ZENO_BOUNCES and numpy.all(gaps[1:] < gaps[:-1]):
                ratio = (gaps[-1] / gaps[0]) ** (1 / (ZENO_BOUNCES - 1))
                rest = gaps[-1] * ratio / (1 - ratio)
                if rest <= ZENO_REST * (self.t_end - self.t_begin):
                    raise _End(Outcome.ZENO)

    def _watch(self) -> None:
        """End a run in which modes change without time going on."""
        window = self.instants.maxlen or 0
        crowded = len(self.instants) == window and self.t - self.instants[0] <= 1e-12 * (
            self.t_end - self.t_begin
        ) + 1000 * EPSILON * abs(self.t)
        if crowded:
            raise _End(Outcome.CHATTERING)
        self.instants.append(self.t)

    def error_norm(self, h: float) -> float:
        """Largest component of the error estimate, beside what the rounding of time itself makes.

        After an event a state may start from zero under a force that starts from zero, and then
        no part of its own size can be met. Where all states are bound, the energies alone tell
        how much goes on in a step.
        """
        n = self.n
        error = numpy.abs(h * _weighted(E, self.K))
        moved = numpy.abs(self.x_new[n:]).max() + h * numpy.abs(self.K[:, n:]).max()
        norm = error[n:].max() / max(AUDIT * self.options.rtol * moved, TINY)
        if n == 0:
            return float(norm)
        turn = numpy.abs(self.K[6] - self.K[0])[:n]
        allowed = self.allowed(self.x_new[:n]) + 64 * EPSILON * abs(self.t + h) * turn
        return float(max(norm, numpy.max(error[:n] / numpy.maximum(allowed, TINY))))

    def first_step(self) -> None:
        """Step length after a start or an event; one too long is only tried in vain."""
        super().first_step()
        self.h = max(self.h, min(1e-10 * (self.t_end - self.t_begin), self.t_end - self.t))
