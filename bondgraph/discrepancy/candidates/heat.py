"""Fade: friction that falls with the heat it has made."""

from __future__ import annotations

from collections.abc import Mapping

import numpy
import sympy

from ...elements import Block
from .builders import weakened
from .features import Array, Feature, Shape, Signals, lagged
from .place import Change, Place
from .places import DISSIPATOR, MECHANICAL
from .value import MEMORY, SIGNAL, Coefficient, Effect

_FADE = Coefficient(
    "fade",
    "1/J",
    "falling share over heat",
    lambda s: 0.1 / (s.effort * s.flow * s.duration),
    absent=0.0,
    linear=True,
)
_COOLING = Coefficient("cooling", "1/s", "rate at which heat is lost", lambda s: 0.1 / s.duration)


def _faded(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    old = place.element
    heat = Block(f"{place.name}_heat", rate=lambda y: old.e * old.f - symbols["cooling"] * y)

    share = law["signal"].xreplace({SIGNAL: sympy.S.One, MEMORY: heat.y})
    return Change(replaced={old: weakened(old, share)}, blocks=(heat,))


def _heat(signals: Signals) -> Array:
    power = signals.effort * signals.flow
    steps = numpy.diff(signals.t) * (power[1:] + power[:-1]) / 2
    return numpy.asarray(numpy.concatenate([[0.0], numpy.cumsum(steps)]))


def _heated(share: float) -> Shape:
    """Heat that leaves within a share of the time; all of it stays where that is infinite."""

    def heat(signals: Signals) -> Array:
        if share == numpy.inf:
            return _heat(signals)
        constant = share * signals.duration
        return constant * lagged(signals.t, signals.effort * signals.flow, constant, 0.0)

    return Shape(
        (Feature(f"heat ({share:g})", heat, memory=True),),
        lambda a, s: {"fade": a[0], "cooling": 1 / (min(share, 10.0) * s.duration)},
    )


FADE = Effect(
    "thermal_fade",
    (DISSIPATOR,),
    (_FADE, _COOLING),
    {"signal": SIGNAL * sympy.exp(-_FADE.symbol * MEMORY)},
    _faded,
    "a brake or damper that weakens with the heat it has made",
    "Limpert, Brake Design and Safety, 3rd ed., ch. 4",
    domains=MECHANICAL,
    shapes=tuple(map(_heated, (0.03, 0.1, 0.3, numpy.inf))),
    states=("heat that has not left yet",),
)
HEAT = (FADE,)
