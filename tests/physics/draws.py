"""Random plans from a seeded generator: the same seed draws the same plan.

A plan drawn is well formed; whether it has a solution is left open.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

from .plans import CONTACTS, SIGNALS, STATE, Part, Plan

VALUES = [
    Fraction(n, d) for n, d in [(1, 1), (2, 1), (3, 1), (1, 2), (2, 3), (5, 3), (5, 4), (7, 5)]
]
RATIOS = [sign * value for value in VALUES for sign in (1, -1)]
OFFSIDE = [Fraction(n, 2) for n in (-2, -1, 0, 1, 2)]
DEFINITE = [Fraction(n, 2) for n in (5, 6, 7, 9)]


@dataclass(frozen=True)
class Menu:
    """What a plan may hold: at most so many of each, and chances from 0 to 1.

    Attributes
    ----------
    junctions, loops, ones, chain
        Junctions, bonds that close a loop of junctions, one-ports at a junction, and
        two-ports in a row.
    kinds
        One-ports to draw from, each as often as it stands here.
    fields, sensors, blocks, signals, pairs, switches
        Multiport fields, sensors, signal blocks, parts that follow a variable, sources bonded
        to a one-port without a junction, and switching elements.
    curved
        Share of laws that are not linear.
    heats
        Dissipators that heat a body.
    """

    junctions: int = 5
    loops: int = 2
    ones: int = 3
    chain: int = 2
    kinds: tuple[str, ...] = ("R", "C", "I", "R", "C", "I", "Se", "Sf")
    fields: int = 0
    sensors: int = 0
    blocks: int = 0
    signals: int = 0
    pairs: int = 0
    switches: int = 0
    heats: int = 0
    curved: float = 0.0
    switching: tuple[str, ...] = ("Diode", "Switch", "CheckValve", "EndStop", "Friction", "Clutch")


def draw(rng: random.Random, menu: Menu) -> Plan:
    """Draw a plan."""
    return _Draw(rng, menu).plan()


class _Draw:
    """Draws part by part and bond by bond."""

    def __init__(self, rng: random.Random, menu: Menu) -> None:
        self.rng = rng
        self.menu = menu
        self.parts: dict[str, Part] = {}
        self.bonds: list[tuple[str, str]] = []
        self.nodes: list[str] = []

    def plan(self) -> Plan:
        menu, rng = self.menu, self.rng
        self.nodes = [
            self.part(Part(rng.choice("01"))) for _ in range(rng.randint(1, menu.junctions))
        ]
        for place, node in enumerate(self.nodes[1:], start=1):
            self.join(rng.choice(self.nodes[:place]), node)
        for _ in range(rng.randint(0, menu.loops) if len(self.nodes) > 1 else 0):
            self.join(*rng.sample(self.nodes, 2))
        for node in self.nodes:
            for _ in range(rng.randint(0, menu.ones)):
                self.join(node, self.part(self.simple(rng.choice(menu.kinds))))
        for _ in range(self.up_to(menu.fields)):
            self.field()
        for _ in range(self.up_to(menu.switches)):
            self.join(rng.choice(self.nodes), self.part(self.switching()), 0)
        for _ in range(self.up_to(menu.heats)):
            self.heat()
        for node in self.nodes:
            while sum(node in bond for bond in self.bonds) < 2:
                self.join(node, self.part(self.simple(rng.choice(("R", "C", "I")))), 0)
        for _ in range(self.up_to(menu.sensors)):
            self.sensor()
        for _ in range(self.up_to(menu.pairs)):
            self.pair()
        plan = Plan(self.parts, tuple(self.bonds))
        return self.signals(plan)

    def up_to(self, most: int) -> int:
        return self.rng.randint(0, most)

    def part(self, part: Part) -> str:
        name = f"{part.kind}{chr(97 + len(self.parts) % 26)}{len(self.parts)}"
        self.parts[name] = part
        return name

    def curved(self) -> bool:
        return self.rng.random() < self.menu.curved

    def simple(self, kind: str) -> Part:
        """Draw a one-port or two-port with its law."""
        rng = self.rng
        if kind in ("Se", "Sf"):
            return Part(kind)
        if kind in ("TF", "GY"):
            return Part(kind, numbers=(rng.choice(RATIOS),))
        law = "linear"
        if self.curved() and kind == "R":
            law = f"{rng.choice(('effort', 'flow'))} {rng.choice(('cubic', 'tanh', 'rise'))}"
        elif self.curved() and kind in STATE:
            gives = rng.choice(("energy", "effort" if kind == "C" else "flow"))
            law = (
                f"{gives} cubic"
                if gives != "energy"
                else f"energy {rng.choice(('cubic', 'growth', 'swing'))}"
            )
        return Part(kind, law, (rng.choice(VALUES),))

    def join(self, first: str, second: str, chain: int | None = None, turn: bool = True) -> None:
        """Bond two ends, now and then through two-ports, with arrows either way."""
        rng = self.rng
        most = self.menu.chain if chain is None else chain
        between = [
            self.part(self.simple(rng.choice(("TF", "GY"))))
            for _ in range(rng.choice(range(most + 1)))
        ]
        for tail, head in pairwise([first, *between, second]):
            backwards = turn and rng.random() < 0.5
            self.bonds.append((head, tail) if backwards else (tail, head))

    def matrix(self, size: int, skew: bool) -> tuple[Fraction, ...]:
        """Draw a positive definite matrix: its diagonal outweighs the rest."""
        rows = [[Fraction(0)] * size for _ in range(size)]
        for i in range(size):
            rows[i][i] = self.rng.choice(DEFINITE)
            for j in range(i):
                rows[i][j] = rows[j][i] = self.rng.choice(OFFSIDE)
                if skew:
                    turn = self.rng.choice(RATIOS)
                    rows[i][j] += turn
                    rows[j][i] -= turn
        return tuple(value for row in rows for value in row)

    def field(self) -> None:
        """Draw a multiport field between any junctions."""
        rng = self.rng
        kind = rng.choice(("CField", "IField", "ICField", "RField"))
        size = rng.choice((2, 2, 3))
        names = ("one", "two", "three")[:size]
        if kind == "ICField":
            ports = dict(zip(names, [rng.choice("CI") for _ in names], strict=True))
        else:
            ports = dict.fromkeys(names, kind[0])
        laws = {
            "CField": ("stiffness", "compliance", "energy"),
            "IField": ("inertance", "energy"),
            "ICField": ("energy",),
            "RField": ("resistance", "conductance"),
        }[kind]
        curves = {"RField": ("cubic",)}.get(kind, ("quartic", "product"))
        law = rng.choice(curves if self.curved() else laws)
        skew = kind == "RField" and rng.random() < 0.5
        name = self.part(Part(kind, law, self.matrix(size, skew), ports=ports))
        for port in ports:
            self.join(rng.choice(self.nodes), f"{name}.{port}", rng.choice((0, 0, 1)))

    def sensor(self) -> None:
        node = self.rng.choice(self.nodes)
        self.join(node, self.part(Part("De" if self.parts[node].kind == "0" else "Df")), 0)

    def pair(self) -> None:
        """A source on a one-port, or on two-ports that end there, beside all else."""
        source = self.part(self.simple(self.rng.choice(("Se", "Sf"))))
        self.join(source, self.part(self.simple(self.rng.choice(("R", "C", "I")))))

    def switching(self) -> Part:
        rng = self.rng
        kind = rng.choice(self.menu.switching)
        law = rng.choice(("falling", "viscous")) if kind == "Friction" else "linear"
        slope = rng.choice([Fraction(0), Fraction(0), *VALUES])
        return Part(kind, law, (rng.choice(VALUES), slope))

    def heat(self) -> None:
        """A dissipator whose loss warms a body."""
        rng = self.rng
        law = f"effort {rng.choice(('cubic', 'tanh'))}" if self.curved() else "linear"
        junction, store = "linear", "energy hot"
        if rng.random() < 0.3:
            law, junction, store = "pseudo linear", "pseudo", "pseudo linear"
        pad = self.part(Part("RS", law, (rng.choice(VALUES),)))
        room = self.part(Part("0", junction))
        body = self.part(Part("C", store, (rng.choice(VALUES),)))
        self.bonds += [(rng.choice(self.nodes), pad), (f"{pad}_heat", room), (room, body)]

    def signals(self, plan: Plan) -> Plan:
        """Draw signal blocks, and let some parts follow variables: none follows one that follows."""
        rng, menu = self.rng, self.menu
        followers = ["Se", "Sf", *(["TF", "GY", "R"] if menu.curved else [])]
        chosen = plan.of(*followers)
        rng.shuffle(chosen)
        chosen = chosen[: self.up_to(menu.signals)]
        sounding = [
            name for name, part in plan.parts.items()
            if name not in chosen and part.kind in "R C I 0 1 De Df CField IField RField"
        ]  # fmt: skip
        for _ in range(self.up_to(menu.blocks) if sounding else 0):
            kind = rng.choice(SIGNALS)
            heard = self.heard(rng.choice(sounding))
            name = self.part(Part(kind, "linear", (rng.choice(RATIOS), rng.choice(VALUES)), heard))
            sounding.append(name)
        for name in chosen if sounding else ():
            part, own = self.parts[name], [other for other in sounding if other != name]
            laws = ("square", "sine") if part.kind in ("TF", "GY", "R") else ("linear",)
            if menu.curved and part.kind in ("Se", "Sf"):
                laws = ("linear", "sine", "square")
            # a ratio or resistance by a state, mostly: by others it may ask what it decides
            states = [other for other in own if self.parts[other].kind in (*STATE, *SIGNALS)]
            if part.kind in ("TF", "GY", "R") and states and rng.random() < 0.8:
                heard = self.heard(rng.choice(states), "qpy")
            else:
                heard = self.heard(rng.choice(own))
            number = (rng.choice(RATIOS),) if part.kind != "R" else part.numbers
            self.parts[name] = replace(part, heard=heard, law=rng.choice(laws), numbers=number)
        return Plan(self.parts, tuple(self.bonds))

    def heard(self, name: str, letters: str = "efqpy") -> str:
        """Draw one of a part's variables."""
        part = self.parts[name]
        if part.ports:
            port = self.rng.choice(list(part.ports))
            kind = part.ports[port] if part.kind != "RField" else "R"
            name = f"{name}.{port}"
        else:
            kind = part.kind
        has = {"0": "e", "1": "f", "C": "efq", "I": "efp"}.get(kind, "ef")
        if kind in SIGNALS:
            has = "y"
        return f"{name}.{self.rng.choice([x for x in has if x in letters] or list(has))}"


def labels(plan: Plan) -> list[str]:
    """Return what is worth counting about a plan."""
    kinds = {part.kind for part in plan.parts.values()}
    junctions = len(plan.of("0", "1"))
    between = sum(
        all(plan.parts[plan.owner(end)].kind in ("0", "1", "TF", "GY") for end in bond)
        for bond in plan.bonds
    ) - len(plan.of("TF", "GY"))
    heard = [part for part in plan.parts.values() if part.heard]
    return [
        label
        for label, holds in {
            "mesh": between >= junctions > 1,
            "two-port": kinds & {"TF", "GY"},
            "field": kinds & {"CField", "IField", "ICField", "RField"},
            "sensor": kinds & {"De", "Df"},
            "block": kinds & set(SIGNALS),
            "followed": any(part.kind not in SIGNALS for part in heard),
            "modulated": any(part.kind in ("TF", "GY", "R") for part in heard),
            "heat": "RS" in kinds,
            "contact": kinds & set(CONTACTS),
        }.items()
        if holds
    ]
