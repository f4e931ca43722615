"""Pushes of a steady state along its modes: how large, and which way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy

from ..elements import EndStop
from ..errors import ParameterError
from ..parameters import unknown_name
from .rest import FREE, Rest

Array = numpy.ndarray

MOST_MODES = 6
SMALL = 0.02
# Amplitudes looked at in each decade, and phases of each.
EACH_DECADE, PHASES = 6, 16
# Where the rates are this much off the linear ones the search for cycles begins and ends.
FIRST, LAST = 1e-5, 10.0
MOST_CROSSINGS = 4
# Beside the eigenvalue: growth of less than this is none.
ROUNDING = 1e-7


@dataclass(frozen=True, eq=False)
class Push:
    """A direction to push a steady state in, and sizes that mean something.

    Attributes
    ----------
    label : str
    pole : complex
    vector : (n,) complex array
        Eigenvector in the chart's states, turned so that its real part pushes at the nearest
        contact, or is as it comes where there is none.
    contact : str or None
        That a growing push changes the mode of first.
    touch : float
        Size of the push at which it does; inf where there is none.
    crossings : tuple of (float, bool)
        Sizes at which the growth averaged over a period changes its sign, and whether it falls
        there, as it does at a cycle that attracts.
    scale : float
        Size of a push that is neither small nor large.
    """

    label: str
    pole: complex
    vector: Array
    contact: str | None
    touch: float
    crossings: tuple[tuple[float, bool], ...]
    scale: float

    def change(self, size: float, sign: float = 1.0) -> Array:
        """Return the change of the chart's states."""
        return size * sign * self.vector.real

    def sizes(self) -> list[tuple[str, float]]:
        """Return sizes to begin runs with, each with a word for it."""
        found = [("slightly", SMALL * self.scale)]
        if numpy.isfinite(self.touch):
            found += [
                (f"to {self.contact}", self.touch),
                (f"past {self.contact}", 2.5 * self.touch),
            ]
        falls = [size for size, falling in self.crossings if falling]
        found += [(f"to a cycle {i + 1}" if i else "to a cycle", s) for i, s in enumerate(falls)]
        if self.crossings and not self.crossings[-1][1]:
            found += [("far", 1.5 * self.crossings[-1][0])]
        elif not numpy.isfinite(self.touch) and not falls:
            found += [("far", self.scale)]
        return found


def pushes(rest: Rest, own: Array, sizes: Array) -> tuple[Push, ...]:
    """Return pushes along the modes of a steady state, the least damped ones first.

    Parameters
    ----------
    rest : Rest
    own : (n,) array
        The model's own start, for a size where nothing else tells one.
    sizes : (n,) array
        Of the model's states: what of the steady state is smaller is rounding.

    Returns
    -------
    tuple of Push
        Along each oscillation, and each real mode that grows; along the slowest mode where there
        are none of either.
    """
    poles = rest.poles
    largest = numpy.abs(poles).max(initial=0.0)
    here = [i for i, pole in enumerate(poles) if abs(pole) > FREE * largest]
    chosen = [i for i in here if poles[i].imag > 0 or (poles[i].imag == 0 and poles[i].real > 0)]
    if not chosen:
        chosen = here[:1]
    chosen.sort(key=lambda i: -poles[i].real / abs(poles[i]))
    base = _without_rounding(rest, sizes)
    return tuple(_push(rest, i, own, base) for i in chosen[:MOST_MODES])


def push_along(rest: Rest, direction: Mapping[str, float], own: Array, sizes: Array) -> Push:
    """Return the push along a given direction; one of size 1 changes states by what is given.

    Parameters
    ----------
    rest : Rest
    direction : mapping of str to float
        Changes of states by name.
    own, sizes : (n,) arrays
        As for `pushes`.

    Returns
    -------
    Push

    Raises
    ------
    ParameterError
        For a state that there is not, and a direction without any.
    """
    names = list(rest.chart.states)
    vector = numpy.zeros(len(names))
    for name, amount in direction.items():
        if name not in names:
            raise unknown_name("state", name, names)
        vector[names.index(name)] = float(amount)
    if not vector.any() or not numpy.isfinite(vector).all():
        raise ParameterError(
            f"a push along {dict(direction)} goes nowhere; give states with numbers that are not zero"
        )
    contact, touch, turn = _nearest(rest, vector.astype(complex), 0j)
    if turn.real < 0:  # this way it leaves the contact
        contact, touch = None, numpy.inf
    unit = _unit(_without_rounding(rest, sizes), vector)
    scale = min(touch, _typical(rest, vector, own, (numpy.inf, unit)))
    label = ", ".join(direction)
    return Push(label, 0j, vector.astype(complex), contact, touch, (), scale)


def _without_rounding(rest: Rest, sizes: Array) -> Array:
    """Return how large the chart's states are at rest, zero where that is rounding."""
    size = dict(zip(rest.states, sizes, strict=True))
    base = numpy.array([rest.states.get(name, 0.0) for name in rest.chart.states])
    least = numpy.array([size.get(name, 0.0) for name in rest.chart.states])
    return numpy.where(numpy.abs(base) < 0.999 * least, 0.0, numpy.abs(base))


def _push(rest: Rest, index: int, own: Array, base: Array) -> Push:
    pole, vector = complex(rest.poles[index]), rest.shapes[:, index]
    # as they come, eigenvectors have any phase: here the state moved most is real
    lead = vector[numpy.argmax(numpy.abs(vector) / (base if base.all() else 1.0))]
    vector = vector * (abs(lead) / lead)
    contact, touch, turn = _nearest(rest, vector, pole)
    vector = vector * turn
    unit = _unit(base, vector)
    bent, crossings = _crossings(rest, index, vector, (unit, touch))
    scale = min(
        [touch, _typical(rest, vector, own, (bent, unit)), *(size for size, _ in crossings)]
    )
    label = f"{abs(pole.imag) / (2 * numpy.pi):.4g} Hz" if pole.imag else f"{pole.real:.4g} 1/s"
    return Push(label, pole, vector, contact, touch, crossings, scale)


def _nearest(rest: Rest, vector: Array, pole: complex) -> tuple[str | None, float, complex]:
    """Return the contact that a growing push changes first, at which size, and at which phase."""
    smooth, order = rest.chart.smooth, len(rest.chart.states)
    here = smooth.contact_values(rest.x, rest.u, rest.p)
    nearest: tuple[str | None, float, complex] = (None, numpy.inf, 1.0)
    for name, values in here.items():
        place = list(values.element.modes).index(rest.modes[name])
        margin = values.margins[place]
        if not margin > 0 or not numpy.isfinite(margin):
            continue

        def slope(part: Array, name: str = name, place: int = place) -> float:
            """Return how fast the margin changes along a part of the vector."""
            size = (
                1e-6
                * max(1e-3, float(numpy.abs(rest.x[:order]).max()))
                / max(float(numpy.abs(part).max()), 1e-300)
            )
            sides = []
            for sign in (1.0, -1.0):
                x = rest.x.copy()
                x[:order] += sign * size * part
                if len(x) > order:
                    found = smooth.consistent(x[:order], rest.u, rest.p, x[order:])
                    x = x if found is None else found
                sides.append(smooth.contact_values(x, rest.u, rest.p)[name].margins[place])
            return (sides[0] - sides[1]) / (2 * size)

        real = slope(vector.real) if vector.real.any() else 0.0
        imag = slope(vector.imag) if vector.imag.any() else 0.0
        along = complex(real, imag)
        if not abs(along) > 0:
            continue
        if margin / abs(along) < nearest[1]:
            turn = -along.conjugate() / abs(along)
            if isinstance(values.element, EndStop) and pole.imag:
                turn *= -1j  # a gap is no longer there beyond the stop: push at it, not into it
            nearest = (name, margin / abs(along), turn)
    return nearest


def averaged_growth(rest: Rest, index: int, vector: Array, size: float) -> tuple[float, float]:
    """Return the growth rate along a mode averaged over a period, and how far rates are off linear.

    First harmonic: along ``x + size Re(v e^(i phase))`` the rates are projected on the mode's left
    eigenvector and averaged over the phase.

    Parameters
    ----------
    rest : Rest
    index : int
        Of the mode.
    vector : (n,) complex array
        Its eigenvector, turned or not.
    size : float

    Returns
    -------
    growth : float
        1/s; nan where rates are not finite.
    off : float
        Greatest part of the rates that is not linear, beside the eigenvalue.

    References
    ----------
    Krylov, Bogoliubov, Introduction to non-linear mechanics, Princeton 1947.
    """
    smooth, order = rest.chart.smooth, len(rest.chart.states)
    lead = int(numpy.argmax(numpy.abs(rest.shapes[:, index])))
    left = rest.left[:, index] * (rest.shapes[lead, index] / vector[lead])
    pole, total, off = complex(rest.poles[index]), 0.0, 0.0
    count, share = (PHASES, 2.0) if pole.imag else (2, 1.0)
    for phase in 2 * numpy.pi * numpy.arange(count) / count:
        turn = numpy.exp(1j * phase)
        x = rest.x.copy()
        x[:order] += size * (vector * turn).real
        if len(x) > order:
            found = smooth.consistent(x[:order], rest.u, rest.p, x[order:])
            if found is None:
                return numpy.nan, numpy.nan
            x = found
        part = share * complex(left @ smooth.rates(x, rest.u, rest.p)[:order]) / (size * turn)
        total += part.real
        off = max(off, abs(part - pole) / abs(pole))
    return total / count, off


def _unit(base: Array, vector: Array) -> float:
    """Return the size at which a push is as large as the steady state; 0 where that is zero."""
    there = (base > 0) & (numpy.abs(vector) > 1e-9 * numpy.abs(vector).max())
    return float(1 / (numpy.abs(vector[there]) / base[there]).max()) if there.any() else 0.0


def _crossings(
    rest: Rest, index: int, vector: Array, bounds: tuple[float, float]
) -> tuple[float, tuple[tuple[float, bool], ...]]:
    """Return where rates are as much nonlinear as linear, and where the growth changes sign."""
    (unit, touch), largest = bounds, float(numpy.abs(vector).max())
    # smaller than these the rates of a push drown in rounding
    size = 1e-6 * unit if unit else 1e-15 / largest
    end = min(touch, 1e9 * unit if unit else 1e12 / largest)
    found: list[tuple[float, bool]] = []
    before, scale, fine = (0.0, float(rest.poles[index].real)), numpy.inf, False
    while size < end and len(found) < MOST_CROSSINGS:
        growth, off = averaged_growth(rest, index, vector, size)
        if not (numpy.isfinite(growth) and numpy.isfinite(off)):
            break
        if off > FIRST and not fine:
            fine, size = True, size / 10.0
            continue
        if abs(growth) < ROUNDING * abs(rest.poles[index]):
            growth = 0.0
        if before[1] * growth < 0 and before[0] > 0:
            share = before[1] / (before[1] - growth)
            found.append((before[0] + share * (size - before[0]), bool(growth < 0)))
        if off >= 1 and not numpy.isfinite(scale):
            scale = size
        if off > LAST:
            break
        before = (size, growth) if growth else before
        size *= 10.0 ** (1 / EACH_DECADE) if fine else 10.0
    return scale, tuple(found)


def _typical(rest: Rest, vector: Array, own: Array, known: tuple[float, float]) -> float:
    """Return a size: where rates bend, or of the steady state, or of the own start beside it."""
    bent, unit = known
    if numpy.isfinite(bent):
        return bent
    if unit:
        return unit
    away = numpy.abs(own - rest.vector).max(initial=0.0)
    return float((away or 1.0) / numpy.abs(vector).max())
