"""Where runs begin: the model's own start, pushes of the steady state, held contacts, rest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy

from ..elements import DryFriction, I
from ..errors import BondGraphError
from .bench import Bench
from .pushes import SMALL, Push
from .rest import Rest

Array = numpy.ndarray

ITERATIONS = 8


def starts_of(
    bench: Bench,
    values: Mapping[str, float],
    rest: Rest | None,
    along: tuple[Push, ...],
    given: Mapping[str, Mapping[Any, float]] | None,
) -> dict[str, Array]:
    """Return starts by name, the model's own first.

    Parameters
    ----------
    bench : Bench
    values : mapping of str to float
        All parameters.
    rest : Rest or None
    along : tuple of Push
    given : mapping of str to mapping, optional
        Further starts by name: states to numbers, others as at the model's own start.

    Returns
    -------
    dict of str to (n,) array
    """
    own = bench.start(values)
    found = {"own": own}
    for name, states in (given or {}).items():
        found[name] = bench.start(values, states)
    if rest is None:
        return found
    for push in along:
        for word, size in push.sizes():
            signs = {"": 1.0} if push.pole.imag else {"": 1.0, " backwards": -1.0}
            for direction, sign in signs.items():
                try:
                    x = rest.at(push.change(size, sign))
                except BondGraphError:
                    continue
                found[f"{push.label} {word}{direction}"] = x
    for name, point in (("held", held(bench, values, rest)), ("at rest", still(bench, rest))):
        if point is not None:
            found[name] = point
    return {name: x for name, x in found.items() if numpy.isfinite(x).all()}


def off_rest(x: Array, rest: Rest | None, along: tuple[Push, ...]) -> Array:
    """Return a start, pushed slightly where it is a steady state that is not stable.

    A run would stay there for ever.

    Parameters
    ----------
    x : (n,) array
    rest : Rest or None
    along : tuple of Push
        Its pushes, the fastest growing first.

    Returns
    -------
    (n,) array
        The same array where it is none.
    """
    if rest is None or rest.growth < 0 or not along:
        return x
    first = along[0]
    reach = first.scale * float(numpy.abs(first.vector).max())
    size = numpy.maximum(numpy.abs(rest.vector), reach)
    if (numpy.abs(x - rest.vector) > 1e-9 * size).any():
        return x
    return rest.at(first.change(SMALL * first.scale))


def still(bench: Bench, rest: Rest) -> Array | None:
    """Return the steady state with every momentum gone; None where it has none."""
    momenta = {f"{name}.p" for name, _ in bench.graph.of(I)}
    x = rest.vector
    stopped = numpy.array([0.0 if n in momenta else v for n, v in zip(bench.names, x, strict=True)])
    return None if (stopped == x).all() else stopped


def held(bench: Bench, values: Mapping[str, float], rest: Rest) -> Array | None:
    """Return the steady state with its sliding contacts seized, as by a blow between the two sides.

    Of all states without slip it is the nearest in energy, as where momentum is kept.

    Parameters
    ----------
    bench : Bench
    values : mapping of str to float
    rest : Rest

    Returns
    -------
    (n,) array or None
        None where nothing slides.
    """
    sliding = [
        name
        for name, element in bench.graph.of(DryFriction)
        if name in rest.modes and element.code(rest.modes[name])
    ]
    order = len(rest.chart.states)
    if not sliding or not order:
        return None
    whole = dict(zip(bench.names, bench.scales(values, rest.vector), strict=True))
    weights = numpy.array([whole.get(name, 0.0) for name in rest.chart.states])
    x = rest.x.copy()
    for _ in range(ITERATIONS):
        slips = _slips(rest, x, sliding)
        if numpy.abs(slips).max() == 0:
            break
        slopes = numpy.empty((len(sliding), order))
        for column in range(order):
            step = 1e-6 * (weights[column] or 1.0)
            ahead = x.copy()
            ahead[column] += step
            slopes[:, column] = (_slips(rest, ahead, sliding) - slips) / step
        scaled = slopes * weights
        try:
            x[:order] -= weights * numpy.linalg.lstsq(scaled, slips, rcond=1e-10)[0]
            x[:order] = x[:order]
        except numpy.linalg.LinAlgError:
            return None
        if not numpy.isfinite(x).all():
            return None
    try:
        return rest.at(x[:order] - rest.x[:order])
    except BondGraphError:
        return None


def _slips(rest: Rest, x: Array, names: list[str]) -> Array:
    values = rest.chart.smooth.contact_values(x, rest.u, rest.p)
    return numpy.array([values[name].flow for name in names])
