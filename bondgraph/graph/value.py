"""The graph as a frozen value: elements, bonds, ports, parameters, outputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any

import sympy

from ..bonds import Joinable
from ..elements import Element, Junction
from ..errors import GraphError, suggestion
from ..parameters import Parameter
from ..views import HtmlView, SvgView

TIME = sympy.Symbol("t", real=True)


@dataclass(frozen=True)
class Output:
    """A named signal computed from the graph's variables.

    Attributes
    ----------
    expression : Expr
        In port variables, states, inputs and parameters.
    unit : str
        SI unit of the result.
    meaning : str
        What it is.

    Examples
    --------
    >>> Output(sympy.Integer(2), "m/s").unit
    'm/s'
    """

    expression: sympy.Expr
    unit: str = ""
    meaning: str = ""


@dataclass(frozen=True, eq=False)
class Port(Joinable):
    """A submodel's exposed junction, ready to be bonded to.

    Attributes
    ----------
    graph : BondGraph
    name : str
    junction : Junction
    """

    graph: BondGraph
    name: str
    junction: Junction


@dataclass(frozen=True)
class GraphBond:
    """A bond of an assembled graph.

    Attributes
    ----------
    name : str
        ``tail>head`` in qualified names.
    tail, head : str
        Qualified names of the ends; power is positive from tail to head.
    """

    name: str
    tail: str
    head: str


@dataclass(frozen=True)
class Signal:
    """A modulation: a law that uses a variable of another element.

    Attributes
    ----------
    source : str
        Qualified name of the element whose variable is used.
    variable : str
        Which one: ``e``, ``f``, ``q``, ``p``, ...
    target : str
        Qualified name of the element whose law uses it.
    """

    source: str
    variable: str
    target: str


@dataclass(frozen=True, eq=False)
class BondGraph(HtmlView, SvgView):
    """An assembled bond graph: immutable, checked, without causality yet.

    Attributes
    ----------
    name : str
    elements : mapping of str to Element
        By qualified name, in the order written.
    bonds : tuple of GraphBond
    ports : mapping of str to str
        Exposed junctions by port name.
    parameters : mapping of Symbol to Parameter
    inputs : mapping of Symbol to str
        Input symbols and their units.
    outputs : mapping of str to Output
    warnings : tuple of str
        What is suspicious but not wrong, such as disconnected parts.
    notes : tuple of str
        What was put right, such as arrows turned round.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble
    >>> loop = One("loop")
    >>> rc = assemble("rc", Se("battery", 1) >> loop >> (R("r", 2), C("c", 3)))
    >>> sorted(rc.elements)
    ['battery', 'c', 'loop', 'r']
    """

    name: str
    elements: Mapping[str, Element]
    bonds: tuple[GraphBond, ...]
    ports: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[sympy.Symbol, Parameter] = field(default_factory=dict)
    inputs: Mapping[sympy.Symbol, str] = field(default_factory=dict)
    outputs: Mapping[str, Output] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"BondGraph({self.name!r}, {len(self.elements)} elements, {len(self.bonds)} bonds)"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the mappings as plain ones: those that cannot be written to do not pickle."""
        values = (getattr(self, item.name) for item in fields(self))
        return _restored, tuple(dict(v) if isinstance(v, Mapping) else v for v in values)

    def __getitem__(self, name: str) -> Any:
        """Return the element with a qualified name."""
        try:
            return self.elements[name]
        except KeyError:
            raise GraphError(
                f"graph {self.name!r} has no element {name!r}; {_nearest(name, self.elements)}"
            ) from None

    def port(self, name: str) -> Port:
        """Return an exposed junction to bond to.

        Parameters
        ----------
        name : str
            Port name as given to `assemble`.

        Raises
        ------
        GraphError
            If there is no such port.
        """
        if name not in self.ports:
            raise GraphError(
                f"graph {self.name!r} has no port {name!r}; {_nearest(name, self.ports)}"
            )
        junction = self.elements[self.ports[name]]
        assert isinstance(junction, Junction)
        return Port(self, name, junction)

    def copy(self, name: str) -> BondGraph:
        """Return the same graph made of fresh elements, to be used beside the first.

        Parameters
        ----------
        name : str
            The copy's name, which qualifies its elements in a parent.

        Examples
        --------
        >>> from bondgraph import I, One, R, assemble
        >>> v = One("v")
        >>> cell = assemble("cell", v >> (I("m", 1), R("b", 2)), ports={"v": v})
        >>> left, right = cell.copy("left"), cell.copy("right")
        >>> left["m"] is right["m"]
        False
        """
        fresh = {
            symbol: sympy.Dummy(symbol.name, **symbol.assumptions0)
            for element in self.elements.values()
            for symbol in element.symbols.values()
        }
        return BondGraph(
            name,
            MappingProxyType(
                {key: element.replaced(fresh) for key, element in self.elements.items()}
            ),
            self.bonds,
            self.ports,
            self.parameters,
            self.inputs,
            MappingProxyType(
                {
                    key: Output(output.expression.xreplace(fresh), output.unit, output.meaning)
                    for key, output in self.outputs.items()
                }
            ),
            self.warnings,
            self.notes,
        )

    @property
    def signals(self) -> tuple[Signal, ...]:
        """Modulations: which law uses which variable of another element."""
        return signals_of(self.elements)

    def bonds_of(self, name: str) -> tuple[GraphBond, ...]:
        """Return the bonds of one element, in the order written."""
        return tuple(bond for bond in self.bonds if name in (bond.tail, bond.head))

    def of(self, kind: type | tuple[type, ...]) -> Iterator[tuple[str, Any]]:
        """Iterate over qualified name and element of one class, or of any of several."""
        return (
            (name, element) for name, element in self.elements.items() if isinstance(element, kind)
        )


def _restored(*given: Any) -> BondGraph:
    """Make a graph again from what was pickled."""
    values: list[Any] = [MappingProxyType(v) if isinstance(v, dict) else v for v in given]
    return BondGraph(*values)


def signals_of(elements: Mapping[str, Element]) -> tuple[Signal, ...]:
    """Return which law uses which variable of another element."""
    owner = {
        symbol: (label, key)
        for label, element in elements.items()
        for key, symbol in element.symbols.items()
    }
    used = {
        Signal(*owner[symbol], target=label): None
        for label, element in elements.items()
        for law in element.laws.values()
        for symbol in sorted(law.free_symbols, key=str)
        if symbol in owner and owner[symbol][0] != label
    }
    return tuple(used)


def _nearest(name: str, known: Iterable[str]) -> str:
    names = list(known)
    return suggestion(name, names) or f"there is {', '.join(names) or 'none'}"
