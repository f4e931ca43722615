"""Friction and drag: what resists a flow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy
import sympy

from ...elements import C, Friction, One, R, Zero
from .builders import resistor
from .features import Feature, Shape, Signals, dry, stop
from .place import Change, Place
from .places import FLOW_JUNCTION, FLOW_PAIR, MECHANICAL, POWER
from .value import FLOW, MEMORY, Coefficient, Effect, Scale

_SITES = (FLOW_JUNCTION, FLOW_PAIR)
_SIGN = Feature("sign(f)", dry)


def _force(scale: Scale) -> float:
    return 0.1 * scale.effort


def _level(meaning: str) -> Coefficient:
    return Coefficient("level", "{e}", meaning, _force, absent=0.0, linear=True)


_EXCESS = Coefficient(
    "excess", "{e}", "static beyond kinetic level", _force, absent=0.0, linear=True
)
_SPEED = Coefficient("speed", "{f}", "Stribeck speed", lambda s: 0.1 * s.flow)


def _falling(share: float) -> Shape:
    return Shape(
        (
            _SIGN,
            Feature(
                f"sign(f) exp(-|f|/{share:g}F)",
                lambda s: dry(s) * numpy.exp(-abs(s.flow) / (share * s.speed)),
            ),
        ),
        lambda a, s: {"level": a[0], "excess": a[1], "speed": share * s.speed},
    )


def _bristle(share: float) -> Shape:
    """Elastic up to a width, then as dry friction."""

    def starts(amounts: Sequence[float], signals: Signals) -> dict[str, float]:
        level, width = max(amounts[0], 1e-300), share * signals.stroke
        return {
            "level": level,
            "excess": 0.2 * level,
            "speed": 0.1 * signals.speed,
            "stiffness": level / width,
            "damping": 0.1 * level / signals.speed,
            "viscous": 0.01 * level / signals.speed,
        }

    return Shape(
        (
            Feature(
                f"stop({share:g})",
                lambda s: stop(s.displacement, share * s.stroke) / (share * s.stroke),
                memory=True,
            ),
        ),
        starts,
        turning=True,
    )


def _dry(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    def kinetic(speed: sympy.Expr) -> sympy.Expr:
        return law["kinetic"].xreplace({FLOW: speed})

    return Change((place.node >> Friction(place.name, kinetic=kinetic),))


def _bristles(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    """Bond an elastic bristle in series with a slider that lets it slip, beside viscous drag.

    The slider is an R whose flow the speed modulates: what it takes is lost.
    """
    root, bristle = Zero(f"{place.name}_root"), One(f"{place.name}_bristle")
    spring = C(f"{place.name}_spring", stiffness=symbols["stiffness"])
    slip = law["slip"].xreplace({FLOW: place.flow, MEMORY: spring.q})
    bonds = [
        place.node >> root,
        root >> R(place.name, flow=lambda effort: slip),
        root >> bristle,
        bristle >> (spring, R(f"{place.name}_damper", effort=lambda f: symbols["damping"] * f)),
    ]
    if isinstance(place.node, One):
        viscous = R(f"{place.name}_film", effort=lambda f: symbols["viscous"] * f)
        return Change((*bonds, place.node >> viscous))
    # at a 0-junction, which carries one effort, drag and bristle share the flow
    way = One(f"{place.name}_way")
    film = R(f"{place.name}_film", effort=lambda f: symbols["viscous"] * f)
    return Change((place.node >> way, way >> (root, film), *bonds[1:]))


VISCOUS = Effect(
    "viscous_damping",
    _SITES,
    (
        Coefficient(
            "damping",
            "{e}/({f})",
            "viscous damping",
            lambda s: 0.1 * s.effort / s.flow,
            absent=0.0,
            linear=True,
        ),
    ),
    {"effort": sympy.Symbol("damping", nonnegative=True) * FLOW},
    resistor,
    "effort in proportion to flow",
    "Karnopp, Margolis, Rosenberg, System Dynamics, ch. 3",
    domains=POWER,
    features=(Feature("f", lambda s: s.flow),),
)
COULOMB = Effect(
    "coulomb_friction",
    _SITES,
    (_level("friction, stuck and slipping"),),
    {"kinetic": sympy.Symbol("level", nonnegative=True)},
    _dry,
    "a constant effort against the flow, set-valued at rest",
    "Karnopp, J. Dyn. Sys. Meas. Control 107 (1985) 100-103",
    domains=MECHANICAL,
    features=(_SIGN,),
    events=True,
)
STRIBECK = Effect(
    "stribeck_friction",
    _SITES,
    (_level("friction at high speed"), _EXCESS, _SPEED),
    {
        "kinetic": _level("").symbol
        + _EXCESS.symbol * sympy.exp(-FLOW / _SPEED.symbol)  # FLOW: the slip speed, not negative
    },
    _dry,
    "dry friction that falls as slip grows",
    "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083-1138",
    domains=MECHANICAL,
    shapes=(_falling(0.03), _falling(0.1), _falling(0.3)),
    events=True,
    limits=("coulomb_friction",),
)
LUGRE = Effect(
    "lugre_friction",
    _SITES,
    (
        Coefficient("level", "{e}", "friction at high speed", _force),
        Coefficient("excess", "{e}", "static beyond kinetic level", lambda s: 0.05 * s.effort),
        _SPEED,
        Coefficient(
            "stiffness",
            "{e}/({q})",
            "stiffness of the bristles",
            lambda s: 10.0 * s.effort / s.displacement,
            absent=0.0,
        ),
        Coefficient(
            "damping",
            "{e}/({f})",
            "damping of the bristles",
            lambda s: 0.1 * s.effort / s.flow,
            absent=0.0,
        ),
        Coefficient(
            "viscous", "{e}/({f})", "viscous drag", lambda s: 0.01 * s.effort / s.flow, absent=0.0
        ),
    ),
    {
        "slip": sympy.Abs(FLOW)
        * MEMORY
        * sympy.Symbol("stiffness", nonnegative=True)
        / (
            sympy.Symbol("level", positive=True)
            + sympy.Symbol("excess", positive=True) * sympy.exp(-((FLOW / _SPEED.symbol) ** 2))
        )
    },
    _bristles,
    "bristles that bend and slip: rising static friction, lag, presliding",
    "Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE Trans. Autom. Control 40 (1995) 419-425",
    domains=MECHANICAL,
    shapes=(_bristle(0.005), _bristle(0.02), _bristle(0.1)),
    states=("deflection of the bristles",),
    # bristles that damp by a constant may give energy back at high speed: Barahona, Canudas de Wit
    passive=False,
    limits=("stribeck_friction",),
)
DRAG = Effect(
    "quadratic_drag",
    _SITES,
    (
        Coefficient(
            "drag",
            "{e}/({f})^2",
            "quadratic drag",
            lambda s: 0.1 * s.effort / s.flow**2,
            absent=0.0,
            linear=True,
        ),
    ),
    {"effort": sympy.Symbol("drag", nonnegative=True) * FLOW * sympy.Abs(FLOW)},
    resistor,
    "effort in proportion to the square of flow: turbulence, air",
    "White, Fluid Mechanics, ch. 6 and 7",
    domains=("translation", "rotation", "hydraulic"),
    features=(Feature("f|f|", lambda s: s.flow * numpy.abs(s.flow)),),
)
FRICTION = (VISCOUS, COULOMB, STRIBECK, LUGRE, DRAG)
