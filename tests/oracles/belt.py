"""A mass on a moving belt, in closed form.

A mass `m` on a spring `k` rides a belt of speed `v_b`. Friction holds it up to `F_s`; once it
slides, friction is `F_k` towards the belt's motion whatever the slip, so each phase is a line or
a harmonic and every event time is a formula. Nothing is damped.

For m = 1, k = 100, v_b = 0.5, F_s = 12, F_k = 8 each slip of the cycle *lasts* 0.493370342273 s
and each stick *lasts* 0.16 s: durations, not instants. Started stuck at ``x = F_s/k`` on the point
of slipping (``x0=0.12``), it sticks at 0.493370342273 s and lets go 0.16 s later. Started
stuck at ``x = 0.04``, it lets go at 0.16 s and sticks again 0.493370342273 s later. From rest at
``x = 0`` it slides at first, sticks at 0.067513153 s, lets go at 0.272413113 s and has then joined
the same cycle. `Belt.events` lists any of these.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

Mode = Literal["stick", "slip+", "slip-"]


class Event(NamedTuple):
    """A change of mode: time in s, mode left, mode entered."""

    t: float
    left: Mode
    entered: Mode


class Phase(NamedTuple):
    """One mode from `t` (s) to `end` (s, may be inf), entered at `x` (m) and `v` (m/s)."""

    mode: Mode
    t: float
    end: float
    x: float
    v: float


@dataclass(frozen=True)
class Belt:
    """Mass on a belt; ``slip+`` is a mass slower than the belt, ``slip-`` a faster one.

    Attributes
    ----------
    m, k : mass in kg, stiffness in N/m
    v_b : speed of the belt, m/s, positive
    F_s, F_k : static limit and kinetic friction, N, with ``F_s >= F_k > 0``
    """

    m: float = 1.0
    k: float = 100.0
    v_b: float = 0.5
    F_s: float = 12.0
    F_k: float = 8.0

    @property
    def omega(self) -> float:
        """Natural frequency, rad/s."""
        return math.sqrt(self.k / self.m)

    @property
    def slip_duration(self) -> float:
        """Length of each slip of the settled cycle, s."""
        drop = (self.F_s - self.F_k) / self.k
        return 2 * (math.pi - math.atan(drop * self.omega / self.v_b)) / self.omega

    @property
    def stick_duration(self) -> float:
        """Length of each stick of the settled cycle, s."""
        return 2 * (self.F_s - self.F_k) / (self.k * self.v_b)

    @property
    def period(self) -> float:
        """Period of the stick-slip cycle, s."""
        return self.slip_duration + self.stick_duration

    def phases(self, x0: float, v0: float | None = None) -> Iterator[Phase]:
        """Phases in order of time, ending with one that lasts for ever if there is one.

        Parameters
        ----------
        x0 : deflection of the spring at t = 0, m
        v0 : velocity of the mass at t = 0, m/s; the belt's if not given, which means stuck
        """
        t, x, v = 0.0, x0, self.v_b if v0 is None else v0
        while True:
            mode = self._mode(x, v)
            end = t + self._duration(mode, x, v)
            yield Phase(mode, t, end, x, v)
            if end == math.inf:
                return
            x, _ = self._move(mode, x, v, end - t)
            t, v = end, self.v_b
            if mode == "stick":
                x = self.F_s / self.k

    def events(self, t_end: float, x0: float, v0: float | None = None) -> list[Event]:
        """Changes of mode up to `t_end`, from the start that `phases` describes."""
        found: list[Event] = []
        last: Phase | None = None
        for phase in self.phases(x0, v0):
            if phase.t > t_end:
                break
            if last is not None:
                found.append(Event(phase.t, last.mode, phase.mode))
            last = phase
        return found

    def state(self, t: float, x0: float, v0: float | None = None) -> tuple[float, float]:
        """Deflection (m) and velocity (m/s) at time `t`, from the start that `phases` describes."""
        for phase in self.phases(x0, v0):
            if t <= phase.end:
                return self._move(phase.mode, phase.x, phase.v, t - phase.t)
        raise AssertionError("phases cover all times")

    def _mode(self, x: float, v: float) -> Mode:
        if v != self.v_b:
            return "slip+" if v < self.v_b else "slip-"
        # at the limit itself the belt drags the mass on, so it lets go
        if -self.F_s <= self.k * x < self.F_s:
            return "stick"
        return "slip+" if x > 0 else "slip-"

    def _centre(self, mode: Mode) -> float:
        return self.F_k / self.k * (1.0 if mode == "slip+" else -1.0)

    def _duration(self, mode: Mode, x: float, v: float) -> float:
        """Time until the mode ends, s."""
        if mode == "stick":
            return (self.F_s / self.k - x) / self.v_b
        offset = (x - self._centre(mode)) * self.omega
        amplitude, phase = math.hypot(offset, v), math.atan2(offset, v)
        if amplitude < self.v_b:
            return math.inf
        # v(t) = amplitude cos(omega t + phase): it next meets the belt's speed from below where the
        # cosine rises (slip+), from above where it falls (slip-)
        reach = math.acos(self.v_b / amplitude)
        if v == self.v_b:
            # it leaves from the other crossing, which `phase` is itself
            turn = 2 * math.pi - 2 * phase if mode == "slip+" else -2 * phase
        else:
            turn = (-reach if mode == "slip+" else reach) - phase
        return turn % (2 * math.pi) / self.omega

    def _move(self, mode: Mode, x: float, v: float, t: float) -> tuple[float, float]:
        if mode == "stick":
            return x + self.v_b * t, self.v_b
        centre, angle = self._centre(mode), self.omega * t
        offset, speed = x - centre, v / self.omega
        return (
            centre + offset * math.cos(angle) + speed * math.sin(angle),
            self.omega * (speed * math.cos(angle) - offset * math.sin(angle)),
        )
