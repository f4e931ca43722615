"""The causal graph as a frozen value: a stroke and a reason for every bond."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ..elements import Storage
from ..graph import BondGraph
from ..views import HtmlView, SvgView


class Reason(Enum):
    """Why a bond has its stroke."""

    SOURCE = "source"
    INTEGRAL = "integral"
    DERIVATIVE = "derivative"
    LAW = "law"
    ARBITRARY = "arbitrary"
    PROPAGATED = "propagated"


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
class CausalGraph(HtmlView, SvgView):
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
        lines = [
            f"{stroke.bond}: effort out of {stroke.effort_out_of} ({stroke.because})"
            for stroke in self.strokes
        ]
        return "\n".join(lines + list(self.warnings))

    @property
    def warnings(self) -> tuple[str, ...]:
        """Storages that could not keep integral causality, with the reason."""
        by_end = {
            bond.head: stroke for bond, stroke in zip(self.graph.bonds, self.strokes, strict=True)
        }
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
