"""Causality: which end of each bond decides its effort, and why.

The sequential causality assignment procedure (SCAP): sources first, storage in
integral causality, elements whose law has only one direction, then the free
choices; each choice is propagated through the junction structure before the
next. Every stroke keeps its reason and the stroke it follows from.

References
----------
Karnopp, Margolis, Rosenberg, System Dynamics, 5th ed., Wiley 2012, ch. 3 and 5.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from enum import Enum

import networkx

from .elements import C, Friction, GY, Element, I, Junction, One, R, Se, Sf, Storage, TF
from .errors import CausalConflictError
from .graph import BondGraph, GraphBond, check_structure


class Reason(Enum):
    """Why a bond has its stroke."""

    SOURCE = "source"
    INTEGRAL = "integral"
    DERIVATIVE = "derivative"
    LAW = "law"
    ARBITRARY = "arbitrary"
    PROPAGATED = "propagated"


# Whether an element, left to itself, decides the effort of its bond.
PREFERRED: dict[type[Element], bool] = {Se: True, Sf: False, C: True, I: False, Friction: True}


@dataclass(frozen=True)
class Stroke:
    """The causality of one bond.

    Attributes
    ----------
    bond : str
        Name of the bond.
    effort_out_of : str
        Element that decides the effort; the other end decides the flow. The
        causal stroke is drawn at the other end.
    flow_out_of : str
        Element that decides the flow.
    reason : Reason
    because : str
        The reason in words.
    """

    bond: str
    effort_out_of: str
    flow_out_of: str
    reason: Reason
    because: str


@dataclass(frozen=True, eq=False)
class CausalGraph:
    """A bond graph with a causal stroke on every bond.

    Attributes
    ----------
    graph : BondGraph
    strokes : tuple of Stroke
        In the order of ``graph.bonds``.
    integral, derivative : tuple of str
        Qualified names of storages in integral and in derivative causality.

    Examples
    --------
    >>> from bondgraph import I, One, R, Se, assemble, assign_causality
    >>> v = One("v")
    >>> pair = assemble("pair", Se("F", 1) >> v >> (I("a", 2), I("b", 3), R("r", 0.5)))
    >>> assign_causality(pair).derivative
    ('b',)
    """

    graph: BondGraph
    strokes: tuple[Stroke, ...]
    integral: tuple[str, ...]
    derivative: tuple[str, ...]

    def decides_effort(self, element: str, bond: str) -> bool:
        """Whether an element decides the effort of a bond."""
        return self.stroke(bond).effort_out_of == element

    def stroke(self, bond: str) -> Stroke:
        """Return the stroke of a bond by its name."""
        for stroke in self.strokes:
            if stroke.bond == bond:
                return stroke
        raise KeyError(bond)

    def explain(self) -> str:
        """Say in words, line by line, how each stroke came about."""
        lines = [f"{stroke.bond}: effort out of {stroke.effort_out_of} ({stroke.because})" for stroke in self.strokes]
        return "\n".join(lines + list(self.warnings))

    @property
    def warnings(self) -> tuple[str, ...]:
        """Storages that could not keep integral causality, with the reason."""
        by_end = {bond.head: stroke for bond, stroke in zip(self.graph.bonds, self.strokes, strict=True)}
        by_end |= {
            bond.tail: stroke
            for bond, stroke in zip(self.graph.bonds, self.strokes, strict=True)
            if isinstance(self.graph.elements[bond.tail], Storage)
        }
        return tuple(
            f"{self.graph.elements[name].kind} {name!r} is in derivative causality "
            f"({by_end[name].because}): it adds no state of its own"
            for name in self.derivative
        )


def assign_causality(graph: BondGraph) -> CausalGraph:
    """Assign a causal stroke to every bond.

    Parameters
    ----------
    graph : BondGraph

    Returns
    -------
    CausalGraph

    Raises
    ------
    CausalConflictError
        When two elements decide the same variable of a junction, or none can;
        both causes and the junction are named.
    GraphError
        When a junction still waits for a parent's bond.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble
    >>> loop = One("loop")
    >>> rc = assign_causality(assemble("rc", Se("E", 1) >> loop >> (R("r", 1), C("c", 1))))
    >>> [stroke.effort_out_of for stroke in rc.strokes]
    ['E', 'loop', 'c']
    """
    check_structure(graph.name, graph.elements, graph.bonds)
    scap = _Scap(graph)
    scap.run()
    return CausalGraph(
        graph,
        tuple(scap.stroke(index) for index in range(len(graph.bonds))),
        tuple(name for name, element in graph.of(Storage) if scap.is_integral(name, element)),
        tuple(name for name, element in graph.of(Storage) if not scap.is_integral(name, element)),
    )


@dataclass(frozen=True)
class _Cause:
    """Why a bond has its stroke: kind, words, the element that asks, the bond it follows from."""

    reason: Reason
    because: str
    element: str
    parent: int | None = None


class _Conflict(Exception):
    """Two strokes cannot hold together: the element whose rule breaks, the bonds, their causes."""

    def __init__(self, element: str, said: str, bonds: list[int], causes: list[_Cause]) -> None:
        super().__init__(said)
        self.element = element
        self.said = said
        self.bonds = bonds
        self.causes = causes


class _Scap:
    """One run of SCAP over bond indices; choices can be taken back by a trail."""

    def __init__(self, graph: BondGraph) -> None:
        self.graph = graph
        self.bonds: tuple[GraphBond, ...] = graph.bonds
        self.network = networkx.MultiGraph()
        self.network.add_nodes_from(graph.elements)
        for index, bond in enumerate(graph.bonds):
            self.network.add_edge(bond.tail, bond.head, key=index)
        self.at = {name: [key for _, _, key in self.network.edges(name, keys=True)] for name in graph.elements}
        self.effort: dict[int, str] = {}
        self.cause: dict[int, _Cause] = {}
        self.trail: list[int] = []

    def run(self) -> None:
        """Assign all bonds: sources, storage, one-way laws, then free choices."""
        self._required((Se, Sf), Reason.SOURCE)
        for name, element in self.graph.of(Storage):
            self._prefer(name, PREFERRED[type(element)], Reason.INTEGRAL, "integral causality")
        self._required((Friction,), Reason.LAW)
        for name, resistor in self.graph.of(R):
            if (resistor.effort is None) != (resistor.flow is None):
                self._prefer(name, resistor.flow is None, Reason.LAW, "its law has one direction")
        for name, _ in self.graph.of(R):
            self._prefer(name, True, Reason.ARBITRARY, "free choice")
        for index, bond in enumerate(self.bonds):
            if index not in self.effort:
                self._choose(index, bond.tail, _Cause(Reason.ARBITRARY, f"free choice at {bond.name}", bond.tail))

    def stroke(self, index: int) -> Stroke:
        """Return the finished stroke of one bond."""
        bond, cause = self.bonds[index], self.cause[index]
        effort = self.effort[index]
        return Stroke(bond.name, effort, self._other(index, effort), cause.reason, cause.because)

    def is_integral(self, name: str, element: Storage) -> bool:
        """Whether a storage ended in integral causality."""
        return (self.effort[self.at[name][0]] == name) == PREFERRED[type(element)]

    def _other(self, index: int, end: str) -> str:
        bond = self.bonds[index]
        return bond.head if end == bond.tail else bond.tail

    def _required(self, kinds: tuple[type[Element], ...], reason: Reason) -> None:
        for name, element in self.graph.elements.items():
            if not isinstance(element, kinds):
                continue
            if isinstance(element, Friction) and element.smoothing is not None:
                self._prefer(name, True, Reason.LAW, "its law has one direction")
                continue
            index = self.at[name][0]
            out = PREFERRED[type(element)]
            words = f"{element.kind} {name!r} decides its {'effort' if out else 'flow'}"
            try:
                self._set(index, name if out else self._other(index, name), _Cause(reason, words, name))
            except _Conflict as conflict:
                raise self._error(conflict) from None

    def _prefer(self, name: str, out: bool, reason: Reason, words: str) -> None:
        index = self.at[name][0]
        if index in self.effort:
            return
        element = self.graph.elements[name]
        end = name if out else self._other(index, name)
        self._choose(index, end, _Cause(reason, f"{words} of {element.kind} {name!r}", name))

    def _choose(self, index: int, end: str, cause: _Cause) -> None:
        """Try a choice; take it back and turn it round where it cannot hold."""
        mark = len(self.trail)
        try:
            self._set(index, end, cause)
        except _Conflict as conflict:
            first = self._error(conflict)
            self._undo(mark)
            reason = Reason.DERIVATIVE if cause.reason is Reason.INTEGRAL else Reason.PROPAGATED
            turned = _Cause(reason, f"not {cause.because}: {first}", cause.element)
            try:
                self._set(index, self._other(index, end), turned)
            except _Conflict as second:
                raise self._error(second) from None

    def _undo(self, mark: int) -> None:
        while len(self.trail) > mark:
            index = self.trail.pop()
            del self.effort[index], self.cause[index]

    def _set(self, index: int, end: str, cause: _Cause) -> None:
        """Give one bond its stroke and follow all consequences."""
        queue = deque([(index, end, cause)])
        while queue:
            index, end, cause = queue.popleft()
            if index in self.effort:
                if self.effort[index] != end:
                    raise self._contradiction(index, cause)
                continue
            self.effort[index] = end
            self.cause[index] = cause
            self.trail.append(index)
            bond = self.bonds[index]
            for name in (bond.tail, bond.head):
                queue.extend(self._follow(name, index))

    def _contradiction(self, index: int, cause: _Cause) -> _Conflict:
        """Tell which element's rule breaks when a bond is given a second, opposite stroke."""
        before = self.cause[index]
        bond = self.bonds[index]
        ends = [bond.tail, bond.head]
        shared = [self._shared_end(index, item) for item in (before, cause)]
        candidates = [name for name in (*shared, *ends) if name is not None]
        name = next((n for n in candidates if isinstance(self.graph.elements[n], Junction)), candidates[0])
        element = self.graph.elements[name]
        if not isinstance(element, Junction):
            return _Conflict(name, "its two bonds ask for causalities that it cannot join", [index], [before, cause])
        others = [item.parent for item in (before, cause) if item.parent is not None]
        count = "no bond decides" if self._decides(index, name, element) else "two bonds decide"
        return _Conflict(name, f"{count} its {element.shared}", [*others, index], [before, cause])

    def _shared_end(self, index: int, cause: _Cause) -> str | None:
        """Return the element through which a propagated cause reached a bond."""
        if cause.parent is None:
            return None
        here, there = self.bonds[index], self.bonds[cause.parent]
        return next((end for end in (here.tail, here.head) if end in (there.tail, there.head)), None)

    def _follow(self, name: str, index: int) -> list[tuple[int, str, _Cause]]:
        """Return the strokes that an element's rule forces after bond ``index`` is set."""
        element = self.graph.elements[name]
        if isinstance(element, Junction):
            return self._follow_junction(name, element, index)
        if isinstance(element, TF | GY):
            first, second = self.at[name]
            other = second if index == first else first
            out = self.effort[index] == name
            forced = out if isinstance(element, GY) else not out
            return [(other, name if forced else self._other(other, name), self._passed(name, element, index))]
        return []

    def _follow_junction(self, name: str, junction: Junction, index: int) -> list[tuple[int, str, _Cause]]:
        bonds = self.at[name]
        deciding = [bond for bond in bonds if bond in self.effort and self._decides(bond, name, junction)]
        if len(deciding) > 1:
            causes = [self.cause[bond] for bond in deciding]
            raise _Conflict(name, f"two bonds decide its {junction.shared}", deciding, causes)
        if deciding and deciding[0] == index:
            return [
                (bond, self._end(bond, name, junction, False), self._passed(name, junction, index))
                for bond in bonds
                if bond != index
            ]
        if deciding:
            return []
        free = [bond for bond in bonds if bond not in self.effort]
        if not free:
            causes = [self.cause[bond] for bond in bonds]
            raise _Conflict(name, f"no bond decides its {junction.shared}", bonds, causes)
        if len(free) == 1:
            return [(free[0], self._end(free[0], name, junction, True), self._passed(name, junction, index))]
        return []

    def _passed(self, name: str, element: Element, index: int) -> _Cause:
        root = self._root(self.cause[index])
        return _Cause(Reason.PROPAGATED, f"through {element.kind} {name!r}, from: {root.because}", name, index)

    def _decides(self, bond: int, name: str, junction: Junction) -> bool:
        """Whether a bond brings the junction its shared variable."""
        return (self.effort[bond] == name) == isinstance(junction, One)

    def _end(self, bond: int, name: str, junction: Junction, decides: bool) -> str:
        return name if decides == isinstance(junction, One) else self._other(bond, name)

    def _error(self, conflict: _Conflict) -> CausalConflictError:
        element = self.graph.elements[conflict.element]
        suffix = "-junction" if isinstance(element, Junction) else ""
        roots = [self._root(cause) for cause in conflict.causes]
        words = list(dict.fromkeys(root.because for root in roots))
        return CausalConflictError(
            f"causal conflict at {element.kind}{suffix} {conflict.element!r}: {conflict.said}: "
            f"{' and '.join(words)}; remove one of them, or put an R, C or I between",
            elements=list(dict.fromkeys([conflict.element, *(root.element for root in roots)])),
            bonds=list(dict.fromkeys(self.bonds[bond].name for bond in conflict.bonds)),
        )

    def _root(self, cause: _Cause) -> _Cause:
        """Follow a propagated cause back to the choice it comes from."""
        while cause.parent is not None:
            cause = self.cause[cause.parent]
        return cause
