"""Features: functions of recorded signals that an effect's latent effort or flow is regressed on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Signals:
    """Signals at a site, over common times.

    Parameters
    ----------
    t : (nt,) array, s
    flow, displacement, effort, rate, effort_rate, momentum : (nt,) array
        Flow, its integral, effort, the rates of flow and effort, and the momentum of an inertia;
        NaN throughout where unknown.
    whole : Signals, optional
        Those of all recordings, which the ranges are taken from.

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
    effort_rate: Array
    momentum: Array
    whole: Signals | None = field(default=None, repr=False)

    @classmethod
    def of(
        cls,
        t: object,
        flow: object = None,
        displacement: object = None,
        effort: object = None,
        momentum: object = None,
        rate: object = None,
        effort_rate: object = None,
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
        kept = nothing if momentum is None else numpy.asarray(momentum, float)
        grows = numpy.gradient(moving, times) if rate is None else numpy.asarray(rate, float)
        rises = numpy.gradient(felt, times) if effort_rate is None else effort_rate
        return cls(times, moving, way, felt, grows, numpy.asarray(rises, float), kept)

    @classmethod
    def together(cls, parts: Sequence[Signals]) -> tuple[Signals, ...]:
        """Return signals of several recordings whose ranges are those of all of them."""
        names = ("t", "flow", "displacement", "effort", "rate", "effort_rate", "momentum")
        t, flow, way, effort, rate, effort_rate, momentum = (
            numpy.concatenate([getattr(part, name) for part in parts]) for name in names
        )
        whole = cls(t, flow, way, effort, rate, effort_rate, momentum)
        return tuple(replace(part, whole=whole) for part in parts)

    def _all(self, name: str) -> Array:
        found: Array = getattr(self.whole or self, name)
        return found

    @property
    def duration(self) -> float:
        """Length of the recording, s."""
        return float(numpy.ptp(self.t))

    @property
    def stroke(self) -> float:
        """Half the range of displacement, in all recordings."""
        return 0.5 * float(numpy.ptp(self._all("displacement")))

    @property
    def reach(self) -> tuple[float, float]:
        """Least and greatest displacement; zero is always between."""
        way = self._all("displacement")
        return float(way.min(initial=0.0)), float(way.max(initial=0.0))

    @property
    def speed(self) -> float:
        """A large flow: of all magnitudes, 95 % are below."""
        return float(numpy.quantile(numpy.abs(self._all("flow")), 0.95))

    @property
    def efforts(self) -> tuple[float, float]:
        """Least and greatest effort."""
        effort = self._all("effort")
        return float(effort.min()), float(effort.max())


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
    rate : bool
        Whether what acts is the time derivative of what `evaluate` returns: that of a smoothed
        signal would carry the model's own error, so it is not formed.

    Examples
    --------
    >>> drag = Feature("f|f|", lambda s: s.flow * abs(s.flow))
    >>> drag.evaluate(Signals.of([0.0, 1.0], flow=[-2.0, 1.0])).tolist()
    [-4.0, 1.0]
    """

    name: str
    evaluate: Callable[[Signals], Array]
    memory: bool = False
    rate: bool = False


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


def turned(displacement: Array, share: float = 0.02) -> bool:
    """Return whether a displacement goes both up and down by a share of its range.

    Examples
    --------
    >>> turned(numpy.array([0.0, 1.0, 3.0])), turned(numpy.array([0.0, 3.0, 2.0]))
    (False, True)
    """
    up = displacement - numpy.minimum.accumulate(displacement)
    down = numpy.maximum.accumulate(displacement) - displacement
    far = share * float(numpy.ptp(displacement))
    return bool(min(up.max(initial=0.0), down.max(initial=0.0)) > far)


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


def lagged(t: Array, values: Array, constant: float, start: float | None = None) -> Array:
    """Return a signal behind a first-order lag, exact for straight lines between samples.

    Parameters
    ----------
    t : (nt,) array, s
    values : (nt,) array
    constant : float, s
    start : float, optional
        What it begins with; the first value unless given.

    Returns
    -------
    (nt,) array

    Examples
    --------
    >>> bool(abs(lagged(numpy.array([0.0, 100.0]), numpy.array([1.0, 1.0]), 2.0)[1] - 1) < 1e-12)
    True
    """
    out = numpy.empty(len(t))
    out[0] = values[0] if start is None else start
    for index, step in enumerate(numpy.diff(t)):
        kept = numpy.exp(-step / constant)
        slope = (values[index + 1] - values[index]) / step
        settled = values[index] - slope * constant
        out[index + 1] = settled + slope * step + (out[index] - settled) * kept
    return out


@dataclass(frozen=True)
class Shape:
    """A form of an effect with its widths and thresholds set, linear in what is left.

    Parameters
    ----------
    features : tuple of Feature
        Their sum, each by an amount, is what the effect does.
    starts : callable
        ``starts(amounts, signals)``: coefficients by name, where a fit begins.
    signed : bool
        Whether amounts below zero are physical.
    floating : bool
        Whether it also takes a constant where nothing tells where the displacement begins.
    turning : bool
        Whether it is told from other effects only where the displacement turns back: what yields
        is then let go, while before it is as a spring that softens.

    Examples
    --------
    >>> spring = Shape((Feature("q", lambda s: s.displacement),), lambda a, s: {"stiffness": a[0]})
    >>> spring.starts([3.0], Signals.of([0.0, 1.0], flow=[1.0, 1.0]))
    {'stiffness': 3.0}
    """

    features: tuple[Feature, ...]
    starts: Callable[[Sequence[float], Signals], Mapping[str, float]]
    signed: bool = False
    floating: bool = False
    turning: bool = False


def dry(signals: Signals) -> Array:
    """Return the flow's sign, blurred where the flow is too small for it to be known."""
    return numpy.asarray(numpy.tanh(signals.flow / (0.01 * signals.speed + 1e-300)))


def over(values: Array, edge: float) -> Array:
    """Return what of each magnitude is above an edge, with its sign.

    Examples
    --------
    >>> over(numpy.array([-3.0, 1.0, 4.0]), 2.0).tolist()
    [-1.0, 0.0, 2.0]
    """
    return numpy.asarray(numpy.sign(values) * numpy.maximum(numpy.abs(values) - edge, 0.0))
