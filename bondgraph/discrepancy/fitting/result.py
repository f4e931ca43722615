"""From the point a search ended at to the `Fit` that is handed out."""

from __future__ import annotations

import math

import numpy

from .descend import Log, normal_rows
from .identify import Known, identified
from .noise import correlation_time
from .problem import Problem
from .search import Found
from .segments import UNEXPLAINED, unexplained
from .value import Channel, Fit

Array = numpy.ndarray


def finished(found: Found, log: Log, seconds: float) -> Fit:
    """Return the result of a search.

    Parameters
    ----------
    found : Found
    log : Log
    seconds : float

    Returns
    -------
    Fit
    """
    problem, z = found.problem, found.point.z
    unknowns = problem.unknowns
    names = _names(problem)
    q, total = len(unknowns.parameters), len(names)
    channels = _channels(found) if math.isfinite(found.misfit.cost) else ()
    known = _known(found, channels, names)
    slopes, values = unknowns.slopes(z), unknowns.values(z).tolist()
    std = (known.std * slopes).tolist()
    own = [unknowns.own(i) for i in range(len(problem.gun.recordings))]
    states = unknowns.states
    held = (z <= unknowns.lower) | (z >= unknowns.upper)
    covariance = known.covariance * numpy.outer(slopes, slopes)
    return Fit(
        outcome=found.outcome,
        values=dict(zip(names[:q], values[:q], strict=True)),
        std=dict(zip(names[:q], std[:q], strict=True)),
        initial=tuple(dict(zip(states, values[part], strict=True)) for part in own),
        initial_std=tuple(dict(zip(states, std[part], strict=True)) for part in own),
        names=names,
        covariance=covariance,
        directions=known.directions,
        channels=channels,
        trajectories=tuple(tuple(shot.trajectory for shot in row) for row in found.misfit.shots),
        cost=found.misfit.cost,
        gap=found.misfit.gap,
        at_bounds=tuple(names[i] for i in range(total) if held[i]),
        iterations=tuple(log.steps),
        seconds=seconds,
        logs={item.name: item.log for item in unknowns.items if item.recording is None},
        remark="; ".join(filter(None, [found.remark, _left(found)])),
    )


def _left(found: Found) -> str:
    """Say so where the run does not resemble the data."""
    if not math.isfinite(found.misfit.cost):
        return ""
    share = unexplained(found.misfit, found.problem)
    if share < UNEXPLAINED:
        return ""
    return (
        f"{100 * share:.0f} % of a signal's deviation is left: another minimum, or an effect that the "
        f"model lacks; give start values nearer by, or more segments"
    )


def _names(problem: Problem) -> tuple[str, ...]:
    rows = problem.gun.recordings
    return tuple(
        item.name
        if item.recording is None or len(rows) == 1
        else f"{item.name} [{item.recording + 1}: {rows[item.recording].name}]"
        for item in problem.unknowns.items
    )


def _channels(found: Found) -> tuple[Channel, ...]:
    channels = []
    problem = found.problem
    cuts = zip(found.misfit.shots, problem.segments, problem.gun.recordings, strict=True)
    for row, segments, recording in cuts:
        for name, column in recording.data.items():
            residuals = numpy.full(len(column), numpy.nan)
            for shot, segment in zip(row, segments, strict=True):
                if name in shot.residuals:
                    residuals[segment.first : segment.last] = shot.residuals[name]
            there = residuals[numpy.isfinite(residuals)]
            sigma = problem.sigma[name]
            square = float((there**2).mean())
            channels.append(
                Channel(
                    recording=recording.name,
                    signal=name,
                    t=recording.t,
                    residuals=residuals,
                    noise=sigma,
                    rmse=square**0.5,
                    chi2=square / sigma**2,
                    count=len(there),
                    effective=len(there) / correlation_time(there),
                )
            )
    return tuple(channels)


def _known(found: Found, channels: tuple[Channel, ...], names: tuple[str, ...]) -> Known:
    """Return what the data tell, each channel counted as so many samples as it is worth."""
    problem, point = found.problem, found.point
    total = len(names)
    if not channels:
        endless = numpy.diag(numpy.full(total, numpy.inf))
        return Known(numpy.full(total, numpy.inf), endless, ())
    sigma = {}
    for name, noise in problem.sigma.items():
        mine = [channel for channel in channels if channel.signal == name]
        share = sum(c.effective for c in mine) / sum(c.count for c in mine)
        sigma[name] = noise / share**0.5
    worth = problem.with_(sigma=sigma)
    misfit = worth.weighed(point, found.misfit.shots)
    assert misfit.prior is not None
    logs = [
        item.recording is None and value != 0
        for item, value in zip(
            problem.unknowns.items, problem.unknowns.values(point.z), strict=True
        )
    ]
    rows = normal_rows(worth, misfit)
    return identified(rows, misfit.prior, _scales(found), names, logs)


def _scales(found: Found) -> Array:
    """Return what a relative change of one is: of a start state, that of its range."""
    problem = found.problem
    values = problem.unknowns.values(found.point.z)
    out = []
    for item, value in zip(problem.unknowns.items, values, strict=True):
        size = 1.0 if item.log else abs(float(value))
        if item.recording is not None:
            place = problem.states.index(item.name)
            runs = found.misfit.shots[item.recording]
            size = max(float(abs(shot.trajectory.x[place]).max(initial=0.0)) for shot in runs)
        out.append(size or 1.0)
    return numpy.array(out)
