"""Elements in words and formulas: modes with their margins, signal blocks, fields."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import sympy

from .elements import (
    DryFriction,
    EffortSource,
    EndStop,
    FlowSource,
    OnePort,
    R,
    SignalBlock,
    Storage,
    Switched,
)
from .equations import Equations
from .graph import BondGraph

Names = Mapping[sympy.Basic, sympy.Basic]


@dataclass(frozen=True, eq=False)
class ModeLaw:
    """What a switching element is in one mode, and how long that lasts.

    Attributes
    ----------
    label : str
    variable : Expr
        Effort or flow that the mode decides.
    value : Expr
        What it is.
    margin : Expr
        Positive while the mode lasts.
    """

    label: str
    variable: sympy.Expr
    value: sympy.Expr
    margin: sympy.Expr


def mode_laws(element: Switched) -> tuple[ModeLaw, ...]:
    """Return the modes of a switching element, those in which the flow is free first.

    Parameters
    ----------
    element : Switched

    Returns
    -------
    tuple of ModeLaw
        In the element's own symbols.

    Examples
    --------
    >>> from bondgraph import Diode
    >>> [(mode.label, mode.variable, mode.value, mode.margin) for mode in mode_laws(Diode("d"))]
    [('conducting', _d.e, 0, _d.f), ('blocking', _d.f, 0, -_d.e)]
    """
    codes = sorted(element.modes.values(), key=lambda code: (code == 0, -code))
    return tuple(_mode_law(element, code, element.plain(code)) for code in codes)


def _mode_law(element: Switched, code: int, plain: OnePort) -> ModeLaw:
    variable, value = element.e, sympy.S.Zero
    if isinstance(plain, FlowSource):
        variable, value = element.f, plain.flow
    elif isinstance(plain, EffortSource | R) and plain.effort is not None:
        value = plain.effort
    return ModeLaw(element.label(code), variable, value, element.margin(code))


def mode_words(element: Switched, names: Names) -> str:
    """Say in which mode a switching element is when.

    Parameters
    ----------
    element : Switched
    names : mapping of Symbol to Symbol
        For the element's own symbols, and those of others that it hears.

    Returns
    -------
    str

    Examples
    --------
    >>> import sympy
    >>> from bondgraph import Diode
    >>> d = Diode("d", drop=2)
    >>> mode_words(d, {d.e: sympy.Symbol("e"), d.f: sympy.Symbol("f")})
    'conducting while f > 0 with e = 2; blocking while e < 2 with f = 0'
    """
    own = {names.get(element.e, element.e), names.get(element.f, element.f)}
    said = [
        f"{mode.label} while {_positive(mode.margin.xreplace(names), own)} "
        f"with {mode.variable.xreplace(names)} = {plain(mode.value.xreplace(names))}"
        for mode in mode_laws(element)
    ]
    if isinstance(element, EndStop):
        flow = names.get(element.f, element.f)
        said.append(
            f"an impact turns {flow} to {plain(-element.restitution.xreplace(names) * flow)}"
        )
    return "; ".join(said)


def _positive(margin: sympy.Expr, own: set[sympy.Basic]) -> str:
    """Write that a margin is positive, without minus signs where it can be."""
    terms = sympy.Add.make_args(margin)
    less = sympy.Add(*(-term for term in terms if term.could_extract_minus_sign()))
    more = sympy.Add(*(term for term in terms if not term.could_extract_minus_sign()))
    known = not more.free_symbols and less.free_symbols
    if known or (less.free_symbols & own and not more.free_symbols & own):
        return f"{plain(less)} < {plain(more)}"
    return f"{plain(more)} > {plain(less)}"


def plain(expression: sympy.Basic) -> str:
    """Write an expression for reading."""
    return str(expression).replace("**", "^")


def qualified(graph: BondGraph) -> dict[sympy.Basic, sympy.Basic]:
    """Name the symbols of all elements by qualified name, such as ``rear.mass.p``."""
    return {
        symbol: sympy.Symbol(f"{name}.{key}", real=True)
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
    }


def switching(equations: Equations) -> Iterator[tuple[str, Switched]]:
    """Iterate over the switching elements whose modes the equations leave open, but for friction."""
    for name, element in equations.graph.of(Switched):
        if element.switches and not isinstance(element, DryFriction):
            yield name, element


def switch_lines(equations: Equations) -> list[str]:
    r"""Say of each switching element which modes it has, and what the equations leave open.

    Examples
    --------
    >>> from bondgraph import Diode, I, One, Se, assemble, derive
    >>> graph = assemble("choke", Se("E", 1) >> One("loop") >> (Diode("d"), I("coil", 2)))
    >>> print(*switch_lines(derive(graph)), sep="\n")
    d: conducting while d.f > 0 with d.e = 0; blocking while d.e < 0 with d.f = 0
      in these equations d.f is loop.f, and d.e waits for the mode
    """
    names = qualified(equations.graph)
    lines = []
    for name, element in switching(equations):
        lines.append(f"{name}: {mode_words(element, names)}")
        ports = {key: equations.ports[f"{name}.{key}"] for key in "ef"}
        opened = equations.switches.get(name)
        other = [
            f"{name}.{key} is {plain(value)}"
            for key, value in ports.items()
            if str(value) != f"{name}.{key}"
        ]
        waits = [f"{opened} waits for the mode"] if opened is not None else []
        if other or waits:
            lines.append(f"  in these equations {', and '.join([*other, *waits])}")
    return lines


def switch_variables(equations: Equations) -> set[sympy.Basic]:
    """Return the variables that the modes of switching elements rest on."""
    found: set[sympy.Basic] = set()
    for _, element in switching(equations):
        for mode in mode_laws(element):
            for part in (mode.variable, mode.value, mode.margin):
                found |= in_equations(equations, part).free_symbols
    return found


def in_equations(equations: Equations, expression: sympy.Expr) -> sympy.Expr:
    """Write an expression in elements' own symbols in the variables of the equations."""
    return expression.xreplace(equations.own_symbols)


def switch_cases(equations: Equations) -> list[sympy.Expr]:
    """Return for each switching element what is zero, case by case."""
    return [
        sympy.Piecewise(
            *(
                (
                    in_equations(equations, mode.variable - mode.value),
                    sympy.StrictGreaterThan(
                        in_equations(equations, mode.margin), 0, evaluate=False
                    ),
                )
                for mode in mode_laws(element)
            ),
            evaluate=False,
        )
        for _, element in switching(equations)
    ]


def block_lines(equations: Equations) -> list[str]:
    """Say what each signal block does, in the graph's own names."""
    names = qualified(equations.graph)
    return [
        f"{name}: {element.kind}, der({name}.y) = {plain(element.rate.xreplace(names))}"
        for name, element in equations.graph.of(SignalBlock)
    ]


def field_energies(equations: Equations) -> dict[str, sympy.Expr]:
    """Return the energy of each multiport storage by the field's name."""
    storages = {name for name, _ in equations.graph.of(Storage)}
    return {
        name: energy
        for name, energy in equations.energies.items()
        if name not in storages and energy is not None
    }


def switches_json(equations: Equations) -> list[dict[str, Any]]:
    """Return switching elements as plain values: modes, what each holds, and its margin."""
    names = qualified(equations.graph)
    return [
        {
            "name": name,
            "kind": element.kind,
            "open": None if name not in equations.switches else str(equations.switches[name]),
            "modes": [
                {
                    "mode": mode.label,
                    "variable": str(mode.variable.xreplace(names)),
                    "value": str(mode.value.xreplace(names)),
                    "margin": str(mode.margin.xreplace(names)),
                }
                for mode in mode_laws(element)
            ],
        }
        for name, element in equations.graph.of(Switched)
        if element.switches
    ]
