"""Parameters with value, unit, meaning and source, and their resolution to SI numbers.

A parameter is a sympy symbol. What the symbol assumes (``positive=True``,
``nonnegative=True``) is what its value must satisfy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy

from .errors import LawError, ParameterError, suggestion
from .laws import exact
from .units import check_compatible, quantity_parts, to_si


@dataclass(frozen=True)
class Parameter:
    """One row of a model's parameter table.

    Attributes
    ----------
    value : float, Expr or None
        Number in ``unit``; or an expression in other parameters, whose result
        is in SI; or None where the user must give it.
    unit : str
        Unit of the value, empty for a pure number.
    meaning : str
        What it is, in a few words.
    source : str
        Where the value comes from.

    Examples
    --------
    >>> Parameter(350, "N/mm", "frame stiffness at the caliper").unit
    'N/mm'
    """

    value: Any = None
    unit: str = ""
    meaning: str = ""
    source: str = ""

    @property
    def derived(self) -> bool:
        """Whether the value is an expression in other parameters."""
        return isinstance(self.value, sympy.Expr) and bool(self.value.free_symbols)


def as_parameter(name: str, given: Any) -> Parameter:
    """Read a parameter from any of its accepted forms.

    Parameters
    ----------
    name : str
        For error messages.
    given : Parameter, number, Expr, (value, unit) or pint quantity

    Returns
    -------
    Parameter

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> as_parameter("k", (350, "N/mm")).value
    350
    """
    if isinstance(given, Parameter):
        parameter = given
    elif (parts := quantity_parts(given)) is not None:
        parameter = Parameter(*parts)
    elif isinstance(given, tuple):
        if len(given) < 2 or len(given) > 4 or not all(isinstance(word, str) for word in given[1:]):
            raise ParameterError(
                f"parameter {name!r}: expected (value, 'unit', 'meaning', 'source'), got {given!r}"
            )
        parameter = Parameter(*given)
    else:
        parameter = Parameter(given)
    if parameter.value is None:
        return parameter
    try:
        value = exact(parameter.value)
    except LawError as error:
        raise ParameterError(f"parameter {name!r}: {error}") from None
    if not value.free_symbols:
        number = parameter.value if isinstance(parameter.value, int | float) else float(value)
        return Parameter(number, parameter.unit, parameter.meaning, parameter.source)
    return Parameter(value, parameter.unit, parameter.meaning, parameter.source)


def unknown_name(kind: str, name: str, known: Iterable[str]) -> ParameterError:
    """Build the error for a name that is not known, with the nearest ones."""
    names = list(known)
    hint = suggestion(name, names) or f"known: {', '.join(names) or 'none'}"
    return ParameterError(f"{kind} {name!r} is not known; {hint}")


def resolve(
    table: Mapping[sympy.Symbol, Parameter],
    overrides: Mapping[Any, Any] | None = None,
    *,
    partial: bool = False,
) -> dict[str, float]:
    """Evaluate all parameters to SI numbers, once; see `Resolver` for many times.

    Parameters
    ----------
    table : mapping of Symbol to Parameter
    overrides : mapping, optional
        Name or symbol to a number in SI, ``(value, unit)`` or a quantity. An
        override of a derived parameter replaces its expression.
    partial : bool
        Leave out parameters without a value instead of raising.

    Returns
    -------
    dict of str to float
        SI values by name, in the table's order.

    Raises
    ------
    ParameterError
        For unknown names, wrong units, values that are not finite or not
        admissible, missing values and circular expressions.

    Examples
    --------
    >>> m, k, f = sympy.symbols("m k f", positive=True)
    >>> resolve({k: Parameter(2, "N/m"), m: Parameter(k / f**2), f: Parameter(2, "Hz")}, {"k": (1, "N/mm")})["m"]
    250.0
    """
    return Resolver(table)(overrides, partial=partial)


class Resolver:
    """Evaluates a parameter table again and again; expressions are compiled once.

    Parameters
    ----------
    table : mapping of Symbol to Parameter

    Raises
    ------
    ParameterError
        For circular expressions, and for symbols that are not in the table.

    Examples
    --------
    >>> k, m = sympy.symbols("k m", positive=True)
    >>> values = Resolver({k: Parameter(8.0), m: Parameter(k / 2)})
    >>> values()["m"], values({"k": 4})["m"]
    (4.0, 2.0)
    """

    def __init__(self, table: Mapping[sympy.Symbol, Parameter]) -> None:
        self._table = table
        self._by_name = {symbol.name: symbol for symbol in table}
        self._order = _in_order(table)
        self._plain = {
            symbol: to_si(row.value, row.unit) if row.unit else float(row.value)
            for symbol, row in table.items()
            if row.value is not None and not row.derived
        }
        self._functions: dict[
            sympy.Symbol, tuple[tuple[sympy.Symbol, ...], Callable[..., Any]]
        ] = {}

    def __call__(
        self, overrides: Mapping[Any, Any] | None = None, *, partial: bool = False
    ) -> dict[str, float]:
        """Return SI values by name; see `resolve`."""
        given = self._given(overrides or {})
        values: dict[sympy.Symbol, float] = {}
        for symbol in self._order:
            number = self._value(symbol, given, values, partial)
            if number is not None:
                values[symbol] = _admissible(symbol, number)
        return {symbol.name: values[symbol] for symbol in self._table if symbol in values}

    def _given(self, overrides: Mapping[Any, Any]) -> dict[sympy.Symbol, float]:
        given = {}
        for key, value in overrides.items():
            name = key.name if isinstance(key, sympy.Symbol) else str(key)
            if name not in self._by_name:
                raise unknown_name("parameter", name, self._by_name)
            symbol = self._by_name[name]
            given[symbol] = _override(name, value, self._table[symbol])
        return given

    def _value(
        self,
        symbol: sympy.Symbol,
        given: Mapping[sympy.Symbol, float],
        values: Mapping[sympy.Symbol, float],
        partial: bool,
    ) -> float | None:
        row = self._table[symbol]
        if symbol in given:
            return given[symbol]
        if symbol in self._plain:
            return self._plain[symbol]
        if row.value is None:
            if partial:
                return None
            raise ParameterError(
                f"parameter {symbol.name!r} has no value; give it, e.g. parameters={{{symbol.name!r}: 1.0}}"
            )
        arguments, function = self._function(symbol, row.value)
        if not all(argument in values for argument in arguments):
            return None
        return _number(
            symbol.name, row.value, {argument: values[argument] for argument in arguments}, function
        )

    def _function(
        self, symbol: sympy.Symbol, expression: sympy.Expr
    ) -> tuple[tuple[sympy.Symbol, ...], Callable[..., Any]]:
        if symbol not in self._functions:
            arguments = tuple(sorted(expression.free_symbols, key=lambda item: item.name))
            self._functions[symbol] = (
                arguments,
                sympy.lambdify(arguments, expression, modules="math"),
            )
        return self._functions[symbol]


def _in_order(table: Mapping[sympy.Symbol, Parameter]) -> list[sympy.Symbol]:
    """Sort parameters so that each comes after those it is derived from."""
    order: dict[sympy.Symbol, None] = {}

    def visit(symbol: sympy.Symbol, path: tuple[sympy.Symbol, ...]) -> None:
        if symbol in order:
            return
        if symbol in path:
            loop = " -> ".join(item.name for item in (*path[path.index(symbol) :], symbol))
            raise ParameterError(
                f"parameters are defined in a circle: {loop}; give one of them a number"
            )
        if symbol not in table:
            raise ParameterError(
                f"parameter {path[-1].name!r} uses {symbol.name!r}, which is no parameter; add it to the table"
            )
        if table[symbol].derived:
            for item in sorted(table[symbol].value.free_symbols, key=lambda item: item.name):
                visit(item, (*path, symbol))
        order[symbol] = None

    for symbol in table:
        visit(symbol, ())
    return list(order)


def _override(name: str, value: Any, row: Parameter) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    parameter = as_parameter(name, value)
    if parameter.value is None:
        raise ParameterError(f"parameter {name!r}: expected a number, got {value!r}")
    if parameter.derived:
        raise ParameterError(
            f"parameter {name!r}: an override is a number, not the expression {parameter.value}"
        )
    if not parameter.unit:
        return float(parameter.value)
    try:
        return to_si(parameter.value, parameter.unit, expected=row.unit)
    except ParameterError as error:
        raise ParameterError(f"parameter {name!r}: {error}") from None


def _number(
    name: str,
    expression: sympy.Expr,
    values: Mapping[sympy.Symbol, float],
    function: Callable[..., Any],
) -> float:
    try:
        return float(function(*values.values()))
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        shown = ", ".join(f"{key.name} = {value:g}" for key, value in values.items())
        raise ParameterError(
            f"parameter {name!r} = {expression} has no real value at {shown}"
        ) from None


def _admissible(symbol: sympy.Symbol, value: float) -> float:
    """Check a value against what its symbol assumes."""
    if not math.isfinite(value):
        raise ParameterError(f"parameter {symbol.name!r} is {value}; it must be a finite number")
    rules = (
        (symbol.is_positive, value > 0, "positive"),
        (symbol.is_negative, value < 0, "negative"),
        (symbol.is_nonnegative, value >= 0, "at least zero"),
        (symbol.is_nonzero and symbol.is_real, value != 0, "different from zero"),
        (symbol.is_integer, value == int(value), "a whole number"),
    )
    for applies, holds, words in rules:
        if applies and not holds:
            raise ParameterError(f"parameter {symbol.name!r} is {value:g}; it must be {words}")
    return value


def check_unit(name: str, unit: str, expected: str) -> None:
    """Raise, naming the parameter, unless its unit fits.

    Examples
    --------
    >>> check_unit("k", "N/mm", "N/m")
    """
    try:
        check_compatible(unit, expected)
    except ParameterError as error:
        raise ParameterError(f"parameter {name!r}: {error}") from None
