"""Graphs: bonds gathered, checked and frozen.

``assemble`` is the only way to make a `BondGraph`. It names the elements,
turns backward arrows on passive one-ports round, and refuses malformed
structure by name. Submodels are graphs with ports.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import networkx
import sympy

from .bonds import Bond, Chain, Joinable
from .elements import Element, Junction, OnePort, TwoPort
from .errors import GraphError, LawError, ParameterError
from .laws import exact
from .parameters import Parameter, as_parameter

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
class BondGraph:
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

    def __getitem__(self, name: str) -> Any:
        """Return the element with a qualified name."""
        try:
            return self.elements[name]
        except KeyError:
            raise GraphError(f"graph {self.name!r} has no element {name!r}; {_nearest(name, self.elements)}") from None

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
            raise GraphError(f"graph {self.name!r} has no port {name!r}; {_nearest(name, self.ports)}")
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
            MappingProxyType({key: element.replaced(fresh) for key, element in self.elements.items()}),
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
        return _signals(self.elements)

    def bonds_of(self, name: str) -> tuple[GraphBond, ...]:
        """Return the bonds of one element, in the order written."""
        return tuple(bond for bond in self.bonds if name in (bond.tail, bond.head))

    def of(self, kind: type | tuple[type, ...]) -> Iterator[tuple[str, Any]]:
        """Iterate over qualified name and element of one class, or of any of several."""
        return ((name, element) for name, element in self.elements.items() if isinstance(element, kind))


def assemble(
    name: str,
    *parts: Any,
    ports: Mapping[str, Any] | None = None,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Iterable[sympy.Symbol] | Mapping[sympy.Symbol, str] = (),
    outputs: Mapping[str, Any] | None = None,
) -> BondGraph:
    """Gather bonds and submodels into an immutable graph.

    Parameters
    ----------
    name : str
        The graph's name.
    *parts : Chain, Bond, BondGraph, Junction, or iterables of these
        Bonds written with ``>>``, and submodels.
    ports : mapping of str to Junction, optional
        Junctions that a parent may bond to.
    parameters : mapping, optional
        Symbol (or its name) to a value, ``(value, unit, meaning, source)``, a
        quantity, a `Parameter`, or an expression in other parameters.
    inputs : iterable of Symbol, or mapping of Symbol to unit, optional
        Symbols that vary in time from outside.
    outputs : mapping of str to Expr or (Expr, unit), optional
        Named signals.

    Returns
    -------
    BondGraph

    Raises
    ------
    GraphError
        For malformed structure: a one-port bonded twice, an unknown port, a
        duplicate name, a dangling junction, a TF or GY without two bonds, or a
        bond between two one-ports that makes no sense.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> v = One("v")
    >>> graph = assemble("msd", Se("force", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 0.5)))
    >>> len(graph.bonds)
    4
    """
    if not isinstance(name, str) or not name.strip() or "." in name or ">" in name:
        raise GraphError(f"a graph needs a plain name without '.' or '>', got {name!r}")
    builder = _Builder(name)
    for part in parts:
        builder.add(part)
    bonds, notes = builder.bonds()
    names = builder.names
    exposed = _exposed(name, ports or {}, names)
    elements = MappingProxyType({label: element for element, label in names.items()})
    check_structure(name, elements, bonds, open_junctions=frozenset(exposed.values()))
    symbols = _Symbols(name, elements, builder.submodels, parameters or {}, inputs)
    elements = MappingProxyType(
        {label: element.replaced(symbols.merged) if symbols.touches(element) else element for label, element in elements.items()}
    )
    return BondGraph(
        name,
        elements,
        tuple(bonds),
        MappingProxyType(exposed),
        MappingProxyType(symbols.parameters),
        MappingProxyType(symbols.inputs),
        MappingProxyType(_outputs(name, outputs or {}, builder.submodels, symbols)),
        _disconnected(name, elements, bonds),
        tuple(notes),
    )


class _Builder:
    """Collects parts in the order written; elements are keyed by identity."""

    def __init__(self, name: str) -> None:
        self.graph = name
        self.names: dict[Element, str] = {}
        self._labels: set[str] = set()
        self.submodels: list[BondGraph] = []
        self._bonds: list[Bond] = []
        self._inner: list[GraphBond] = []

    def add(self, part: Any) -> None:
        if isinstance(part, BondGraph):
            self._submodel(part)
        elif isinstance(part, Port):
            self._submodel(part.graph)
        elif isinstance(part, Chain):
            for bond in part.bonds:
                self.add(bond)
            for end in (*part.tails, *part.heads):
                self._end(end)
        elif isinstance(part, Bond):
            self._end(part.tail)
            self._end(part.head)
            self._bonds.append(part)
        elif isinstance(part, Element):
            self._end(part)
        elif isinstance(part, Iterable) and not isinstance(part, str | Mapping):
            for item in part:
                self.add(item)
        else:
            raise GraphError(f"graph {self.graph!r}: {part!r} is no bond, element or submodel; join elements with >>")

    def _end(self, end: Any) -> None:
        if isinstance(end, Port):
            self._submodel(end.graph)
        elif end not in self.names:
            self._register(end, end.name)

    def _submodel(self, graph: BondGraph) -> None:
        if any(graph is known for known in self.submodels):
            return
        if any(graph.name == known.name for known in self.submodels):
            raise GraphError(
                f"graph {self.graph!r} holds two submodels named {graph.name!r}; use .copy('another_name')",
                elements=[graph.name],
            )
        self.submodels.append(graph)
        for label, element in graph.elements.items():
            self._register(element, f"{graph.name}.{label}")
        self._inner.extend(_qualified(bond, graph.name) for bond in graph.bonds)

    def _register(self, element: Element, label: str) -> None:
        if element in self.names:
            raise GraphError(
                f"graph {self.graph!r}: element {self.names[element]!r} is also {label!r}; "
                f"bond to submodels through their ports, and copy a submodel that is used twice",
                elements=[self.names[element], label],
            )
        if label in self._labels:
            raise GraphError(
                f"graph {self.graph!r} has two elements named {label!r}; give one another name", elements=[label]
            )
        self.names[element] = label
        self._labels.add(label)

    def bonds(self) -> tuple[list[GraphBond], list[str]]:
        """Name the bonds; turn backward arrows on passive one-ports round."""
        bonds, notes = list(self._inner), [note for graph in self.submodels for note in graph.notes]
        taken = {bond.name for bond in bonds}
        for bond in self._bonds:
            tail, head = _element(bond.tail), _element(bond.head)
            if isinstance(tail, OnePort) and tail.passive:
                notes.append(f"bond {self.names[tail]}>{self.names[head]} turned round: {tail!r} takes power")
                tail, head = head, tail
            name = stem = f"{self.names[tail]}>{self.names[head]}"
            count = 1
            while name in taken:
                count += 1
                name = f"{stem} ({count})"
            taken.add(name)
            bonds.append(GraphBond(name, self.names[tail], self.names[head]))
        return bonds, notes


def _qualified(bond: GraphBond, prefix: str) -> GraphBond:
    count = bond.name.removeprefix(f"{bond.tail}>{bond.head}")
    tail, head = f"{prefix}.{bond.tail}", f"{prefix}.{bond.head}"
    return GraphBond(f"{tail}>{head}{count}", tail, head)


def _element(end: Any) -> Element:
    return end.junction if isinstance(end, Port) else end


def check_structure(
    name: str,
    elements: Mapping[str, Element],
    bonds: Iterable[GraphBond],
    open_junctions: frozenset[str] = frozenset(),
) -> None:
    """Refuse malformed structure by name.

    Parameters
    ----------
    name : str
        The graph's name, for messages.
    elements : mapping of str to Element
    bonds : iterable of GraphBond
    open_junctions : frozenset of str
        Junctions that a parent may still bond to.

    Raises
    ------
    GraphError

    Examples
    --------
    >>> from bondgraph import One
    >>> check_structure("g", {"v": One("v")}, [], frozenset({"v"}))
    """
    if not elements:
        raise GraphError(f"graph {name!r} is empty; give it bonds, such as source >> junction")
    count: dict[str, list[str]] = {label: [] for label in elements}
    for bond in bonds:
        if bond.tail == bond.head:
            raise GraphError(f"graph {name!r}: {bond.tail!r} is bonded to itself", elements=[bond.tail], bonds=[bond.name])
        count[bond.tail].append(bond.name)
        count[bond.head].append(bond.name)
        _check_pair(name, bond, elements[bond.tail], elements[bond.head])
    for label, element in elements.items():
        _check_count(name, label, element, count[label], label in open_junctions)


def _check_count(graph: str, label: str, element: Element, bonds: list[str], is_open: bool) -> None:
    where = f"graph {graph!r}: {element.kind} {label!r}"
    number = len(bonds)
    if isinstance(element, OnePort) and number != 1:
        said = "has no bond" if number == 0 else f"is bonded {number} times ({', '.join(bonds)})"
        raise GraphError(
            f"{where} {said}; a one-port has exactly one bond: join through a junction", elements=[label], bonds=bonds
        )
    if isinstance(element, TwoPort) and number != 2:
        raise GraphError(
            f"{where} has {number} bond{'s' * (number != 1)}; a two-port has exactly two: a >> {element.kind} >> b",
            elements=[label],
            bonds=bonds,
        )
    if isinstance(element, Junction) and number < 2 and not is_open:
        raise GraphError(
            f"{where} is dangling: it has {'one bond' if number == 1 else 'no bond'}; "
            f"a junction joins two or more: bond it, or name it in ports",
            elements=[label],
            bonds=bonds,
        )


def _check_pair(graph: str, bond: GraphBond, tail: Element, head: Element) -> None:
    if not (isinstance(tail, OnePort) and isinstance(head, OnePort)):
        return
    if tail.passive and head.passive:
        problem = "two passive one-ports cannot both take the power of one bond"
    elif type(tail) is type(head):
        problem = f"two {tail.kind} decide the same variable"
    elif not tail.passive and not head.passive:
        problem = "two sources on one bond leave nothing to solve"
    else:
        return
    raise GraphError(
        f"graph {graph!r}: the bond {bond.name} makes no sense: {problem}; join them through a 0- or 1-junction",
        elements=[bond.tail, bond.head],
        bonds=[bond.name],
    )


def _exposed(graph: str, ports: Mapping[str, Any], names: Mapping[Element, str]) -> dict[str, str]:
    exposed = {}
    for port, end in ports.items():
        element = _element(end)
        if not isinstance(element, Junction):
            raise GraphError(f"graph {graph!r}: port {port!r} must be a junction, not {element!r}")
        if element not in names:
            raise GraphError(f"graph {graph!r}: port {port!r} is {element!r}, which is not in the graph; bond it first")
        exposed[port] = names[element]
    return exposed


def _signals(elements: Mapping[str, Element]) -> tuple[Signal, ...]:
    owner = {
        symbol: (label, key) for label, element in elements.items() for key, symbol in element.symbols.items()
    }
    used = {
        Signal(*owner[symbol], target=label): None
        for label, element in elements.items()
        for law in element.laws.values()
        for symbol in sorted(law.free_symbols, key=str)
        if symbol in owner and owner[symbol][0] != label
    }
    return tuple(used)


def _disconnected(graph: str, elements: Mapping[str, Element], bonds: Iterable[GraphBond]) -> tuple[str, ...]:
    """Warn of parts joined by neither bonds nor signals; each is still solved."""
    network = networkx.Graph()
    network.add_nodes_from(elements)
    network.add_edges_from((bond.tail, bond.head) for bond in bonds)
    if networkx.is_connected(network):
        return ()
    network.add_edges_from((signal.source, signal.target) for signal in _signals(elements))
    parts = [list(part) for part in networkx.connected_components(network)]
    if len(parts) == 1:
        return ()
    place = {label: index for index, label in enumerate(elements)}
    shown = "; ".join(
        ", ".join(sorted(part, key=place.__getitem__)[:4]) + (", ..." if len(part) > 4 else "") for part in parts
    )
    return (f"graph {graph!r} has {len(parts)} disconnected parts, each solved on its own: {shown}",)


class _Symbols:
    """Sorts the free symbols of all laws into time, inputs, parameters and port variables."""

    def __init__(
        self,
        graph: str,
        elements: Mapping[str, Element],
        submodels: list[BondGraph],
        parameters: Mapping[Any, Any],
        inputs: Iterable[sympy.Symbol] | Mapping[sympy.Symbol, str],
    ) -> None:
        self.graph = graph
        self.own = {symbol for element in elements.values() for symbol in element.symbols.values()}
        self.merged: dict[sympy.Basic, sympy.Basic] = {}
        self._by_name: dict[str, sympy.Symbol] = {}
        given_inputs = dict(inputs) if isinstance(inputs, Mapping) else dict.fromkeys(inputs, "")
        for symbol, unit in given_inputs.items():
            if not isinstance(symbol, sympy.Symbol) or not isinstance(unit, str):
                raise ParameterError(f"graph {graph!r}: inputs are sympy symbols with units, got {symbol!r}: {unit!r}")
        for key in parameters:
            if isinstance(key, sympy.Symbol):
                self._known(key)
        for symbol in given_inputs:
            self._known(symbol)
        for submodel in submodels:
            for symbol in (*submodel.parameters, *submodel.inputs):
                self._known(symbol)
        used: dict[sympy.Symbol, None] = {}
        for label, element in elements.items():
            for law in element.laws.values():
                used |= dict.fromkeys(self._foreign(law, f"{element.kind} {label!r}"))
        self.inputs = {self._known(symbol): unit for submodel in submodels for symbol, unit in submodel.inputs.items()}
        self.inputs |= {self._known(symbol): unit for symbol, unit in given_inputs.items()}
        self.parameters = self._parameters(submodels, parameters)
        self._use(used)
        clash = [symbol.name for symbol in self.inputs if symbol in self.parameters]
        if clash:
            raise ParameterError(f"graph {graph!r}: {', '.join(clash)} cannot be both input and parameter")

    def _use(self, symbols: Iterable[sympy.Symbol]) -> None:
        """Make parameters without a value of symbols that nothing else is said about."""
        for symbol in symbols:
            if symbol is not TIME and symbol not in self.inputs:
                self.parameters.setdefault(symbol, Parameter())

    def touches(self, element: Element) -> bool:
        return any(law.free_symbols & self.merged.keys() for law in element.laws.values())

    def canonical(self, expression: sympy.Expr, user: str) -> sympy.Expr:
        self._use(self._foreign(expression, user))
        return expression.xreplace(self.merged)

    def _known(self, symbol: sympy.Symbol) -> sympy.Symbol:
        """Merge symbols of one name: they are one parameter, whatever they assume."""
        chosen = self._by_name.setdefault(symbol.name, symbol)
        if chosen is not symbol and chosen != symbol:
            self.merged[symbol] = chosen
        return chosen

    def _foreign(self, expression: sympy.Expr, user: str) -> list[sympy.Symbol]:
        found = []
        for symbol in sorted(expression.free_symbols - self.own, key=lambda item: item.name):
            if isinstance(symbol, sympy.Dummy):
                raise GraphError(
                    f"graph {self.graph!r}: {user} uses {symbol.name}, but that element is not in the graph; add it",
                    elements=[user],
                )
            if symbol.name == TIME.name and symbol.name not in self._by_name:
                if symbol != TIME:
                    self.merged[symbol] = TIME
                found.append(TIME)
            else:
                found.append(self._known(symbol))
        return found

    def _parameters(self, submodels: list[BondGraph], given: Mapping[Any, Any]) -> dict[sympy.Symbol, Parameter]:
        table: dict[sympy.Symbol, Parameter] = {}
        own: dict[sympy.Symbol, Any] = {}
        for key, value in given.items():
            symbol = self._known(self._by_name.get(key) or sympy.Symbol(key, real=True) if isinstance(key, str) else key)
            if symbol in own:
                raise ParameterError(f"graph {self.graph!r} gives parameter {symbol.name!r} twice; keep one of them")
            own[symbol] = value
        for symbol, value in own.items():
            table[symbol] = self._row(as_parameter(symbol.name, value))
        for submodel in submodels:
            for symbol, row in submodel.parameters.items():
                known = self._known(symbol)
                row = self._row(row)
                if known in table and known not in own and None not in (row.value, table[known].value) and row != table[known]:
                    raise ParameterError(
                        f"graph {self.graph!r}: submodels give {symbol.name!r} different values "
                        f"({table[known].value} and {row.value}); set it in the parent's parameters"
                    )
                if known not in table or table[known].value is None:
                    table[known] = row
        for row in list(table.values()):
            if row.derived:
                for symbol in row.value.free_symbols:
                    table.setdefault(symbol, Parameter())
        return table

    def _row(self, row: Parameter) -> Parameter:
        if not row.derived:
            return row
        if TIME in self._foreign(row.value, "a parameter") or row.value.free_symbols & self.own:
            raise ParameterError(
                f"graph {self.graph!r}: a parameter is constant, but {row.value} depends on time or on the graph's "
                f"variables; write it into the law that uses it"
            )
        return Parameter(row.value.xreplace(self.merged), row.unit, row.meaning, row.source)


def _outputs(
    graph: str, given: Mapping[str, Any], submodels: list[BondGraph], symbols: _Symbols
) -> dict[str, Output]:
    outputs = {
        f"{submodel.name}.{name}": Output(symbols.canonical(output.expression, name), output.unit, output.meaning)
        for submodel in submodels
        for name, output in submodel.outputs.items()
    }
    for name, value in given.items():
        expression, *rest = value if isinstance(value, tuple) else (value,)
        if isinstance(value, Output):
            expression, rest = value.expression, [value.unit, value.meaning]
        if len(rest) > 2 or not all(isinstance(word, str) for word in rest):
            raise GraphError(f"graph {graph!r}: output {name!r} takes an expression and a unit, got {value!r}")
        try:
            outputs[name] = Output(symbols.canonical(exact(expression), f"output {name!r}"), *rest)
        except LawError as error:
            raise GraphError(f"graph {graph!r}: output {name!r}: {error}") from None
    return outputs


def _nearest(name: str, known: Iterable[str]) -> str:
    names = list(known)
    near = difflib.get_close_matches(name, names, n=3)
    return f"did you mean {' or '.join(near)}?" if near else f"there is {', '.join(names) or 'none'}"

