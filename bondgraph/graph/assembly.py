"""Assembly: bonds and submodels gathered, named, checked and frozen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

import sympy

from ..bonds import Bond, Chain
from ..codegen.collector import held_back
from ..elements import RS, De, Df, Element, Junction, OnePort
from ..errors import GraphError
from .structure import check_structure, disconnected
from .symbols import Symbols, gather_outputs
from .value import BondGraph, GraphBond, Output, Port


@held_back()
def assemble(
    name: str,
    *parts: Any,
    ports: Mapping[str, Any] | None = None,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Iterable[sympy.Symbol] | Mapping[sympy.Symbol, str] = (),
    outputs: Mapping[str, Any] | None = None,
) -> BondGraph:
    """Gather bonds and submodels into an immutable graph.

    Parameters
    ----------
    name : str
        The graph's name.
    *parts : Chain, Bond, BondGraph, Junction, or iterables of these
        Bonds written with ``>>``, and submodels.
    ports : mapping of str to Junction, optional
        Junctions that a parent may bond to.
    parameters : mapping, optional
        Symbol (or its name) to a value, ``(value, unit, meaning, source)``, a
        quantity, a `Parameter`, or an expression in other parameters.
    inputs : iterable of Symbol, or mapping of Symbol to unit, optional
        Symbols that vary in time from outside.
    outputs : mapping of str to Expr or (Expr, unit), optional
        Named signals.

    Returns
    -------
    BondGraph

    Raises
    ------
    GraphError
        For malformed structure: a one-port bonded twice, an unknown port, a
        duplicate name, a dangling junction, a TF or GY without two bonds, or a
        bond between two one-ports that makes no sense.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> v = One("v")
    >>> graph = assemble("msd", Se("force", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 0.5)))
    >>> len(graph.bonds)
    4
    """
    if not isinstance(name, str) or not name.strip() or "." in name or ">" in name:
        raise GraphError(f"a graph needs a plain name without '.' or '>', got {name!r}")
    builder = _Builder(name)
    for part in parts:
        builder.add(part)
    bonds, notes = builder.bonds()
    names = builder.names
    exposed = _exposed(name, ports or {}, names)
    elements = MappingProxyType({label: element for element, label in names.items()})
    check_structure(name, elements, bonds, open_junctions=frozenset(exposed.values()))
    symbols = Symbols(name, elements, builder.submodels, parameters or {}, inputs)
    elements = MappingProxyType(
        {
            label: element.replaced(symbols.merged) if symbols.touches(element) else element
            for label, element in elements.items()
        }
    )
    return BondGraph(
        name,
        elements,
        tuple(bonds),
        MappingProxyType(exposed),
        MappingProxyType(symbols.parameters),
        MappingProxyType(symbols.inputs),
        MappingProxyType(_outputs(name, outputs or {}, builder, symbols)),
        disconnected(name, elements, bonds),
        (*notes, *symbols.notes),
    )


def _outputs(
    name: str, given: Mapping[str, Any], builder: _Builder, symbols: Symbols
) -> dict[str, Output]:
    """Gather the outputs given, and one for each sensor of the graph itself."""
    inner = {element for graph in builder.submodels for element in graph.elements.values()}
    sensors = {
        label: Output(element.e if isinstance(element, De) else element.f)
        for element, label in builder.names.items()
        if isinstance(element, De | Df) and element not in inner
    }
    clash = [label for label in sensors if label in given]
    if clash:
        raise GraphError(
            f"graph {name!r}: output {clash[0]!r} has the name of a sensor; give one another name",
            elements=clash,
        )
    return gather_outputs(name, {**sensors, **given}, builder.submodels, symbols)


class _Builder:
    """Collects parts in the order written; elements are keyed by identity."""

    def __init__(self, name: str) -> None:
        self.graph = name
        self.names: dict[Element, str] = {}
        self._labels: set[str] = set()
        self.submodels: list[BondGraph] = []
        self._bonds: list[Bond] = []
        self._inner: list[GraphBond] = []

    def add(self, part: Any) -> None:
        if isinstance(part, BondGraph):
            self._submodel(part)
        elif isinstance(part, Port):
            self._submodel(part.graph)
        elif isinstance(part, Chain):
            for bond in part.bonds:
                self.add(bond)
            for end in (*part.tails, *part.heads):
                if not isinstance(end, RS):
                    self._end(end)
        elif isinstance(part, Bond):
            tail, head = _port_of(part.tail, heat=True), _port_of(part.head, heat=False)
            self._end(tail)
            self._end(head)
            self._bonds.append(Bond(tail, head))
        elif isinstance(part, Element):
            self._end(part)
        elif isinstance(part, Iterable) and not isinstance(part, str | Mapping):
            for item in part:
                self.add(item)
        else:
            raise GraphError(
                f"graph {self.graph!r}: {part!r} is no bond, element or submodel; join elements with >>"
            )

    def _end(self, end: Any) -> None:
        if isinstance(end, Port):
            self._submodel(end.graph)
        elif end not in self.names:
            self._register(end, end.name)

    def _submodel(self, graph: BondGraph) -> None:
        if any(graph is known for known in self.submodels):
            return
        if any(graph.name == known.name for known in self.submodels):
            raise GraphError(
                f"graph {self.graph!r} holds two submodels named {graph.name!r}; use .copy('another_name')",
                elements=[graph.name],
            )
        self.submodels.append(graph)
        for label, element in graph.elements.items():
            self._register(element, f"{graph.name}.{label}")
        self._inner.extend(_qualified(bond, graph.name) for bond in graph.bonds)

    def _register(self, element: Element, label: str) -> None:
        if element in self.names:
            raise GraphError(
                f"graph {self.graph!r}: element {self.names[element]!r} is also {label!r}; "
                f"bond to submodels through their ports, and copy a submodel that is used twice",
                elements=[self.names[element], label],
            )
        if label in self._labels:
            raise GraphError(
                f"graph {self.graph!r} has two elements named {label!r}; give one another name",
                elements=[label],
            )
        self.names[element] = label
        self._labels.add(label)

    def bonds(self) -> tuple[list[GraphBond], list[str]]:
        """Name the bonds; turn backward arrows on passive one-ports round."""
        bonds, notes = list(self._inner), [note for graph in self.submodels for note in graph.notes]
        taken = {bond.name for bond in bonds}
        for bond in self._bonds:
            tail, head = _element(bond.tail), _element(bond.head)
            if isinstance(tail, OnePort) and tail.passive:
                notes.append(
                    f"bond {self.names[tail]}>{self.names[head]} turned round: {tail!r} takes power"
                )
                tail, head = head, tail
            name = stem = f"{self.names[tail]}>{self.names[head]}"
            count = 1
            while name in taken:
                count += 1
                name = f"{stem} ({count})"
            taken.add(name)
            bonds.append(GraphBond(name, self.names[tail], self.names[head]))
        return bonds, notes


def _qualified(bond: GraphBond, prefix: str) -> GraphBond:
    count = bond.name.removeprefix(f"{bond.tail}>{bond.head}")
    tail, head = f"{prefix}.{bond.tail}", f"{prefix}.{bond.head}"
    return GraphBond(f"{tail}>{head}{count}", tail, head)


def _port_of(end: Any, heat: bool) -> Any:
    """Return the port of an RS that a bond ends on: power goes in, heat comes out."""
    if not isinstance(end, RS):
        return end
    return end.heat if heat else end.dissipator


def _element(end: Any) -> Element:
    return end.junction if isinstance(end, Port) else end


def _exposed(graph: str, ports: Mapping[str, Any], names: Mapping[Element, str]) -> dict[str, str]:
    exposed = {}
    for port, end in ports.items():
        element = _element(end)
        if not isinstance(element, Junction):
            raise GraphError(f"graph {graph!r}: port {port!r} must be a junction, not {element!r}")
        if element not in names:
            raise GraphError(
                f"graph {graph!r}: port {port!r} is {element!r}, which is not in the graph; bond it first"
            )
        exposed[port] = names[element]
    return exposed
