"""Springs, stops and hysteresis: what depends on a displacement."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy
import sympy

from ...elements import TF, C, EndStop, Integrator, One, R, Zero
from .builders import begins, spring
from .features import Array, Feature, Shape, Signals, over, stop
from .place import Change, Place
from .places import BOND, EFFORT_JUNCTION, FLOW_JUNCTION, FLOW_PAIR, MECHANICAL, POWER
from .value import DISPLACEMENT, FLOW, MEMORY, Coefficient, Effect

_SITES = (FLOW_JUNCTION, FLOW_PAIR)
_HALF = sympy.Rational(1, 2)
_POSITION = ("displacement of the site",)
_STIFFNESS = Coefficient(
    "stiffness",
    "{e}/({q})",
    "stiffness",
    lambda s: 0.1 * s.effort / s.displacement,
    absent=0.0,
    linear=True,
    signed=False,
)
_WIDTH = Coefficient("width", "{q}", "half width", lambda s: 0.2 * s.displacement)
_K, _W = _STIFFNESS.symbol, _WIDTH.symbol

LINEAR = Effect(
    "linear_stiffness",
    _SITES,
    (_STIFFNESS,),
    {"energy": _K * DISPLACEMENT**2 / 2},
    spring,
    "effort in proportion to displacement",
    "Karnopp, Margolis, Rosenberg, System Dynamics, ch. 3",
    domains=POWER,
    shapes=(
        Shape(
            (Feature("q", lambda s: s.displacement),),
            lambda a, s: {"stiffness": a[0]},
            floating=True,
        ),
    ),
    states=_POSITION,
)
_CUBIC = Coefficient(
    "cubic",
    "{e}/({q})^3",
    "effort over the cube of displacement",
    lambda s: 0.1 * s.effort / s.displacement**3,
    absent=0.0,
    linear=True,
    signed=True,  # a softening spring is physical; it is passive where the whole stays stiff
)
CUBIC = Effect(
    "cubic_stiffness",
    _SITES,
    (_CUBIC,),
    {"energy": _CUBIC.symbol * DISPLACEMENT**4 / 4},
    spring,
    "a spring that hardens or softens",
    "Nayfeh, Mook, Nonlinear Oscillations, ch. 4",
    domains=POWER,
    features=(Feature("q^3", lambda s: s.displacement**3),),
    states=_POSITION,
)


def _beyond(share: float) -> Shape:
    return Shape(
        (Feature(f"q beyond {share:g}Q", lambda s: over(s.displacement, share * s.stroke)),),
        lambda a, s: {"stiffness": a[0], "width": share * s.stroke},
    )


DEAD_ZONE = Effect(
    "dead_zone",
    _SITES,
    (_STIFFNESS, _WIDTH),
    {"effort": _K * (sympy.Max(DISPLACEMENT - _W, 0) - sympy.Max(-DISPLACEMENT - _W, 0))},
    lambda place, law, symbols: _slack(place, law),
    "a spring that acts beyond a clearance",
    "Nordin, Gutman, Automatica 38 (2002) 1633-1649",
    domains=MECHANICAL,
    shapes=tuple(map(_beyond, (0.1, 0.25, 0.5, 0.75))),
    states=_POSITION,
    limits=("linear_stiffness",),
)


def _slack(place: Place, law: Mapping[str, sympy.Expr]) -> Change:
    element = C(
        place.name,
        effort=lambda q: law["effort"].xreplace({DISPLACEMENT: q}),
        initial=place.initial(place.displacement),
    )
    return Change((place.node >> element,), starts=begins(element.q, place))


def _stopped(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    """Bond one stop for each direction; a 1-junction holds the speed that closes the gaps."""
    assert place.flow is not None
    way = Integrator(f"{place.name}_way", place.flow, initial=place.initial(place.displacement))
    share, rest = symbols["restitution"], symbols["rest"]
    upper = EndStop(
        place.name,
        gap=law["upper gap"].xreplace({DISPLACEMENT: way.y}),
        restitution=share,
        rest=rest,
    )
    lower = EndStop(
        f"{place.name}_lower",
        gap=law["lower gap"].xreplace({DISPLACEMENT: way.y}),
        restitution=share,
        rest=rest,
    )
    node, bonds = place.node, []
    if isinstance(node, Zero):
        node = One(f"{place.name}_speed")
        bonds = [place.node >> node]
    turned = TF(f"{place.name}_turned", -1)
    bonds += [node >> upper, node >> turned >> lower]
    return Change(tuple(bonds), (way,), starts=begins(way.y, place))


_SIDES = ("both", "upper", "lower")


def _pressed(signals: Signals, edge: float, side: int) -> Array:
    """Return how fast a stop is run into: an impact takes the speed that is left at the edge."""
    there = side * (signals.displacement - edge) > 0
    return numpy.asarray(side * numpy.maximum(side * signals.flow, 0.0) * there)


def _pushed(share: float, sides: str) -> Shape:
    """Stops that are met near the ends of the way; far away on a side where there is none."""

    def features() -> Iterable[Feature]:
        if sides != "lower":
            yield Feature(f"q above {share:g}", lambda s: _pressed(s, s.reach[1] * share, 1))
        if sides != "upper":
            yield Feature(f"q below {share:g}", lambda s: _pressed(s, s.reach[0] * share, -1))

    def starts(amounts: Sequence[float], signals: Signals) -> dict[str, float]:
        low, high = signals.reach
        far = 10 * signals.stroke
        upper = high if sides != "lower" else far + high
        lower = -low if sides != "upper" else far - low
        tiny = 1e-3 * signals.stroke
        return {"upper": max(upper, tiny), "lower": max(lower, tiny), "rest": 0.02 * signals.speed}

    return Shape(tuple(features()), starts)


END_STOP = Effect(
    "end_stop",
    (FLOW_JUNCTION,),
    (
        Coefficient(
            "upper", "{q}", "way to the upper stop", lambda s: 0.8 * s.displacement, numpy.inf
        ),
        Coefficient(
            "lower", "{q}", "way to the lower stop", lambda s: 0.8 * s.displacement, numpy.inf
        ),
        Coefficient("restitution", "", "speed after over speed before an impact", lambda s: 0.5),
        Coefficient(
            "rest",
            "{f}",
            "speed up to which an impact has no rebound",
            lambda s: 0.02 * s.flow,
            numerical=True,
        ),
    ),
    {
        "upper gap": sympy.Symbol("upper", positive=True) - DISPLACEMENT,
        "lower gap": sympy.Symbol("lower", positive=True) + DISPLACEMENT,
    },
    _stopped,
    "rigid stops on either side, with Newton's restitution",
    "Brogliato, Nonsmooth Mechanics, 3rd ed., ch. 1",
    domains=MECHANICAL,
    shapes=tuple(_pushed(share, sides) for share in (0.7, 0.85, 0.95) for sides in _SIDES),
    states=_POSITION,
    events=True,
    impacts=True,
)


def _hysteretic(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    """Bond a spring in series with a slider, which yields only while it is loaded further."""
    root = place.node if isinstance(place.node, Zero) else Zero(f"{place.name}_root")
    store = C(f"{place.name}_spring", stiffness=symbols["level"] / symbols["width"])
    slip = law["slip"].xreplace({FLOW: place.flow, MEMORY: store.q})
    slider = R(place.name, flow=lambda effort: slip)
    joint = () if root is place.node else (place.node >> root,)
    return Change((*joint, root >> (slider, store)))


_LEVEL = Coefficient(
    "level", "{e}", "effort when it yields", lambda s: 0.1 * s.effort, absent=0.0, linear=True
)


def _yielding(share: float) -> Shape:
    return Shape(
        (
            Feature(
                f"stop({share:g})",
                lambda s: stop(s.displacement, share * s.stroke) / (share * s.stroke),
                memory=True,
            ),
        ),
        lambda a, s: {"level": a[0], "width": share * s.stroke},
        turning=True,
    )


HYSTERESIS = Effect(
    "hysteresis",
    _SITES,
    (_LEVEL, Coefficient("width", "{q}", "displacement of yield", lambda s: 0.2 * s.displacement)),
    {"slip": (sympy.Abs(FLOW) * MEMORY * sympy.Abs(MEMORY) + FLOW * MEMORY**2) * _HALF / _W**2},
    _hysteretic,
    "Bouc-Wen with exponent 2 and equal shares: elastic on unloading, yields on loading",
    "Ikhouane, Rodellar, Systems with Hysteresis, Wiley 2007",
    domains=MECHANICAL,
    shapes=tuple(map(_yielding, (0.05, 0.15, 0.3, 0.6))),
    states=("elongation of the hysteretic spring",),
    limits=("coulomb_friction",),
)


def _coupled(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    link = One(f"{place.name}_link")
    store = C(place.name, stiffness=symbols["stiffness"])
    loss = R(f"{place.name}_damper", effort=lambda f: symbols["damping"] * f)
    return Change((place.node >> link, link >> (store, loss)))


COUPLING = Effect(
    "compliant_coupling",
    (BOND, EFFORT_JUNCTION),
    (
        Coefficient(
            "stiffness",
            "{e}/({q})",
            "stiffness of the coupling",
            lambda s: 10 * s.effort / s.displacement,
            absent=numpy.inf,
        ),
        Coefficient(
            "damping", "{e}/({f})", "damping of the coupling", lambda s: 0.1 * s.effort / s.flow
        ),
    ),
    {
        "effort": sympy.Symbol("stiffness", positive=True) * DISPLACEMENT
        + sympy.Symbol("damping", positive=True) * FLOW
    },
    _coupled,
    "what was rigid yields: spring and damper inside a bond",
    "Karnopp, Margolis, Rosenberg, System Dynamics, ch. 4",
    domains=POWER,
    shapes=(
        Shape(
            (Feature("de/dt", lambda s: s.effort, rate=True),),
            lambda a, s: {
                "stiffness": 1 / max(a[0], 1e-300),
                "damping": 1e-3 * float(numpy.median(numpy.diff(s.t))) / max(a[0], 1e-300),
            },
        ),
    ),
    states=("elongation of the coupling",),
)
_SINE, _COSINE = (
    Coefficient(
        name, "{e}", f"{name} part", lambda s: 0.1 * s.effort, absent=0.0, linear=True, signed=True
    )
    for name in ("sine", "cosine")
)
_ORDER = Coefficient("order", "1/({q})", "waves per displacement, times 2 pi", lambda s: 1.0)


def _wave(order: Callable[[Signals], float], name: str) -> Shape:
    return Shape(
        (
            Feature(f"sin({name} q)", lambda s: numpy.sin(order(s) * s.displacement)),
            Feature(f"cos({name} q)", lambda s: numpy.cos(order(s) * s.displacement)),
        ),
        lambda a, s: {"sine": a[0], "cosine": a[1], "order": order(s)},
        signed=True,
    )


def _turns(count: float) -> Shape:
    """Waves per radian: whole ones of a turning shaft."""
    return _wave(lambda s: count, f"{count:g}")


def _lengths(count: float) -> Shape:
    """Waves over the whole way, of which a place knows no unit."""
    return _wave(lambda s: numpy.pi * count / s.stroke, f"{count:g} waves")


RUN_OUT = Effect(
    "run_out",
    (FLOW_JUNCTION,),
    (_SINE, _COSINE, _ORDER),
    {
        "energy": (
            _SINE.symbol * (1 - sympy.cos(_ORDER.symbol * DISPLACEMENT))
            + _COSINE.symbol * sympy.sin(_ORDER.symbol * DISPLACEMENT)
        )
        / _ORDER.symbol
    },
    spring,
    "an effort that repeats with the angle: eccentricity, cogging, thickness variation",
    "Hanselman, Brushless Permanent Magnet Motor Design, ch. 4 (cogging)",
    domains=MECHANICAL,
    shapes=(*map(_turns, (1, 2, 3, 4, 6, 8, 12, 24)), *map(_lengths, (1, 2, 4, 8, 16))),
    states=_POSITION,
    periodic=True,
)
SPRINGS = (LINEAR, CUBIC, DEAD_ZONE, END_STOP, HYSTERESIS, COUPLING, RUN_OUT)
