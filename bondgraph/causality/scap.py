"""The sequential causality assignment procedure, with every cause kept."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from ..codegen.collector import held_back
from ..elements import (
    GY,
    TF,
    C,
    DryFriction,
    EffortSource,
    Element,
    FlowSource,
    I,
    Junction,
    One,
    R,
    Storage,
    Switched,
)
from ..errors import CausalConflictError
from ..graph import BondGraph, GraphBond, check_structure
from .value import CausalGraph, Reason, Stroke

# Whether an element, left to itself, decides the effort of its bond.
PREFERRED: dict[type[Element], bool] = {
    EffortSource: True,
    FlowSource: False,
    C: True,
    I: False,
    Switched: True,
}

# A message lists no more causes than these.
MAX_CAUSES = 4


def preferred(element: Element) -> bool:
    """Whether an element, left to itself, decides the effort of its bond."""
    return next(out for kind, out in PREFERRED.items() if isinstance(element, kind))


@held_back()
def assign_causality(graph: BondGraph, dependent: Collection[str] = ()) -> CausalGraph:
    """Assign a causal stroke to every bond.

    Parameters
    ----------
    graph : BondGraph
    dependent : collection of str
        Storages that have to be in derivative causality, because a relation that strokes do
        not show binds their states.

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
    scap = _Scap(graph, dependent)
    scap.run()
    return CausalGraph(
        graph,
        tuple(scap.stroke(index) for index in range(len(graph.bonds))),
        tuple(name for name, element in graph.of(Storage) if scap.is_integral(name, element)),
        tuple(name for name, element in graph.of(Storage) if not scap.is_integral(name, element)),
    )


@dataclass(frozen=True, eq=False)
class _Cause:
    """Why a bond has its stroke.

    A propagated cause has ``parent``, the bond it came along, and ``origins``, all causes it
    follows from. Any other is a root: required (nothing blamed), chosen (blamed: its own
    decision), or turned round (blamed: the decisions that forced it; ``told`` says how).
    """

    reason: Reason
    because: str
    element: str
    parent: int | None = None
    origins: tuple[_Cause, ...] = ()
    blamed: frozenset[int] = frozenset()
    told: str = ""
    grounds: tuple[_Cause, ...] = ()


@dataclass(frozen=True)
class _Choice:
    """A bond still free, and the end whose effort is tried first."""

    index: int
    end: str
    cause: _Cause


@dataclass(frozen=True)
class _Decision:
    """A choice taken: its place in the order, and the length of the trail before it."""

    choice: _Choice
    position: int
    mark: int


class _Conflict(Exception):
    """Two strokes cannot hold together: the element whose rule breaks, the bonds, their causes."""

    def __init__(self, element: str, said: str, bonds: list[int], causes: list[_Cause]) -> None:
        super().__init__(said)
        self.element = element
        self.said = said
        self.bonds = bonds
        self.causes = causes


class _Scap:
    """One run of SCAP over bond indices.

    Where a choice holds neither way, the last earlier choice to blame is turned round (conflict
    directed backjumping), so that a conflict is reported only where no assignment exists.
    """

    def __init__(self, graph: BondGraph, dependent: Collection[str]) -> None:
        self.graph = graph
        self.dependent = dependent
        self.bonds: tuple[GraphBond, ...] = graph.bonds
        self.at: dict[str, list[int]] = {name: [] for name in graph.elements}
        for index, bond in enumerate(graph.bonds):
            self.at[bond.tail].append(index)
            self.at[bond.head].append(index)
        # of each junction: the bonds that bring its shared variable, and how many are still free
        self.deciding: dict[str, list[int]] = {name: [] for name, _ in graph.of(Junction)}
        self.free = {name: len(self.at[name]) for name in self.deciding}
        self.effort: dict[int, str] = {}
        self.cause: dict[int, _Cause] = {}
        self.trail: list[int] = []

    def run(self) -> None:
        """Assign all bonds: sources, storage, friction, one-way laws, then free choices."""
        for name, _ in self.graph.of((EffortSource, FlowSource)):
            self._require(self._wish(name, Reason.SOURCE))
        for name in self.dependent:
            wish = self._wish(name, Reason.INTEGRAL)
            cause = _Cause(
                Reason.DERIVATIVE, f"a loop of junctions binds the state of {name!r}", name
            )
            self._require(replace(wish, end=self._other(wish.index, wish.end), cause=cause))
        self._assign(list(self._choices()))

    def _require(self, choice: _Choice) -> None:
        try:
            self._set(choice.index, choice.end, choice.cause)
        except _Conflict as conflict:
            raise self._error(conflict) from None

    def _choices(self) -> Iterator[_Choice]:
        """All choices, in the order in which they are taken."""
        for name, _ in self.graph.of(Storage):
            yield self._wish(name, Reason.INTEGRAL)
        for name, _ in self.graph.of(DryFriction):
            yield self._wish(name, Reason.LAW)
        for name, resistor in self.graph.of(R):
            if (resistor.effort is None) != (resistor.flow is None):
                yield self._wish(name, Reason.LAW)
        for name, element in self.graph.of((R, Switched)):
            if not isinstance(element, DryFriction):
                yield self._wish(name, Reason.ARBITRARY)
        for index, bond in enumerate(self.bonds):
            cause = _Cause(Reason.ARBITRARY, f"free choice at {bond.name}", bond.tail)
            yield _Choice(index, bond.tail, cause)

    def _wish(self, name: str, reason: Reason) -> _Choice:
        """Return the causality that a one-port would have by itself."""
        element = self.graph.elements[name]
        out = element.effort is not None if isinstance(element, R) else preferred(element)
        words = {
            Reason.SOURCE: f"{element.kind} {name!r} decides its {'effort' if out else 'flow'}",
            Reason.INTEGRAL: f"integral causality of {element.kind} {name!r}",
            Reason.LAW: f"{element.kind} {name!r} gives its {'effort' if out else 'flow'} by its law",
            Reason.ARBITRARY: f"free choice of {element.kind} {name!r}",
        }
        index = self.at[name][0]
        return _Choice(
            index,
            name if out else self._other(index, name),
            _Cause(reason, words[reason], name),
        )

    def stroke(self, index: int) -> Stroke:
        """Return the finished stroke of one bond."""
        bond, cause = self.bonds[index], self.cause[index]
        effort = self.effort[index]
        words = cause.because if cause.parent is None else self._came(cause)
        if cause.told:
            words = f"{words}: {cause.told}"
        return Stroke(bond.name, effort, self._other(index, effort), cause.reason, words)

    def is_integral(self, name: str, element: Storage) -> bool:
        """Whether a storage ended in integral causality."""
        return (self.effort[self.at[name][0]] == name) == preferred(element)

    def _other(self, index: int, end: str) -> str:
        bond = self.bonds[index]
        return bond.head if end == bond.tail else bond.tail

    def _assign(self, choices: Sequence[_Choice]) -> None:
        """Take the choices in order."""
        decisions: list[_Decision] = []
        position = 0
        while position < len(choices):
            choice = choices[position]
            if choice.index not in self.effort:
                cause = replace(choice.cause, blamed=frozenset((len(decisions),)))
                decisions.append(_Decision(choice, position, len(self.trail)))
                conflict = self._attempt(choice.index, choice.end, cause)
                if conflict is not None:
                    position = self._repair(decisions, conflict)
            position += 1

    def _repair(self, decisions: list[_Decision], conflict: _Conflict | None) -> int:
        """Turn round the last choice to blame, as often as needed; return where to go on."""
        while conflict is not None:
            roots = _roots(conflict.causes)
            blamed = frozenset().union(*(root.blamed for root in roots))
            if not blamed:
                raise self._error(conflict)
            last = max(blamed)
            choice = decisions[last].choice
            turned = _Cause(
                Reason.DERIVATIVE if choice.cause.reason is Reason.INTEGRAL else Reason.PROPAGATED,
                f"not {choice.cause.because}",
                choice.cause.element,
                blamed=blamed - {last},
                told=self._told(conflict),
                grounds=tuple(dict.fromkeys(ground for root in roots for ground in _grounds(root))),
            )
            self._undo(decisions[last].mark)
            del decisions[last + 1 :]
            conflict = self._attempt(choice.index, self._other(choice.index, choice.end), turned)
        return decisions[-1].position

    def _attempt(self, index: int, end: str, cause: _Cause) -> _Conflict | None:
        try:
            self._set(index, end, cause)
        except _Conflict as conflict:
            return conflict
        return None

    def _undo(self, mark: int) -> None:
        while len(self.trail) > mark:
            index = self.trail.pop()
            for name, junction in self._junctions(index):
                self.free[name] += 1
                if self._decides(index, name, junction):
                    self.deciding[name].remove(index)
            del self.effort[index], self.cause[index]

    def _junctions(self, index: int) -> list[tuple[str, Junction]]:
        """Return the junctions that a bond ends on."""
        bond = self.bonds[index]
        ends = ((name, self.graph.elements[name]) for name in (bond.tail, bond.head))
        return [(name, element) for name, element in ends if isinstance(element, Junction)]

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
            for name, junction in self._junctions(index):
                self.free[name] -= 1
                if self._decides(index, name, junction):
                    self.deciding[name].append(index)
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
        name = next(
            (n for n in candidates if isinstance(self.graph.elements[n], Junction)), candidates[0]
        )
        element = self.graph.elements[name]
        if not isinstance(element, Junction):
            return _Conflict(
                name,
                "its two bonds ask for causalities that it cannot join",
                [index],
                [before, cause],
            )
        others = [item.parent for item in (before, cause) if item.parent is not None]
        count = "no bond decides" if self._decides(index, name, element) else "two bonds decide"
        return _Conflict(name, f"{count} its {element.shared}", [*others, index], [before, cause])

    def _shared_end(self, index: int, cause: _Cause) -> str | None:
        """Return the element through which a propagated cause reached a bond."""
        if cause.parent is None:
            return None
        here, there = self.bonds[index], self.bonds[cause.parent]
        return next(
            (end for end in (here.tail, here.head) if end in (there.tail, there.head)), None
        )

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
            cause = self._passed(name, element, index, [index])
            return [(other, name if forced else self._other(other, name), cause)]
        return []

    def _follow_junction(
        self, name: str, junction: Junction, index: int
    ) -> list[tuple[int, str, _Cause]]:
        bonds = self.at[name]
        deciding = sorted(self.deciding[name])
        if len(deciding) > 1:
            causes = [self.cause[bond] for bond in deciding]
            raise _Conflict(name, f"two bonds decide its {junction.shared}", deciding, causes)
        if deciding and deciding[0] == index:
            cause = self._passed(name, junction, index, [index])
            return [
                (bond, self._end(bond, name, junction, False), cause)
                for bond in bonds
                if bond != index
            ]
        if deciding:
            return []
        if self.free[name] == 0:
            causes = [self.cause[bond] for bond in bonds]
            raise _Conflict(name, f"no bond decides its {junction.shared}", bonds, causes)
        if self.free[name] == 1:
            free = next(bond for bond in bonds if bond not in self.effort)
            cause = self._passed(name, junction, index, [bond for bond in bonds if bond != free])
            return [(free, self._end(free, name, junction, True), cause)]
        return []

    def _passed(self, name: str, element: Element, index: int, given: list[int]) -> _Cause:
        """Cause that an element hands on along ``index``, given the strokes of some of its bonds.

        Chains of single origins are cut short, so that looking back does not cost their length.
        """
        causes = [self.cause[index], *(self.cause[bond] for bond in given if bond != index)]
        origins = tuple(cause.origins[0] if len(cause.origins) == 1 else cause for cause in causes)
        return _Cause(Reason.PROPAGATED, f"through {element.kind} {name!r}", name, index, origins)

    def _decides(self, bond: int, name: str, junction: Junction) -> bool:
        """Whether a bond brings the junction its shared variable."""
        return (self.effort[bond] == name) == isinstance(junction, One)

    def _end(self, bond: int, name: str, junction: Junction, decides: bool) -> str:
        return name if decides == isinstance(junction, One) else self._other(bond, name)

    def _place(self, conflict: _Conflict) -> str:
        element = self.graph.elements[conflict.element]
        return f"{element.kind}{'-junction' if isinstance(element, Junction) else ''} {conflict.element!r}"

    def _told(self, conflict: _Conflict) -> str:
        return f"at {self._place(conflict)} {conflict.said}: {_listed(_roots(conflict.causes))}"

    def _came(self, cause: _Cause) -> str:
        """Say where a propagated stroke came from."""
        root = cause
        while root.origins:
            root = root.origins[0]
        return f"{cause.because}, from: {root.because}"

    def _error(self, conflict: _Conflict) -> CausalConflictError:
        """Name the causes that stand whatever is chosen, and the choices that were never free."""
        roots = _roots(conflict.causes)
        named = list(
            dict.fromkeys(
                cause for root in roots for cause in (_grounds(root) if root.told else (root,))
            )
        )
        where = f"causal conflict at {self._place(conflict)}: {conflict.said}"
        if named:
            message = f"{where}: {_listed(named)}; remove one of them, or put an R, C or I between"
        else:
            message = (
                f"{where}, whatever is chosen elsewhere; the junctions alone contradict each other: "
                f"part them by an R, C or I"
            )
        return CausalConflictError(
            message,
            elements=list(dict.fromkeys([conflict.element, *(cause.element for cause in named)])),
            bonds=list(dict.fromkeys(self.bonds[bond].name for bond in conflict.bonds)),
        )


def _roots(causes: Iterable[_Cause]) -> list[_Cause]:
    """Follow propagated causes back to all that they come from."""
    found: dict[_Cause, None] = {}
    seen: set[_Cause] = set()
    stack = list(causes)[::-1]
    while stack:
        cause = stack.pop()
        if cause in seen:
            continue
        seen.add(cause)
        if not cause.origins:
            found[cause] = None
        stack.extend(cause.origins[::-1])
    return list(found)


def _grounds(root: _Cause) -> tuple[_Cause, ...]:
    """Return the required causes behind a root; a choice has none."""
    if root.told:
        return root.grounds
    return () if root.blamed else (root,)


def _listed(causes: Iterable[_Cause]) -> str:
    words = list(dict.fromkeys(cause.because for cause in causes))
    return " and ".join(words if len(words) <= MAX_CAUSES else [*words[:MAX_CAUSES], "others"])
