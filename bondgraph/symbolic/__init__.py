"""Small models in symbols: Jacobians, transfer functions and stability in the parameters.

`symbolic_system` takes a graph to a `SymbolicSystem`. Polynomials are computed
in exact sparse arithmetic (`rational`, `determinant`, `common`), read under the
assumptions of their symbols (`signs`, `routh`), and given up by name when they
grow too large (`limits`).
"""

from .analyse import symbolic_system
from .array import RouthArray
from .limits import SymbolicError
from .polynomial import Polynomial
from .routh import RouthHurwitz, Stability, routh_hurwitz
from .system import SymbolicSystem
from .transfer import TransferFunction

__all__ = [
    "Polynomial",
    "RouthArray",
    "RouthHurwitz",
    "Stability",
    "SymbolicError",
    "SymbolicSystem",
    "TransferFunction",
    "routh_hurwitz",
    "symbolic_system",
]
