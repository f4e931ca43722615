"""What the real recordings support: plain least squares over laws written out by hand.

A yardstick for what is found in them, with no bond graph and none of the framework's fits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from bondgraph.discrepancy.measurement import Measurement

Array = numpy.ndarray
LAWS = ("pull", "viscous", "coulomb", "quadratic", "offset")
STARTS = {"pull": 64.05, "viscous": 0.03, "coulomb": 0.15, "quadratic": 0.005, "offset": 0.0}
# what moves an unknown for a difference quotient; columns of the Jacobian run as one batch
_NUDGE = 1e-6


@dataclass(frozen=True)
class Yardstick:
    """Coefficients that were fitted, and RMS deviations over all recordings of a kind."""

    values: Mapping[str, float]
    train: float
    held_out: float


def swings(
    names: tuple[str, ...], train: list[Measurement], held_out: list[Measurement]
) -> Yardstick:
    """Fit a pendulum with the laws named, of `LAWS`; the others are absent."""
    laws = dict.fromkeys(LAWS, 0.0) | {name: STARTS[name] for name in names}
    found, left = _swings(names, laws, train)
    return Yardstick({name: found[name] for name in names}, left, _swings((), found, held_out)[1])


def _swings(
    names: tuple[str, ...], laws: Mapping[str, float], runs: list[Measurement]
) -> tuple[dict[str, float], float]:
    """Fit laws and the start of each run; return the laws and the RMS that is left."""
    angles = numpy.stack([run.columns["theta"] for run in runs], 1)
    step = float(numpy.diff(runs[0].t).mean())
    slopes = (angles[4] - angles[0]) / (4 * step)
    first = numpy.concatenate([[laws[name] for name in names], angles[0], slopes])

    def all_of(x: Array) -> Array:
        """Angles of a batch of unknowns (n, b): (nt, runs, b)."""
        values = {name: numpy.full(x.shape[1], value) for name, value in laws.items()}
        values |= {name: x[i] for i, name in enumerate(names)}
        starts = x[len(names) :].reshape(2, len(runs), -1)
        return swing(values, starts[0], starts[1], step, len(angles))

    def residuals(x: Array) -> Array:
        return (all_of(x[:, None])[..., 0] - angles).ravel()

    def jacobian(x: Array) -> Array:
        batch = x[:, None] + numpy.hstack([numpy.zeros((len(x), 1)), _NUDGE * numpy.eye(len(x))])
        rows = all_of(batch).reshape(-1, len(x) + 1)
        return (rows[:, 1:] - rows[:, :1]) / _NUDGE

    best = least_squares(residuals, first, jacobian, x_scale="jac", max_nfev=25)
    values = dict(zip(names, best.x[: len(names)].tolist(), strict=True))
    return {**laws, **values}, float(numpy.sqrt(numpy.mean(best.fun**2)))


def swing(laws: Mapping[str, Array], q: Array, w: Array, step: float, rows: int) -> Array:
    """Angles of pendulums side by side, by classical Runge-Kutta a step a sample."""

    def rate(q: Array, w: Array) -> Array:
        drag = laws["viscous"] + laws["quadratic"] * numpy.abs(w)
        return -laws["pull"] * numpy.sin(q) - drag * w - laws["coulomb"] * numpy.sign(w)

    out = numpy.empty((rows, *q.shape))
    for row in range(rows):
        out[row] = q + laws["offset"]
        a1 = rate(q, w)
        w2 = w + step / 2 * a1
        a2 = rate(q + step / 2 * w, w2)
        w3 = w + step / 2 * a2
        a3 = rate(q + step / 2 * w2, w3)
        w4 = w + step * a3
        a4 = rate(q + step * w3, w4)
        q = q + step / 6 * (w + 2 * w2 + 2 * w3 + w4)
        w = w + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return out


def falls(names: tuple[str, ...], train: Measurement, held_out: Measurement) -> Yardstick:
    """Fit a fall with ``viscous``, ``quadratic`` or ``gravity`` free; the start is, in each drop."""
    laws = {"viscous": 0.0, "quadratic": 0.0, "gravity": 9.8}
    found, left = _falls(names, laws, train)
    return Yardstick({name: found[name] for name in names}, left, _falls((), found, held_out)[1])


def _falls(
    names: tuple[str, ...], laws: Mapping[str, float], run: Measurement
) -> tuple[dict[str, float], float]:
    height = run.columns["height"]
    speed = (height[3] - height[0]) / (run.t[3] - run.t[0])
    first = [{"viscous": 0.05, "quadratic": 0.01, "gravity": 9.8}[name] for name in names]

    def residuals(x: Array) -> Array:
        values = {**laws, **dict(zip(names, x, strict=False))}

        def rates(_: float, y: Array) -> list[float]:
            drag = values["viscous"] + values["quadratic"] * abs(y[1])
            return [y[1], -values["gravity"] - drag * y[1]]

        ends = (run.t[0], run.t[-1])
        fall = solve_ivp(rates, ends, x[-2:], rtol=1e-8, atol=1e-8, t_eval=run.t)
        return numpy.asarray(fall.y[0] - height)

    lowest = [0.0] * len(names) + [-numpy.inf] * 2
    scale = [0.1] * len(names) + [1.0, 1.0]
    best = least_squares(
        residuals, [*first, height[0], speed], bounds=(lowest, numpy.inf), x_scale=scale
    )
    values = dict(zip(names, best.x[: len(names)].tolist(), strict=True))
    return {**laws, **values}, float(numpy.sqrt(numpy.mean(best.fun**2)))
