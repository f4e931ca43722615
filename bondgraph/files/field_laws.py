"""Multiport fields of a graph, and the rows that say them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import sympy

from ..elements import Element, R, Storage
from ..elements.fields import port_of
from ..elements.matrices import inverse_of
from ..errors import BondGraphError, ModelError
from .fields import FIELDS, LETTERS, MAX_INVERTED
from .kinds import local, variables_of
from .names import Names


def fields_in(elements: Mapping[str, Element]) -> dict[str, dict[str, Any]]:
    """Return the ports of each field by the field's qualified name, in the field's order.

    Raises
    ------
    ModelError
        Where ports of one field are missing, or two fields have one name.
    """
    found: dict[str, dict[str, Any]] = {}
    for label, element in elements.items():
        names = port_of(element)
        if names is not None:
            field = label.removesuffix(f".{names[1]}")
            found.setdefault(field, {})[names[1]] = element
    return {
        label: _ordered(label, ports)
        for label, ports in found.items()
        if len(ports) > 1 or not isinstance(next(iter(ports.values())), R)
    }


def _ordered(label: str, ports: dict[str, Any]) -> dict[str, Any]:
    """Put the ports of a storage field in the order in which they share its energy."""
    stores = {port: element for port, element in ports.items() if isinstance(element, Storage)}
    if not stores and len({_gives(element) for element in ports.values()}) == 1:
        return ports
    first = next((port for port, store in stores.items() if store.energy != 0), next(iter(ports)))
    by_state = {store.state: port for port, store in stores.items()}
    shared = (stores[first].state, *stores[first].partners) if first in stores else ()
    if set(shared) != set(by_state) or len(stores) < len(ports):
        raise ModelError(
            f"field {label!r} has bonds at {', '.join(ports)} only, or shares its name with another; "
            f"bond every port, and give each field a name of its own",
            elements=[f"{label}.{port}" for port in ports],
        )
    return {by_state[state]: stores[by_state[state]] for state in shared}


def _gives(element: R) -> str:
    return "effort" if element.effort is not None else "flow"


def field_entry(label: str, ports: Mapping[str, Any], names: Names) -> dict[str, Any]:
    """Return the row of a field, without the places of its ports."""
    letters = {port: type(element).__name__ for port, element in ports.items()}
    kinds = set(letters.values())
    kind = f"{kinds.pop()}Field" if len(kinds) == 1 else "ICField"
    row = {"name": label, "kind": kind, "ports": letters if kind == "ICField" else list(ports)}
    row |= _law(label, kind, ports, names)
    starts = {
        port: names.write(element.initial)
        for port, element in ports.items()
        if isinstance(element, Storage) and element.initial != 0
    }
    return row | ({"initial": starts} if starts else {})


def _law(label: str, kind: str, ports: Mapping[str, Any], names: Names) -> dict[str, Any]:
    for key, matrix in _matrices(kind, ports):
        if _builds(label, kind, ports, {key: matrix}):
            return {key: [[names.write(entry) for entry in row] for row in matrix.tolist()]}
    if kind == "RField":
        key = _gives(next(iter(ports.values())))
        bare = _bare(ports, "f" if key == "effort" else "e")
        laws = {port: names.write(getattr(item, key), bare) for port, item in ports.items()}
        return {key: laws}
    return {"energy": names.write(_energy(ports), _bare(ports, ""))}


def _bare(ports: Mapping[str, Any], letter: str) -> dict[str, sympy.Symbol]:
    return {
        port: getattr(element, LETTERS.get(element.kind, letter)) for port, element in ports.items()
    }


def _energy(ports: Mapping[str, Any]) -> sympy.Expr:
    return next((port.energy for port in ports.values() if port.energy != 0), sympy.S.Zero)


def _matrices(kind: str, ports: Mapping[str, Any]) -> Iterator[tuple[str, sympy.Matrix]]:
    """Yield the matrices that may say a linear law, the simplest first."""
    if kind == "ICField":
        return
    if kind == "RField":
        key = _gives(next(iter(ports.values())))
        given = list(_bare(ports, "f" if key == "effort" else "e").values())
        rows = sympy.Matrix([getattr(port, key) for port in ports.values()])
    else:
        key = "stiffness"
        given = list(_bare(ports, "").values())
        rows = sympy.Matrix([port.law for port in ports.values()])
    matrix = rows.jacobian(given)
    if matrix.free_symbols & set(given):
        return
    if kind == "RField":
        yield {"effort": "resistance", "flow": "conductance"}[key], matrix
        return
    inverse = _inverse(matrix)
    found = [(key, matrix)] if kind == "CField" else []
    if inverse is not None:
        found.append(("compliance" if kind == "CField" else "inertance", inverse))
    yield from sorted(found, key=lambda item: sum(sympy.count_ops(entry) for entry in item[1]))


def _inverse(matrix: sympy.Matrix) -> sympy.Matrix | None:
    numeric = all(entry.is_Rational for entry in matrix)
    return inverse_of(matrix) if numeric or matrix.rows <= MAX_INVERTED else None


def _builds(label: str, kind: str, ports: Mapping[str, Any], law: Mapping[str, Any]) -> bool:
    """Whether a matrix gives a field with the very same laws."""
    try:
        twin = FIELDS[kind].build(local(label), list(ports), **law)
    except (BondGraphError, TypeError, ValueError):
        return False
    own = {
        symbol: getattr(ports[port], key)
        for port, element in twin.ports.items()
        for key, symbol in variables_of(element).items()
    }
    keys = ("effort", "flow") if kind == "RField" else ("law", "energy", "inverse", "partners")
    return all(
        getattr(ports[port], key) == getattr(element.replaced(own), key)
        for port, element in twin.ports.items()
        for key in keys
    )
