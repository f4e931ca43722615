"""Inputs over time as every integrator takes them: knots, and a cubic after each."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...errors import SimulationError

Array = np.ndarray

# Pieces meet but for so much of an input's range; more is a jump.
SEAM = 1e-9


@dataclass(frozen=True, eq=False)
class InputTable:
    """Inputs over time: values at knots, kept or joined by straight lines or cubics in between.

    Parameters
    ----------
    knots : (nk,) array, increasing
        Times. Before the first and after the last, the inputs are constant; one knot is a constant.
    values : (nk, m) array
        The inputs at the knots.
    hold : (m,) sequence of 0, 1 or 2
        0 keeps a value until the next knot, 1 interpolates linearly, 2 follows `cubics`.
    cubics : (nk, 3, m) array, optional
        What s, s^2 and s^3 are multiplied by, s the time since a knot; read where hold is 2.

    Attributes
    ----------
    shapes : (nk, 3, m) array
        The same of all inputs; zero after the last knot.
    jumps : (nk,) array of int8
        Whether an input jumps at a knot.
    """

    knots: Array
    values: Array
    hold: Array
    cubics: Array | None = None
    shapes: Array = field(init=False)
    jumps: Array = field(init=False)

    def __post_init__(self) -> None:
        knots, values = _doubles(self.knots), _doubles(self.values)
        hold = np.ascontiguousarray(self.hold, dtype=np.int8)
        if knots.ndim != 1 or len(knots) == 0 or values.shape != (len(knots), len(hold)):
            raise SimulationError(
                f"an input table of {len(hold)} channels needs (nk,) knots and (nk, {len(hold)}) "
                f"values, not {knots.shape} and {values.shape}"
            )
        if not np.isfinite(knots).all() or not (np.diff(knots) > 0).all():
            raise SimulationError("the times of an input table must be finite and increase")
        if not np.isfinite(values).all():
            raise SimulationError("an input table must hold finite values")
        if not np.isin(hold, (0, 1, 2)).all():
            raise SimulationError("the hold of an input is 0 (zero order), 1 (linear) or 2 (cubic)")
        shape = (len(knots), 3, len(hold))
        cubics = _doubles(np.zeros(0) if self.cubics is None else self.cubics)
        if (hold == 2).any() and (cubics.shape != shape or not np.isfinite(cubics).all()):
            raise SimulationError(f"cubic inputs need finite coefficients of shape {shape}")
        shapes = _shapes(knots, values, hold, cubics)
        object.__setattr__(self, "shapes", shapes)
        object.__setattr__(self, "jumps", _jumps(knots, values, hold, shapes))
        object.__setattr__(self, "knots", knots)
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "hold", hold)


def _shapes(knots: Array, values: Array, hold: Array, cubics: Array) -> Array:
    """Coefficients of s, s^2 and s^3 between knots."""
    shapes = np.zeros((len(knots), 3, len(hold)))
    if len(knots) == 1:
        return shapes
    rises = np.diff(values, axis=0) / np.diff(knots)[:, None]
    shapes[:-1, 0] = np.where(hold == 1, rises, 0.0)
    if (hold == 2).any():
        shapes[:-1] = np.where(hold == 2, cubics[:-1], shapes[:-1])
    return shapes


def _jumps(knots: Array, values: Array, hold: Array, shapes: Array) -> Array:
    """Where an input is not what it was just before."""
    jumps = np.zeros(len(knots), dtype=np.int8)
    if len(knots) == 1:
        return jumps
    stepped = (hold == 0) & (values[1:] != values[:-1])
    if (hold == 2).any():
        s = np.diff(knots)[:, None]
        slope, bend, twist = (shapes[:-1, i] for i in range(3))
        rest = values[:-1] + s * (slope + s * (bend + s * twist)) - values[1:]
        stepped |= (hold == 2) & (np.abs(rest) > SEAM * np.ptp(values, axis=0))
    jumps[1:] = stepped.any(axis=1)
    return jumps


def _doubles(values: Any) -> Array:
    return np.ascontiguousarray(values, dtype=float)
