"""Errors: what went wrong, where, and the way out.

One base class, few children. Each error carries the names of the elements and
bonds at fault, so that a caller (or a drawing) can point at them.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def suggestion(name: str, known: Iterable[str], most: int = 3) -> str:
    """Return a question with the nearest known names; empty where none is near.

    Examples
    --------
    >>> suggestion("sinn", ["sin", "asin", "exp"])
    'did you mean sin or asin?'
    """
    near = difflib.get_close_matches(name, list(known), n=most)
    return f"did you mean {' or '.join(near)}?" if near else ""


def owners(variables: Iterable[str]) -> tuple[str, ...]:
    """Return the elements that variables of equations belong to, by the variables' names.

    Examples
    --------
    >>> owners(["rate(der(rear.mass.p))", "a>b (2).e", "mass.f", "rear.mass.e"])
    ('rear.mass', 'a', 'b', 'mass')
    """
    found: dict[str, None] = {}
    for name in variables:
        while name.startswith(("der(", "rate(")) and name.endswith(")"):
            name = name.partition("(")[2][:-1]
        bond = name.rpartition(".")[0].partition(" (")[0]
        found |= dict.fromkeys(end for end in bond.split(">") if end)
    return tuple(found)


class BondGraphError(Exception):
    """Base of every error raised on purpose by the framework.

    Parameters
    ----------
    message : str
        What is wrong, where, and the remedy.
    elements : iterable of str, optional
        Qualified names of the elements at fault.
    bonds : iterable of str, optional
        Names of the bonds at fault.

    Examples
    --------
    >>> from bondgraph.errors import GraphError
    >>> GraphError("junction 'x' has one bond", elements=["x"]).elements
    ('x',)
    """

    def __init__(
        self,
        message: str,
        *,
        elements: tuple[str, ...] | list[str] = (),
        bonds: tuple[str, ...] | list[str] = (),
    ) -> None:
        super().__init__(message)
        self.elements = tuple(elements)
        self.bonds = tuple(bonds)


class GraphError(BondGraphError):
    """The graph's structure is malformed."""


class CausalConflictError(BondGraphError):
    """Two elements decide the same effort or flow, or none does."""


class AlgebraicLoopError(BondGraphError):
    """An algebraic loop has no unique solution."""


class LawError(BondGraphError):
    """A constitutive law is missing, contradictory or cannot be used as asked."""


class ParameterError(BondGraphError):
    """A parameter, input or initial value is unknown, missing or not admissible."""


class SimulationError(BondGraphError):
    """A simulation cannot be started as asked."""


class SweepError(BondGraphError):
    """A sweep cannot be started or taken up again as asked."""


class MeasurementError(BondGraphError):
    """Measured data are malformed or do not fit the model."""


class SteadyStateError(BondGraphError):
    """No steady state was found."""


class ModelError(BondGraphError):
    """A model's name, file or content cannot be used."""
