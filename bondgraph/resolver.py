"""Parameter tables resolved to SI numbers, again and again for many sets of values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import sympy

from .errors import ParameterError
from .parameters import Parameter, as_parameter, unknown_name
from .units import to_si


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


class _Step(NamedTuple):
    """One derived parameter: its name, what it takes, and its expression in two forms."""

    name: str
    arguments: tuple[str, ...]
    function: Callable[..., Any]
    expression: sympy.Expr


class _Plan(NamedTuple):
    """What remains to be done where certain parameters are given."""

    values: dict[str, float]  # in the table's order; those of `steps` and of the given to be filled
    steps: tuple[_Step, ...]


class Resolver:
    """Evaluates a parameter table again and again.

    Expressions are compiled once, and what does not depend on the parameters
    given is evaluated once for each set of names.

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
        self._rows = {symbol.name: row for symbol, row in table.items()}
        self._order = _in_order(table)
        self._rules = {symbol.name: _rules(symbol) for symbol in table}
        self._compiled: dict[str, _Step] = {}
        self._plans: dict[tuple[frozenset[str], bool], _Plan] = {}

    def __call__(
        self, overrides: Mapping[Any, Any] | None = None, *, partial: bool = False
    ) -> dict[str, float]:
        """Return SI values by name; see `resolve`."""
        given = self._given(overrides or {})
        key = frozenset(given), partial
        if key not in self._plans:
            self._plans[key] = self._plan(*key)
        plan = self._plans[key]
        values = plan.values.copy()
        for name, number in given.items():
            values[name] = self._admissible(name, number)
        for step in plan.steps:
            values[step.name] = self._admissible(step.name, _number(step, values))
        return values

    def along(
        self, fixed: Mapping[Any, Any], names: Iterable[str], *, partial: bool = False
    ) -> Callable[[Iterable[float]], dict[str, float]]:
        """Return a function from values of some parameters, in SI, to all.

        Parameters
        ----------
        fixed : mapping
            Overrides that stay the same; those of `names` do not count.
        names : iterable of str
        partial : bool

        Returns
        -------
        callable

        Raises
        ------
        ParameterError
            For what is wrong whatever the values are. The function raises for values.

        Examples
        --------
        >>> k, m = sympy.symbols("k m", positive=True)
        >>> values = Resolver({k: Parameter(8.0), m: Parameter(k / 2)}).along({}, ["k"])
        >>> values([4.0]), values([2.0])["m"]
        ({'k': 4.0, 'm': 2.0}, 1.0)
        """
        moving = tuple(names)
        given = self._given({name: math.nan for name in moving})
        held = {name: v for name, v in self._given(fixed).items() if name not in given}
        plan = self._plan(frozenset((*given, *held)), partial)
        base, open_names, steps = plan.values.copy(), set(moving), []
        for name, number in held.items():
            base[name] = self._admissible(name, number)
        for step in plan.steps:
            if open_names.intersection(step.arguments):
                open_names.add(step.name)
                steps.append(step)
            else:
                base[step.name] = self._admissible(step.name, _number(step, base))

        def resolved(numbers: Iterable[float]) -> dict[str, float]:
            values = base.copy()
            for name, number in zip(moving, numbers, strict=True):
                values[name] = self._admissible(name, number)
            for step in steps:
                values[step.name] = self._admissible(step.name, _number(step, values))
            return values

        return resolved

    def _given(self, overrides: Mapping[Any, Any]) -> dict[str, float]:
        given = {}
        for key, value in overrides.items():
            name = key if isinstance(key, str) else getattr(key, "name", str(key))
            if name not in self._rows:
                raise unknown_name("parameter", name, self._rows)
            given[name] = _override(name, value, self._rows[name])
        return given

    def _plan(self, given: frozenset[str], partial: bool) -> _Plan:
        """Evaluate what does not depend on the given; the rest are steps, in order."""
        known: dict[str, float] = {}
        open_names, steps = set(given), []
        for symbol in self._order:
            name, row = symbol.name, self._table[symbol]
            if name in given:
                continue
            if row.value is None:
                if not partial:
                    raise ParameterError(
                        f"parameter {name!r} has no value; give it, e.g. parameters={{{name!r}: 1.0}}"
                    )
            elif not row.derived:
                number = to_si(row.value, row.unit) if row.unit else float(row.value)
                known[name] = self._admissible(name, number)
            else:
                step = self._step(name, row.value)
                if any(item not in known and item not in open_names for item in step.arguments):
                    continue  # one of them has no value
                if open_names.intersection(step.arguments):
                    open_names.add(name)
                    steps.append(step)
                else:
                    known[name] = self._admissible(name, _number(step, known))
        names = [symbol.name for symbol in self._table]
        kept = [name for name in names if name in known or name in open_names]
        return _Plan({name: known.get(name, math.nan) for name in kept}, tuple(steps))

    def _step(self, name: str, expression: sympy.Expr) -> _Step:
        if name not in self._compiled:
            arguments = tuple(sorted(expression.free_symbols, key=lambda item: item.name))
            function = sympy.lambdify(arguments, expression, modules="math")
            names = tuple(item.name for item in arguments)
            self._compiled[name] = _Step(name, names, function, expression)
        return self._compiled[name]

    def _admissible(self, name: str, value: float) -> float:
        """Check a value against what its symbol assumes."""
        if not math.isfinite(value):
            raise ParameterError(f"parameter {name!r} is {value}; it must be a finite number")
        for holds, words in self._rules[name]:
            if not holds(value):
                raise ParameterError(f"parameter {name!r} is {value:g}; it must be {words}")
        return value


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


def _number(step: _Step, values: Mapping[str, float]) -> float:
    try:
        return float(step.function(*[values[name] for name in step.arguments]))
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        shown = ", ".join(f"{name} = {values[name]:g}" for name in step.arguments)
        raise ParameterError(
            f"parameter {step.name!r} = {step.expression} has no real value at {shown}"
        ) from None


def _rules(symbol: sympy.Symbol) -> tuple[tuple[Callable[[float], bool], str], ...]:
    """Return what a symbol's assumptions ask of its value, in words too."""
    rules: tuple[tuple[Any, Callable[[float], bool], str], ...] = (
        (symbol.is_positive, lambda value: value > 0, "positive"),
        (symbol.is_negative, lambda value: value < 0, "negative"),
        (symbol.is_nonnegative, lambda value: value >= 0, "at least zero"),
        (symbol.is_nonzero and symbol.is_real, lambda value: value != 0, "different from zero"),
        (symbol.is_integer, lambda value: value == int(value), "a whole number"),
    )
    return tuple((holds, words) for applies, holds, words in rules if applies)
