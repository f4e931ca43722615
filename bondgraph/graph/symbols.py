"""The symbols of all laws, sorted into time, inputs, parameters and port variables."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import sympy

from ..codegen.symbols import symbols_in
from ..elements import DryFriction, Element
from ..errors import GraphError, LawError, ParameterError
from ..laws import exact
from ..parameters import Parameter, as_parameter
from .value import TIME, BondGraph, Output


class Symbols:
    """Sorts the free symbols of all laws into time, inputs, parameters and port variables."""

    def __init__(
        self,
        graph: str,
        elements: Mapping[str, Element],
        submodels: list[BondGraph],
        parameters: Mapping[Any, Any],
        inputs: Iterable[sympy.Symbol] | Mapping[sympy.Symbol, str],
    ) -> None:
        self.graph = graph
        # what stands for the slip speed in a friction's law is no variable of the graph
        self._inner = {
            element.speed for element in elements.values() if isinstance(element, DryFriction)
        }
        self.own = {symbol for element in elements.values() for symbol in element.symbols.values()}
        self.own -= self._inner
        self.merged: dict[sympy.Basic, sympy.Basic] = {}
        self.notes: list[str] = []
        self._by_name: dict[str, sympy.Symbol] = {}
        given_inputs = dict(inputs) if isinstance(inputs, Mapping) else dict.fromkeys(inputs, "")
        for symbol, unit in given_inputs.items():
            if not isinstance(symbol, sympy.Symbol) or not isinstance(unit, str):
                raise ParameterError(
                    f"graph {graph!r}: inputs are sympy symbols with units, got {symbol!r}: {unit!r}"
                )
        for key in parameters:
            if isinstance(key, sympy.Symbol):
                self._known(key)
        for symbol in given_inputs:
            self._known(symbol)
        for submodel in submodels:
            for symbol in (*submodel.parameters, *submodel.inputs):
                self._known(symbol)
        used: dict[sympy.Symbol, None] = {}
        for label, element in elements.items():
            user = f"{element.kind} {label!r}"
            own = {element.speed} if isinstance(element, DryFriction) else ()
            for law in element.laws.values():
                used |= dict.fromkeys(self._foreign(law, user, own))
        self.inputs = {
            self._known(symbol): unit
            for submodel in submodels
            for symbol, unit in submodel.inputs.items()
        }
        self.inputs |= {self._known(symbol): unit for symbol, unit in given_inputs.items()}
        self.parameters = self._parameters(submodels, parameters)
        self._use(used)
        clash = [symbol.name for symbol in self.inputs if symbol in self.parameters]
        if clash:
            raise ParameterError(
                f"graph {graph!r}: {', '.join(clash)} cannot be both input and parameter"
            )

    def _use(self, symbols: Iterable[sympy.Symbol]) -> None:
        """Make parameters without a value of symbols that nothing else is said about."""
        for symbol in symbols:
            if symbol is not TIME and symbol not in self.inputs:
                self.parameters.setdefault(symbol, Parameter())

    def touches(self, element: Element) -> bool:
        """Whether an element's laws use a symbol that was merged into another of its name."""
        if not self.merged:
            return False
        return any(law.free_symbols & self.merged.keys() for law in element.laws.values())

    def canonical(self, expression: sympy.Expr, user: str) -> sympy.Expr:
        """Return an expression in the graph's own symbols; unknown ones become parameters."""
        self._use(self._foreign(expression, user))
        return expression.xreplace(self.merged)

    def _known(self, symbol: sympy.Symbol) -> sympy.Symbol:
        """Merge symbols of one name: they are one parameter, whatever they assume."""
        chosen = self._by_name.setdefault(symbol.name, symbol)
        if chosen is not symbol and chosen != symbol:
            self.merged[symbol] = chosen
        return chosen

    def _foreign(
        self, expression: sympy.Expr, user: str, inner: Collection[sympy.Basic] = ()
    ) -> list[sympy.Symbol]:
        found = []
        outside = symbols_in(expression) - self.own - set(inner)
        for symbol in sorted(outside, key=lambda item: item.name):
            if symbol in self._inner:
                name = symbol.name.removesuffix(".speed")
                raise GraphError(
                    f"graph {self.graph!r}: {user} uses {symbol.name}, which stands for the slip speed inside the law "
                    f"of {name!r} alone; use its flow {name}.f",
                    elements=[name],
                )
            if isinstance(symbol, sympy.Dummy):
                raise GraphError(
                    f"graph {self.graph!r}: {user} uses {symbol.name}, but that element is not in the graph; add it",
                    elements=[user],
                )
            if symbol.name == TIME.name and symbol.name not in self._by_name:
                if symbol != TIME and symbol not in self.merged:
                    self.merged[symbol] = TIME
                    if symbol.assumptions0 != sympy.Symbol(symbol.name).assumptions0:
                        self.notes.append(
                            f"symbol {symbol.name!r} of {user} is taken for time; give it a row in parameters "
                            f"if it is a parameter"
                        )
                found.append(TIME)
            else:
                found.append(self._known(symbol))
        return found

    def _parameters(
        self, submodels: list[BondGraph], given: Mapping[Any, Any]
    ) -> dict[sympy.Symbol, Parameter]:
        table: dict[sympy.Symbol, Parameter] = {}
        own: dict[sympy.Symbol, Any] = {}
        for key, value in given.items():
            symbol = self._known(
                self._by_name.get(key) or sympy.Symbol(key, real=True)
                if isinstance(key, str)
                else key
            )
            if symbol in own:
                raise ParameterError(
                    f"graph {self.graph!r} gives parameter {symbol.name!r} twice; keep one of them"
                )
            own[symbol] = value
        for symbol, value in own.items():
            table[symbol] = self._row(as_parameter(symbol.name, value))
        for submodel in submodels:
            for symbol, row in submodel.parameters.items():
                known = self._known(symbol)
                row = self._row(row)
                if (
                    known in table
                    and known not in own
                    and None not in (row.value, table[known].value)
                    and row != table[known]
                ):
                    raise ParameterError(
                        f"graph {self.graph!r}: submodels give {symbol.name!r} different values "
                        f"({table[known].value} and {row.value}); set it in the parent's parameters"
                    )
                if known not in table or table[known].value is None:
                    table[known] = row
        for row in list(table.values()):
            if row.derived:
                for symbol in row.value.free_symbols:
                    table.setdefault(symbol, Parameter())
        return table

    def _row(self, row: Parameter) -> Parameter:
        if not row.derived:
            return row
        if TIME in self._foreign(row.value, "a parameter") or row.value.free_symbols & self.own:
            raise ParameterError(
                f"graph {self.graph!r}: a parameter is constant, but {row.value} depends on time or on the graph's "
                f"variables; write it into the law that uses it"
            )
        return Parameter(row.value.xreplace(self.merged), row.unit, row.meaning, row.source)


def gather_outputs(
    graph: str, given: Mapping[str, Any], submodels: list[BondGraph], symbols: Symbols
) -> dict[str, Output]:
    """Collect the outputs of submodels and those given."""
    outputs = {
        f"{submodel.name}.{name}": Output(
            symbols.canonical(output.expression, name), output.unit, output.meaning
        )
        for submodel in submodels
        for name, output in submodel.outputs.items()
    }
    for name, value in given.items():
        expression, *rest = value if isinstance(value, tuple) else (value,)
        if isinstance(value, Output):
            expression, rest = value.expression, [value.unit, value.meaning]
        if len(rest) > 2 or not all(isinstance(word, str) for word in rest):
            raise GraphError(
                f"graph {graph!r}: output {name!r} takes an expression and a unit, got {value!r}"
            )
        try:
            outputs[name] = Output(symbols.canonical(exact(expression), f"output {name!r}"), *rest)
        except LawError as error:
            raise GraphError(f"graph {graph!r}: output {name!r}: {error}") from None
    return outputs
