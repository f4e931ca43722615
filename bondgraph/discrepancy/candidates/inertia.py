"""Inertia that was not counted, or is not constant."""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from ...elements import I
from .builders import stands_for
from .features import Feature
from .place import Change, Place
from .places import FLOW_JUNCTION, INERTIA, POWER
from .value import FLOW, MOMENTUM, SIGNAL, Coefficient, Effect


def _added(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    start = place.initial(law["momentum"].xreplace({FLOW: place.flow}))
    element = I(place.name, symbols["inertance"], initial=start)
    return Change((place.node >> element,))


def _bent(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    """Add a cubic share to the flow of an I, whose energy keeps its form."""
    old = place.element

    def flow(p: sympy.Expr) -> sympy.Expr:
        said = law["flow"].xreplace({SIGNAL: old.law, MOMENTUM: old.p})
        return said.xreplace({old.p: p})

    new = I(old.name, flow=flow, initial=old.initial)
    return Change(replaced={old: stands_for(new, old)})


_MASS = Coefficient(
    "inertance",
    "{p}/({f})",
    "inertance",
    lambda s: 0.1 * s.effort * s.duration / s.flow,
    absent=0.0,
    linear=True,
)
ADDED = Effect(
    "added_inertia",
    (FLOW_JUNCTION,),
    (_MASS,),
    {"momentum": _MASS.symbol * FLOW},
    _added,
    "inertia that was not counted: entrained fluid, a mount, an armature",
    "Karnopp, Margolis, Rosenberg, System Dynamics, ch. 3",
    domains=POWER,
    features=(Feature("df/dt", lambda s: s.flow, rate=True),),
)
_CUBIC = Coefficient(
    "cubic",
    "({f})/({p})^3",
    "flow over the cube of momentum",
    lambda s: 0.1 * s.flow / (s.effort * s.duration) ** 3,
    absent=0.0,
    linear=True,
)
NONLINEAR = Effect(
    "nonlinear_inertance",
    (INERTIA,),
    (_CUBIC,),
    {"flow": SIGNAL + _CUBIC.symbol * MOMENTUM**3},
    _bent,
    "flow that grows faster than momentum: a coil whose iron saturates",
    "Thomas, Rosa, Toussaint, The Analysis and Design of Linear Circuits, ch. 6 (flux linkage)",
    domains=POWER,
    features=(Feature("p^3", lambda s: s.momentum**3),),
)
INERTIAS = (NONLINEAR, ADDED)
