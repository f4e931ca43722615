"""The list of cases: what is hidden, how it is excited, measured and spoiled. Nothing is run here."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy

from .entries import ENTRIES, Entry
from .excite import KINDS
from .plants import PLANTS

SEED = 20261122
LEVELS = (0.002, 0.02, 0.1, 0.2)


@dataclass(frozen=True)
class Plan:
    """One case before it is run.

    Attributes
    ----------
    kind : ``effect``, ``nothing``, ``wrong``, ``outside``, ``two`` or ``low``
    machine : of `machines.MACHINES`
    entries : what is hidden
    noise : share of each signal's deviation
    wrong : factors on the truth's parameters, by name
    right : answers that are right where nothing is hidden but a number is wrong
    hidden_signal : the output that is not measured
    flaw : ``outliers``, ``gaps``, ``coarse``, ``zero`` or none
    number : its place in the whole list
    """

    kind: str
    machine: str
    entries: tuple[Entry, ...] = ()
    noise: float = 0.02
    wrong: Mapping[str, float] = field(default_factory=dict)
    right: tuple[tuple[str, str], ...] = ()
    hidden_signal: str = ""
    flaw: str = ""
    number: int = 0

    @property
    def id(self) -> str:
        """Opaque, and the same for the same list."""
        return hashlib.sha256(f"{SEED}/{self.number}".encode()).hexdigest()[:8]

    @property
    def rng(self) -> numpy.random.Generator:
        """The case's own random numbers."""
        return numpy.random.default_rng([SEED, self.number])

    def excitations(self) -> tuple[str, str]:
        """Return the kinds of the training and the validating input, of which no two are alike."""
        i = self.number % len(KINDS)
        return KINDS[i], KINDS[(i + 1) % len(KINDS)]

    @property
    def stratum(self) -> str:
        """What a subset keeps the proportions of."""
        return f"{self.kind} {self.noise:g} {bool(self.flaw)} {bool(self.hidden_signal)}"


def plans() -> tuple[Plan, ...]:
    """Return all cases."""
    found = [
        *_effects(),
        *_nothing(),
        *_wrong(),
        *_outside(),
        *_two(),
        *_low(),
        *_partial(),
        *_flawed(),
    ]
    return tuple(replace(plan, number=i) for i, plan in enumerate(found))


def subset(fraction: float, only: str = "") -> tuple[Plan, ...]:
    """Return a share of each stratum, the same at every call, of what is named by ``only``.

    Parameters
    ----------
    fraction : 0 to 1
    only : an id, a machine, an effect or a kind; all of them if empty
    """
    chosen = [plan for plan in plans() if not only or only in names_of(plan)]
    strata: dict[str, list[Plan]] = {}
    for plan in sorted(chosen, key=lambda plan: plan.id):
        strata.setdefault(plan.stratum, []).append(plan)
    kept = [plan for rows in strata.values() for plan in rows[: round(fraction * len(rows) + 0.4)]]
    return tuple(sorted(kept, key=lambda plan: plan.id))


def names_of(plan: Plan) -> set[str]:
    """Return what a case may be called on the command line."""
    return {plan.id, plan.machine, plan.kind, *(entry.effect for entry in plan.entries)}


def entry(machine: str, effect: str, site: str) -> Entry:
    """Return the first entry of an effect at a site."""
    return next(e for e in ENTRIES if (e.machine, e.effect, e.site) == (machine, effect, site))


def _effects() -> Iterator[Plan]:
    """Yield every entry at 2 %, and every other one at 0.2 and 20 %, the rest at 10 %."""
    for i, each in enumerate(ENTRIES):
        for noise in (0.02, *((0.002, 0.2) if i % 2 else (0.1,))):
            yield Plan("effect", each.machine, (each,), noise)


def _nothing() -> Iterator[Plan]:
    for i, machine in enumerate(PLANTS):
        for noise in (0.02, LEVELS[(0, 2, 3)[i % 3]], LEVELS[(2, 3, 0)[i % 3]]):
            yield Plan("nothing", machine, noise=noise)


def _wrong() -> Iterator[Plan]:
    """Yield parameters of the table that are off, and numbers that stand in a law."""
    off = (
        ("mass_spring", {"k": 1.4}),
        ("mass_spring", {"m": 0.7, "b": 1.3}),
        ("two_mass_chain", {"m2": 1.35}),
        ("undamped_chain", {"k1": 0.65}),
        ("dc_motor", {"kt": 1.25}),
        ("free_motor", {"Jl": 0.7}),
        ("quarter_car", {"cs": 0.6}),
        ("two_tanks", {"R12": 1.4}),
        ("hydraulic_cylinder", {"Coil": 1.4, "B": 0.7}),
        ("thermal_brake", {"Rc": 0.65}),
        ("rlc", {"Ce": 1.3}),
        ("rc", {"Re": 0.75}),
    )
    for i, (machine, factors) in enumerate(off):
        yield Plan("wrong", machine, noise=(0.02, 0.1)[i % 2], wrong=factors)
    numbers: tuple[tuple[str, dict[str, float], tuple[tuple[str, str], ...]], ...] = (
        ("rlc", {"Rload": 0.6}, (("leakage", "node"),)),
        ("rlc", {"Rload": 1.4}, ()),
        ("weighed_mass", {"m": 1.25}, (("added_inertia", "carriage"),)),
        ("weighed_mass", {"m": 0.75}, ()),
        ("weighed_chain", {"m2": 0.8}, ()),
        ("weighed_chain", {"m2": 1.3}, (("added_inertia", "second"),)),
        ("quarter_car", {"ms": 1.3}, ()),
        ("hydraulic_cylinder", {"A": 1.2}, ()),
    )
    for machine, factors, right in numbers:
        for noise in (0.02, 0.1):
            yield Plan("wrong", machine, noise=noise, wrong=factors, right=right)


def _outside() -> Iterator[Plan]:
    """Yield effects of no kind that the library has."""
    found = (
        Entry("mass_spring", "van_der_pol", "carriage", {"size": 6.0, "width": 0.015}, ("size",)),
        Entry("mass_spring", "clocked", "carriage", {"size": 3.0, "period": 0.37}, ("size",)),
        Entry("mass_spring", "one_way", "carriage", {"size": 5.0}, ("size",)),
        Entry("two_mass_chain", "van_der_pol", "way", {"size": 3.0, "width": 0.01}, ("size",)),
        Entry("two_mass_chain", "clocked", "second", {"size": 2.0, "period": 0.29}, ("size",)),
        Entry("dc_motor", "one_way", "wheel", {"size": 2e-3}, ("size",)),
        Entry("dc_motor", "clocked", "wheel", {"size": 0.1, "period": 0.11}, ("size",)),
        Entry("quarter_car", "one_way", "suspension", {"size": 900.0}, ("size",)),
        Entry(
            "quarter_car", "van_der_pol", "suspension", {"size": 600.0, "width": 0.015}, ("size",)
        ),
        Entry("two_tanks", "clocked", "first", {"size": 2e-4, "period": 97.0}, ("size",)),
        Entry("two_tanks", "clocked", "second", {"size": 2e-4, "period": 71.0}, ("size",)),
        Entry("hydraulic_cylinder", "one_way", "rod", {"size": 2000.0}, ("size",)),
        Entry("hydraulic_cylinder", "clocked", "rod", {"size": 800.0, "period": 0.083}, ("size",)),
        Entry("thermal_brake", "one_way", "wheel", {"size": 0.6}, ("size",)),
        Entry("rlc", "clocked", "loop", {"size": 5.0, "period": 7.3e-3}, ("size",)),
        Entry("rlc", "one_way", "loop", {"size": 4.0}, ("size",)),
    )
    for i, each in enumerate(found):
        for noise in (0.02, (0.002, 0.1)[i % 2]):
            yield Plan("outside", each.machine, (each,), noise)


def _two() -> Iterator[Plan]:
    pairs = (
        ("mass_spring", ("coulomb_friction", "carriage"), ("cubic_stiffness", "carriage")),
        ("mass_spring", ("quadratic_drag", "carriage"), ("transport_delay", "source actuator")),
        (
            "two_mass_chain",
            ("coulomb_friction", "first"),
            ("quadratic_drag", "second"),
        ),
        ("dc_motor", ("coulomb_friction", "wheel"), ("saturation", "source supply")),
        ("quarter_car", ("coulomb_friction", "suspension"), ("cubic_stiffness", "suspension")),
        ("two_tanks", ("leakage", "first"), ("overflow", "second")),
        ("hydraulic_cylinder", ("coulomb_friction", "rod"), ("leakage", "chamber")),
        ("rlc", ("nonlinear_inertance", "inertia coil"), ("overflow", "node")),
    )
    for machine, *both in pairs:
        hidden = tuple(entry(machine, effect, site) for effect, site in both)
        for noise in (0.002, 0.02):
            yield Plan("two", machine, hidden, noise)


def _low() -> Iterator[Plan]:
    """Yield effects that are there and are not excited: nothing can be named."""
    found = (
        ("mass_spring", "dead_zone", "carriage", {"width": 0.2}),
        ("mass_spring", "end_stop", "carriage", {"upper": 0.15, "lower": 0.2}),
        ("mass_spring", "cubic_stiffness", "carriage", {"cubic": 300.0}),
        ("two_mass_chain", "quadratic_drag", "second", {"drag": 1e-3}),
        ("dc_motor", "saturation", "source supply", {"limit": 15.0}),
        ("dc_motor", "nonlinear_inertance", "inertia coil", {"cubic": 20.0}),
        ("quarter_car", "dead_zone", "suspension", {"width": 0.3}),
        ("two_tanks", "overflow", "second", {"threshold": 8000.0}),
        ("hydraulic_cylinder", "end_stop", "rod", {"upper": 0.06, "lower": 0.06}),
        ("rlc", "overflow", "node", {"threshold": 60.0}),
    )
    for machine, effect, site, values in found:
        base = entry(machine, effect, site)
        weak = replace(base, values={**base.values, **values}, scaled=())
        yield Plan("low", machine, (weak,), 0.02)


def _partial() -> Iterator[Plan]:
    found = (
        ("mass_spring", "coulomb_friction", "carriage", "v"),
        ("mass_spring", "cubic_stiffness", "carriage", "x"),
        ("mass_spring", "quadratic_drag", "carriage", "x"),
        ("two_mass_chain", "coulomb_friction", "first", "v2"),
        ("two_mass_chain", "dead_zone", "between first and second", "v1"),
        ("dc_motor", "coulomb_friction", "wheel", "current"),
        ("dc_motor", "saturation", "source supply", "speed"),
        ("quarter_car", "coulomb_friction", "suspension", "body_speed"),
        ("quarter_car", "cubic_stiffness", "suspension", "body_speed"),
        ("two_tanks", "overflow", "first", "p2"),
        ("hydraulic_cylinder", "coulomb_friction", "rod", "pressure"),
        ("hydraulic_cylinder", "quadratic_drag", "line", "speed"),
        ("thermal_brake", "quadratic_drag", "wheel", "temperature"),
        ("rlc", "nonlinear_inertance", "inertia coil", "u"),
    )
    for i, (*what, missing) in enumerate(found):
        each = entry(*what)
        # one signal rarely tells the scale of all parameters, so coefficients are not asked for
        each = replace(each, unscored=tuple(each.values))
        yield Plan("effect", each.machine, (each,), (0.02, 0.002)[i % 2], hidden_signal=missing)


def _flawed() -> Iterator[Plan]:
    found = (
        ("mass_spring", "coulomb_friction", "carriage"),
        ("two_mass_chain", "quadratic_drag", "second"),
        ("quarter_car", "cubic_stiffness", "suspension"),
        ("rlc", "saturation", "source generator"),
    )
    for what in found:
        each = entry(*what)
        for flaw in ("outliers", "gaps", "coarse", "zero"):
            yield Plan("effect", each.machine, (each,), 0.02, flaw=flaw)
