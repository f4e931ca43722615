"""Bond graphs: from elements and bonds to equations, simulation and stability.

Public names are loaded when first used, so that ``import bondgraph`` is cheap.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .causality import CausalGraph, assign_causality
    from .elements import GY, TF, C, Friction, I, One, R, Se, Sf, Zero
    from .equations import Equations, derive
    from .errors import BondGraphError
    from .files import load, save
    from .graph import TIME, BondGraph, Output, assemble
    from .linear import LinearSystem, linearize
    from .modes import in_mode, smoothed
    from .parameters import Parameter
    from .simulation import CompiledModel, Outcome, Samples, Trajectory, simulate
    from .steady import SteadyState, steady_state
    from .symbolic import SymbolicSystem, routh_hurwitz, symbolic_system

_HOME = {
    "BondGraph": "graph",
    "BondGraphError": "errors",
    "C": "elements",
    "CausalGraph": "causality",
    "CompiledModel": "simulation",
    "Equations": "equations",
    "Friction": "elements",
    "GY": "elements",
    "I": "elements",
    "LinearSystem": "linear",
    "One": "elements",
    "Outcome": "simulation",
    "Output": "graph",
    "Parameter": "parameters",
    "R": "elements",
    "Samples": "simulation",
    "Se": "elements",
    "Sf": "elements",
    "SteadyState": "steady",
    "SymbolicSystem": "symbolic",
    "TF": "elements",
    "TIME": "graph",
    "Trajectory": "simulation",
    "Zero": "elements",
    "assemble": "graph",
    "assign_causality": "causality",
    "derive": "equations",
    "in_mode": "modes",
    "linearize": "linear",
    "load": "files",
    "routh_hurwitz": "symbolic",
    "save": "files",
    "simulate": "simulation",
    "smoothed": "modes",
    "steady_state": "steady",
    "symbolic_system": "symbolic",
}

__all__ = [
    "assemble",
    "assign_causality",
    "BondGraph",
    "BondGraphError",
    "C",
    "CausalGraph",
    "CompiledModel",
    "derive",
    "Equations",
    "Friction",
    "GY",
    "I",
    "in_mode",
    "linearize",
    "LinearSystem",
    "load",
    "One",
    "Outcome",
    "Output",
    "Parameter",
    "R",
    "routh_hurwitz",
    "Samples",
    "save",
    "Se",
    "Sf",
    "simulate",
    "smoothed",
    "steady_state",
    "SteadyState",
    "symbolic_system",
    "SymbolicSystem",
    "TF",
    "TIME",
    "Trajectory",
    "Zero",
]
__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'bondgraph' has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
