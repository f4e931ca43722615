"""The report as a frozen value; expressions stay sympy's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy

from ..graph import Signal


@dataclass(frozen=True)
class BondCausality:
    """A bond with its half arrow, its causal stroke and the reason.

    Attributes
    ----------
    bond : str
    tail, head : str
        The half arrow points from tail to head.
    effort_out_of, flow_out_of : str
        Which end decides the effort, and which the flow; the stroke is drawn
        at the end that decides the flow.
    reason : str
        ``source``, ``integral``, ``derivative``, ``law``, ``arbitrary`` or
        ``propagated``.
    because : str
        The reason in words.
    """

    bond: str
    tail: str
    head: str
    effort_out_of: str
    flow_out_of: str
    reason: str
    because: str


@dataclass(frozen=True)
class JunctionDecision:
    """The one bond that decides what a junction shares.

    Attributes
    ----------
    junction, kind : str
    shared : str
        ``effort`` of a 0-junction, ``flow`` of a 1-junction.
    bond, decided_by : str
        The bond, and the element at its other end.
    because : str
    followers : tuple of str
        Elements that the junction tells it to.
    """

    junction: str
    kind: str
    shared: str
    bond: str
    decided_by: str
    because: str
    followers: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class StorageCausality:
    """A storage: a state of its own, or bound by others.

    Attributes
    ----------
    storage, kind : str
    state : str
    integral : bool
    bond, because : str
        Its bond, and why that has its stroke.
    constraint : Expr or None
        What the state of a dependent storage is, in the equations' variables;
        None for a storage in integral causality, and where only an implicit
        law tells.
    expanded : Expr or None
        The same in states, inputs, parameters and algebraic variables; None
        where that is too large to read.
    bound_by : tuple of str
        Storages, sources, inputs and switching elements that bind it.
    done : str
        What the equations do about it.
    idle_initial : bool
        Whether an initial value is given that is not used.
    """

    storage: str
    kind: str
    state: str
    integral: bool
    bond: str
    because: str
    constraint: sympy.Expr | None = None
    expanded: sympy.Expr | None = None
    bound_by: tuple[str, ...] = ()
    done: str = ""
    idle_initial: bool = False


@dataclass(frozen=True, eq=False)
class Reduction:
    """An integral storage and those that move with it, as one.

    Attributes
    ----------
    storage : str
        In integral causality.
    carried : tuple of str
        Storages that it alone binds.
    quantity : str
        ``inertance`` or ``capacitance``.
    value : Expr
        Of all together, as the storage in integral causality sees them: a
        number, or a function of states and parameters.
    """

    storage: str
    carried: tuple[str, ...]
    quantity: str
    value: sympy.Expr


@dataclass(frozen=True)
class LoopReport:
    """Variables that depend on each other at the same instant.

    Attributes
    ----------
    kind : str
        ``algebraic loop`` or ``loop of dependent rates``.
    variables, tearing : tuple of str
        In order round the loop, and those solved for.
    solved : str
        ``linear``: solved symbolically; ``algebraic``: kept as algebraic
        variables.
    remedy : str
        How the model could do without.
    """

    kind: str
    variables: tuple[str, ...]
    tearing: tuple[str, ...]
    solved: str
    remedy: str


@dataclass(frozen=True, eq=False)
class BoundState:
    """A state that a mode binds.

    Attributes
    ----------
    state : str
    value : Expr or None
        What it follows, while the mode lasts; None where too large to read.
    bound_by : tuple of str
    because : str
    """

    state: str
    value: sympy.Expr | None
    bound_by: tuple[str, ...]
    because: str


@dataclass(frozen=True, eq=False)
class ModeCausality:
    """What one mode does to the states.

    Attributes
    ----------
    modes : mapping of str to str
        Switching element to the label of its mode; ``slip`` where dry friction
        slips either way.
    bound : tuple of BoundState
        States that are none of their own in this mode.
    algebraic : tuple of str
        Variables that stay implicit in this mode.
    impossible : str
        Why this mode cannot be; empty where it can.
    """

    modes: Mapping[str, str]
    bound: tuple[BoundState, ...] = ()
    algebraic: tuple[str, ...] = ()
    impossible: str = ""


@dataclass(frozen=True, eq=False)
class CausalityReport:
    """All that causality decided, why, and what was done about it.

    Attributes
    ----------
    model : str
    bonds : tuple of BondCausality
    junctions : tuple of JunctionDecision
    storages : tuple of StorageCausality
    reductions : tuple of Reduction
    loops : tuple of LoopReport
    signals : tuple of Signal
        Laws that use a variable of another element.
    input_rates : tuple of (str, str)
        Inputs whose rate is needed, and the rate's name.
    turned : tuple of str
        What was put right when the graph was assembled: arrows turned round.
    parts : tuple of tuple of str
        Elements of each part, where neither bonds nor signals join them all.
    modes : tuple of ModeCausality
        Of graphs with switching elements.
    possible_modes : int
        How many combinations of modes there are; `modes` holds those of a
        single change where they are many.
    """

    model: str
    bonds: tuple[BondCausality, ...]
    junctions: tuple[JunctionDecision, ...]
    storages: tuple[StorageCausality, ...]
    reductions: tuple[Reduction, ...]
    loops: tuple[LoopReport, ...]
    signals: tuple[Signal, ...]
    input_rates: tuple[tuple[str, str], ...]
    turned: tuple[str, ...]
    parts: tuple[tuple[str, ...], ...]
    modes: tuple[ModeCausality, ...]
    possible_modes: int

    @property
    def dependent(self) -> tuple[StorageCausality, ...]:
        """Storages without a state of their own."""
        return tuple(item for item in self.storages if not item.integral)
