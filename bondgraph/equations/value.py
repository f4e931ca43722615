"""The equations as a frozen value, and the check that nothing is left over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy

from ..blocks import AlgebraicLoop, expansion
from ..causality import CausalGraph
from ..codegen.symbols import symbols_in
from ..errors import BondGraphError
from ..graph import TIME, BondGraph
from ..views import HtmlView, LatexView
from .fractions import fractions

# A rate of more operations is not simplified for display, only brought to lowest terms; angles are
# slow to simplify.
MOST_OPERATIONS, MOST_WITH_ANGLES = 150, 50


@dataclass(frozen=True)
class Contact:
    """A dry-friction contact as the equations see it.

    Attributes
    ----------
    name : str
        Qualified name of the element.
    direction : Symbol
        +1 or -1 while slipping; a free symbol of the equations.
    slip, effort : Symbol
        The contact's flow and effort.
    breakaway : Expr
        Largest effort while stuck, in the equations' variables.
    """

    name: str
    direction: sympy.Symbol
    slip: sympy.Symbol
    effort: sympy.Symbol
    breakaway: sympy.Expr


@dataclass(frozen=True, eq=False)
class Equations(HtmlView, LatexView):
    """State equations of a bond graph as ordered assignments.

    Attributes
    ----------
    name : str
    states : tuple of Symbol
        Named like ``rear.mass.p``.
    inputs : tuple of Symbol
        Inputs, and rates of inputs where a dependent storage needs them.
    parameters : tuple of Symbol
        The parameters that the equations use.
    algebraic : tuple of Symbol
        Variables that remain implicit; as many as `residuals`.
    residuals : tuple of Expr
        Each is zero.
    assignments : tuple of (Symbol, Expr)
        Ordered: each uses states, inputs, parameters, algebraic variables,
        time, directions of slip and earlier assignments only.
    derivatives : tuple of Expr
        Rate of each state.
    outputs : mapping of str to Expr
    initial : tuple of Expr
        Default initial value of each state, in parameters.
    contacts : tuple of Contact
    supplied, dissipated : mapping of str to Expr
        Power given by each source, and taken by each dissipator. Where a
        storage's law is modulated, the modulation's work counts as supplied.
    energies : mapping of str to Expr or None
        Stored energy of each storage in the equations' variables; None where
        the law has no known potential.
    dependent : mapping of str to Expr
        State of each storage in derivative causality, in the equations' variables.
    loops : tuple of AlgebraicLoop
    causal : CausalGraph
    ports : mapping of str to Expr
        Every element's port variables and states by qualified name, such as
        ``rear.mass.f``, in the equations' variables.
    input_rates : mapping of Symbol to Symbol
        Input to its rate, where a dependent storage needs the rate.
    switches : mapping of str to Symbol
        By the name of a switching element that is not in a mode: the effort or
        flow that its mode decides; a free symbol of the equations.
    warnings : tuple of str

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble, derive
    >>> loop = One("loop")
    >>> rc = derive(assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3))))
    >>> rc.explicit()
    {c.q: 1/2 - c.q/6}
    """

    name: str
    states: tuple[sympy.Symbol, ...]
    inputs: tuple[sympy.Symbol, ...]
    parameters: tuple[sympy.Symbol, ...]
    algebraic: tuple[sympy.Symbol, ...]
    residuals: tuple[sympy.Expr, ...]
    assignments: tuple[tuple[sympy.Symbol, sympy.Expr], ...]
    derivatives: tuple[sympy.Expr, ...]
    outputs: Mapping[str, sympy.Expr]
    initial: tuple[sympy.Expr, ...]
    contacts: tuple[Contact, ...]
    supplied: Mapping[str, sympy.Expr]
    dissipated: Mapping[str, sympy.Expr]
    energies: Mapping[str, sympy.Expr | None]
    dependent: Mapping[str, sympy.Expr]
    loops: tuple[AlgebraicLoop, ...]
    causal: CausalGraph
    ports: Mapping[str, sympy.Expr] = field(default_factory=dict)
    input_rates: Mapping[sympy.Symbol, sympy.Symbol] = field(default_factory=dict)
    switches: Mapping[str, sympy.Symbol] = field(default_factory=dict)

    def __repr__(self) -> str:
        sizes = f"{len(self.states)} states, {len(self.algebraic)} algebraic variables"
        return f"Equations({self.name!r}, {sizes}, {len(self.inputs)} inputs)"

    @property
    def graph(self) -> BondGraph:
        """The graph these equations come from."""
        return self.causal.graph

    @property
    def time(self) -> sympy.Symbol:
        """The symbol of time."""
        return TIME

    @property
    def own_symbols(self) -> dict[sympy.Basic, sympy.Expr]:
        """Map the elements' own symbols, as laws use them, to the equations' variables."""
        return {
            symbol: self.ports[f"{name}.{key}"]
            for name, element in self.graph.elements.items()
            for key, symbol in element.symbols.items()
            if f"{name}.{key}" in self.ports
        }

    @property
    def directions(self) -> tuple[sympy.Symbol, ...]:
        """Slip directions of the contacts, in order."""
        return tuple(contact.direction for contact in self.contacts)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Everything a careful reader should know: parts, dependence, loops."""
        rates = (
            f"the rate of input {symbol.name!r} is needed, as {rate.name}: a dependent storage follows it"
            for symbol, rate in self.input_rates.items()
        )
        starts = (
            f"the initial value of {name!r} is not used: its state follows from others"
            for name in self.dependent
            if self.graph.elements[name].initial != 0  # type: ignore[attr-defined]
        )
        told = (*self.graph.warnings, *self.causal.warnings, *map(str, self.loops))
        return (*told, *rates, *starts)

    @property
    def arguments(self) -> frozenset[sympy.Symbol]:
        """All symbols that are given from outside."""
        return frozenset(
            (
                TIME,
                *self.states,
                *self.inputs,
                *self.parameters,
                *self.algebraic,
                *self.directions,
                *self.switches.values(),
            )
        )

    def substituted(self, expression: sympy.Expr) -> sympy.Expr:
        """Expand an expression until only states, inputs, parameters and the like are left.

        Parameters
        ----------
        expression : Expr
            In the equations' variables.

        Returns
        -------
        Expr
            Not simplified. Meant for small models: size may grow fast.
        """
        return expression.xreplace(expansion(self.assignments, expression.free_symbols))

    def explicit(self) -> dict[sympy.Symbol, sympy.Expr]:
        """Return the expanded, simplified rate of each state.

        For display and analysis of small models; simulation never needs it.

        Returns
        -------
        dict of Symbol to Expr
        """
        rates = [self.substituted(rate) for rate in self.derivatives]
        if not all(map(_is_simplified, rates)):
            rates = fractions(self.assignments, self.derivatives) or rates
        return {
            state: sympy.simplify(rate) if _is_simplified(rate) else rate
            for state, rate in zip(self.states, rates, strict=True)
        }


def _is_simplified(rate: sympy.Expr) -> bool:
    """Whether a rate is short enough to be simplified for display."""
    if rate.has(sympy.sign):
        return False  # sympy would write cases
    angles = rate.has(sympy.sin, sympy.cos)
    return bool(sympy.count_ops(rate) <= (MOST_WITH_ANGLES if angles else MOST_OPERATIONS))


def assert_closed(equations: Equations) -> None:
    """Check that no bond variable is left over and that equations match unknowns."""
    known = set(equations.arguments)
    for symbol, expression in equations.assignments:
        leftover = symbols_in(expression) - known
        if leftover:
            raise BondGraphError(
                f"internal error: {symbol} uses {leftover} before it is known; please report the graph"
            )
        known.add(symbol)
    expressions: list[sympy.Expr] = [
        *equations.residuals,
        *equations.derivatives,
        *equations.outputs.values(),
        *equations.supplied.values(),
        *equations.dissipated.values(),
    ]
    expressions += [contact.breakaway for contact in equations.contacts]
    for expression in expressions:
        leftover = symbols_in(expression) - known
        if leftover:
            raise BondGraphError(
                f"internal error: {leftover} is left over in {expression}; please report the graph"
            )
    if len(equations.algebraic) != len(equations.residuals):
        raise BondGraphError(
            "internal error: equations and unknowns differ in number; please report the graph"
        )
