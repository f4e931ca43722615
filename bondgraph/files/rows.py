"""Rows of the list ``elements``: which elements each makes, and in which order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..errors import GraphError, LawError, ModelError
from .entries import as_flag, as_text, check_keys, nearest, shown
from .fields import FIELDS, FieldRow, field_row
from .kinds import ALIASES, HEAT, KINDS, PORT, RS, Kind, local


@dataclass(frozen=True)
class Rows:
    """What the list of elements says.

    Attributes
    ----------
    plain : mapping of str to (Kind, row)
        By qualified name of the element.
    fields : mapping of str to FieldRow
        By qualified name of the field.
    order : tuple of str
        Qualified names of all elements, in the order of states.
    """

    plain: Mapping[str, tuple[Kind, dict[str, Any]]]
    fields: Mapping[str, FieldRow]
    order: tuple[str, ...]

    @property
    def kinds(self) -> dict[str, tuple[str, Kind]]:
        """Own name and kind of each element, by qualified name."""
        found = {label: (local(label), kind) for label, (kind, _) in self.plain.items()}
        for label, field in self.fields.items():
            for port, kind in field.ports.items():
                found[f"{label}.{port}"] = (f"{local(label)}.{port}", kind)
        return {label: found[label] for label in self.order}


def read_rows(given: Any) -> Rows:
    """Check the list of elements, and say which elements it makes."""
    if not isinstance(given, list) or not given:
        raise ModelError("elements is no list; write elements = [{ name = ..., kind = ... }, ...]")
    plain: dict[str, tuple[Kind, dict[str, Any]]] = {}
    fields: dict[str, FieldRow] = {}
    places: list[list[str]] = []  # by row; ports with a row of their own stand there
    own_rows: dict[str, int] = {}
    for index, row in enumerate(given, 1):
        label, name = _named(index, row)
        if name == PORT:
            check_keys(row, ("name", "kind"), f"element {label!r} ({PORT})")
            if label in own_rows:
                raise _twice(label)
            own_rows[label] = len(places)
            places.append([label])
        elif name in FIELDS:
            if label in fields:
                raise _twice(label)
            fields[label] = field_row(label, name, row)
            places.append(list(fields[label].labels.values()))
        else:
            made = _with_heat(label, row) if name == RS else {label: _plain(label, name, row)}
            for made_label, entry in made.items():
                if made_label in plain:
                    raise _twice(made_label)
                plain[made_label] = entry
            places.append(list(made))
    order = [
        label
        for index, labels in enumerate(places)
        for label in labels
        if own_rows.get(label, index) == index
    ]
    _check(plain, fields, own_rows)
    return Rows(plain, fields, tuple(order))


def _check(
    plain: Mapping[str, Any], fields: Mapping[str, FieldRow], own_rows: Mapping[str, int]
) -> None:
    """Raise for an element that two rows make, and for the place of a port that none makes."""
    ports: set[str] = set()
    for field in fields.values():
        for label in field.labels.values():
            if label in ports or label in plain:
                raise _twice(label)
            ports.add(label)
    for label in own_rows:
        if label not in ports:
            raise ModelError(
                f"element {label!r}: no field has this port; {nearest(label, sorted(ports) or ['none'])}",
                elements=[label],
            )


def _named(index: int, row: Any) -> tuple[str, str]:
    """Return name and kind of a row."""
    if not isinstance(row, dict):
        raise ModelError(f"elements, entry {index}: expected a table, got {shown(row)}")
    label = as_text(row.get("name"), f"elements, entry {index}, name")
    if ">" in label or not all(part.strip() for part in label.split(".")):
        raise GraphError(f"element {label!r}: a name has no '>' and no empty part; rename")
    name = row.get("kind")
    known = (*KINDS, *FIELDS, RS, PORT)
    if not isinstance(name, str) or ALIASES.get(name, name) not in known:
        raise ModelError(
            f"element {label!r}: kind {shown(name)} is not known; {nearest(name, known)}"
        )
    return label, ALIASES.get(name, name)


def _plain(label: str, name: str, row: dict[str, Any]) -> tuple[Kind, dict[str, Any]]:
    """Check a row that makes one element."""
    kind, where = KINDS[name], f"element {label!r} ({name})"
    check_keys(row, ("name", "kind", *kind.keys), where)
    missing = [key for key in kind.required if key not in row]
    if missing:
        raise LawError(f"{where} needs the key {missing[0]!r}", elements=[label])
    for key in kind.flags:
        as_flag(row.get(key, False), f"{where}, {key}")
    return kind, row


def _with_heat(label: str, row: dict[str, Any]) -> dict[str, tuple[Kind, dict[str, Any]]]:
    """Make a resistor and its heat of one row."""
    laws, where = KINDS["R"].laws, f"element {label!r} ({RS})"
    check_keys(row, ("name", "kind", *laws, "pseudo"), where)
    given = {key: row[key] for key in laws if key in row}
    if not given:
        raise LawError(
            f"{where} has no law; give {', '.join(laws)}, or say whose heat it is: "
            f'kind = "Heat", dissipator = ...',
            elements=[label],
        )
    heat = {"dissipator": label, "pseudo": as_flag(row.get("pseudo", False), f"{where}, pseudo")}
    return {label: (KINDS["R"], given), f"{label}{HEAT}": (KINDS["Heat"], heat)}


def _twice(label: str) -> GraphError:
    return GraphError(f"element {label!r} is there twice; rename one", elements=[label])
