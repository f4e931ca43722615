"""What a graph says about dimensions: by its parameters' units, its laws and its outputs."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import sympy

from ..elements import TF, Element, Heat, Junction, SignalBlock, TwoPort
from ..errors import ParameterError
from ..graph import TIME, BondGraph, Output
from ..parameters import Parameter
from .forms import POWER, SECOND, TEMPERATURE, Form, dimension, per, times
from .laws import law_claims
from .reader import Claim, Lookup, Reader, Value


class Regions:
    """Bonds that share the dimension of their effort: all that meet at junctions.

    Attributes
    ----------
    at : dict of str to list of int
        Bonds of each element.
    of_bond : list of int
        Region of each bond.
    of_block : dict of str to int
        Number of each signal block: what it says has a dimension of its own.
    pseudo : dict of int to str
        Regions of pseudo-bonds, effort in K and flow in W, and who says so.
    """

    def __init__(self, graph: BondGraph) -> None:
        self.graph = graph
        self.at: dict[str, list[int]] = {name: [] for name in graph.elements}
        for index, bond in enumerate(graph.bonds):
            self.at[bond.tail].append(index)
            self.at[bond.head].append(index)
        self.of_bond = [-1] * len(graph.bonds)
        count = 0
        for start in range(len(graph.bonds)):
            if self.of_bond[start] < 0:
                self._flood(start, count)
                count += 1
        blocks = (name for name, _ in graph.of(SignalBlock))
        self.of_block = {name: count + place for place, name in enumerate(blocks)}
        self.pseudo = {
            self.of_bond[self.at[name][0]]: f"{element.kind} {name!r}"
            for name, element in graph.of((Junction, Heat))
            if element.pseudo and self.at[name]
        }

    def _flood(self, start: int, region: int) -> None:
        stack = [start]
        while stack:
            index = stack.pop()
            if self.of_bond[index] >= 0:
                continue
            self.of_bond[index] = region
            bond = self.graph.bonds[index]
            for name in (bond.tail, bond.head):
                if not isinstance(self.graph.elements[name], TwoPort):
                    stack.extend(self.at[name])

    def sides(self, name: str) -> tuple[int, int]:
        """Return in and out bond of a two-port: by arrows, by order where arrows do not tell."""
        first, second = self.at[name]
        bonds = self.graph.bonds
        if bonds[first].tail == name and bonds[second].head == name:
            return second, first
        return first, second


class Symbols(Lookup):
    """Dimension of every symbol of a graph.

    Attributes
    ----------
    variables : dict of Symbol to Form
        Port variables, by the effort of their region.
    problems : list of str
        Units that cannot be read.
    claims : list of Claim
        What derived parameters ask for.
    """

    def __init__(self, graph: BondGraph, regions: Regions) -> None:
        self.graph = graph
        self.problems: list[str] = []
        self.claims: list[Claim] = []
        self.variables: dict[sympy.Basic, Form] = {TIME: SECOND}
        for name, element in graph.elements.items():
            self.variables |= _port_variables(element, regions, name)
        self.units: dict[sympy.Basic, str] = {
            symbol: row.unit for symbol, row in graph.parameters.items() if row.unit
        }
        self.units |= {symbol: unit for symbol, unit in graph.inputs.items() if unit}
        self._given: dict[sympy.Basic, Form | None] = {
            symbol: self.vector(unit, str(symbol)) for symbol, unit in self.units.items()
        }
        for symbol, row in graph.parameters.items():
            self._parameter(symbol, row)

    def symbol(self, symbol: sympy.Basic) -> Value | None:
        """Return the dimension of a symbol; None where it is not known."""
        if symbol in self.variables:
            return Value(self.variables[symbol], False)
        known = self._dimension(symbol)
        return None if known is None else Value(known, True)

    def vector(self, unit: str, user: str) -> Form | None:
        """Return a unit's dimension; a unit that cannot be read is a problem."""
        try:
            return dimension(unit)
        except ParameterError as error:
            self.problems.append(f"{user}: {error}")
            return None

    def shown(self, laws: Iterable[sympy.Expr]) -> str:
        """Name the units that laws rest on, for messages."""
        used = {symbol for law in laws for symbol in law.free_symbols if symbol in self.units}
        names = [f"{symbol} in {self.units[symbol]}" for symbol in sorted(used, key=str)]
        return f" ({', '.join(names[:3])}{', ...' if len(names) > 3 else ''})" if names else ""

    def _dimension(self, symbol: sympy.Basic) -> Form | None:
        """Return the dimension of a parameter or input."""
        if symbol not in self._given:
            self._given[symbol] = None  # a parameter defined in a circle has none
            row = self.graph.parameters.get(symbol)
            if row is not None and row.derived:
                found = Reader(self, "").read(row.value)
                self._given[symbol] = found.form if found is not None and found.anchored else None
            elif row is not None and (row.meaning or row.source) and self.units:
                self._given[symbol] = {}  # documented, among others with units: a pure number
        return self._given[symbol]

    def _parameter(self, symbol: sympy.Symbol, row: Parameter) -> None:
        """Check a derived parameter's expression against the unit it declares."""
        if not row.derived:
            return
        reader = Reader(self, f"parameter {symbol.name!r}")
        found, known = reader.read(row.value), self._given.get(symbol)
        if row.unit and known is not None and found is not None and found.anchored:
            words = f"is declared in {row.unit}, but its expression {row.value} is in <right>"
            reader.claim(known, found.form, words)
        self.claims += reader.claims


def _port_variables(element: Element, regions: Regions, name: str) -> dict[sympy.Basic, Form]:
    if isinstance(element, SignalBlock):
        return {element.y: {regions.of_block[name]: Fraction(1)}}
    bonds = regions.at[name]
    if not bonds:
        return {symbol: {} for symbol in element.symbols.values()}
    sides = [("", bonds[0])]
    if isinstance(element, TwoPort):
        sides = list(zip(("_in", "_out"), regions.sides(name), strict=True))
    found: dict[sympy.Basic, Form] = {}
    for suffix, bond in sides:
        effort: Form = {regions.of_bond[bond]: Fraction(1)}
        flow = per(POWER, effort)
        if regions.of_bond[bond] in regions.pseudo:
            effort, flow = TEMPERATURE, POWER
        forms = {"e": effort, "f": flow, "speed": flow}
        forms |= {"q": times(flow, SECOND), "p": times(effort, SECOND)}
        for key, form in forms.items():
            if f"{key}{suffix}" in element.symbols:
                found[element.symbols[f"{key}{suffix}"]] = form
    return found


def claims(graph: BondGraph, regions: Regions, symbols: Symbols) -> list[Claim]:
    """Gather what parameters, laws and outputs ask for, in the order written."""
    gathered = list(symbols.claims)
    for name, element in graph.elements.items():
        if regions.at[name] or isinstance(element, SignalBlock):
            gathered += _element_claims(name, element, symbols, regions)
    for name, output in graph.outputs.items():
        gathered += _output_claims(name, output, symbols)
    return gathered


def _element_claims(name: str, element: Element, symbols: Symbols, regions: Regions) -> list[Claim]:
    if isinstance(element, TwoPort):
        sides = {regions.of_bond[bond] for bond in regions.at[name]}
        return [] if sides & regions.pseudo.keys() else _two_port_claims(name, element, symbols)
    laws = law_claims(element, symbols.variables)
    reader = Reader(symbols, f"{element.kind} {name!r}{symbols.shown(item.law for item in laws)}")
    for item in laws:
        value = reader.read(item.law)
        if item.form is not None and value is not None and (value.anchored or item.certain):
            words = f"has {item.what} in <left>, but its law is in <right>"
            reader.claim(item.form, value.form, words, firm=item.firm)
    if isinstance(element, Heat) and not element.pseudo:
        words = "has effort in <left>, where a temperature is wanted"
        reader.claim(symbols.variables[element.e], TEMPERATURE, words, firm=True)
    return reader.claims


def _output_claims(name: str, output: Output, symbols: Symbols) -> list[Claim]:
    unit = symbols.vector(output.unit, f"output {name!r}") if output.unit else None
    reader = Reader(symbols, f"output {name!r}")
    value = reader.read(output.expression)
    if unit is not None and value is not None:
        words = f"is declared in {output.unit}, but its expression is in <right>"
        reader.claim(unit, value.form, words)
    return reader.claims


def _two_port_claims(name: str, element: TwoPort, symbols: Symbols) -> list[Claim]:
    reader = Reader(symbols, f"{element.kind} {name!r}{symbols.shown([element.ratio])}")
    value = reader.read(element.ratio)
    if value is not None and value.anchored:
        above = symbols.variables[element.e_in]
        below = symbols.variables[element.e_out if isinstance(element, TF) else element.f_out]
        reader.claim(per(above, below), value.form, "", two_port=True)
    return reader.claims
