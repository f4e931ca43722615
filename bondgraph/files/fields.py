"""Rows of multiport fields: one row makes an element for each port."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import sympy

from ..elements import CField, Element, ICField, IField, RField
from ..errors import LawError, ModelError
from ..expressions.words import reason
from .entries import as_expression, at, check_keys, nearest, shown
from .kinds import KINDS, Kind, local, variables_of
from .names import Names

MAX_PORTS = 40
MAX_INVERTED = 5  # ports: what inverting symbols takes grows with the factorial
INVERTED = ("compliance", "inertance")
LETTERS: Mapping[str, str] = MappingProxyType({"C": "q", "I": "p"})


@dataclass(frozen=True)
class FieldKind:
    """How one kind of field stands in a file.

    Attributes
    ----------
    build : type
        The field's class.
    port : str
        Kind of every port; empty where the row says it port by port.
    matrices, formulas : mapping of str to str
        Keywords of laws in matrix form and in formulas, to the variable that a
        port's bare name stands for.
    per_port : bool
        Whether there is one formula for each port.

    Examples
    --------
    >>> FIELDS["RField"].formulas["flow"]
    'e'
    """

    build: type[Any]
    port: str
    matrices: tuple[str, ...] = ()
    formulas: Mapping[str, str] = field(default_factory=lambda: {"energy": "state"})
    per_port: bool = False


FIELDS: Mapping[str, FieldKind] = MappingProxyType(
    {
        "CField": FieldKind(CField, "C", ("stiffness", "compliance")),
        "IField": FieldKind(IField, "I", ("inertance",)),
        "ICField": FieldKind(ICField, ""),
        "RField": FieldKind(
            RField,
            "R",
            ("resistance", "conductance"),
            {"effort": "f", "flow": "e"},
            per_port=True,
        ),
    }
)


@dataclass(frozen=True)
class FieldRow:
    """A field as its row says it.

    Attributes
    ----------
    label : str
        Qualified name of the field.
    kind : FieldKind
    ports : mapping of str to Kind
        In order.
    row : mapping
    """

    label: str
    kind: FieldKind
    ports: Mapping[str, Kind]
    row: Mapping[str, Any]

    @property
    def laws(self) -> tuple[str, ...]:
        """Keys of the laws that the row may hold."""
        return (*self.kind.matrices, *self.kind.formulas)

    @property
    def labels(self) -> dict[str, str]:
        """Qualified name of the element of each port."""
        return {port: f"{self.label}.{port}" for port in self.ports}

    def bare(self, key: str, variables: Mapping[str, sympy.Symbol]) -> dict[str, sympy.Symbol]:
        """Return what the ports' bare names mean in a formula."""
        letter = self.kind.formulas[key]
        letters = {port: LETTERS.get(kind.build.kind, letter) for port, kind in self.ports.items()}
        return {port: variables[f"{self.label}.{port}.{own}"] for port, own in letters.items()}


def field_row(label: str, name: str, row: Mapping[str, Any]) -> FieldRow:
    """Read which ports a field has."""
    kind, where = FIELDS[name], f"element {label!r} ({name})"
    storage = () if kind.per_port else ("initial",)
    laws = (*kind.matrices, *kind.formulas, *storage)
    check_keys(row, ("name", "kind", "ports", *laws), where)
    given = row.get("ports")
    names = list(given) if isinstance(given, list | dict) else []
    if not names or isinstance(given, list) is (kind.port == ""):
        example = '["left", "right"]' if kind.port else '{ coil = "I", gap = "C" }'
        said = "is missing" if given is None else f"is {shown(given)}"
        raise ModelError(f"{where}: ports {said}; write ports = {example}")
    if len(names) > MAX_PORTS or not all(isinstance(port, str) for port in names):
        raise ModelError(
            f"{where}: ports is {shown(given)}; give names in quotes, {MAX_PORTS} at most"
        )
    kinds = dict(given) if isinstance(given, dict) else dict.fromkeys(names, kind.port)
    for port, letter in kinds.items():
        if letter not in ("C", "I", kind.port):
            raise ModelError(f'{where}: port {port!r} is {shown(letter)}; write "C" or "I"')
    if len(kinds) < len(names):
        raise ModelError(f"{where}: ports is {shown(given)}; a port is there twice, rename one")
    return FieldRow(label, kind, {port: KINDS[letter] for port, letter in kinds.items()}, row)


def built_field(
    field: FieldRow, names: Names, variables: Mapping[str, sympy.Symbol]
) -> dict[str, Element]:
    """Build the elements of a field's ports, by qualified name."""
    laws: dict[str, Any] = {}
    for key in field.kind.matrices:
        if key in field.row:
            laws[key] = _matrix(field, key, names)
    for key in field.kind.formulas:
        if key in field.row:
            laws[key] = _formulas(field, key, names, variables)
    if "initial" in field.row:
        laws["initial"] = _by_port(field, "initial", names.meanings)
    ports: Any = list(field.ports)
    if not field.kind.port:
        ports = {port: kind.build.kind for port, kind in field.ports.items()}
    with at(f"element {field.label!r}"):
        try:
            made = field.kind.build(local(field.label), ports, **_needed(field, laws))
        except (TypeError, ValueError, ArithmeticError, RecursionError) as error:
            raise LawError(f"its law cannot be worked out ({reason(error)}); simplify it") from None
    own = {
        symbol: variables[f"{field.label}.{port}.{key}"]
        for port, element in made.ports.items()
        for key, symbol in variables_of(element).items()
    }
    return {label: made[port].replaced(own, name=label) for port, label in field.labels.items()}


def _needed(field: FieldRow, laws: dict[str, Any]) -> dict[str, Any]:
    if not field.kind.port and "energy" not in laws:
        raise LawError("ICField needs the key 'energy'", elements=[field.label])
    return laws


def _matrix(field: FieldRow, key: str, names: Names) -> list[list[sympy.Expr]]:
    """Read a matrix, a row for each port."""
    given, size = field.row[key], len(field.ports)
    where, wanted = f"element {field.label!r}, {key}", f"{size} ports need {size} rows of {size}"
    if not isinstance(given, list):
        raise ModelError(f"{where} is {shown(given)}; write a matrix, [[1, 0], [0, 1]]: {wanted}")
    if len(given) != size:
        raise ModelError(f"{where} has {len(given)} row{'s' * (len(given) != 1)}; {wanted}")
    for number, row in enumerate(given, 1):
        if not isinstance(row, list) or len(row) != size:
            raise ModelError(f"{where}, row {number} is {shown(row)}; {wanted}")
    matrix = [
        [
            as_expression(entry, names.meanings, f"{where}, row {number}, column {place}")
            for place, entry in enumerate(row, 1)
        ]
        for number, row in enumerate(given, 1)
    ]
    symbols = set().union(*(entry.free_symbols for row in matrix for entry in row))
    if key in INVERTED and symbols and size > MAX_INVERTED:
        raise LawError(
            f"{where}: a matrix of more than {MAX_INVERTED} ports is inverted in numbers only; "
            f"give numbers, or {' or '.join(other for other in field.laws if other != key)}",
            elements=[field.label],
        )
    return matrix


def _formulas(
    field: FieldRow, key: str, names: Names, variables: Mapping[str, sympy.Symbol]
) -> Callable[..., Any]:
    """Read a law in formulas, as a function of the ports' variables."""
    bare = field.bare(key, variables)
    meanings = names.within(bare)
    if not field.kind.per_port:
        where = f"element {field.label!r}, {key}"
        return as_function(as_expression(field.row[key], meanings, where), list(bare.values()))
    rows = _by_port(field, key, meanings)
    missing = [port for port in field.ports if port not in rows]
    if missing:
        raise ModelError(
            f"element {field.label!r}, {key}: port {missing[0]!r} has no formula; give one for each port"
        )
    laws = [as_function(rows[port], list(bare.values())) for port in field.ports]
    return lambda *given: [law(*given) for law in laws]


def _by_port(field: FieldRow, key: str, meanings: Mapping[str, Any]) -> dict[str, sympy.Expr]:
    given, where = field.row[key], f"element {field.label!r}, {key}"
    if not isinstance(given, dict):
        example = ", ".join(f"{port} = ..." for port in list(field.ports)[:2])
        raise ModelError(f"{where} is {shown(given)}; write {key} = {{ {example} }}")
    for port in given:
        if port not in field.ports:
            raise ModelError(f"{where}: there is no port {port!r}; {nearest(port, field.ports)}")
    return {
        port: as_expression(law, meanings, f"{where}, port {port!r}") for port, law in given.items()
    }


def as_function(law: sympy.Expr, arguments: Sequence[Any]) -> Callable[..., sympy.Expr]:
    """Return a law as the function of its arguments that elements take."""
    return lambda *given: law.xreplace(dict(zip(arguments, given, strict=True)))
