"""The public `fit`: a model and recordings in, parameters with error bars out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy

from ...causality import CausalGraph
from ...errors import MeasurementError, ParameterError
from ...graph import BondGraph
from ...simulation import CompiledModel
from ..measurement import Measurement
from .descend import Iteration, Log
from .loss import loss_named
from .noise import spread
from .problem import Misfit, Problem
from .recordings import Recording, recorded
from .result import finished
from .search import Found, searched
from .shots import Gun, cut
from .unknowns import Unknowns, sought
from .value import Fit

Array = numpy.ndarray

FLOOR = 1e-9  # of a channel's deviation: data without any noise
ROUNDS = 4


def fit(
    model: BondGraph | CausalGraph | CompiledModel,
    measurements: Measurement | Sequence[Measurement],
    free: Sequence[Any],
    *,
    parameters: Mapping[Any, Any] | None = None,
    initial: Mapping[Any, Any] | None = None,
    ties: Mapping[str, Mapping[str, float]] | None = None,
    bounds: Mapping[Any, Any] | None = None,
    priors: Mapping[Any, Any] | None = None,
    noise: Mapping[str, float] | None = None,
    loss: str = "linear",
    segments: int | str | None = "auto",
    rtol: float = 1e-6,
    progress: Callable[[Iteration], object] | None = None,
    max_iterations: int = 300,
    time_budget: float = 600.0,
) -> Fit:
    """Fit parameters and initial states of a model to recordings.

    Parameters
    ----------
    model : BondGraph, CausalGraph or CompiledModel
    measurements : Measurement or sequence of Measurement
        Columns named as inputs drive the model; those named as outputs, states or port
        variables are what it is fitted to. NaN is a gap.
    free : sequence of str or Symbol
        Parameters of the table, and states whose initial value is sought in each recording;
        ``"states"`` stands for all of them.
    parameters : mapping, optional
        Values as for `simulate`; where the free ones start.
    initial : mapping, optional
        Initial states as for `simulate`, in all recordings; where the free ones start.
        ``Measurement.initial`` has those of one recording.
    ties : mapping of str to mapping of str to float, optional
        Start states that are sums of other states, each by a factor, such as two springs side
        by side: ``{"second.q": {"first.q": 1.0}}``.
    bounds : mapping, optional
        Name to ``(lower, upper)`` in SI or with units, None where there is none. Steps are
        projected on them.
    priors : mapping, optional
        Name to ``(value, std)``; further residuals.
    noise : mapping, optional
        Standard deviation of signals, SI; that of others is estimated from their residuals.
    loss : {"linear", "huber", "cauchy"}
        The others hold outliers back, by reweighted least squares.
    segments : int, "auto" or None
        Multiple shooting with so many segments a recording; None for one. Auto tries one,
        and cuts where it switches often, grows, fails or does not explain the data.
    rtol : float
        Of the runs.
    progress : callable, optional
        Called with each `Iteration`.
    max_iterations : int
        Steps in all.
    time_budget : float
        Wall-clock limit, s.

    Returns
    -------
    Fit
        With a named outcome; runs that fail on the way are steps not taken.

    Raises
    ------
    BondGraphError
        For unknown names, values that are not admissible and columns that do not fit.

    Notes
    -----
    Levenberg-Marquardt on exact sensitivities, in the logarithm of what is positive by
    assumption. Segments start from states of their own, fitted to their data one after the
    other; joints are then tightened by and by, and at last one shot is tried from there.

    References
    ----------
    Bock, Recent advances in parameter identification techniques for O.D.E., in: Numerical
    Treatment of Inverse Problems, Birkhäuser 1983, 95-121. Nocedal, Wright, Numerical
    Optimization, 2nd ed., Springer 2006, ch. 10.

    Examples
    --------
    >>> import sympy
    >>> from bondgraph import C, One, R, assemble
    >>> tau = sympy.Symbol("tau", positive=True)
    >>> graph = assemble(
    ...     "decay", One("loop") >> (R("r", tau), C("c", 1, initial=2)), parameters={tau: 1}
    ... )
    >>> t = numpy.linspace(0, 3, 31)
    >>> found = fit(graph, Measurement(t, {"c.q": 2 * numpy.exp(-t / 0.5)}), ["tau"])
    >>> found.outcome.value, round(found.values["tau"], 5)
    ('converged', 0.5)
    """
    began = time.monotonic()
    compiled = model if isinstance(model, CompiledModel) else CompiledModel(model)
    rows = [measurements] if isinstance(measurements, Measurement) else list(measurements)
    if not rows:
        raise MeasurementError("there is no measurement to fit to; give one or more")
    recordings = tuple(recorded(row, compiled) for row in rows)
    unknowns, start = sought(compiled, free, len(rows), parameters, bounds, priors)
    problem = Problem(
        gun=Gun(compiled, recordings, rtol, unknowns.fixed, dict(initial or {}), dict(ties or {})),
        unknowns=unknowns,
        segments=tuple(cut(recording, i, 1) for i, recording in enumerate(recordings)),
        sigma=_first_noise(recordings, noise or {}),
        loss=loss_named(loss),
        scale=numpy.ones(len(compiled.equations.states)),
        tightness=0.0,
        deadline=began + time_budget,
    )
    z = numpy.concatenate([start, _first_states(compiled, recordings, unknowns, start, initial)])
    log = Log(max_iterations, progress)
    found = searched(problem, z, _parts(segments), log)
    if math.isfinite(found.misfit.cost):
        found = _noise_settled(found, noise or {}, loss != "linear", log)
    return finished(found, log, time.monotonic() - began)


def _parts(segments: Any) -> int | None:
    """Return the number of segments; None for auto."""
    if segments is None:
        return 1
    if segments == "auto":
        return None
    if isinstance(segments, bool) or not isinstance(segments, int) or segments < 1:
        raise ParameterError(f"segments is {segments!r}; give a number from 1 on, 'auto' or None")
    return segments


def _first_noise(recordings: Sequence[Recording], given: Mapping[str, float]) -> dict[str, float]:
    """Return a tenth of each signal's deviation where no noise is given: equal weights."""
    sigma: dict[str, float] = {}
    for name in dict.fromkeys(name for row in recordings for name in row.data):
        if name in given:
            sigma[name] = float(given[name])
            if not 0 < sigma[name] < math.inf:
                raise ParameterError(f"noise of {name!r} is {given[name]!r}; it must be positive")
            continue
        parts = [row.data[name] for row in recordings if name in row.data]
        column = numpy.concatenate(parts)
        size = float(numpy.nanstd(column)) or float(numpy.nanmax(abs(column))) or 1.0
        sigma[name] = 0.1 * size
    for name in given:
        if name not in sigma:
            raise ParameterError(f"noise is given for {name!r}, which no measurement has")
    return sigma


def _first_states(
    model: CompiledModel,
    recordings: Sequence[Recording],
    unknowns: Unknowns,
    start: Array,
    initial: Mapping[Any, Any] | None,
) -> Array:
    """Return where sought initial states start: the model's own unless given."""
    sought_now = {item.name: item.value(u) for item, u in zip(unknowns.items, start, strict=False)}
    values = model.resolver({**unknowns.fixed, **sought_now}, partial=True)
    names = [state.name for state in model.equations.states]
    out = []
    for recording in recordings:
        x0 = model.initial_state(values, {**(initial or {}), **recording.initial})
        out += [float(x0[names.index(name)]) for name in unknowns.states]
    limits = slice(len(start), None)
    return numpy.clip(out, unknowns.lower[limits], unknowns.upper[limits])


def _noise_settled(found: Found, given: Mapping[str, float], robust: bool, log: Log) -> Found:
    """Estimate noise from residuals and fit again, until it no longer changes."""
    for _ in range(ROUNDS):
        sigma = _estimated(found.problem, found.misfit, given, robust)
        changes = [abs(math.log(sigma[n] / found.problem.sigma[n])) for n in sigma]
        problem = found.problem.with_(sigma=sigma)
        misfit = problem.weighed(found.point, found.misfit.shots)
        found = found.again(problem, found.point, misfit, log)
        if max(changes) < 0.02:
            break
    return found


def _estimated(
    problem: Problem, misfit: Misfit, given: Mapping[str, float], robust: bool
) -> dict[str, float]:
    unknowns = len(problem.unknowns.items)
    residuals: dict[str, list[Array]] = {name: [] for name in problem.sigma}
    for row in misfit.shots:
        for shot in row:
            for name, part in shot.residuals.items():
                residuals[name].append(part[numpy.isfinite(part)])
    joint = {name: numpy.concatenate(parts) for name, parts in residuals.items()}
    total = sum(map(len, joint.values()))
    first = _first_noise(problem.gun.recordings, given)
    return {
        name: first[name]
        if name in given
        else max(spread(part, unknowns * len(part) / total, robust), FLOOR * first[name])
        for name, part in joint.items()
    }
