"""Damping table: each pole as a named row, and which elements take part in it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy

from .balance import largest_first

# Elements named as carrying a mode take part at least this much as the one that carries most.
DOMINANT = 0.5


@dataclass(frozen=True)
class DampingRow:
    """One pole.

    Attributes
    ----------
    pole : complex
        1/s.
    carriers : dict of str to float
        Participation of each element, largest first; they add up to one.

    Examples
    --------
    >>> row = DampingRow(complex(-3, 4), {"m": 0.5, "k": 0.5})
    >>> row.natural_frequency, row.damping_ratio, row.elements
    (5.0, 0.6, ('m', 'k'))
    """

    pole: complex
    carriers: dict[str, float]

    @property
    def natural_frequency(self) -> float:
        """Undamped natural frequency, rad/s."""
        return abs(self.pole)

    @property
    def frequency_hz(self) -> float:
        """Frequency of the oscillation, Hz; zero for a real pole."""
        return abs(self.pole.imag) / (2 * math.pi)

    @property
    def damping_ratio(self) -> float | None:
        """Damping ratio; negative where growing, None for a pole at zero."""
        size = abs(self.pole)
        return -self.pole.real / size if size else None

    @property
    def time_constant(self) -> float:
        """Time in which the amplitude changes by a factor e, s; infinite on the imaginary axis."""
        return 1 / abs(self.pole.real) if self.pole.real else math.inf

    @property
    def elements(self) -> tuple[str, ...]:
        """Elements that carry the mode, largest first."""
        return dominant(self.carriers)


def dominant(carriers: Mapping[str, float]) -> tuple[str, ...]:
    """Return the elements that take part at least half as much as the first.

    Examples
    --------
    >>> dominant({"a": 0.6, "b": 0.35, "c": 0.05})
    ('a', 'b')
    """
    largest = max(carriers.values(), default=0.0)
    return tuple(name for name, share in carriers.items() if share >= DOMINANT * largest > 0)


def damping_rows(
    states: tuple[str, ...], poles: numpy.ndarray, shares: numpy.ndarray
) -> tuple[DampingRow, ...]:
    """Return a row for each pole.

    Parameters
    ----------
    states : tuple of str
    poles : (n,) complex array
    shares : (n, n) array
        Participation: row state, column pole.

    Returns
    -------
    tuple of DampingRow
    """
    return tuple(
        DampingRow(complex(pole), by_element(states, shares[:, column]))
        for column, pole in enumerate(poles)
    )


def by_element(states: tuple[str, ...], shares: numpy.ndarray) -> dict[str, float]:
    """Sum the shares of the states of each element, largest first.

    Parameters
    ----------
    states : tuple of str
    shares : (n,) array

    Returns
    -------
    dict of str to float

    Examples
    --------
    >>> by_element(("m.p", "k.q"), numpy.array([0.25, 0.75]))
    {'k': 0.75, 'm': 0.25}
    """
    totals: dict[str, float] = {}
    for state, share in zip(states, shares, strict=True):
        name = state.rpartition(".")[0] or state
        totals[name] = totals.get(name, 0.0) + float(share)
    return largest_first(totals)
