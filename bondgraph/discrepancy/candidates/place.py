"""What an effect is told about its place, and what it answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy

from ...bonds import Chain
from ...elements import Element, SignalBlock


@dataclass(frozen=True, eq=False)
class Place:
    """A place in a graph, as an effect sees it.

    Attributes
    ----------
    name : str
        For the effect's element; further elements are named ``<name>_<word>``.
    node : Junction or None
        What a one-port is bonded to, at junctions, pairs and bonds.
    flow : Expr or None
        Flow that a one-port at the node has, where the place decides it: at a 1-junction, and between two.
    element : Element or None
        The source, inertia or dissipator.
    signal : Expr or None
        What the source gives, or the output says.
    displacement : Expr or None
        Integral of `flow` in states that the graph has already; None where it has none.
    start : mapping of Symbol to Expr
        What the graph's states begin with; and efforts and flows in states, where storage tells.
    """

    name: str
    node: Any = None
    flow: sympy.Expr | None = None
    element: Any = None
    signal: sympy.Expr | None = None
    displacement: sympy.Expr | None = None
    start: Mapping[sympy.Basic, sympy.Expr] = field(default_factory=dict)

    def initial(self, expression: sympy.Expr | None) -> sympy.Expr:
        """Return what an expression is at the start, in parameters; zero where that is not known.

        Parameters
        ----------
        expression : Expr or None
            In the graph's variables.
        """
        if expression is None:
            return sympy.S.Zero
        value = sympy.sympify(expression)
        for _ in range(3):  # an output through a junction's flow through a storage's law
            value = value.xreplace(dict(self.start))
        moving = value.atoms(sympy.Dummy) or any(
            symbol.name == "t" for symbol in value.free_symbols
        )
        return sympy.S.Zero if moving else value


@dataclass(frozen=True, eq=False)
class Change:
    """What an effect does to a graph.

    Attributes
    ----------
    bonds : tuple of Chain
        Written with ``>>``, from the place's node or to it.
    blocks : tuple of SignalBlock
    replaced : mapping of Element to Element
        Elements of the graph and what takes their place, under the same name and variables.
    signal : Expr or None
        What the output says instead.
    starts : mapping of Symbol to Expr
        New states that begin where variables of the graph begin.
    first : tuple of Element
        New elements that stand before the graph's own. Causality asks resistors in order, and the
        last one at a 1-junction must decide its flow, which one of no resistance cannot.
    """

    bonds: tuple[Chain, ...] = ()
    blocks: tuple[SignalBlock, ...] = ()
    replaced: Mapping[Element, Element] = field(default_factory=dict)
    signal: sympy.Expr | None = None
    starts: Mapping[sympy.Symbol, sympy.Expr] = field(default_factory=dict)
    first: tuple[Element, ...] = ()
