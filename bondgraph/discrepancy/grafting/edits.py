"""What changed between two graphs, as values and as lines of text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy

from ...elements import Element, Junction
from ...graph import BondGraph


@dataclass(frozen=True)
class Edit:
    """One change.

    Attributes
    ----------
    sign : str
        ``+`` added, ``-`` removed, ``~`` changed.
    kind : str
        Kind of element, ``bond``, ``parameter`` or ``output``.
    name : str
    where : str
        What it is bonded to, or its law.

    Examples
    --------
    >>> str(Edit("+", "R", "drag", "on 1-junction 'carriage'"))
    "+ R 'drag' on 1-junction 'carriage'"
    """

    sign: str
    kind: str
    name: str
    where: str = ""

    def __str__(self) -> str:
        return f"{self.sign} {self.kind} {self.name!r}{' ' * bool(self.where)}{self.where}"


def edits_of(old: BondGraph, new: BondGraph) -> tuple[Edit, ...]:
    """Return what changed from one graph to the other.

    Parameters
    ----------
    old, new : BondGraph

    Returns
    -------
    tuple of Edit
        Removals, elements, outputs, parameters.
    """
    return tuple([*_elements(old, new), *_bonds(old, new), *_outputs(old, new), *_rows(old, new)])


def _elements(old: BondGraph, new: BondGraph) -> Iterable[Edit]:
    for label in old.elements.keys() - new.elements.keys():
        yield Edit("-", old.elements[label].kind, label)
    added = [label for label in new.elements if label not in old.elements]
    for label in sorted(added, key=lambda name: isinstance(new.elements[name], Junction)):
        yield Edit("+", _kind(new.elements[label]), label, _where(new, label))
    for label, element in new.elements.items():
        before = old.elements.get(label)
        if before is not None and before is not element:
            yield Edit("~", _kind(element), label, f": {_laws(new, element)}")


def _bonds(old: BondGraph, new: BondGraph) -> Iterable[Edit]:
    for bond in old.bonds:
        if bond not in new.bonds:
            yield Edit("-", "bond", bond.name)


def _outputs(old: BondGraph, new: BondGraph) -> Iterable[Edit]:
    for name, output in new.outputs.items():
        if name in old.outputs and old.outputs[name] != output:
            yield Edit("~", "output", name, f": {_shown(new, output.expression)}")


def _rows(old: BondGraph, new: BondGraph) -> Iterable[Edit]:
    for symbol, row in new.parameters.items():
        if symbol not in old.parameters:
            unit = f" {row.unit}" if row.unit else ""
            yield Edit("+", "parameter", symbol.name, f"= {row.value}{unit}")


def _kind(element: Element) -> str:
    return f"{element.kind}-junction" if isinstance(element, Junction) else element.kind


def _where(graph: BondGraph, label: str) -> str:
    element, bonds = graph.elements[label], graph.bonds_of(label)
    if not bonds:
        return f": {_laws(graph, element)}"
    ends = [bond.head if bond.tail == label else bond.tail for bond in bonds]
    shown = [f"{_kind(graph.elements[end])} {end!r}" for end in ends]
    if isinstance(element, Junction):
        return f"joining {', '.join(shown)}"
    return f"{'on' if len(ends) == 1 else 'between'} {' and '.join(shown)}"


def _laws(graph: BondGraph, element: Element) -> str:
    keys = ("effort", "law", "kinetic", "rate", "flow")
    laws = element.laws
    key = next((key for key in keys if key in laws), None)
    return "" if key is None else f"{key} = {_shown(graph, laws[key])}"


def _shown(graph: BondGraph, expression: sympy.Expr) -> str:
    names = {
        symbol: sympy.Symbol(f"{label}.{key}")
        for label, element in graph.elements.items()
        for key, symbol in element.symbols.items()
    }
    return str(expression.xreplace(names))
