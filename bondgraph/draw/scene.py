"""What is drawn: one node an element, but one for all ports of a field, and one for an RS."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from ..elements import (
    C,
    Element,
    Heat,
    I,
    Junction,
    R,
    Se,
    Sf,
    SignalBlock,
    Storage,
    Switched,
    TwoPort,
)
from ..graph import BondGraph, GraphBond, Signal

# Letters of elements whose kind is a word.
LETTERS: Mapping[str, str] = {
    "Friction": "R",
    "Clutch": "Cl",
    "Diode": "D",
    "CheckValve": "Cv",
    "Switch": "Sw",
    "EndStop": "Stop",
    "Integrator": "∫",
}


class Role(Enum):
    """What a node is to the layout."""

    JUNCTION = "junction"
    TWO_PORT = "two-port"
    FIELD = "field"
    SOURCE = "source"
    INERTIA = "inertia"
    COMPLIANCE = "compliance"
    OTHER = "other one-port"
    BLOCK = "signal block"

    @property
    def is_core(self) -> bool:
        """Whether bonds go on from it."""
        return self in (Role.JUNCTION, Role.TWO_PORT, Role.FIELD)

    @property
    def spreads(self) -> bool:
        """Whether it may have more than two bonds."""
        return self in (Role.JUNCTION, Role.FIELD)


@dataclass(frozen=True)
class Figure:
    """A node of the drawing.

    Attributes
    ----------
    name : str
        Of the element, of the field, or of an RS's dissipator.
    role : Role
    kind : str
        Letters: ``I``, ``TF``, ``RS``, ``IC`` for a mixed field, ...
    elements : tuple of str
        Elements of the graph that it stands for.
    modulated : bool
        Whether a law of it uses a variable of another node.
    """

    name: str
    role: Role
    kind: str
    elements: tuple[str, ...]
    modulated: bool = False

    @property
    def label(self) -> str:
        """Write the label, with M for a modulated one."""
        if self.role is Role.JUNCTION:
            return self.kind
        kind = f"M{self.kind}" if self.modulated else self.kind
        return kind if self.role.is_core else f"{kind} : {self.name}"


@dataclass(frozen=True)
class Scene:
    """A graph as it is drawn.

    Attributes
    ----------
    figures : mapping of str to Figure
    bonds : tuple of GraphBond
        In the order of the graph's, between nodes.
    signals : tuple of Signal
        Between nodes; none within one.
    ports : tuple of (str, str)
        For each bond, the port's name where its tail and its head is a field.
    """

    figures: Mapping[str, Figure]
    bonds: tuple[GraphBond, ...]
    signals: tuple[Signal, ...]
    ports: tuple[tuple[str, str], ...]


def scene_of(graph: BondGraph) -> Scene:
    """Gather what is drawn.

    Parameters
    ----------
    graph : BondGraph

    Returns
    -------
    Scene

    Examples
    --------
    >>> from bondgraph import CField, One, Se, assemble
    >>> beam = CField("beam", ("a", "b"), stiffness=[[2, 1], [1, 2]])
    >>> drawn = scene_of(assemble("g", Se("F", 1) >> One("v") >> beam["a"], One("w") >> (beam["b"], Se("G", 1))))
    >>> drawn.figures["beam"].label, drawn.ports[1]
    ('C', ('', 'a'))
    """
    of_element = {name: _node_of(graph, name, element) for name, element in graph.elements.items()}
    members: dict[str, list[str]] = {}
    for name, node in of_element.items():
        members.setdefault(node, []).append(name)
    signals = _signals(graph, of_element)
    heard = {signal.target for signal in signals}
    figures = {
        node: _figure(graph, node, tuple(names), node in heard) for node, names in members.items()
    }
    bonds = tuple(
        GraphBond(bond.name, of_element[bond.tail], of_element[bond.head]) for bond in graph.bonds
    )
    ports = tuple(
        (_port(graph, figures, bond.tail, drawn.tail), _port(graph, figures, bond.head, drawn.head))
        for bond, drawn in zip(graph.bonds, bonds, strict=True)
    )
    return Scene(figures, bonds, signals, ports)


def is_port(element: Element) -> bool:
    """Whether an element is a port of a field: these alone have names with a dot."""
    return isinstance(element, Storage | R) and "." in element.name


def _node_of(graph: BondGraph, name: str, element: Element) -> str:
    """Return the node that an element belongs to: its field, or the dissipator that heats."""
    if is_port(element):
        return name.rpartition(".")[0]
    if isinstance(element, Heat):
        symbols = element.power.free_symbols
        return next(
            label
            for label, other in graph.elements.items()
            if other is not element and symbols & set(other.symbols.values())
        )
    return name


def _signals(graph: BondGraph, of_element: Mapping[str, str]) -> tuple[Signal, ...]:
    """Return signals between nodes, each once; a field's are named by port."""
    found: dict[Signal, None] = {}
    for signal in graph.signals:
        source, target = of_element[signal.source], of_element[signal.target]
        if source != target:
            port = signal.source.removeprefix(source).removeprefix(".")
            variable = f"{port}.{signal.variable}" if port else signal.variable
            found[Signal(source, variable, target)] = None
    return tuple(found)


def _figure(graph: BondGraph, node: str, names: tuple[str, ...], heard: bool) -> Figure:
    elements = [graph.elements[name] for name in names]
    first = elements[0]
    if is_port(first):
        kinds = sorted({element.kind for element in elements}, reverse=True)
        return Figure(node, Role.FIELD, "".join(kinds), names, heard)
    if len(names) > 1:
        return Figure(node, Role.TWO_PORT, "RS", names, heard)
    kind = LETTERS.get(first.kind, first.kind)
    # the arrow alone tells what a switch or block hears; MR is the textbook's name for friction
    silent = isinstance(first, SignalBlock) or (isinstance(first, Switched) and kind != "R")
    return Figure(node, _role(first), kind, names, heard and not silent)


def _role(element: Element) -> Role:
    roles: list[tuple[type | tuple[type, ...], Role]] = [
        (Junction, Role.JUNCTION),
        (TwoPort, Role.TWO_PORT),
        ((Se, Sf), Role.SOURCE),
        (I, Role.INERTIA),
        (C, Role.COMPLIANCE),
        (SignalBlock, Role.BLOCK),
    ]
    return next((role for kind, role in roles if isinstance(element, kind)), Role.OTHER)


def _port(graph: BondGraph, figures: Mapping[str, Figure], name: str, node: str) -> str:
    return name.rpartition(".")[2] if figures[node].role is Role.FIELD else ""
