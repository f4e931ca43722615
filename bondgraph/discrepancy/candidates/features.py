"""Features: functions of recorded signals that an effect's latent effort or flow is regressed on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Signals:
    """Signals at a site, over common times.

    Parameters
    ----------
    t : (nt,) array, s
    flow, displacement, effort, rate : (nt,) array
        Flow, its integral, effort, and the flow's rate; NaN throughout where unknown.

    Examples
    --------
    >>> signals = Signals.of([0.0, 1.0], flow=[1.0, 2.0])
    >>> signals.displacement.tolist(), signals.rate.tolist()
    ([0.0, 1.5], [1.0, 1.0])
    """

    t: Array
    flow: Array
    displacement: Array
    effort: Array
    rate: Array

    @classmethod
    def of(
        cls, t: object, flow: object = None, displacement: object = None, effort: object = None
    ) -> Signals:
        """Return signals with what is not given integrated, differentiated or NaN."""
        times = numpy.asarray(t, float)
        nothing = numpy.full(times.shape, numpy.nan)
        moving = nothing if flow is None else numpy.asarray(flow, float)
        if flow is None and displacement is not None:
            moving = numpy.gradient(numpy.asarray(displacement, float), times)
        steps = numpy.diff(times) * (moving[1:] + moving[:-1]) / 2
        way = numpy.concatenate([[0.0], numpy.cumsum(steps)])
        way = way if displacement is None else numpy.asarray(displacement, float)
        felt = nothing if effort is None else numpy.asarray(effort, float)
        return cls(times, moving, way, felt, numpy.gradient(moving, times))


@dataclass(frozen=True)
class Feature:
    """One column of the screening regression.

    Parameters
    ----------
    name : str
        As a report shows it.
    evaluate : callable
        From `Signals` to an (nt,) array.
    memory : bool
        Whether it depends on the past beside the present.

    Examples
    --------
    >>> drag = Feature("f|f|", lambda s: s.flow * abs(s.flow))
    >>> drag.evaluate(Signals.of([0.0, 1.0], flow=[-2.0, 1.0])).tolist()
    [-4.0, 1.0]
    """

    name: str
    evaluate: Callable[[Signals], Array]
    memory: bool = False


def stop(displacement: Array, width: float) -> Array:
    """Return the stop operator: an elastic slider whose elongation stays within a width.

    Parameters
    ----------
    displacement : (nt,) array
    width : float
        Largest elongation, in the unit of displacement.

    Returns
    -------
    (nt,) array

    References
    ----------
    Brokate, Sprekels, Hysteresis and Phase Transitions, Springer 1996, ch. 2.

    Examples
    --------
    >>> stop(numpy.array([0.0, 1.0, 3.0, 2.0]), 1.5).tolist()
    [0.0, 1.0, 1.5, 0.5]
    """
    elongation = numpy.zeros(len(displacement))
    for index, step in enumerate(numpy.diff(displacement)):
        elongation[index + 1] = min(max(elongation[index] + step, -width), width)
    return elongation


def play(displacement: Array, width: float) -> Array:
    """Return the play operator: what is left of a displacement behind a slack of twice the width.

    Parameters
    ----------
    displacement : (nt,) array
    width : float

    Returns
    -------
    (nt,) array

    Examples
    --------
    >>> play(numpy.array([0.0, 1.0, 3.0, 2.0]), 1.5).tolist()
    [0.0, 0.0, 1.5, 1.5]
    """
    return numpy.asarray(displacement - displacement[0] - stop(displacement, width))


def lagged(t: Array, values: Array, constant: float) -> Array:
    """Return a signal behind a first-order lag, exact for straight lines between samples.

    Parameters
    ----------
    t : (nt,) array, s
    values : (nt,) array
    constant : float, s

    Returns
    -------
    (nt,) array

    Examples
    --------
    >>> bool(abs(lagged(numpy.array([0.0, 100.0]), numpy.array([1.0, 1.0]), 2.0)[1] - 1) < 1e-12)
    True
    """
    out = numpy.empty(len(t))
    out[0] = values[0]
    for index, step in enumerate(numpy.diff(t)):
        kept = numpy.exp(-step / constant)
        slope = (values[index + 1] - values[index]) / step
        settled = values[index] - slope * constant
        out[index + 1] = settled + slope * step + (out[index] - settled) * kept
    return out


def stops(*shares: float) -> tuple[Feature, ...]:
    """Return stop operators whose widths are shares of the largest displacement."""

    def feature(share: float) -> Feature:
        def evaluate(signals: Signals) -> Array:
            return stop(signals.displacement, share * float(numpy.ptp(signals.displacement)) / 2)

        return Feature(f"stop({share:g})", evaluate, memory=True)

    return tuple(feature(share) for share in shares)


def beyond(signal: str, *shares: float) -> tuple[Feature, ...]:
    """Return what a signal is beyond shares of its largest magnitude."""

    def feature(share: float) -> Feature:
        def evaluate(signals: Signals) -> Array:
            values = getattr(signals, signal)
            edge = share * float(numpy.nanmax(numpy.abs(values)))
            return numpy.asarray(numpy.sign(values) * numpy.maximum(numpy.abs(values) - edge, 0.0))

        return Feature(f"{signal} beyond {share:g}", evaluate)

    return tuple(feature(share) for share in shares)
