"""Edges: where an eigenvalue crosses the imaginary axis along a branch."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy

from ..linear import Mode, linearize_at, modal_table
from ..steady import SteadyState
from .family import Family
from .onset import Onset, onset


@dataclass(frozen=True, eq=False)
class Edge:
    """A crossing of the imaginary axis.

    Attributes
    ----------
    kind : str
        ``"hopf"`` where a complex pair crosses, ``"fold"`` where a real
        eigenvalue does: a fold of the branch, or another exchange of stability.
    parameter : str
    value : float
        Of the parameter, SI.
    unit : str
        The parameter's own unit, for display.
    frequency_hz : float
        Of the crossing pair; zero at a fold.
    boundary : bool
        Whether the steady state is stable on one side; False where another
        mode is unstable already.
    unstable_above : bool or None
        On which side the crossing mode grows; None at the end of a branch.
    mode : Mode
        The crossing mode: its carriers, and feeds that balance here.
    point : SteadyState
        The operating point at the edge.
    onset : Onset or None
        At a Hopf point: whether the vibration starts softly or hard; None where
        that cannot be told.
    """

    kind: str
    parameter: str
    value: float
    unit: str
    frequency_hz: float
    boundary: bool
    unstable_above: bool | None
    mode: Mode = field(repr=False)
    point: SteadyState = field(repr=False)
    onset: Onset | None = field(default=None, repr=False)

    @property
    def first_lyapunov(self) -> float | None:
        """First Lyapunov coefficient: negative soft, positive hard, zero undecided."""
        return None if self.onset is None else self.onset.first_lyapunov


def described(
    family: Family,
    y: numpy.ndarray,
    crossing: complex,
    unstable_above: bool | None,
    sizes: numpy.ndarray,
) -> Edge:
    """Describe a crossing at a point of a family with one free parameter.

    Parameters
    ----------
    family : Family
    y : (n + nz + 1,) array
    crossing : complex
        The eigenvalue that crosses.
    unstable_above : bool or None
    sizes : (n + nz,) array
        To measure states by.

    Returns
    -------
    Edge
    """
    point = family.point_at(y)
    omega = abs(crossing.imag)
    modes = modal_table(linearize_at(family.smooth, point))
    target = complex(crossing.real, omega)
    mode = min(modes, key=lambda item: abs(item.eigenvalue - target))
    others = [item.eigenvalue.real for item in modes if item.eigenvalue.conjugate() != target]
    scale = max(abs(item.eigenvalue) for item in modes)
    return Edge(
        "hopf" if mode.eigenvalue.imag else "fold",
        family.names[0],
        float(y[-1]),
        family.units[0],
        mode.frequency_hz,
        max(others, default=0.0) <= 1e-10 * scale,
        unstable_above,
        mode,
        point,
        onset(family.forms, point, omega, family.names[0], sizes) if omega else None,
    )


def same(one: Edge, other: Edge) -> bool:
    """Whether two crossings are one."""
    near = abs(one.value - other.value) <= 1e-9 * max(abs(one.value), 1e-300)
    alike = abs(one.frequency_hz - other.frequency_hz) <= 1e-6 * one.frequency_hz
    return near and alike and one.kind == other.kind
