"""What each mode of the switching elements does to the states."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from ..elements import DryFriction, Switched
from ..equations import Equations
from ..errors import BondGraphError
from ..modes import ModeEquations, contacts, mode_equations
from .constraints import Constraints
from .value import BoundState, ModeCausality

# Up to so many combinations of modes all are derived; else those of a single change.
ALL_MODES = 16


def mode_table(equations: Equations) -> tuple[ModeCausality, ...]:
    """Derive the modes of a graph and tell which states each binds.

    Parameters
    ----------
    equations : Equations
        Of the graph with all modes open.

    Returns
    -------
    tuple of ModeCausality
        All combinations where they are at most 16; else the one in which
        nothing is held, and those in which one element is. Empty for a graph
        without switching elements.

    Examples
    --------
    >>> from bondgraph import Diode, I, One, R, Se, assemble, derive
    >>> loop = One("loop")
    >>> graph = assemble("choke", Se("E", 1) >> loop >> (Diode("d"), I("coil", 2), R("r", 3)))
    >>> [(dict(row.modes), [bound.state for bound in row.bound]) for row in mode_table(derive(graph))]
    [({'d': 'conducting'}, []), ({'d': 'blocking'}, ['coil.p'])]
    """
    names = contacts(equations.graph)
    return tuple(_row(equations, names, held) for held in _held(names)) if names else ()


def possible_modes(equations: Equations) -> int:
    """Return the number of combinations of held and other modes."""
    names = contacts(equations.graph)
    return 2 ** len(names) if names else 0


def _held(names: tuple[str, ...]) -> Iterator[frozenset[str]]:
    if 2 ** len(names) > ALL_MODES:
        yield frozenset()
        yield from (frozenset((name,)) for name in names)
        return
    for choice in itertools.product((False, True), repeat=len(names)):
        yield frozenset(name for name, is_held in zip(names, choice, strict=True) if is_held)


def _row(equations: Equations, names: tuple[str, ...], held: frozenset[str]) -> ModeCausality:
    modes = {name: _label(equations, name, name in held) for name in names}
    try:
        mode = mode_equations(equations, held)
    except BondGraphError as error:
        return ModeCausality(modes, impossible=str(error))
    constraints = Constraints(mode.equations, mode.imposed.values())
    bound = tuple(_bound(mode, constraints, str(state)) for state in mode.bound)
    return ModeCausality(modes, bound, tuple(map(str, mode.equations.algebraic)))


def _label(equations: Equations, name: str, is_held: bool) -> str:
    element = equations.graph.elements[name]
    assert isinstance(element, Switched)
    if not is_held and isinstance(element, DryFriction):
        return "slip"
    return element.label(0 if is_held else 1)


def _bound(mode: ModeEquations, constraints: Constraints, state: str) -> BoundState:
    equations = mode.equations
    storage = state.rpartition(".")[0]
    constraint = equations.dependent[storage]
    (bond,) = equations.graph.bonds_of(storage)
    return BoundState(
        state,
        constraints.expanded(constraint),
        constraints.bound_by(constraint, besides=[storage]),
        equations.causal.stroke(bond.name).because,
    )
