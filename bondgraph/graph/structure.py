"""What a well-formed graph looks like; everything else is refused by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import networkx
import sympy

from ..elements import (
    De,
    Df,
    Element,
    Junction,
    One,
    OnePort,
    SignalBlock,
    Storage,
    TwoPort,
    Zero,
)
from ..errors import GraphError
from .value import GraphBond, signals_of


def check_structure(
    name: str,
    elements: Mapping[str, Element],
    bonds: Iterable[GraphBond],
    open_junctions: frozenset[str] = frozenset(),
) -> None:
    """Refuse malformed structure by name.

    Parameters
    ----------
    name : str
        The graph's name, for messages.
    elements : mapping of str to Element
    bonds : iterable of GraphBond
    open_junctions : frozenset of str
        Junctions that a parent may still bond to.

    Raises
    ------
    GraphError

    Examples
    --------
    >>> from bondgraph import One
    >>> check_structure("g", {"v": One("v")}, [], frozenset({"v"}))
    """
    if not elements:
        raise GraphError(f"graph {name!r} is empty; give it bonds, such as source >> junction")
    count: dict[str, list[str]] = {label: [] for label in elements}
    for bond in bonds:
        if bond.tail == bond.head:
            raise GraphError(
                f"graph {name!r}: {bond.tail!r} is bonded to itself",
                elements=[bond.tail],
                bonds=[bond.name],
            )
        count[bond.tail].append(bond.name)
        count[bond.head].append(bond.name)
        _check_pair(name, bond, elements[bond.tail], elements[bond.head])
        _check_sensor(name, bond, elements[bond.tail], elements[bond.head])
    for label, element in elements.items():
        _check_count(name, label, element, count[label], label in open_junctions)
    _check_fields(name, elements)


def _check_fields(graph: str, elements: Mapping[str, Element]) -> None:
    """Refuse storage fields with ports left out, whose shared energy would be none, and of one name."""
    fields: dict[str, dict[sympy.Basic, str]] = {}
    partners: dict[str, set[sympy.Basic]] = {}
    for label, element in elements.items():
        if isinstance(element, Storage) and element.partners:
            name = label.rpartition(".")[0]
            fields.setdefault(name, {})[element.state] = label
            partners.setdefault(name, set()).update(element.partners)
    for name, states in fields.items():
        absent = partners[name] - states.keys()
        if absent:
            raise GraphError(
                f"graph {graph!r}: field {name!r} has a port that is not bonded "
                f"({', '.join(sorted(str(state).lstrip('_').rpartition('.')[0] for state in absent))}), or another "
                f"field has its name; bond every port, and give fields names of their own",
                elements=list(states.values()),
            )
        if any(len(elements[label].partners) + 1 != len(states) for label in states.values()):  # type: ignore[attr-defined]
            raise GraphError(
                f"graph {graph!r} has two fields named {name!r}; give one another name",
                elements=list(states.values()),
            )


def _check_count(graph: str, label: str, element: Element, bonds: list[str], is_open: bool) -> None:
    where = f"graph {graph!r}: {element.kind} {label!r}"
    number = len(bonds)
    if isinstance(element, OnePort) and number != 1:
        said = "has no bond" if number == 0 else f"is bonded {number} times ({', '.join(bonds)})"
        raise GraphError(
            f"{where} {said}; a one-port has exactly one bond: join through a junction",
            elements=[label],
            bonds=bonds,
        )
    if isinstance(element, TwoPort) and number != 2:
        raise GraphError(
            f"{where} has {number} bond{'s' * (number != 1)}; a two-port has exactly two: a >> {element.kind} >> b",
            elements=[label],
            bonds=bonds,
        )
    if isinstance(element, SignalBlock) and number:
        raise GraphError(
            f"{where} is a signal block and has no power bonds; use its state {label}.y in a law",
            elements=[label],
            bonds=bonds,
        )
    if isinstance(element, Junction) and number < 2 and not is_open:
        raise GraphError(
            f"{where} is dangling: it has {'one bond' if number == 1 else 'no bond'}; "
            f"a junction joins two or more: bond it, or name it in ports",
            elements=[label],
            bonds=bonds,
        )


def _check_sensor(graph: str, bond: GraphBond, tail: Element, head: Element) -> None:
    """Refuse a sensor that would hold what it is to measure."""
    for sensor, other, end in ((tail, head, bond.tail), (head, tail, bond.head)):
        wrong = (isinstance(sensor, De) and isinstance(other, One)) or (
            isinstance(sensor, Df) and isinstance(other, Zero)
        )
        if wrong:
            held, junction = ("flow", "0") if isinstance(sensor, De) else ("effort", "1")
            raise GraphError(
                f"graph {graph!r}: {sensor.kind} {end!r} would hold the {held} of its junction at zero; "
                f"bond it to a {junction}-junction",
                elements=[end],
                bonds=[bond.name],
            )


def _check_pair(graph: str, bond: GraphBond, tail: Element, head: Element) -> None:
    if not (isinstance(tail, OnePort) and isinstance(head, OnePort)):
        return
    if tail.passive and head.passive:
        problem = "two passive one-ports cannot both take the power of one bond"
    elif type(tail) is type(head):
        problem = f"two {tail.kind} decide the same variable"
    elif not tail.passive and not head.passive:
        problem = "two sources on one bond leave nothing to solve"
    else:
        return
    raise GraphError(
        f"graph {graph!r}: the bond {bond.name} makes no sense: {problem}; join them through a 0- or 1-junction",
        elements=[bond.tail, bond.head],
        bonds=[bond.name],
    )


def disconnected(
    graph: str, elements: Mapping[str, Element], bonds: Iterable[GraphBond]
) -> tuple[str, ...]:
    """Warn of parts joined by neither bonds nor signals; each is still solved."""
    network = networkx.Graph()
    network.add_nodes_from(elements)
    network.add_edges_from((bond.tail, bond.head) for bond in bonds)
    if networkx.is_connected(network):
        return ()
    network.add_edges_from((signal.source, signal.target) for signal in signals_of(elements))
    parts = [list(part) for part in networkx.connected_components(network)]
    if len(parts) == 1:
        return ()
    place = {label: index for index, label in enumerate(elements)}
    shown = "; ".join(
        ", ".join(sorted(part, key=place.__getitem__)[:4]) + (", ..." if len(part) > 4 else "")
        for part in parts
    )
    return (
        f"graph {graph!r} has {len(parts)} disconnected parts, each solved on its own: {shown}",
    )
