"""From a graph or its equations to their symbolic analysis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy

from ..equations import Equations, derive
from ..errors import ParameterError
from ..graph import TIME, BondGraph
from ..laws import exact
from ..modes import CODES, in_mode
from ..parameters import unknown_name
from ..resolver import resolve
from .expand import Expanded, expand
from .jacobian import eliminated, inverse, jacobian
from .system import SymbolicSystem
from .tidy import tidy


def symbolic_system(
    graph: BondGraph | Equations,
    at: Mapping[Any, Any] | None = None,
    *,
    modes: Mapping[str, str] | None = None,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Iterable[str | sympy.Symbol] = (),
    outputs: Iterable[str] = (),
) -> SymbolicSystem:
    """Analyse a small model in symbols: expanded equations, Jacobians, and what follows from them.

    Parameters
    ----------
    graph : BondGraph or Equations
    at : mapping, optional
        Operating point: state, input or algebraic variable, by name or
        symbol, to a number or expression in SI. What is not given stays a
        symbol. The point need not be an equilibrium; see ``drift``.
    modes : mapping of str to str, optional
        Mode of each contact: ``"stick"``, ``"slip+"`` or ``"slip-"``.
    parameters : mapping, optional
        What to put in place of parameters: numbers in SI or with unit as
        elsewhere, or expressions. Others stay symbols.
    inputs : iterable of str or Symbol, optional
        Parameters that count as inputs too.
    outputs : iterable of str, optional
        Port variables, such as ``"mass.f"``, that count as outputs too.

    Returns
    -------
    SymbolicSystem

    Raises
    ------
    ParameterError
        For names that are not known, and contacts without a mode.
    SymbolicError
        Where the model is too large, or has no derivative at the point.

    Examples
    --------
    Sliding on a belt is stable where damping outweighs the fall of the friction:

    >>> from bondgraph.models import mass_on_belt
    >>> system = symbolic_system(mass_on_belt.graph(), {"mass.p": 0}, modes={"contact": "slip+"})
    >>> [condition.count(sympy.exp) for condition in system.routh_hurwitz().conditions]
    [1]
    """
    equations = _in_modes(graph, modes or {})
    given = _parameters(equations, parameters or {})
    found = expand(equations, _outputs(equations, outputs), given)
    columns = (*equations.inputs, *_extra_inputs(equations, inputs))
    point = _point(equations, at or {})
    a, b, c, d = _matrices(equations, found, columns, point)
    rates = dict(zip(equations.states, found.rates, strict=True))
    drift = {state: tidy(_at(rate, point)) for state, rate in rates.items()}
    known = {*equations.states, *columns, *equations.algebraic, TIME}
    return SymbolicSystem(
        name=equations.name,
        states=equations.states,
        inputs=columns,
        parameters=_others(
            [*rates.values(), *found.residuals, *found.outputs.values(), *point.values()], known
        ),
        rates=rates,
        outputs=found.outputs,
        algebraic=equations.algebraic,
        residuals=found.residuals,
        at=point,
        drift=drift,
        A=a,
        B=b,
        C=c,
        D=d,
        input_rates=equations.input_rates,
    )


def _matrices(
    equations: Equations,
    found: Expanded,
    inputs: tuple[sympy.Symbol, ...],
    point: Mapping[sympy.Symbol, sympy.Expr],
) -> tuple[sympy.ImmutableMatrix, ...]:
    """Return A, B, C, D."""
    rates = {
        f"the rate of {state.name}": rate
        for state, rate in zip(equations.states, found.rates, strict=True)
    }
    outputs = {f"output {name}": value for name, value in found.outputs.items()}
    residuals = {f"residual {place}": item for place, item in enumerate(found.residuals, 1)}
    algebraic = equations.algebraic
    inner = inverse(jacobian(residuals, algebraic, point), algebraic)
    blocks = []
    for rows in (rates, outputs):
        through = jacobian(rows, algebraic, point)
        for columns in (equations.states, inputs):
            outer = jacobian(residuals, columns, point)
            blocks.append(eliminated(jacobian(rows, columns, point), through, inner, outer))
    return tuple(blocks)


def _in_modes(graph: BondGraph | Equations, modes: Mapping[str, str]) -> Equations:
    if isinstance(graph, Equations) and not modes:
        equations = graph
    else:
        whole = graph.graph if isinstance(graph, Equations) else graph
        equations = derive(in_mode(whole, modes))
    open_ = [contact.name for contact in equations.contacts]
    if open_:
        raise ParameterError(
            f"contact {open_[0]!r} of {equations.name!r} can stick and slip: say which, as "
            f"modes={{{open_[0]!r}: 'slip+'}}; the modes are {', '.join(CODES)}",
            elements=open_,
        )
    return equations


def _parameters(equations: Equations, given: Mapping[Any, Any]) -> dict[sympy.Basic, sympy.Expr]:
    """Read what is to stand for parameters, numbers in SI."""
    table = equations.graph.parameters
    known = {symbol.name: symbol for symbol in table}
    found: dict[sympy.Basic, sympy.Expr] = {}
    for key, value in given.items():
        name = _name(key)
        if name not in known:
            raise unknown_name("parameter", name, known)
        symbol = known[name]
        if isinstance(value, sympy.Expr) and value.free_symbols:
            found[symbol] = exact(value)
        else:
            found[symbol] = exact(resolve({symbol: table[symbol]}, {symbol: value})[name])
    return found


def _point(equations: Equations, at: Mapping[Any, Any]) -> dict[sympy.Symbol, sympy.Expr]:
    symbols = (*equations.states, *equations.inputs, *equations.algebraic)
    known = {symbol.name: symbol for symbol in symbols}
    found = {}
    for key, value in at.items():
        name = _name(key)
        if name not in known:
            raise unknown_name("state, input or algebraic variable", name, known)
        found[known[name]] = exact(value)
    return found


def _outputs(equations: Equations, more: Iterable[str]) -> dict[str, sympy.Expr]:
    found = dict(equations.outputs)
    for name in more:
        if name not in found and name not in equations.ports:
            raise unknown_name("output", name, [*found, *equations.ports])
        found.setdefault(name, equations.ports.get(name, sympy.S.Zero))
    return found


def _extra_inputs(
    equations: Equations, more: Iterable[str | sympy.Symbol]
) -> tuple[sympy.Symbol, ...]:
    own = {symbol.name for symbol in equations.inputs}
    known = {symbol.name: symbol for symbol in equations.graph.parameters}
    names = dict.fromkeys(_name(item) for item in more)
    for name in names:
        if name not in known and name not in own:
            raise unknown_name("input", name, [*own, *known])
    return tuple(known[name] for name in names if name not in own)


def _name(key: Any) -> str:
    return key.name if isinstance(key, sympy.Symbol) else str(key)


def _at(expression: sympy.Expr, point: Mapping[sympy.Symbol, sympy.Expr]) -> sympy.Expr:
    return expression.subs(point, simultaneous=True) if point else expression


def _others(
    expressions: Iterable[sympy.Expr], known: set[sympy.Symbol]
) -> tuple[sympy.Symbol, ...]:
    found: set[sympy.Symbol] = set().union(*(item.free_symbols for item in expressions))
    return tuple(sorted(found - known, key=lambda symbol: symbol.name))
