"""Plots of constitutive laws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy

from ..codegen.program import Program
from ..codegen.to_numpy import to_numpy
from ..dimensions import infer
from ..elements import Friction
from ..errors import BondGraphError
from ..graph import BondGraph
from ..steady import SteadyState
from .style import INK, dressed, legend, line, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def friction_curve(
    graph: BondGraph,
    element: str,
    point: SteadyState,
    *,
    span: float | None = None,
    ax: Axes | None = None,
    label: str = "",
    index: int = 0,
) -> Axes:
    """Plot a contact's effort over its slip, with the vertical part at zero slip.

    Parameters
    ----------
    graph : BondGraph
    element : str
        Qualified name of a Friction.
    point : SteadyState
        Gives the parameters, and the variables that modulate the contact.
    span : float, optional
        Largest slip; one and a half times that of the point unless given.
    ax : Axes, optional
    label : str
        Of the curve, for a family of them.
    index : int
        Place in the family, which decides colour and style.

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        If the element is no Friction.

    Examples
    --------
    >>> from bondgraph import steady_state
    >>> from bondgraph.models import mass_on_belt
    >>> graph = mass_on_belt.graph()
    >>> ax = friction_curve(graph, "contact", steady_state(graph))
    >>> round(float(max(ax.lines[0].get_ydata())), 9)
    4.0
    """
    contact = graph[element]
    if not isinstance(contact, Friction):
        raise BondGraphError(
            f"{element!r} is no Friction of graph {graph.name!r}", elements=[element]
        )
    kinetic, breakaway, slip = _friction_numbers(graph, element, contact, point)
    reach = span or 1.5 * abs(slip) or 1.0
    speeds = numpy.concatenate([[0.0], numpy.geomspace(1e-3, 1.0, 300) * reach])
    forces = kinetic(speeds)
    ax = dressed(ax)
    ax.plot(
        numpy.concatenate([-speeds[::-1], [0.0, 0.0], speeds]),
        numpy.concatenate([-forces[::-1], [-breakaway, breakaway], forces]),
        label=label or element,
        **line(index),
    )
    ax.axhline(0, color=INK, lw=0.6)
    ax.axvline(0, color=INK, lw=0.6)
    units = infer(graph).units
    ax.set_xlabel(f"slip [{pretty(units.get(f'{element}.f') or 'SI')}]")
    ax.set_ylabel(f"friction [{pretty(units.get(f'{element}.e') or 'SI')}]")
    ax.margins(x=0.01)
    if label:
        legend(ax)
    return ax


def _friction_numbers(
    graph: BondGraph, name: str, contact: Friction, point: SteadyState
) -> tuple[Any, float, float]:
    """Return the kinetic law as a function of arrays, the breakaway, and the slip at a point."""
    equations = point.equations
    numbers = {**point.states, **point.parameters, **point.inputs}

    def value(expression: Any) -> Any:
        expression = equations.substituted(expression)
        return expression.evalf(17, subs={s: numbers[s.name] for s in expression.free_symbols})

    used = (contact.kinetic.free_symbols | contact.breakaway.free_symbols) - {contact.speed}
    inner = {}
    for label, element in graph.elements.items():
        for key, symbol in element.symbols.items():
            if symbol in used:
                inner[symbol] = value(equations.ports[f"{label}.{key}"])
    rest = {symbol: numbers[symbol.name] for symbol in used if symbol not in inner}
    law = contact.kinetic.subs({**inner, **rest})
    function = to_numpy(Program("law", (("speed", (contact.speed,)),), (), (("force", (law,)),)))
    breakaway = float(contact.breakaway.subs({**inner, **rest}))
    return (
        lambda speeds: function(speeds[None])[0][0],
        breakaway,
        float(value(equations.ports[f"{name}.f"])),
    )
