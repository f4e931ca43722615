"""The law that was learned, over what the data say without it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy
import sympy

from ..candidates.value import DISPLACEMENT, EFFORT, FLOW, Effect
from ..grafting import Grafted
from ..latent.linear import along
from ..latent.screen import Sketch
from .bench import Added, Trial
from .value import LearnedLaw

Array = numpy.ndarray
Law = Callable[[Array, Mapping[str, float]], Array]

POINTS = 300
GRID = 121
STEP = 1e-4

_AXES = (
    ("effort", FLOW, "flow", "effort"),
    ("kinetic", FLOW, "flow", "effort"),
    ("effort", DISPLACEMENT, "displacement", "effort"),
    ("energy", DISPLACEMENT, "displacement", "effort"),
    ("flow", EFFORT, "effort", "flow"),
)


def learned(sketch: Sketch, trial: Trial) -> tuple[LearnedLaw, ...]:
    """Return the law of each effect that is a function of one variable of its site.

    Parameters
    ----------
    sketch : Sketch
        Of the model without the effects.
    trial : Trial
        With them.

    Returns
    -------
    tuple of LearnedLaw
    """
    found = []
    for item, grafted in zip(trial.added, trial.grafts, strict=True):
        known = law_of(item.effect)
        candidate = next((c for c in sketch.columns.candidates if c.label == item.label), None)
        if known is None or candidate is None:
            continue
        across, along_, law = known
        x = getattr(candidate.signals, across)
        if not numpy.isfinite(x).all():
            continue
        values = coefficients(item, grafted, trial)
        std = {
            name: trial.fit.std.get(parameter, 0.0)
            for name, parameter in grafted.parameters.items()
        }
        grid = numpy.linspace(float(x.min()), float(x.max()), GRID)
        y = law(grid, values)
        band = numpy.zeros(GRID)
        for name, spread in std.items():
            step = STEP * (abs(values[name]) or 1.0)
            slope = (law(grid, values | {name: values[name] + step}) - y) / step
            band += numpy.where(slope == 0, 0.0, (slope * spread)) ** 2
        points = latent_points(sketch, candidate.probe, x)
        place = f"{across} at {item.site.name}"
        found.append(
            LearnedLaw(
                item.label,
                place,
                f"{along_} of {item.effect.name.replace('_', ' ')}",
                _units(item.site.domain, across, along_),
                grid,
                y,
                numpy.sqrt(band),
                points,
            )
        )
    return tuple(found)


def coefficients(item: Added, grafted: Grafted, trial: Trial) -> dict[str, float]:
    """Return the coefficients of one effect of a trial by their own names; NaN where unknown."""
    return {
        name: trial.values.get(parameter, item.starts.get(name, math.nan))
        for name, parameter in grafted.parameters.items()
    }


def law_of(effect: Effect) -> tuple[str, str, Law] | None:
    """Return what an effect's law is a function of, what it decides, and the function.

    Parameters
    ----------
    effect : Effect

    Returns
    -------
    across, along : str
        ``flow``, ``displacement`` or ``effort``.
    law : callable
        From values of across and coefficients by name to those of along.

    None where the law depends on more than one variable, or on the past.

    Examples
    --------
    >>> from bondgraph.discrepancy.candidates import EFFECTS
    >>> across, along, law = law_of(EFFECTS["cubic_stiffness"])
    >>> across, along, law(numpy.array([-2.0, 1.0]), {"cubic": 3.0}).tolist()
    ('displacement', 'effort', [-24.0, 3.0])
    """
    for key, variable, across, along_ in _AXES:
        if _is_of(effect, key, variable):
            return across, along_, _function(effect, key, variable)
    return None


def _is_of(effect: Effect, key: str, variable: sympy.Symbol) -> bool:
    law = effect.law.get(key)
    if law is None:
        return False
    ports = law.free_symbols & {FLOW, DISPLACEMENT, EFFORT}
    return ports == {variable} or (key == "kinetic" and ports <= {FLOW})


def _function(effect: Effect, key: str, variable: sympy.Symbol) -> Law:
    law = effect.law[key]
    if key == "energy":
        law = sympy.diff(law, DISPLACEMENT)
    if key == "kinetic":
        law = law.subs(FLOW, sympy.Abs(FLOW)) * sympy.sign(FLOW)
    names = list(effect.symbols)
    plain = sympy.lambdify([variable, *(effect.symbols[name] for name in names)], law, "numpy")

    def evaluate(x: Array, values: Mapping[str, float]) -> Array:
        with numpy.errstate(all="ignore"):
            return numpy.broadcast_to(plain(x, *(values[name] for name in names)), x.shape) * 1.0

    return evaluate


def latent_points(sketch: Sketch, probe: int, x: Array, count: int = POINTS) -> Array:
    """Return the effort or flow that the smoother needs at a site, averaged in parts of x.

    Parameters
    ----------
    sketch : Sketch
    probe : int
        Of the site.
    x : (nt,) array
        At all times of all courses.
    count : int
        Of the parts, each with as many times.

    Returns
    -------
    (count, 2) array
        Means of x, rising, and of the effort or flow.
    """
    found = sketch.relaxed
    used = len(found.table.used)
    amounts = []
    for course in found.courses:
        lines, before, after = along(
            found.functions,
            course.grid,
            course.x,
            found.table.vector(found.values),
            course.record.measured,
        )
        push = before.rates_p[:, :, used + probe : used + probe + 1]
        forced = lines.pushed(push, after.rates_p[:, :, used + probe : used + probe + 1])[..., 0]
        weight = 1 / numpy.maximum((lines.rates**2).mean(axis=0), 1e-300)
        size = (forced**2 * weight).sum(axis=1)
        amount = (forced * weight * lines.broken).sum(axis=1) / numpy.maximum(size, 1e-300)
        amounts.append(numpy.append(amount, amount[-1:]))
    y = numpy.concatenate(amounts)
    order = numpy.argsort(x, kind="stable")
    parts = numpy.array_split(order, min(count, len(order)))
    return numpy.array([[x[part].mean(), y[part].mean()] for part in parts])


_SI = {
    "translation": {"effort": "N", "flow": "m/s", "displacement": "m"},
    "rotation": {"effort": "N*m", "flow": "rad/s", "displacement": "rad"},
    "hydraulic": {"effort": "Pa", "flow": "m^3/s", "displacement": "m^3"},
    "electrical": {"effort": "V", "flow": "A", "displacement": "C"},
    "thermal": {"effort": "K", "flow": "W", "displacement": "J"},
}


def _units(domain: str, across: str, along_: str) -> tuple[str, str]:
    known = _SI.get(domain, {})
    return known.get(across, ""), known.get(along_, "")
