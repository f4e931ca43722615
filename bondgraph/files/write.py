"""Writes a bond graph as the text of a model file."""

from __future__ import annotations

from typing import Any

from ..elements import Element
from ..errors import ModelError
from ..graph import BondGraph
from .assumptions import assumptions_of
from .elements import laws_of
from .entries import at
from .kinds import KINDS, variables_of
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
        elements = [self._element(*item) for item in self.graph.elements.items()]
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

    def _element(self, label: str, element: Element) -> dict[str, Any]:
        kind = type(element).__name__
        if kind not in KINDS:
            raise ModelError(
                f"element {label!r}: a {kind} has no form in a model file; keep this model in Python"
            )
        row = {"name": label, "kind": kind}
        with at(f"element {label!r}"):
            for key, law in laws_of(element).items():
                argument = KINDS[kind].laws[key]
                symbol = getattr(element, argument) if argument else None
                row[key] = self.names.write(law, argument, symbol)
        return row

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
        for name, output in self.graph.outputs.items():
            with at(f"output {name!r}"):
                entry = {"expression": self.names.write(output.expression), "unit": output.unit}
            table[name] = entry | ({"meaning": output.meaning} if output.meaning else {})
        return table
