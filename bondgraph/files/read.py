"""Reads the text of a model file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import sympy

from ..bonds import Bond
from ..elements import De, Df, Element
from ..errors import GraphError, ModelError, ParameterError
from ..expressions import parse
from ..graph import BondGraph, Output, assemble
from ..parameters import Parameter
from .assumptions import as_symbol
from .elements import built, check_heaters
from .entries import (
    as_expression,
    as_text,
    at,
    check_keys,
    check_table,
    check_unit,
    is_finite,
    nearest,
    shown,
)
from .fields import built_field
from .names import Names
from .rows import Rows, read_rows
from .syntax import tables

SCHEMA = 1
TABLES = ("ports", "parameters", "inputs", "outputs")
TOP = ("schema", "name", "elements", "bonds", *TABLES)
PARAMETER = ("value", "unit", "meaning", "source", "assume")


def loads(text: str, source: str = "model") -> BondGraph:
    """Read a bond graph from the text of a model file.

    Parameters
    ----------
    text : str
    source : str
        What error messages call the text.

    Returns
    -------
    BondGraph

    Raises
    ------
    BondGraphError
        As `load`.

    Examples
    --------
    >>> loads("schema = 2")
    Traceback (most recent call last):
    ...
    bondgraph.errors.ModelError: model: schema is 2; this program reads schema = 1
    """
    with at(source):
        return _Reader(tables(text)).graph()


class _Reader:
    """Reads one file: symbols first, then laws, then the graph."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.data = data

    def graph(self) -> BondGraph:
        check_keys(self.data, TOP, "")
        if self.data.get("schema") != SCHEMA or isinstance(self.data["schema"], bool):
            raise ModelError(
                f"schema is {shown(self.data.get('schema', 'missing'))}; this program reads schema = 1"
            )
        for table in TABLES:
            check_table(self.data.get(table, {}), table)
        rows = read_rows(self.data.get("elements"))
        kinds = rows.kinds
        parameters = self._symbols("parameters", PARAMETER)
        inputs = self._symbols("inputs", ("unit", "assume"))
        variables = {
            f"{label}.{key}": sympy.Dummy(f"{own}.{key}", **assumed)
            for label, (own, kind) in kinds.items()
            for key, assumed in kind.variables.items()
        }
        names = Names(variables, parameters, inputs)
        elements = _built(rows, names, variables)
        outputs = self._outputs(names)
        sensors = _sensors(elements, outputs)
        graph = assemble(
            as_text(self.data.get("name"), "name"),
            *elements.values(),
            *self._bonds(elements),
            ports=self._ports(elements),
            parameters=self._parameters(parameters),
            inputs=self._inputs(inputs),
            outputs={key: value for key, value in outputs.items() if key not in sensors},
        )
        own = {label: name for label, (name, _) in kinds.items()}
        return replace(
            graph,
            elements=MappingProxyType(_localised(graph.elements, own)),
            outputs=MappingProxyType(_ordered(graph.outputs, outputs)),
        )

    def _symbols(self, table: str, keys: tuple[str, ...]) -> dict[str, sympy.Symbol]:
        given = self.data.get(table, {})
        symbols = {}
        for name, row in given.items():
            where = f"{table}, {name!r}"
            if table == "inputs" and name in self.data.get("parameters", {}):
                raise ParameterError(f"{where} is a parameter too; keep one of them")
            if not name.strip():
                raise ParameterError(f"{where}: the name is empty; give it a word")
            if not isinstance(row, dict):
                row = given[name] = {keys[0]: row}  # short for { value = ... } or { unit = ... }
            check_keys(row, keys, where, name)
            symbols[name] = as_symbol(name, row.get("assume", "real"), where)
        return symbols

    def _parameters(self, symbols: Mapping[str, sympy.Symbol]) -> dict[sympy.Symbol, Parameter]:
        names = Names({}, symbols)
        table = {}
        for name, symbol in symbols.items():
            row, where = self.data["parameters"][name], f"parameters, {name!r}"
            value = row.get("value")
            with at(f"{where}, value"):
                if isinstance(value, str):
                    value = parse(value, names.meanings)
                elif value is not None and (isinstance(value, bool) or not is_finite(value)):
                    raise ParameterError(
                        f"expected a finite number or a formula, got {shown(value)}"
                    )
            words = {key: as_text(row.get(key, ""), f"{where}, {key}") for key in PARAMETER[1:4]}
            check_unit(words["unit"], where)
            table[symbol] = Parameter(value, **words)
        return table

    def _inputs(self, symbols: Mapping[str, sympy.Symbol]) -> dict[sympy.Symbol, str]:
        units = {}
        for name, symbol in symbols.items():
            where = f"inputs, {name!r}"
            units[symbol] = as_text(self.data["inputs"][name].get("unit", ""), f"{where}, unit")
            check_unit(units[symbol], where)
        return units

    def _outputs(self, names: Names) -> dict[str, tuple[sympy.Expr, str, str]]:
        outputs = {}
        for name, row in self.data.get("outputs", {}).items():
            where = f"outputs, {name!r}"
            row = row if isinstance(row, dict) else {"expression": row}
            check_keys(row, ("expression", "unit", "meaning"), where, name)
            expression = as_expression(
                row.get("expression"), names.meanings, f"{where}, expression"
            )
            words = [as_text(row.get(key, ""), f"{where}, {key}") for key in ("unit", "meaning")]
            check_unit(words[0], where)
            outputs[name] = (expression, words[0], words[1])
        return outputs

    def _bonds(self, elements: Mapping[str, Element]) -> list[Bond]:
        given = self.data.get("bonds", [])
        if not isinstance(given, list):
            raise ModelError('bonds is no list; write bonds = ["a > b", ...]')
        bonds = []
        for index, text in enumerate(given, 1):
            where = f"bonds, entry {index}"
            ends = as_text(text, where).split(">")
            if len(ends) != 2:
                raise ModelError(
                    f"{where}: {shown(text)} is no bond; write 'a > b', power from a to b"
                )
            bonds.append(Bond(*(_end(end, elements, f"{where}, {text!r}") for end in ends)))
        return bonds

    def _ports(self, elements: Mapping[str, Element]) -> dict[str, Element]:
        given = self.data.get("ports", {})
        return {
            port: _end(as_text(name, f"ports, {port!r}"), elements, f"ports, {port!r}")
            for port, name in given.items()
        }


def _built(rows: Rows, names: Names, variables: Mapping[str, sympy.Symbol]) -> dict[str, Element]:
    """Build the elements of all rows, in order."""
    check_heaters(rows.plain, {label: kind for label, (_, kind) in rows.kinds.items()})
    made = {
        label: built(label, kind, row, names, variables)
        for label, (kind, row) in rows.plain.items()
    }
    for field in rows.fields.values():
        made |= built_field(field, names, variables)
    return {label: made[label] for label in rows.order}


def _sensors(
    elements: Mapping[str, Element], outputs: Mapping[str, tuple[sympy.Expr, str, str]]
) -> set[str]:
    """Return which outputs are a sensor's own, and there without being written."""
    return {
        label
        for label, element in elements.items()
        if label in outputs
        and isinstance(element, De | Df)
        and outputs[label][0] == (element.e if isinstance(element, De) else element.f)
    }


def _ordered(
    made: Mapping[str, Output], given: Mapping[str, tuple[sympy.Expr, str, str]]
) -> dict[str, Output]:
    """Put outputs in the order written; those of sensors that are not written come first."""
    unwritten = {label: output for label, output in made.items() if label not in given}
    return unwritten | {
        label: Output(made[label].expression, unit, meaning)
        for label, (_, unit, meaning) in given.items()
    }


def _end(name: str, elements: Mapping[str, Element], where: str) -> Element:
    for label in (name, name.strip()):
        if label in elements:
            return elements[label]
    ports = [label for label in elements if label.rpartition(".")[0] == name.strip()]
    if ports:
        raise GraphError(f"{where}: {name.strip()!r} has ports; name one of {', '.join(ports)}")
    raise GraphError(
        f"{where}: there is no element {name.strip()!r}; {nearest(name.strip(), elements)}"
    )


def _localised(elements: Mapping[str, Element], names: Mapping[str, str]) -> dict[str, Element]:
    """Give elements of submodels their own short names again; the keys are qualified."""
    return {
        label: element if label == names[label] else element.replaced({}, name=names[label])
        for label, element in elements.items()
    }
