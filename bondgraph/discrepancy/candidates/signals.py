"""Biases, limits and delays at sources and sensors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy
import sympy

from ...elements import Lag
from ...graph import TIME
from .builders import resourced, source
from .features import Feature, Shape, Signals, over
from .place import Change, Place
from .places import FLOW_JUNCTION, FLOW_PAIR, OUTPUT, POWER, SOURCE
from .value import SIGNAL, Coefficient, Effect

DELAY_SECTIONS = 4  # all-pass, each Pade (1, 1) of its part of the delay; even: no change of sign


def said(place: Place, signal: sympy.Expr, **more: object) -> Change:
    """Return the change in which a source gives, or an output says, another signal."""
    if place.element is None:
        return Change(signal=signal, **more)  # type: ignore[arg-type]
    replaced = {place.element: resourced(place.element, signal)}
    return Change(replaced=replaced, **more)  # type: ignore[arg-type]


def _static(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    assert place.signal is not None
    return said(place, law["signal"].xreplace({SIGNAL: place.signal}))


def _delayed(
    place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
) -> Change:
    """Chain first-order all-pass sections, ``(1 - a s) / (1 + a s) = 2 / (1 + a s) - 1``."""
    assert place.signal is not None
    signal, blocks = place.signal, []
    start = place.initial(signal.xreplace({TIME: sympy.S.Zero}))
    starts = {}
    for number in range(1, DELAY_SECTIONS + 1):
        constant = symbols["delay"] / (2 * DELAY_SECTIONS)
        lag = Lag(f"{place.name}_{number}", signal, constant, initial=start)
        blocks.append(lag)
        starts[lag.y] = place.signal
        signal = 2 * lag.y - signal
    return said(place, signal, blocks=tuple(blocks), starts=starts)


_EFFORT = Coefficient(
    "effort", "{e}", "constant effort on the site", lambda s: 0.1 * s.effort, 0.0, True, True
)
EFFORT_BIAS = Effect(
    "effort_bias",
    (FLOW_JUNCTION, FLOW_PAIR),
    (_EFFORT,),
    {"effort": _EFFORT.symbol},
    source,
    "a constant effort that was not counted",
    "Karnopp, Margolis, Rosenberg, System Dynamics, ch. 3",
    domains=POWER,
    features=(Feature("-1", lambda s: -numpy.ones_like(s.t)),),
    passive=False,
)
_OFFSET = Coefficient("offset", "{u}", "added to what is said", lambda s: 0.0, 0.0, True, True)
SENSOR_BIAS = Effect(
    "sensor_bias",
    (OUTPUT,),
    (_OFFSET,),
    {"signal": SIGNAL + _OFFSET.symbol},
    _static,
    "a sensor's offset",
    "Doebelin, Measurement Systems, ch. 3",
    features=(Feature("1", lambda s: numpy.ones_like(s.t)),),
)
_LIMIT = Coefficient(
    "limit", "{u}", "largest magnitude", lambda s: 0.8 * s.effort, absent=numpy.inf
)


def _capped(share: float) -> Shape:
    def limit(signals: Signals) -> float:
        return share * max(map(abs, signals.efforts))

    return Shape(
        (Feature(f"-u beyond {share:g}", lambda s: -over(s.effort, limit(s))),),
        lambda a, s: {"limit": limit(s)},
    )


SATURATION = Effect(
    "saturation",
    (SOURCE, OUTPUT),
    (_LIMIT,),
    {"signal": sympy.Max(-_LIMIT.symbol, sympy.Min(_LIMIT.symbol, SIGNAL))},
    _static,
    "a source or a sensor that gives no more",
    "Khalil, Nonlinear Systems, 3rd ed., ch. 1",
    shapes=tuple(map(_capped, (0.5, 0.7, 0.85, 0.95))),
)
DELAY = Effect(
    "transport_delay",
    (SOURCE, OUTPUT),
    (Coefficient("delay", "s", "delay", lambda s: 0.01 * s.duration, absent=0.0),),
    {"signal": SIGNAL},
    _delayed,
    "what is given or said comes late; four all-pass sections, Pade (1, 1) each",
    "Franklin, Powell, Emami-Naeini, Feedback Control of Dynamic Systems, ch. 5",
    features=(Feature("-du/dt", lambda s: -s.effort_rate, memory=True),),
    states=tuple(f"section {number + 1} of the delay" for number in range(DELAY_SECTIONS)),
)
SIGNALS = (EFFORT_BIAS, SENSOR_BIAS, SATURATION, DELAY)
