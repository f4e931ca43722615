"""Random bond graphs as bare lists: what there is, its numbers, and who is bonded to whom.

A `Plan` knows nothing of the framework but how to write itself in it (`Plan.graph`). The raw
equations of the same plan stand in `raw`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import sympy

import bondgraph as bg

from .formulae import COUPLES, FOLLOWS, KINETIC, MODULATES, RESISTS, STORES, symbolic

JUNCTIONS = {"0": bg.Zero, "1": bg.One}
FIELDS = ("CField", "IField", "ICField", "RField")
SIGNALS = ("Block", "Integrator", "Lag")
CONTACTS = ("Friction", "Clutch")
SWITCHES = ("Diode", "CheckValve", "Switch", "EndStop", *CONTACTS)
PASSIVE = ("R", "C", "I", "De", "Df", *SWITCHES)
STATE = {"C": "q", "I": "p"}


@dataclass(frozen=True)
class Part:
    """An element: kind, law by its name in `formulae`, numbers, and the variable it hears.

    A field has ports, by name and kind; its numbers are a matrix, row by row. A law that begins
    with ``pseudo`` stands on a pseudo-bond, whose flow is heat.
    """

    kind: str
    law: str = "linear"
    numbers: tuple[Fraction, ...] = ()
    heard: str = ""
    ports: dict[str, str] = field(default_factory=dict)

    @property
    def matrix(self) -> list[list[Fraction]]:
        size = len(self.ports)
        return [list(self.numbers[row * size : (row + 1) * size]) for row in range(size)]


@dataclass(frozen=True)
class Plan:
    """Parts by name, and bonds as (tail, head) in the order written.

    An end of a bond is a part, a port of a field (``name.port``), or the heat that an RS gives
    (``name_heat``, always a tail).
    """

    parts: dict[str, Part]
    bonds: tuple[tuple[str, str], ...]

    def of(self, *kinds: str) -> list[str]:
        return [name for name, part in self.parts.items() if part.kind in kinds]

    def owner(self, end: str) -> str:
        """Return the part that an end of a bond belongs to."""
        if end in self.parts:
            return end
        stem = end.removesuffix("_heat")
        return stem if stem in self.parts else end.rpartition(".")[0]

    def kind(self, end: str) -> str:
        """Return what an end is: of a field's port C, I or R; of an RS R or Heat."""
        part = self.parts[self.owner(end)]
        if part.ports:
            return part.ports[end.rpartition(".")[2]]
        if part.kind == "RS":
            return "Heat" if end.endswith("_heat") else "R"
        return part.kind

    @property
    def storages(self) -> dict[str, str]:
        """Every state's owner, also the ports of fields and signal blocks, and its letter."""
        found = {}
        for name, part in self.parts.items():
            if part.ports and part.kind != "RField":
                found |= {f"{name}.{port}": STATE[kind] for port, kind in part.ports.items()}
            elif part.kind in STATE or part.kind in SIGNALS:
                found[name] = STATE.get(part.kind, "y")
        return found

    @property
    def inputs(self) -> list[str]:
        """Sources that follow nothing: each is an input named like its element."""
        return [name for name in self.of("Se", "Sf") if not self.parts[name].heard]

    def inwards(self, tail: str, head: str) -> tuple[str, str]:
        """A passive one-port takes power whichever way its arrow is drawn."""
        return (head, tail) if self.kind(tail) in PASSIVE else (tail, head)

    def without(self, name: str) -> Plan:
        """Leave a part out, with all its bonds, and what hears it hears nothing."""
        gone = {name} | {
            other for other, part in self.parts.items() if part.heard.startswith(f"{name}.")
        }
        parts = {other: part for other, part in self.parts.items() if other not in gone}
        bonds = [bond for bond in self.bonds if not gone & set(map(self.owner, bond))]
        return Plan(parts, tuple(bonds))

    def graph(self, name: str = "plan") -> bg.BondGraph:
        """Write the plan with bonds and `assemble`."""
        made = self.elements()
        chains = [end_of(made, tail) >> end_of(made, head) for tail, head in self.bonds]
        return bg.assemble(name, *loose(made), *chains, inputs=self.symbols)

    @property
    def symbols(self) -> list[sympy.Symbol]:
        """The symbol of each input."""
        return [sympy.Symbol(f"u_{name}", real=True) for name in self.inputs]

    def elements(self) -> dict[str, Any]:
        """Make all elements: those that hear nothing first, signal blocks, then the others."""
        made: dict[str, Any] = {}

        def rank(name: str) -> int:
            part = self.parts[name]
            return 0 if not part.heard else 1 if part.kind in SIGNALS else 2

        for name in sorted(self.parts, key=rank):
            made[name] = element(name, self.parts[name], made)
        return {name: made[name] for name in self.parts}


def loose(made: dict[str, Any]) -> list[Any]:
    """Elements named without a bond: what no bond reaches has to be named; not RS, not fields."""
    return [item for item in made.values() if isinstance(item, bg.elements.Element)]


def end_of(made: dict[str, Any], end: str) -> Any:
    """Return what a bond is drawn to."""
    if end in made:
        return made[end]
    stem, _, port = end.rpartition(".")
    return made[stem][port] if stem else made[end.removesuffix("_heat")]


def hears(made: dict[str, Any], heard: str) -> sympy.Symbol:
    """Return the symbol of a variable such as ``c.e`` or ``field.port.q``."""
    owner, _, letter = heard.rpartition(".")
    return getattr(end_of(made, owner), letter)


def element(name: str, part: Part, made: dict[str, Any]) -> Any:
    """Write one part in the language under test."""
    kind, law = part.kind, part.law
    numbers = [symbolic(number) for number in part.numbers]
    heard = hears(made, part.heard) if part.heard else None
    if kind in JUNCTIONS:
        return JUNCTIONS[kind](name, pseudo=law == "pseudo")
    if kind in ("De", "Df"):
        return getattr(bg, kind)(name)
    if kind in FIELDS:
        return _field(name, part, sympy.Matrix(part_matrix(part)))
    if kind in SIGNALS:
        return _block(name, kind, heard, numbers)
    if kind in ("TF", "GY"):
        ratio = numbers[0] if heard is None else MODULATES[law](sympy, heard, numbers[0])
        return getattr(bg, kind)(name, ratio)
    if kind in ("Se", "Sf"):
        value = sympy.Symbol(f"u_{name}", real=True)
        if heard is not None:
            value = FOLLOWS[law](sympy, heard, numbers[0])
        return getattr(bg, kind)(name, value)
    if kind in ("R", "RS"):
        return getattr(bg, kind)(name, **_resists(law, numbers[0], heard))
    if kind in STATE:
        return _stores(name, kind, law, numbers[0])
    return _switch(name, part, numbers)


def part_matrix(part: Part) -> list[list[sympy.Rational]]:
    """A field's matrix for sympy."""
    return [[symbolic(value) for value in row] for row in part.matrix]


def _resists(law: str, number: Any, heard: Any) -> dict[str, Any]:
    if heard is not None:
        return {"effort": lambda f: MODULATES[law](sympy, heard, number) * f}
    if law == "linear":
        return {"resistance": number}
    if law == "pseudo linear":
        return {"resistance": number, "pseudo": True}
    gives, _, formula = law.partition(" ")
    return {gives: lambda x: RESISTS[formula](sympy, x, number)}


def _stores(name: str, kind: str, law: str, number: Any) -> Any:
    make = getattr(bg, kind)
    if law in ("linear", "pseudo linear"):
        return make(name, number)
    key, _, formula = law.partition(" ")
    store = STORES[formula]
    if key == "energy":
        return make(name, energy=lambda x: store.energy(sympy, x, number))
    return make(name, **{key: lambda x: store.law(sympy, x, number)})


def _field(name: str, part: Part, matrix: sympy.Matrix) -> Any:
    if part.law in ("stiffness", "compliance", "inertance", "resistance", "conductance"):
        return getattr(bg, part.kind)(name, tuple(part.ports), **{part.law: matrix})
    if part.kind == "RField":

        def efforts(*flows: Any) -> list[Any]:
            rows = list(matrix * sympy.Matrix(flows))
            return [rows[0] + flows[0] ** 3, *rows[1:]]

        return bg.RField(name, tuple(part.ports), effort=efforts)

    def energy(*states: Any) -> Any:
        column = sympy.Matrix(states)
        more = COUPLES[part.law][0](*states[:2]) if part.law in COUPLES else 0
        return sympy.expand((column.T * matrix * column)[0] / 2) + more

    ports = part.ports if part.kind == "ICField" else tuple(part.ports)
    return getattr(bg, part.kind)(name, ports, energy=energy)


def _block(name: str, kind: str, heard: Any, numbers: list[Any]) -> Any:
    gain, constant = numbers
    if kind == "Integrator":
        return bg.Integrator(name, gain * heard)
    if kind == "Lag":
        return bg.Lag(name, gain * heard, constant)
    return bg.Block(name, rate=lambda y: gain * heard - constant * y)


def _switch(name: str, part: Part, numbers: list[Any]) -> Any:
    if part.kind in ("Diode", "CheckValve"):
        return getattr(bg, part.kind)(name, drop=numbers[0], resistance=numbers[1])
    if part.kind == "Switch":
        return bg.Switch(name, closed=bg.TIME - numbers[0])
    if part.kind == "EndStop":
        return bg.EndStop(name, gap=numbers[0], restitution=sympy.Rational(1, 2))
    if part.kind == "Clutch":
        return bg.Clutch(name, numbers[0])
    return bg.Friction(
        name,
        kinetic=lambda speed: KINETIC[part.law](sympy, speed, numbers[0]),
        breakaway=3 * numbers[0],
    )


def listening(plan: Plan, name: str, heard: str, law: str, number: Fraction) -> Plan:
    """Return the plan with one part that follows a variable."""
    part = replace(plan.parts[name], heard=heard, law=law, numbers=(number,))
    return Plan({**plan.parts, name: part}, plan.bonds)
