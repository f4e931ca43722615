"""Ordering of assignments, and solution of what depends on itself.

Works on symbols only: a table of variables, each with an expression or with a
residual that must vanish. Strongly connected components are the algebraic
loops. A linear one is solved by elimination inside the block, in exact
arithmetic; a nonlinear one keeps its tearing variables as algebraic variables.

`components` finds what needs each other, `order` sorts and reports, `tearing` chooses what to solve for, `elimination`
solves, `residues` tells what is zero.
"""

from .order import AlgebraicLoop, Ordered, SingularLoopError, expansion, order_and_solve

__all__ = ["AlgebraicLoop", "Ordered", "SingularLoopError", "expansion", "order_and_solve"]
