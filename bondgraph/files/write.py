"""Writes a bond graph as the text of a model file."""

from __future__ import annotations

from typing import Any

from ..elements import De, Df, Heat
from ..errors import ModelError
from ..graph import BondGraph, Output
from .assumptions import assumptions_of
from .elements import HEATERS, laws_of
from .entries import at
from .field_laws import field_entry, fields_in
from .kinds import HEAT, KINDS, PORT, RS, variables_of
from .names import Names
from .read import SCHEMA
from .syntax import toml, toml_key


def dumps(graph: BondGraph) -> str:
    """Write a bond graph as the text of a model file.

    Parameters
    ----------
    graph : BondGraph

    Returns
    -------
    str

    Raises
    ------
    LawError
        If a law uses what the file cannot say.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble
    >>> v = One("v")
    >>> text = dumps(assemble("rc", Se("E", 12) >> v >> (R("r", 2), C("c", 0.2))))
    >>> print(text.partition("elements")[2].partition("bonds")[0].strip())
    = [
      { name = "E", kind = "Se", effort = 12 },
      { name = "v", kind = "One" },
      { name = "r", kind = "R", resistance = 2 },
      { name = "c", kind = "C", stiffness = 5 },
    ]
    """
    return _Writer(graph).text()


class _Writer:
    """Writes one graph, one line an element, bond, parameter and output."""

    def __init__(self, graph: BondGraph) -> None:
        self.graph = graph
        variables = {
            f"{label}.{key}": symbol
            for label, element in graph.elements.items()
            for key, symbol in variables_of(element).items()
        }
        self.parameters = {symbol.name: symbol for symbol in graph.parameters}
        inputs = {symbol.name: symbol for symbol in graph.inputs}
        self.names = Names(variables, self.parameters, inputs)

    def text(self) -> str:
        elements = self._elements()
        bonds = [f"{bond.tail} > {bond.head}" for bond in self.graph.bonds]
        lines = [f"schema = {SCHEMA}", f"name = {toml(self.graph.name)}", ""]
        lines += ["elements = [", *(f"  {toml(row)}," for row in elements), "]", ""]
        lines += ["bonds = [", *(f"  {toml(bond)}," for bond in bonds), "]"]
        tables = {
            "ports": dict(self.graph.ports),
            "parameters": self._parameters(),
            "inputs": self._inputs(),
            "outputs": self._outputs(),
        }
        for name, table in tables.items():
            if table:
                lines += ["", f"[{name}]"]
                lines += [f"{toml_key(key)} = {toml(value)}" for key, value in table.items()]
        return "\n".join(lines) + "\n"

    def _elements(self) -> list[dict[str, Any]]:
        """Return the rows of all elements; a field has one, where its first port stands."""
        labels = list(self.graph.elements)
        fields = fields_in(self.graph.elements)
        field_of = {f"{name}.{port}": name for name, ports in fields.items() for port in ports}
        rows: list[dict[str, Any]] = []
        placed: set[str] = set()
        begun: set[str] = set()
        for index, label in enumerate(labels):
            name = field_of.get(label)
            if name is None:
                self._add(rows, label)
            elif name not in begun:
                begun.add(name)
                with at(f"field {name!r}"):
                    rows.append(field_entry(name, fields[name], self.names))
                placed |= _run(labels[index:], [f"{name}.{port}" for port in fields[name]])
            elif label not in placed:
                rows.append({"name": label, "kind": PORT})
        return rows

    def _add(self, rows: list[dict[str, Any]], label: str) -> None:
        """Add the row of one element; a resistor and its heat go into one."""
        element: Any = self.graph.elements[label]
        heater = self._heater(element)
        before = (rows[-1]["name"], rows[-1]["kind"]) if rows else ()
        if before == (heater, "R") and label == f"{heater}{HEAT}":
            rows[-1] |= {"kind": RS} | ({"pseudo": True} if element.pseudo else {})
            return
        rows.append(self._element(label, element, heater))

    def _heater(self, element: Any) -> str:
        """Return the dissipator whose whole loss a heat is; empty where there is none."""
        if not isinstance(element, Heat):
            return ""
        return next(
            (
                label
                for label, other in self.graph.of(HEATERS)
                if element.power == other.e * other.f
            ),
            "",
        )

    def _element(self, label: str, element: Any, heater: str) -> dict[str, Any]:
        name = type(element).__name__
        if name not in KINDS:
            raise ModelError(
                f"element {label!r}: a {name} has no form in a model file; keep this model in Python"
            )
        kind, row = KINDS[name], {"name": label, "kind": name}
        if heater:
            row["dissipator"] = heater
        with at(f"element {label!r}"):
            for key, law in ({} if heater else laws_of(element)).items():
                argument = kind.laws[key]
                bare = {argument: getattr(element, argument)} if argument else {}
                row[key] = self.names.write(law, bare)
        return row | {key: True for key in kind.flags if getattr(element, key)}

    def _parameters(self) -> dict[str, Any]:
        names = Names({}, self.parameters)
        table = {}
        for symbol, row in self.graph.parameters.items():
            with at(f"parameter {symbol.name!r}"):
                value = None if row.value is None else names.write(row.value)
                if isinstance(row.value, float):
                    value = float(row.value)
                words = {"unit": row.unit, "meaning": row.meaning, "source": row.source}
                entry = {"value": value, **words, **assumptions_of(symbol)}
            table[symbol.name] = {
                key: item for key, item in entry.items() if item not in (None, "")
            }
        return table

    def _inputs(self) -> dict[str, Any]:
        return {
            symbol.name: {"unit": unit, **assumptions_of(symbol)}
            for symbol, unit in self.graph.inputs.items()
        }

    def _outputs(self) -> dict[str, Any]:
        table = {}
        for name, output in self._given_outputs().items():
            with at(f"output {name!r}"):
                entry = {"expression": self.names.write(output.expression), "unit": output.unit}
            table[name] = entry | ({"meaning": output.meaning} if output.meaning else {})
        return table

    def _given_outputs(self) -> dict[str, Output]:
        """Leave out sensors' outputs, which come by themselves, where nothing is said of them."""
        outputs = dict(self.graph.outputs)
        sensors = [label for label, _ in self.graph.of((De, Df)) if label in outputs]
        plain = all(not (outputs[label].unit or outputs[label].meaning) for label in sensors)
        if plain and list(outputs)[: len(sensors)] == sensors:
            return {key: output for key, output in outputs.items() if key not in sensors}
        return outputs


def _run(labels: list[str], ports: list[str]) -> set[str]:
    """Return the ports that follow each other at the head of a list, as in their field."""
    places = {label: index for index, label in enumerate(ports)}
    found: list[str] = []
    for label in labels:
        if label not in places or (found and places[label] < places[found[-1]]):
            break
        found.append(label)
    return set(found)
