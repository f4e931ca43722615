"""Code generation: ordered sympy assignments in, numeric functions out.

A `Program` is a list of assignments with named vector arguments and results.
It knows sympy only; each ``to_*`` module turns it into one numeric or textual
form. Bond graphs are unknown here.
"""

from .program import Program

__all__ = ["Program"]
