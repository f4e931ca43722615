"""Which modes hold: a search near the natural ones, each tried with its jump and its margins."""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy

from ...elements import DryFriction, EndStop, Switched
from ...errors import BondGraphError
from ..mode_set import ModeNumbers, ModeSet
from .jump import Jump, imposed_before, jump

Array = numpy.ndarray

EPSILON = float(numpy.finfo(float).eps)
WOBBLE = 1.0 / 1048576.0
PROBES = 4
MAX_TRIES = 256  # of modes, before those farther away are tried in turn
MAX_ALL = 12  # switches of which all combinations are tried


@dataclass(frozen=True, eq=False)
class Point:
    """Where a mode is sought.

    Attributes
    ----------
    t : float
    x : (n + 2,) array
        State, energies supplied and dissipated.
    u, p : arrays
        Inputs and parameters.
    scale : (n,) array
        Size of each state.
    probe : float
        Time ahead at which a margin that is zero now must not be negative.
    tick : float
        Uncertainty of the time.
    deadline : float
        Of the search, on the monotonic clock.
    """

    t: float
    x: Array
    u: Array
    p: Array
    scale: Array
    probe: float
    tick: float
    deadline: float

    def place(self, codes: Array) -> tuple[float, Array, Array, Array]:
        """Return what the numeric functions take besides the state."""
        return self.t, self.u, self.p, codes.astype(float)


@dataclass(frozen=True, eq=False)
class Found:
    """Modes that hold, the state in them, and which impacts rebound.

    Attributes
    ----------
    codes : (k,) array of int
    jump : Jump
    rebounds : tuple of int
        Switches that are free again at once after an impact.
    """

    codes: Array
    jump: Jump
    rebounds: tuple[int, ...] = ()


class ModeSearch:
    """Finds the modes that hold at a point.

    Parameters
    ----------
    model : ModeSet

    Attributes
    ----------
    refusal : str
        What spoke against the mode tried last.
    """

    def __init__(self, model: ModeSet) -> None:
        self.model = model
        self.refusal = ""

    def find(self, natural: Array, point: Point, now: Array | None) -> Found | None:
        """Return the modes nearest to the natural ones that hold; None where none does.

        Parameters
        ----------
        natural : (k,) array of int
            Codes tried first; those of commanded switches stand.
        point : Point
        now : (k,) array of int or None
            Codes so far; None at the start.

        Raises
        ------
        TimeoutError
            Past the point's deadline.
        """
        seen: set[tuple[int, ...]] = set()
        queue = deque([tuple(int(code) for code in natural)])
        while queue and len(seen) < MAX_TRIES:
            codes = queue.popleft()
            if codes in seen:
                continue
            seen.add(codes)
            found = self._attempt(numpy.array(codes, dtype=int), point, now)
            if isinstance(found, Found):
                return found
            queue.extend(found)
        for codes in self.nearby(natural) if len(natural) <= MAX_ALL else ():
            if codes not in seen:
                found = self._attempt(numpy.array(codes, dtype=int), point, now)
                if isinstance(found, Found):
                    return found
        return None

    def guards(self, codes: Array, point: Point, x: Array) -> tuple[Array, Array, Array]:
        """Return margins, values, and how far rounding of state and time can move a margin."""
        mode = self.model.numbers(mask_of(codes))
        t, u, p, s = point.place(codes)
        k = len(codes)

        def guard(t: float, x: Array) -> Array:
            return mode.guard(t, x, u, p, s)

        found = guard(t, x)
        uneven = 0.5 + numpy.modf(numpy.arange(len(x)) * 0.6180339887498949)[0]
        scatter = numpy.where(numpy.arange(len(x)) % 2, -uneven, uneven) * WOBBLE
        moved = numpy.abs(guard(t, x + scatter * numpy.maximum(numpy.abs(x), point.scale)) - found)
        noise = 64 * EPSILON * (moved / WOBBLE + numpy.abs(found))
        drift = mode.rhs(t, x, u, p, s)[: len(x)]
        for tick in (point.tick, -point.tick):
            noise += numpy.abs(guard(t + tick, x + tick * drift) - found)
        return found[:k], found[k:], noise[:k]

    def _attempt(
        self, codes: Array, point: Point, now: Array | None
    ) -> Found | list[tuple[int, ...]]:
        """Try one set of modes; return it, or those to try instead."""
        if time.monotonic() > point.deadline:
            raise TimeoutError
        try:
            mode = self.model.numbers(mask_of(codes))
            entered = self._entered(mode, codes, point, now)
            if entered is None:
                self.refusal = "the state cannot be brought into the mode"
                return self._neighbours(codes)
            found, wrong = entered
            wrong = wrong or self._violated(found, point)
        except BondGraphError as error:
            self.refusal = str(error)
            return self._neighbours(codes)
        if not wrong:
            return found
        self.refusal = "no mode keeps the margins of " + ", ".join(
            self.model.names[j] for j in wrong
        )
        flipped = [self._flipped(codes, {j: code}) for j, code in wrong.items()]
        return [flipped[0], self._flipped(codes, wrong), *flipped[1:]]

    def _entered(
        self, mode: ModeNumbers, codes: Array, point: Point, now: Array | None
    ) -> tuple[Found, dict[int, int]] | None:
        """Take the state into a mode; return what comes out, and switches that refuse the impulse."""
        place = point.place(codes)
        before = imposed_before(mode, place, point.x[:-2], point.scale)
        if before is None:
            return None
        after = numpy.zeros(len(before))
        final, rebounds = codes.copy(), []
        for index, j in enumerate(mode.held):
            element = self.model.elements[j]
            fresh = now is None or now[j] != 0
            if isinstance(element, EndStop) and codes[j] == 0 and fresh:
                restitution, rest = self.model.impact(j, point.p)
                if before[index] > rest and restitution > 0:
                    after[index] = -restitution * before[index]
                    final[j] = 1
                    rebounds.append(j)
        done = jump(mode, place, point.x, before, after, len(codes))
        return Found(final, done, tuple(rebounds)), self._refused(codes, done)

    def _refused(self, codes: Array, done: Jump) -> dict[int, int]:
        """Return the switches that cannot take their impulse, and the codes they change to."""
        largest = numpy.abs(done.impulses).max(initial=0.0)
        wrong = {}
        for j, impulse in enumerate(done.impulses):
            rule = self.model.elements[j].impulses[int(codes[j])]
            if abs(impulse) <= 1e-9 * largest or rule == 0:
                continue
            if rule is None or rule * impulse < 0:
                wrong[j] = self._turned(j, int(codes[j]), 0.0, float(impulse), 0.0)
        return wrong

    def _violated(self, found: Found, point: Point) -> dict[int, int]:
        """Return the switches whose margins are negative, or will be at once; the worst first."""
        codes, x = found.codes, found.jump.x[:-2]
        margins, values, noise = self.guards(codes, point, x)
        ahead = self._ahead(codes, point, x)
        wrong: dict[int, tuple[float, int]] = {}
        for j, element in enumerate(self.model.elements):
            if element.commanded:
                continue
            at_stop = isinstance(element, EndStop) and codes[j] == 1
            # one that is positive a moment later was negative by rounding only
            negative = margins[j] < -noise[j] and ahead[j] < 0 and not at_stop
            near = margins[j] <= noise[j]
            falling = near and ahead[j] < min(-2 * noise[j], margins[j])
            if negative or falling:
                code = self._turned(j, int(codes[j]), float(values[j]), 0.0, float(noise[j]))
                wrong[j] = (min(margins[j], ahead[j]), code)
        return {j: code for j, (_, code) in sorted(wrong.items(), key=lambda item: item[1][0])}

    def _ahead(self, codes: Array, point: Point, x: Array) -> Array:
        """Return the margins a moment later.

        Several small steps, since a gap that is zero now may open with the third order of time
        only, where the force that held it turns.
        """
        mode = self.model.numbers(mask_of(codes))
        t, u, p, s = point.place(codes)
        n, h = len(x), point.probe
        for part in range(PROBES):
            x = x + h * mode.rhs(t + part * h, x, u, p, s)[:n]
        return mode.guard(t + PROBES * h, x, u, p, s)[: len(codes)]

    def _turned(self, j: int, code: int, value: float, impulse: float, noise: float) -> int:
        """Return the code that a switch changes to."""
        element = self.model.elements[j]
        if not isinstance(element, DryFriction):
            return element.next_code(code, value, value)
        if impulse:
            return 1 if impulse > 0 else -1
        if code == 0 or abs(value) > noise:
            return 1 if value > 0 else -1
        return 0

    def _neighbours(self, codes: Array) -> list[tuple[int, ...]]:
        free = [j for j, element in enumerate(self.model.elements) if not element.commanded]
        return [
            self._flipped(codes, {j: code})
            for j in free
            for code in other_codes(self.model.elements[j], int(codes[j]))
        ]

    def _flipped(self, codes: Array, changes: dict[int, int]) -> tuple[int, ...]:
        return tuple(changes.get(j, int(code)) for j, code in enumerate(codes))

    def nearby(self, natural: Array, commands: bool = False) -> Iterator[tuple[int, ...]]:
        """All combinations of modes, those with few changes first.

        With ``commands``, those that commanded switches are not in by their signals as well.
        """
        choices: Sequence[Sequence[int]] = [
            [int(code)]
            if element.commanded and not commands
            else [int(code), *other_codes(element, int(code))]
            for element, code in zip(self.model.elements, natural, strict=True)
        ]
        combinations = itertools.product(*choices)
        yield from sorted(combinations, key=lambda codes: int(numpy.sum(codes != natural)))


def mask_of(codes: Array) -> int:
    """Return the structural mode: the bits of the switches that are held."""
    return sum(1 << int(j) for j in numpy.flatnonzero(codes == 0))


def other_codes(element: Switched, code: int) -> list[int]:
    """Return the codes of an element's other modes."""
    return [other for other in element.modes.values() if other != code]
