"""Modal table: what each eigenvalue is, which elements carry it and which feed it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy

from .balance import Balance
from .damping import by_element, dominant

if TYPE_CHECKING:
    from .system import LinearSystem

# Beside the fastest eigenvalue, smaller real parts are rounding noise: the mode neither grows
# nor decays.
NEUTRAL = 1e-13


@dataclass(frozen=True)
class Mode:
    """One eigenvalue and what it means.

    Attributes
    ----------
    eigenvalue : complex
        In 1/s.
    growth : int
        1 growing, -1 decaying, 0 neither.
    carriers : mapping of str to float
        Participation factors summed over each element's states, largest first;
        they add up to one.
    energies : mapping of str to float
        Share of each storage in the mode's energy, largest first; they add up
        to one. Empty where the energy is not positive or not known.
    feeds : mapping of str to float
        Contribution of each dissipator and source to the growth rate, 1/s,
        largest first: positive feeds the mode, negative drains it. They add up
        to the real part of the eigenvalue. Empty where `energies` is.

    Examples
    --------
    >>> import math
    >>> mode = Mode(complex(-3, 4), -1)
    >>> mode.damping_ratio, round(mode.frequency_hz * 2 * math.pi, 9)
    (0.6, 4.0)
    """

    eigenvalue: complex
    growth: int
    carriers: Mapping[str, float] = field(default_factory=dict)
    energies: Mapping[str, float] = field(default_factory=dict)
    feeds: Mapping[str, float] = field(default_factory=dict)

    @property
    def frequency_hz(self) -> float:
        """Frequency of the oscillation, Hz; zero for a real eigenvalue."""
        return abs(self.eigenvalue.imag) / (2 * math.pi)

    @property
    def natural_hz(self) -> float:
        """Undamped natural frequency, Hz."""
        return abs(self.eigenvalue) / (2 * math.pi)

    @property
    def damping_ratio(self) -> float | None:
        """Damping ratio; negative where growing, None for an eigenvalue at zero."""
        size = abs(self.eigenvalue)
        return -self.eigenvalue.real / size if size else None

    @property
    def time_constant(self) -> float:
        """Time in which the amplitude changes by a factor e, s."""
        return 1 / abs(self.eigenvalue.real) if self.growth else math.inf

    @property
    def stable(self) -> bool:
        """Whether the mode decays."""
        return self.growth < 0

    @property
    def elements(self) -> tuple[str, ...]:
        """Elements that carry the mode, largest first."""
        return dominant(self.carriers)

    @property
    def telling(self) -> Mapping[str, float]:
        """The feeds, where they tell of this mode.

        That is where its carriers hold most of its energy; else the mode
        merely drives parts that hold more, and the balance is theirs.
        """
        held = sum(self.energies.get(name, 0.0) for name in self.elements)
        return self.feeds if held > 0.5 else {}


def growths(eigenvalues: numpy.ndarray) -> numpy.ndarray:
    """Say of each eigenvalue whether it grows (1), decays (-1) or neither (0).

    Parameters
    ----------
    eigenvalues : (..., n) complex array

    Returns
    -------
    (..., n) int array

    Examples
    --------
    >>> growths(numpy.array([1e-20 + 3j, -2.0])).tolist()
    [0, -1]
    """
    if not eigenvalues.size:
        return numpy.zeros(eigenvalues.shape, dtype=int)
    scale = numpy.abs(eigenvalues).max(axis=-1, keepdims=True)
    real = numpy.real(eigenvalues)
    return numpy.where(numpy.abs(real) > NEUTRAL * scale, numpy.sign(real), 0).astype(int)


def modal_table(system: LinearSystem) -> tuple[Mode, ...]:
    """Describe every eigenvalue of a linear system.

    Parameters
    ----------
    system : LinearSystem

    Returns
    -------
    tuple of Mode
        In the order of ``system.poles()``.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble, linearize
    >>> v = One("v")
    >>> graph = assemble("msd", Se("F", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 0.5)))
    >>> mode = modal_table(linearize(graph))[0]
    >>> mode.elements, round(mode.feeds["b"], 9)
    (('m', 'k'), -0.125)
    """
    poles = system.poles()
    shares = system.participation()
    vectors = system.shapes()
    flows = Balance(system.at) if len(poles) else None
    grow = growths(poles)
    return tuple(
        Mode(
            complex(pole),
            int(grow[index]),
            by_element(system.states, shares[:, index]),
            *(flows.balance(vectors[:, index], complex(pole)) if flows else ({}, {})),
        )
        for index, pole in enumerate(poles)
    )
