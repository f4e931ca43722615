"""Numbers for a set of equations: parameters and initial states in SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import sympy

from .equations import Equations
from .errors import ParameterError
from .parameters import as_parameter, unknown_name
from .resolver import Resolver
from .units import to_si


def parameter_values(
    equations: Equations,
    overrides: Mapping[Any, Any] | None = None,
    resolver: Resolver | None = None,
) -> dict[str, float]:
    """Resolve the graph's parameters; all that the equations use must have a value.

    Parameters
    ----------
    equations : Equations
    overrides : mapping, optional
        By name or symbol; see `bondgraph.resolver.resolve`.
    resolver : Resolver, optional
        That of the graph's table, where one is kept for many evaluations.

    Returns
    -------
    dict of str to float
        SI values of every parameter of the graph that has one.

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import mass_on_belt
    >>> parameter_values(derive(mass_on_belt.graph()), {"k": (1, "N/cm")})["k"]
    100.0
    """
    values = (resolver or Resolver(equations.graph.parameters))(overrides, partial=True)
    require(equations, values)
    return values


def require(equations: Equations, values: Mapping[str, float]) -> None:
    """Raise ParameterError unless all that the equations use has a value.

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import mass_on_belt
    >>> require(derive(mass_on_belt.graph()), {"m": 1.0})
    Traceback (most recent call last):
        ...
    bondgraph.errors.ParameterError: model 'mass_on_belt' needs a value for ...
    """
    missing = [symbol.name for symbol in equations.parameters if symbol.name not in values]
    if missing:
        raise ParameterError(
            f"model {equations.name!r} needs a value for {', '.join(missing)}; "
            f"give it in parameters={{...}}, or in assemble(..., parameters=...)"
        )


def initial_values(
    equations: Equations, values: Mapping[str, float], given: Mapping[Any, Any] | None = None
) -> list[float]:
    """Return the initial state vector in SI.

    Parameters
    ----------
    equations : Equations
    values : mapping of str to float
        Parameter values.
    given : mapping, optional
        State name or symbol to a number. An output that is proportional to a
        single state, such as a mass's speed, may be given in its place. Names of
        algebraic variables are left to `algebraic_guess`.

    Returns
    -------
    list of float
        Ordered as ``equations.states``.

    Raises
    ------
    ParameterError
        For unknown names and values that are not finite.

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import mass_on_belt
    >>> equations = derive(mass_on_belt.graph())
    >>> initial_values(equations, parameter_values(equations), {"v": 0.5})
    [0.5, 0.0]
    """
    return InitialState(equations)(values, given)


class InitialState:
    """Evaluates the initial state of a set of equations again and again.

    Parameters
    ----------
    equations : Equations

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import mass_on_belt
    >>> equations = derive(mass_on_belt.graph())
    >>> InitialState(equations)(parameter_values(equations), {"v": 0.5})
    [0.5, 0.0]
    """

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self._places = {state.name: i for i, state in enumerate(equations.states)}
        self._own = [_Number(value) for value in equations.initial]
        self._outputs: dict[str, tuple[int, _Number, _Number]] = {}

    def __call__(
        self, values: Mapping[str, float], given: Mapping[Any, Any] | None = None
    ) -> list[float]:
        """Return the state in SI; see `initial_values`."""
        start = [
            _real("initial value of {!r}", name, own(values))
            for (name, own) in zip(self._places, self._own, strict=True)
        ]
        for name, number in _numbers(given):
            if name in self._places:
                start[self._places[name]] = number
            elif name in self.equations.outputs:
                place, slope, offset = self._output(name)
                steep = slope(values)
                value = (number - offset(values)) / steep if steep else math.nan
                start[place] = _real("{}", name, value)
            elif _algebraic(self.equations, name) is None:
                implicit = [symbol.name for symbol in self.equations.algebraic]
                known = [*self._places, *implicit, *self.equations.outputs]
                raise unknown_name("state", name, known)
        return start

    def _output(self, name: str) -> tuple[int, _Number, _Number]:
        """Return the one state that an output is affine in, the slope and what is added."""
        if name not in self._outputs:
            state, slope, offset = _affine_output(self.equations, name)
            self._outputs[name] = self._places[state.name], _Number(slope), _Number(offset)
        return self._outputs[name]


def _affine_output(equations: Equations, name: str) -> tuple[sympy.Symbol, sympy.Expr, sympy.Expr]:
    """Return the one state that an output is affine in, the slope and what is added."""
    expression = equations.substituted(equations.outputs[name])
    states = [state for state in equations.states if state in expression.free_symbols]
    slope = sympy.diff(expression, states[0]) if len(states) == 1 else sympy.S.Zero
    known = set(states) | set(equations.graph.parameters)
    if slope == 0 or slope.free_symbols & set(states) or expression.free_symbols - known:
        raise ParameterError(
            f"initial value of output {name!r} does not fix one state; give states instead: "
            f"{', '.join(state.name for state in equations.states)}"
        )
    return states[0], slope, expression.subs(states[0], 0)


def start_expressions(
    equations: Equations, given: Mapping[Any, Any] | None = None
) -> list[sympy.Expr]:
    """Return the initial states as expressions in parameters, for many parameter sets at once.

    Parameters
    ----------
    equations : Equations
    given : mapping, optional
        As for `initial_values`.

    Returns
    -------
    list of Expr
        Ordered as ``equations.states``.

    Raises
    ------
    ParameterError
        As `initial_values` does, but for what depends on values.

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import mass_on_belt
    >>> start_expressions(derive(mass_on_belt.graph()), {"v": 0.5})
    [0.5*m, 0]
    """
    start = dict(zip(equations.states, equations.initial, strict=True))
    names = {state.name: state for state in equations.states}
    for name, number in _numbers(given):
        if name in names:
            start[names[name]] = sympy.Float(number)
        elif name in equations.outputs:
            state, slope, offset = _affine_output(equations, name)
            start[state] = (number - offset) / slope
        elif _algebraic(equations, name) is None:
            implicit = [symbol.name for symbol in equations.algebraic]
            raise unknown_name("state", name, [*names, *implicit, *equations.outputs])
    return list(start.values())


class _Number:
    """An expression in parameters as a function of their values by name."""

    def __init__(self, expression: sympy.Expr) -> None:
        self.expression = expression
        self.names: tuple[str, ...] = ()
        if expression.free_symbols:
            symbols = sorted(expression.free_symbols, key=lambda item: item.name)
            self.names = tuple(symbol.name for symbol in symbols)
            self.function = sympy.lambdify(symbols, expression, modules="math")
        else:
            self.constant = _constant(expression)

    def __call__(self, values: Mapping[str, float]) -> Any:
        if not self.names:
            return self.constant
        try:
            return self.function(*[values[name] for name in self.names])
        except KeyError:  # a parameter without a value: said where it is used
            return self.expression
        except (ValueError, ZeroDivisionError, OverflowError):
            return math.nan


def _constant(expression: sympy.Expr) -> Any:
    try:
        return float(expression)
    except TypeError:  # complex: said where it is used
        return expression


def algebraic_guess(equations: Equations, given: Mapping[Any, Any] | None = None) -> list[float]:
    """Return the guess of the algebraic variables, from which their solution is sought.

    Parameters
    ----------
    equations : Equations
    given : mapping, optional
        Names or symbols to numbers, as for `initial_values`; others are zero. A
        port variable that equals an algebraic variable, but for the sign, will do.

    Returns
    -------
    list of float
        Ordered as ``equations.algebraic``.

    Examples
    --------
    >>> from bondgraph import C, R, Zero, assemble, derive
    >>> graph = assemble("g", Zero("u") >> (C("c", 1), R("r", effort=lambda f: f + f**3)))
    >>> algebraic_guess(derive(graph), {"r.f": 0.5, "c.q": 2})
    [0.5]
    """
    start = dict.fromkeys(equations.algebraic, 0.0)
    for name, number in _numbers(given):
        found = _algebraic(equations, name)
        if found is not None:
            start[found[0]] = found[1] * number
    return list(start.values())


def algebraic_names(equations: Equations) -> set[str]:
    """Return all names by which `algebraic_guess` takes a number."""
    if not equations.algebraic:
        return set()
    names = {symbol.name for symbol in equations.algebraic}
    return names | {name for name in equations.ports if _algebraic(equations, name)}


def _algebraic(equations: Equations, name: str) -> tuple[sympy.Symbol, int] | None:
    """Return the algebraic variable that a name stands for, and with which sign."""
    implicit = {symbol.name: symbol for symbol in equations.algebraic}
    if name in implicit:
        return implicit[name], 1
    if not implicit or name not in equations.ports:
        return None
    value = equations.substituted(equations.ports[name])
    for symbol in equations.algebraic:
        if value in (symbol, -symbol):
            return symbol, 1 if value == symbol else -1
    return None


def _numbers(given: Mapping[Any, Any] | None) -> list[tuple[str, float]]:
    """Return what was given as names and finite numbers in SI."""
    pairs = []
    for key, value in (given or {}).items():
        name = key if isinstance(key, str) else getattr(key, "name", str(key))
        pairs.append((name, _real("initial value of {!r}", name, _si(name, value))))
    return pairs


def _si(name: str, value: Any) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    row = as_parameter(name, value)
    if row.value is None or row.derived:
        raise ParameterError(f"initial value of {name!r}: expected a number, got {value!r}")
    return to_si(float(row.value), row.unit)


def _real(what: str, name: str, value: Any) -> float:
    try:
        number = float(value)
    except TypeError:
        raise ParameterError(f"{what.format(name)} is {value}; it must be a number") from None
    if not math.isfinite(number):
        raise ParameterError(f"{what.format(name)} is {number}; it must be finite")
    return number
