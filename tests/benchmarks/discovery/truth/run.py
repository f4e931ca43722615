"""`simulate`: a machine with hidden effects over the samples of its input."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil

import numpy

from . import (
    dc_motor,
    hydraulic_cylinder,
    mass_spring,
    quarter_car,
    rlc,
    thermal_brake,
    two_mass_chain,
    two_tanks,
)
from .drive import Drive, sensed
from .laws import SMOOTH, Law
from .ode import NOTHING, Inner, Ode, State
from .sliding import SWITCHED, Contact, DryFriction, Stops, switched

MODULES = {
    module.__name__.rpartition(".")[2]: module
    for module in (
        mass_spring,
        two_mass_chain,
        dc_motor,
        quarter_car,
        two_tanks,
        hydraulic_cylinder,
        thermal_brake,
        rlc,
    )
}
FINE = 0.15  # of the fastest rate's time, a step
TWINS = {  # pairs whose relative flow is that of a 1-junction
    "between first and second": "way",
    "between motor and wheel": "twist",
    "between wheel and body": "suspension",
}


@dataclass(frozen=True)
class Hidden:
    """An effect at a site of a machine.

    Attributes
    ----------
    effect, site : as the library names them, or of `laws.OUTSIDE`
    values : coefficients, SI
    form : the law's name here, where it is another than the effect's
    """

    effect: str
    site: str
    values: Mapping[str, float] = field(default_factory=dict)
    form: str = ""

    @property
    def law(self) -> str:
        return self.form or self.effect


def simulate(
    machine: str, parameters: Mapping[str, float], hidden: Sequence[Hidden], drive: Drive
) -> dict[str, numpy.ndarray]:
    """Return outputs at the samples of the input, by name, SI.

    Parameters
    ----------
    machine : of `MODULES`
    parameters : all numbers of the machine, SI
    hidden : none or more
    drive : its input
    """
    late = {h.effect: h.values for h in hidden if h.site.startswith("source ")}
    spoiled = {h.site.removeprefix("output "): h for h in hidden if h.site.startswith("output ")}
    acting = [h for h in hidden if not h.site.startswith(("source ", "output "))]
    inner = next((Inner(h.effect, h.site, h.values) for h in acting if _inner(h)), NOTHING)
    ode = MODULES[machine].build(parameters, inner)
    u = drive.function(
        late.get("transport_delay", {}).get("delay", 0.0),
        late.get("saturation", {}).get("limit", float("inf")),
    )
    motion = _Motion(ode, [h for h in acting if not _inner(h)], u)
    rows = motion.run(drive.t)
    columns = dict(zip(ode.names, numpy.array(rows).T, strict=True))
    for name, h in spoiled.items():
        columns[name] = sensed(drive.t, columns[name], h.effect, h.values)
    return columns


def _inner(h: Hidden) -> bool:
    """Whether an effect changes the machine's own equations."""
    return (
        h.site.startswith(("bond ", "inertia ", "dissipator "))
        or h.effect == "added_inertia"
        or (h.effect == "quadratic_drag" and h.site in ("pipe", "line"))
    )


class _Motion:
    """A run: the machine's states, then displacement and memory of each hidden effect."""

    def __init__(self, ode: Ode, hidden: Sequence[Hidden], u: Callable) -> None:
        self.ode, self.u, self.own = ode, u, len(ode.start)
        self.smooth: list[tuple[str, Law, Mapping[str, float], int]] = []
        self.switch: DryFriction | Stops | None = None
        self.site, self.place, self.mode = "", 0, 0
        self.start = list(ode.start)
        pace = ode.pace
        for h in hidden:
            site = h.site if h.site in ode.flows else TWINS[h.site]
            place = len(self.start)
            self.start += [ode.ways.get(site, 0.0), 0.0]
            pace = max(pace, h.values.get("pace", 0.0))
            if h.law in SWITCHED:
                self.switch, self.site, self.place = switched(h.law, h.values), site, place
            else:
                self.smooth.append((site, SMOOTH[h.law], h.values, place))
        self.pace = pace

    def run(self, times: numpy.ndarray) -> list[tuple[float, ...]]:
        grid = times.tolist()
        steps = ceil((grid[1] - grid[0]) * self.pace / FINE)
        s = list(self.start)
        if self.switch is not None:
            self.mode = self.switch.first(self.contact(grid[0], grid[0], s))
        rows = [self.ode.outputs(s, self.u(grid[0], grid[0] + 1e-9 * (grid[1] - grid[0])))]
        for t0, t1 in pairwise(grid):
            h = (t1 - t0) / steps
            for i in range(steps):
                s = self.step(t0 + i * h, h, s)
            rows.append(self.ode.outputs(s, self.u(t1, t1 + 1e-9 * (t1 - t0))))
        return rows

    def step(self, t: float, h: float, s: State) -> State:
        """Step once, or to an event and on from there."""
        middle = t + h / 2
        if self.switch is None:
            return _rk4(lambda at, x: self.rates(at, middle, x), t, h, s)
        end, left = t + h, 50
        while True:
            new = self.tried(t, end - t, s, middle)
            left -= 1
            if self.margin(end, new, middle) >= 0 or left == 0:
                return new
            to = self.located(t, end - t, s, middle)
            s, t = self.tried(t, to, s, middle), t + to
            s = self.moved_on(t, middle, s)
            if end - t <= 1e-12 * h:
                return s

    def tried(self, t: float, h: float, s: State, middle: float) -> State:
        return _rk4(lambda at, x: self.rates(at, middle, x), t, h, s)

    def located(self, t: float, h: float, s: State, middle: float) -> float:
        """Return how far the mode lasts, by bisection."""
        low, high = 0.0, h
        while high - low > 1e-11 * h:
            half = (low + high) / 2
            inside = self.margin(t + half, self.tried(t, half, s, middle), middle) >= 0
            low, high = (half, high) if inside else (low, half)
        return high

    def margin(self, t: float, s: State, middle: float) -> float:
        assert self.switch is not None
        needs = self.mode in self.switch.held
        return self.switch.margin(self.mode, self.contact(t, middle, s, holding=needs))

    def moved_on(self, t: float, middle: float, s: State) -> State:
        """Take the next mode; an impact moves states along what an effort at the site moves."""
        assert self.switch is not None
        s = list(s)

        def strike(flow: float) -> None:
            without, unit = self.kicks(t, middle, s)
            way = [b - a for a, b in zip(without, unit, strict=True)]
            now = self.ode.flows[self.site](s)
            gain = self.ode.flows[self.site]([a + b for a, b in zip(s, way, strict=True)]) - now
            share = (flow - now) / gain
            s[:] = [a + share * b for a, b in zip(s, way, strict=True)]

        self.mode = self.switch.after(self.mode, self.contact(t, middle, s), strike)
        return s

    def contact(self, t: float, middle: float, s: State, holding: bool = True) -> Contact:
        f = self.ode.flows[self.site](s)
        if not holding:
            return Contact(s[self.place], f, 0.0)
        without, unit = self.kicks(t, middle, s)
        own = self.ode.flows[self.site]
        base = own(s)
        # flows of sites with a switching effect are linear in the states
        a = own([x + d for x, d in zip(s, without, strict=True)]) - base
        b = own([x + d for x, d in zip(s, unit, strict=True)]) - base
        return Contact(s[self.place], f, -a / (b - a))

    def kicks(self, t: float, middle: float, s: State) -> tuple[State, State]:
        """Return rates without the switching effect's effort, and with one of one."""
        u, loads = self.u(t, middle), self.loads(t, s)[0]
        pad = [0.0] * (len(s) - self.own)
        without = self.ode.rates(s[: self.own], u, loads) + pad
        loads[self.site] = loads.get(self.site, 0.0) + 1.0
        return without, self.ode.rates(s[: self.own], u, loads) + pad

    def loads(self, t: float, s: State) -> tuple[dict[str, float], list[float]]:
        loads: dict[str, float] = {}
        more = [0.0] * (len(s) - self.own)
        for site, law, values, place in self.smooth:
            f = self.ode.flows[site](s)
            taken, memory = law(values, s[place], f, s[place + 1], t)
            loads[site] = loads.get(site, 0.0) + taken
            more[place - self.own] = f
            more[place + 1 - self.own] = memory
        return loads, more

    def rates(self, t: float, middle: float, s: State) -> State:
        loads, more = self.loads(t, s)
        if self.switch is not None:
            f = self.ode.flows[self.site](s)
            more[self.place - self.own] = f
            if self.mode in self.switch.held:
                effort = self.contact(t, middle, s).holding
            else:
                effort = self.switch.effort(self.mode, s[self.place], f)
            loads[self.site] = loads.get(self.site, 0.0) + effort
        return self.ode.rates(s[: self.own], self.u(t, middle), loads) + more


def _rk4(rates: Callable[[float, State], State], t: float, h: float, s: State) -> State:
    a = rates(t, s)
    b = rates(t + h / 2, [x + h / 2 * d for x, d in zip(s, a, strict=True)])
    c = rates(t + h / 2, [x + h / 2 * d for x, d in zip(s, b, strict=True)])
    d = rates(t + h, [x + h * d for x, d in zip(s, c, strict=True)])
    return [
        x + h / 6 * (p + 2 * q + 2 * r + w) for x, p, q, r, w in zip(s, a, b, c, d, strict=True)
    ]
