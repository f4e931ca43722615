"""Jumps: a state taken into a mode whose relations it does not meet, by impulses.

What a mode holds has a value before the jump, found from the bound states themselves.
It goes to its value after in no time, and the states go with it along the directions
that the mode's own equations give. Momentum and charge are conserved by construction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ..mode_set import ModeNumbers

Array = numpy.ndarray

MOST_STEPS = 64  # along a path; a straight one takes two
TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class Jump:
    """A state after entering a mode.

    Attributes
    ----------
    x : (n + 2,) array
        With the energies supplied and dissipated so far.
    before : (k,) array
        By switch: flow or effort that the mode holds, as it was before; zero
        where nothing was to be changed.
    impulses : (k,) array
        By switch: impulse of the variable that answers.
    """

    x: Array
    before: Array
    impulses: Array

    @property
    def moved(self) -> bool:
        """Whether anything jumped."""
        return bool(numpy.any(self.before != 0))


def imposed_before(
    mode: ModeNumbers, place: tuple[Any, ...], x: Array, scale: Array
) -> Array | None:
    """Return what the mode would have to impose for the bound states to be as they are.

    Parameters
    ----------
    mode : ModeNumbers
    place : tuple
        ``(t, u, p, s)``.
    x : (n,) array
    scale : (n,) array
        Size of each state, below a part of which it counts as met.

    Returns
    -------
    (h,) array or None
        None where no imposed value explains the state.
    """
    t, u, p, s = place
    w = numpy.zeros(len(mode.held))
    if not len(mode.bound):
        return w
    allowed = scale[mode.bound]
    for _ in range(20):
        off, slope = mode.relation(t, x, u, p, s, w)
        off = off.ravel()
        if not (numpy.isfinite(off).all() and numpy.isfinite(slope).all()):
            return None
        if numpy.all(numpy.abs(off) <= TOLERANCE * allowed):
            return w
        weights = 1 / numpy.where(allowed > 0, allowed, 1.0)
        change = numpy.linalg.lstsq(slope * weights[:, None], -off * weights, rcond=1e-12)[0]
        if numpy.all(numpy.abs(slope @ change) <= 1e-12 * numpy.abs(off)):
            return None
        w = w + change
    return None


def jump(
    mode: ModeNumbers, place: tuple[Any, ...], x: Array, before: Array, after: Array, size: int
) -> Jump:
    """Move the imposed values from before to after, and the states with them.

    Parameters
    ----------
    mode : ModeNumbers
    place : tuple
        ``(t, u, p, s)``.
    x : (n + 2,) array
        State, energy supplied and energy dissipated.
    before, after : (h,) arrays
        Imposed values.
    size : int
        Number of switches.

    Returns
    -------
    Jump
    """
    path = after - before
    impulses = numpy.zeros(size)
    told = numpy.zeros(size)
    told[list(mode.held)] = before
    if numpy.any(path):
        x, impulses = _along(mode, place, x, before, path)
    return Jump(_met(mode, place, x, after), told, impulses)


def _along(
    mode: ModeNumbers, place: tuple[Any, ...], x: Array, before: Array, path: Array
) -> tuple[Array, Array]:
    """Follow the path in as many steps as it bends; return where it leads, and the impulses."""
    steps, found = 1, _stepped(mode, place, x, before, path, 1)
    while steps < MOST_STEPS:
        steps *= 2
        coarse, found = found, _stepped(mode, place, x, before, path, steps)
        change, size = numpy.abs(found[0] - coarse[0]), numpy.abs(found[0] - x)
        if not change.max() > TOLERANCE * size.max():  # or not a number: no step would mend it
            break
    return found


def _stepped(
    mode: ModeNumbers, place: tuple[Any, ...], x: Array, before: Array, path: Array, steps: int
) -> tuple[Array, Array]:
    impulses: Any = 0.0
    for step in range(steps):
        x, gained = _step(mode, place, x, before + step / steps * path, path / steps)
        impulses = impulses + gained
    return x, impulses


def _step(
    mode: ModeNumbers, place: tuple[Any, ...], x: Array, w: Array, path: Array
) -> tuple[Array, Array]:
    """One classical Runge-Kutta step along the path."""
    t, u, p, s = place

    def slope(part: float, at: Array) -> tuple[Array, Array]:
        states, answers = mode.push(t, at[:-2], u, p, s, w + part * path)
        return states @ path, answers @ path

    k1, a1 = slope(0.0, x)
    k2, a2 = slope(0.5, x + 0.5 * k1)
    k3, a3 = slope(0.5, x + 0.5 * k2)
    k4, a4 = slope(1.0, x + k3)
    return x + (k1 + 2 * k2 + 2 * k3 + k4) / 6, (a1 + 2 * a2 + 2 * a3 + a4) / 6


def _met(mode: ModeNumbers, place: tuple[Any, ...], x: Array, w: Array) -> Array:
    """Put the bound states exactly on their relations."""
    if not len(mode.bound):
        return x
    t, u, p, s = place
    off = mode.relation(t, x[:-2], u, p, s, w)[0].ravel()
    x = x.copy()
    x[mode.bound] -= off
    return x
