"""Bond graphs: from elements and bonds to equations, simulation and stability.

Public names are loaded when first used, so that ``import bondgraph`` is cheap.
"""

from __future__ import annotations

import importlib
import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .attractors import Attractor, Attractors, Reach, Trend, find_attractors, reach, trends
    from .causality import CausalGraph, assign_causality
    from .causality_report import CausalityReport, report_causality
    from .cycles import (
        LimitCycle,
        PeriodicOrbit,
        Section,
        Spectrum,
        limit_cycle,
        periodic_orbit,
        poincare_section,
        spectrum,
    )
    from .discrepancy.discovery import Discovery, discover
    from .discrepancy.fitting import Fit, fit
    from .discrepancy.measurement import Measurement
    from .elements import (
        GY,
        RS,
        TF,
        Block,
        C,
        CField,
        CheckValve,
        Clutch,
        De,
        Df,
        Diode,
        EndStop,
        Friction,
        Heat,
        I,
        ICField,
        IField,
        Integrator,
        Lag,
        One,
        R,
        RField,
        Se,
        Sf,
        Switch,
        Zero,
    )
    from .equations import Equations, derive
    from .errors import BondGraphError
    from .files import load, save
    from .graph import TIME, BondGraph, Output, assemble
    from .linear import (
        FrequencyResponse,
        LinearSystem,
        Mode,
        ModeShape,
        TimeResponse,
        linearize,
        modal_table,
    )
    from .modes import in_mode, smoothed
    from .parameters import Parameter
    from .simulation import (
        CompiledModel,
        Outcome,
        Samples,
        Sensitivities,
        Trajectory,
        sensitivities,
        simulate,
    )
    from .stability import EigenvalueMap, eigenvalue_map
    from .steady import SteadyState, steady_state
    from .sweeps import sweep
    from .symbolic import SymbolicSystem, routh_hurwitz, symbolic_system

_HOME = {
    "Attractor": "attractors",
    "Attractors": "attractors",
    "Block": "elements",
    "BondGraph": "graph",
    "BondGraphError": "errors",
    "C": "elements",
    "CField": "elements",
    "CausalGraph": "causality",
    "CausalityReport": "causality_report",
    "CheckValve": "elements",
    "Clutch": "elements",
    "CompiledModel": "simulation",
    "De": "elements",
    "Df": "elements",
    "Diode": "elements",
    "EigenvalueMap": "stability",
    "EndStop": "elements",
    "Equations": "equations",
    "Discovery": "discrepancy.discovery",
    "Fit": "discrepancy.fitting",
    "FrequencyResponse": "linear",
    "Mode": "linear",
    "ModeShape": "linear",
    "TimeResponse": "linear",
    "discover": "discrepancy.discovery",
    "Measurement": "discrepancy.measurement",
    "Friction": "elements",
    "GY": "elements",
    "Heat": "elements",
    "I": "elements",
    "ICField": "elements",
    "IField": "elements",
    "Integrator": "elements",
    "Lag": "elements",
    "LimitCycle": "cycles",
    "LinearSystem": "linear",
    "One": "elements",
    "Outcome": "simulation",
    "Output": "graph",
    "Parameter": "parameters",
    "PeriodicOrbit": "cycles",
    "R": "elements",
    "Reach": "attractors",
    "RField": "elements",
    "RS": "elements",
    "Samples": "simulation",
    "Se": "elements",
    "Section": "cycles",
    "Sensitivities": "simulation",
    "Sf": "elements",
    "Spectrum": "cycles",
    "SteadyState": "steady",
    "Switch": "elements",
    "SymbolicSystem": "symbolic",
    "TF": "elements",
    "TIME": "graph",
    "Trajectory": "simulation",
    "Trend": "attractors",
    "Zero": "elements",
    "assemble": "graph",
    "assign_causality": "causality",
    "derive": "equations",
    "eigenvalue_map": "stability",
    "find_attractors": "attractors",
    "fit": "discrepancy.fitting",
    "in_mode": "modes",
    "limit_cycle": "cycles",
    "linearize": "linear",
    "load": "files",
    "modal_table": "linear",
    "periodic_orbit": "cycles",
    "poincare_section": "cycles",
    "reach": "attractors",
    "report_causality": "causality_report",
    "routh_hurwitz": "symbolic",
    "save": "files",
    "sensitivities": "simulation",
    "simulate": "simulation",
    "smoothed": "modes",
    "sweep": "sweeps",
    "spectrum": "cycles",
    "steady_state": "steady",
    "symbolic_system": "symbolic",
    "trends": "attractors",
}

__all__ = [
    "assemble",
    "assign_causality",
    "Attractor",
    "Attractors",
    "Block",
    "BondGraph",
    "BondGraphError",
    "C",
    "CausalGraph",
    "CausalityReport",
    "CField",
    "CheckValve",
    "Clutch",
    "CompiledModel",
    "De",
    "derive",
    "Df",
    "Diode",
    "eigenvalue_map",
    "EigenvalueMap",
    "EndStop",
    "Equations",
    "find_attractors",
    "fit",
    "discover",
    "Discovery",
    "Fit",
    "FrequencyResponse",
    "Friction",
    "GY",
    "Heat",
    "I",
    "ICField",
    "IField",
    "in_mode",
    "Integrator",
    "Lag",
    "limit_cycle",
    "LimitCycle",
    "linearize",
    "LinearSystem",
    "load",
    "Measurement",
    "modal_table",
    "Mode",
    "ModeShape",
    "One",
    "Outcome",
    "Output",
    "Parameter",
    "periodic_orbit",
    "PeriodicOrbit",
    "poincare_section",
    "R",
    "Reach",
    "reach",
    "report_causality",
    "RField",
    "routh_hurwitz",
    "RS",
    "Samples",
    "save",
    "Se",
    "Section",
    "Sensitivities",
    "sensitivities",
    "Sf",
    "simulate",
    "smoothed",
    "Spectrum",
    "spectrum",
    "steady_state",
    "SteadyState",
    "sweep",
    "Switch",
    "symbolic_system",
    "SymbolicSystem",
    "TF",
    "TIME",
    "TimeResponse",
    "Trajectory",
    "Trend",
    "trends",
    "Zero",
]
__version__ = "0.1.0"


# What runs note is heard where somebody listens, not printed by the last resort.
logging.getLogger(__name__).addHandler(logging.NullHandler())


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'bondgraph' has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
