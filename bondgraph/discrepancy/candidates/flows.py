"""Leaks and orifices: flows that an effort drives."""

from __future__ import annotations

import numpy
import sympy

from .builders import resistor, source
from .features import Feature, Shape, Signals
from .places import EFFORT_JUNCTION, EFFORT_PAIR, POTENTIAL
from .value import EFFORT, Coefficient, Effect

_SITES = (EFFORT_JUNCTION, EFFORT_PAIR)
_CONDUCTANCE = Coefficient(
    "conductance",
    "({f})/({e})",
    "flow over effort",
    lambda s: 0.1 * s.flow / s.effort,
    absent=0.0,
    linear=True,
)
_G = _CONDUCTANCE.symbol
LEAKAGE = Effect(
    "leakage",
    _SITES,
    (_CONDUCTANCE,),
    {"flow": _G * EFFORT},
    resistor,
    "flow in proportion to effort",
    "Merritt, Hydraulic Control Systems, ch. 3",
    domains=POTENTIAL,
    features=(Feature("e", lambda s: s.effort),),
)
_THRESHOLD = Coefficient("threshold", "{e}", "effort at the brim", lambda s: 0.8 * s.effort)


def _above(share: float) -> Shape:
    """Above a share of the range of effort."""

    def brim(signals: Signals) -> float:
        low, high = signals.efforts
        return low + share * (high - low)

    return Shape(
        (Feature(f"e above {share:g}", lambda s: numpy.maximum(s.effort - brim(s), 0.0)),),
        lambda a, s: {"conductance": a[0], "threshold": max(brim(s), 1e-300)},
    )


OVERFLOW = Effect(
    "overflow",
    (EFFORT_JUNCTION,),
    (_CONDUCTANCE, _THRESHOLD),
    {"flow": _G * sympy.Max(EFFORT - _THRESHOLD.symbol, 0)},
    resistor,
    "flow that begins above a threshold: a brim, a relief valve",
    "Merritt, Hydraulic Control Systems, ch. 5",
    domains=("hydraulic", "electrical"),
    shapes=tuple(map(_above, (0.5, 0.7, 0.85, 0.95))),
)
_ORIFICE = Coefficient(
    "orifice",
    "({f})/({e})^(1/2)",
    "flow over the root of effort",
    lambda s: 0.1 * s.flow / s.effort**0.5,
    absent=0.0,
    linear=True,
)
_LAMINAR = Coefficient(
    "laminar",
    "{e}",
    "effort below which the flow is laminar",
    lambda s: 1e-3 * s.effort,
    numerical=True,
)
ORIFICE = Effect(
    "orifice_flow",
    _SITES,
    (_ORIFICE, _LAMINAR),
    # a root alone has no slope at rest: it would empty a vessel in finite time and stick there
    {"flow": _ORIFICE.symbol * EFFORT / (EFFORT**2 + _LAMINAR.symbol**2) ** sympy.Rational(1, 4)},
    resistor,
    "turbulent flow through an opening: the root of the pressure, laminar near rest",
    "Merritt, Hydraulic Control Systems, ch. 3; Borutzky, Barnard, Thoma, Simul. Model. Pract. "
    "Theory 10 (2002) 141-152",
    domains=("hydraulic",),
    features=(
        Feature("sign(e)|e|^1/2", lambda s: numpy.sign(s.effort) * numpy.sqrt(abs(s.effort))),
    ),
)
_FLOW = Coefficient(
    "flow", "{f}", "constant flow into the site", lambda s: 0.1 * s.flow, 0.0, True, True
)
FLOW_BIAS = Effect(
    "flow_bias",
    (EFFORT_JUNCTION,),
    (_FLOW,),
    {"flow": _FLOW.symbol},
    source,
    "a constant flow that was not counted",
    "Karnopp, Margolis, Rosenberg, System Dynamics, ch. 3",
    domains=POTENTIAL,
    features=(Feature("-1", lambda s: -numpy.ones_like(s.t)),),
    passive=False,
)
FLOWS = (LEAKAGE, OVERFLOW, ORIFICE, FLOW_BIAS)
