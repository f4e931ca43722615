"""Where sensitivities start: derivatives of the parameter vector and of the initial state.

A parameter acts through the table: one that is derived from it moves with it, unless it was
given a number for this run.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy
import sympy

from ...equations import Equations
from ...errors import ParameterError
from ...parameters import unknown_name

Array = numpy.ndarray


def names_of(keys: Iterable[Any]) -> tuple[str, ...]:
    """Return names or symbols as names."""
    return tuple(key if isinstance(key, str) else getattr(key, "name", str(key)) for key in keys)


def chosen(equations: Equations, wrt: Any) -> tuple[str, ...]:
    """Return what derivatives are asked for, as names that are known.

    Parameters
    ----------
    equations : Equations
    wrt : str, Symbol or sequence of them

    Returns
    -------
    tuple of str

    Raises
    ------
    ParameterError
        For a name that is neither a parameter nor a state, one that stands
        twice, and none at all.

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import mass_on_belt
    >>> chosen(derive(mass_on_belt.graph()), [mass_on_belt.k, "mass.p"])
    ('k', 'mass.p')
    """
    single = isinstance(wrt, str | sympy.Symbol)
    try:
        names = names_of([wrt] if single else wrt)
    except TypeError:
        raise ParameterError(
            f"wrt must be names of parameters and states, such as ('k', 'mass.p'), not {wrt!r}"
        ) from None
    if not names:
        raise ParameterError("wrt is empty; name a parameter or a state, such as wrt=['k']")
    parameters = [symbol.name for symbol in equations.graph.parameters]
    known = [*parameters, *(state.name for state in equations.states)]
    for position, name in enumerate(names):
        if name not in known:
            raise unknown_name("parameter or state", name, known)
        if name in names[:position]:
            raise ParameterError(f"{name!r} stands twice in wrt; name it once")
    return names


@dataclass(frozen=True, eq=False)
class Seeds:
    """Derivatives at the start, as functions of the parameters' values.

    Parameters
    ----------
    equations : Equations
    wrt : sequence of str
        See `chosen`.
    overridden : collection of str
        Parameters that have a number of their own in this run.
    initial : collection of str
        States and outputs whose initial value is given.

    Examples
    --------
    >>> from bondgraph import CompiledModel
    >>> from bondgraph.models import bicycle_brake
    >>> model = CompiledModel(bicycle_brake.graph())
    >>> p = Seeds(model.equations, ("V0",), (), ())(model.resolver(), numpy.zeros(5))[0]
    >>> [round(float(v), 6) for v in p[p != 0]]  # omega_t = V0/r_r
    [12.5]
    """

    equations: Equations
    wrt: tuple[str, ...]
    overridden: Collection[str]
    initial: Collection[str]

    def __post_init__(self) -> None:
        equations = self.equations
        table = _Table(equations, self.overridden)
        parameters = {symbol.name: symbol for symbol in equations.graph.parameters}
        places, expressions = [], []
        for column, name in enumerate(self.wrt):
            if name in parameters:
                target = parameters[name]
                slopes = [table.slope(symbol, target) for symbol in equations.parameters]
                slopes += _initial_slopes(equations, table, target, names_of(self.initial))
            else:
                slopes = [sympy.S.Zero] * len(equations.parameters)
                slopes += [sympy.Integer(state.name == name) for state in equations.states]
            for row, slope in enumerate(slopes):
                if slope != 0:
                    places.append((row, column))
                    expressions.append(slope)
        symbols = sorted(
            {symbol for slope in expressions for symbol in slope.free_symbols},
            key=lambda symbol: symbol.name,
        )
        object.__setattr__(self, "_places", numpy.array(places, dtype=int).reshape(-1, 2))
        object.__setattr__(self, "_symbols", symbols)
        object.__setattr__(self, "_function", _function(symbols, expressions))

    def __call__(self, values: Mapping[str, float], x0: Array) -> tuple[Array, Array]:
        """Return the derivatives of the parameters (np, q), and of the initial state (n, q).

        Raises
        ------
        ParameterError
            Where the table has no finite slope at these values.
        """
        equations: Equations = self.equations
        states = dict(zip((s.name for s in equations.states), map(float, x0), strict=True))
        found = numpy.zeros((len(equations.parameters) + len(x0), len(self.wrt)))
        given = {**values, **states}
        arguments = [given[symbol.name] for symbol in self._symbols]  # type: ignore[attr-defined]
        try:
            numbers = self._function(*arguments)  # type: ignore[attr-defined]
            found[tuple(self._places.T)] = numbers  # type: ignore[attr-defined]
        except (ZeroDivisionError, ValueError, OverflowError, TypeError):
            found[:] = numpy.nan
        if not numpy.isfinite(found).all():
            raise ParameterError(
                f"model {equations.name!r}: the parameter table has no finite slope by "
                f"{', '.join(self.wrt)} at these values; change the value where a root or a "
                f"quotient of the table is singular"
            )
        count = len(equations.parameters)
        return found[:count], found[count:]


class _Table:
    """Total derivatives of parameters by parameters."""

    def __init__(self, equations: Equations, overridden: Collection[str]) -> None:
        self.rows = equations.graph.parameters
        self.overridden = set(overridden)
        self.known: dict[tuple[sympy.Symbol, sympy.Symbol], sympy.Expr] = {}

    def slope(self, symbol: sympy.Symbol, target: sympy.Symbol) -> sympy.Expr:
        key = symbol, target
        if key not in self.known:
            self.known[key] = self._slope(symbol, target)
        return self.known[key]

    def _slope(self, symbol: sympy.Symbol, target: sympy.Symbol) -> sympy.Expr:
        if symbol == target:
            return sympy.S.One
        row = self.rows.get(symbol)
        if row is None or not row.derived or symbol.name in self.overridden:
            return sympy.S.Zero
        return self.total(row.value, target)

    def total(self, expression: sympy.Expr, target: sympy.Symbol) -> sympy.Expr:
        """Return the derivative of an expression in parameters."""
        inner = ((symbol, self.slope(symbol, target)) for symbol in expression.free_symbols)
        return sympy.Add(
            *(sympy.diff(expression, symbol) * slope for symbol, slope in inner if slope != 0)
        )


def _initial_slopes(
    equations: Equations, table: _Table, target: sympy.Symbol, given: Collection[str]
) -> list[sympy.Expr]:
    """Return the derivatives of the initial state by a parameter."""
    slopes = {
        state: sympy.S.Zero if state.name in given else table.total(initial, target)
        for state, initial in zip(equations.states, equations.initial, strict=True)
    }
    states = {state.name for state in equations.states}
    for name in given:
        if name not in states and name in equations.outputs:
            output = equations.substituted(equations.outputs[name])
            (state,) = (state for state in equations.states if state in output.free_symbols)
            slopes[state] = -table.total(output, target) / sympy.diff(output, state)
    return list(slopes.values())


def _function(
    symbols: Sequence[sympy.Symbol], expressions: Sequence[sympy.Expr]
) -> Callable[..., Any]:
    return sympy.lambdify(symbols, list(expressions), modules="math", cse=True)
