"""How large the gap of each signal is, and how much of it is more than noise."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy

from .floor import Floor, floor_of
from .value import Residuals


@dataclass(frozen=True)
class SignalGap:
    """The gap of one signal.

    Attributes
    ----------
    signal, unit : str
    count : int
        Samples compared.
    rmse, bias : float
        Root of the mean square of the gap, and its mean, in `unit`.
    nrmse : float
        rmse over the standard deviation of the measured signal; infinite where that is zero.
    floor : Floor
    excess : float
        Mean square of the gap less that of the floor, not below zero, in `unit` squared.
    above : float
        Share of the gap's mean square above the floor, 0 to 1.
    share : float
        Of all signals' excess, each over the variance of its own measured signal.
    """

    signal: str
    unit: str
    count: int
    rmse: float
    bias: float
    nrmse: float
    floor: Floor
    excess: float
    above: float
    share: float


@dataclass(frozen=True)
class SignalGaps:
    """Gaps by signal, in the order of the residuals.

    Attributes
    ----------
    rows : tuple of SignalGap
    """

    rows: tuple[SignalGap, ...]

    def __getitem__(self, signal: str) -> SignalGap:
        return {row.signal: row for row in self.rows}[signal]

    def __iter__(self) -> Iterator[SignalGap]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)


def by_signal(found: Residuals, floor: Any = None) -> SignalGaps:
    """Measure the gap of each signal.

    Parameters
    ----------
    found : Residuals
    floor : float, Floor, or mapping of str to these, optional
        Standard deviation of the noise; estimated from the measured signal unless given.

    Returns
    -------
    SignalGaps

    Raises
    ------
    MeasurementError
        Where a floor can be neither had nor estimated.

    Examples
    --------
    >>> t = numpy.linspace(0, 1, 101)
    >>> gaps = by_signal(Residuals(t, {"v": t + 0.3}, {"v": t}), floor=0.1)
    >>> row = gaps["v"]
    >>> round(row.rmse, 3), round(row.bias, 3), round(row.above, 3)
    (0.3, 0.3, 0.889)
    """
    sizes = [_size(found, signal, floor_of(found, signal, floor)) for signal in found.signals]
    weighed = [excess / variance if variance > 0 else 0.0 for *_, excess, variance in sizes]
    total = sum(weighed)
    rows = []
    for signal, size, weight in zip(found.signals, sizes, weighed, strict=True):
        count, square, bias, own, excess, variance = size
        rows.append(
            SignalGap(
                signal,
                found.unit(signal),
                count,
                square**0.5,
                bias,
                (square / variance) ** 0.5 if variance > 0 else numpy.inf,
                own,
                excess,
                excess / square if square > 0 else 0.0,
                weight / total if total > 0 else 0.0,
            )
        )
    return SignalGaps(tuple(rows))


def _size(
    found: Residuals, signal: str, floor: Floor
) -> tuple[int, float, float, Floor, float, float]:
    gap = found.gap(signal)
    gap = gap[numpy.isfinite(gap)]
    square = float((gap**2).mean())
    excess = max(square - floor.sigma**2, 0.0)
    return (
        len(gap),
        square,
        float(gap.mean()),
        floor,
        excess,
        float(numpy.nanvar(found.measured[signal])),
    )
