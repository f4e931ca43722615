"""Equations: from strokes to ordered assignments.

Every effort and flow of the graph becomes one variable with one assignment.
Variables shared at a junction are one variable, so nothing is copied. The
assignments are put in order by their dependencies; what depends on itself is
a loop (algebraic loops, dependent storages) and is solved inside its own block
only: symbolically where linear, kept as algebraic variables where not. Cost
grows with the graph, not with its square.

`value` is the result, `nets` names the variables, `derivation` writes and
solves, `accounts` keeps power and energy, `fractions` brings rates to lowest
terms for display.
"""

from .derivation import derive
from .value import Contact, Equations

__all__ = ["Contact", "Equations", "derive"]
