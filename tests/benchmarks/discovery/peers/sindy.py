"""PySINDy on a case: which term beyond the nominal model's matters most, in which equation.

Features and rates are scaled to one; sparse regression (STLSQ, an ensemble of bags) runs on smoothed
derivatives and in weak form, with raw and smoothed signals; what to use, and the threshold, is chosen
by the weak-form error over both recordings, the held-out one among them.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy
from scipy.signal import savgol_filter

from .setups import SETUPS, Array, Columns, Setup

THRESHOLDS = (0.003, 0.01, 0.02, 0.05, 0.1, 0.2)
WINDOWS = (0, 9, 21)  # samples of a Savitzky-Golay filter; none
NEAR = 1.05  # of the least error: among these the sparsest is taken
BAGS = 20
Latent = Callable[[Path, str], Columns]


@dataclass(frozen=True)
class Problem:
    """Regression of one rate: rows of terms, and the rate."""

    terms: Array
    rate: Array


def solve(folder: Path, latent: Latent | None = None) -> dict[str, Any]:
    """Return the strongest term beyond the nominal model's.

    Parameters
    ----------
    folder : of a case
    latent : what makes signals and states better than smoothing does, from folder and recording;
        columns by name take the place of those measured and derived
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return _solved(folder, latent)


def _solved(folder: Path, latent: Latent | None) -> dict[str, Any]:
    model = json.loads((folder / "case.json").read_text(encoding="utf-8"))["model"]
    setup = SETUPS[model]
    found: list[tuple[float, str, str, float]] = []
    for equation, nominal in setup.equations.items():
        names, coefficients, error = _best(folder, setup, equation, latent)
        for name, value in zip(names, coefficients, strict=True):
            if name not in nominal and value:
                found.append((abs(float(value)), equation, name, error))
    if not found:
        return {"verdict": "none", "effects": []}
    size, equation, name, error = max(found)
    return {
        "verdict": "named",
        "effects": [{"name": name, "site": equation, "parameters": {}}],
        "size": size,
        "error_left": error,
    }


def _best(
    folder: Path, setup: Setup, equation: str, latent: Latent | None
) -> tuple[list[str], Array, float]:
    """Return terms and coefficients of the sparsest among the best."""
    tried: list[tuple[float, int, Array]] = []
    names: list[str] = []
    for window in WINDOWS:
        recordings = [read(folder, label, setup, window, latent) for label in ("train", "validate")]
        (t, states), (held_t, held) = recordings
        features = {**setup.features(states, equation), "1": numpy.ones(len(t))}
        names = list(features)
        size = numpy.array([numpy.std(column) or 1.0 for column in features.values()])
        held_features = {**setup.features(held, equation), "1": numpy.ones(len(held_t))}
        scale = numpy.std(numpy.gradient(_smooth(states[equation], 21), t))
        weak = _weak(t, states[equation] / scale, numpy.stack([*features.values()]) / size[:, None])
        other = _weak(
            held_t, held[equation] / scale, numpy.stack([*held_features.values()]) / size[:, None]
        )
        problems = [weak]
        if window:
            rate = savgol_filter(states[equation] / scale, window, 3, 1, t[1] - t[0])
            problems.append(Problem((numpy.stack([*features.values()]) / size[:, None]).T, rate))
        for problem in problems:
            for coefficients in _sparse(problem):
                error = _error((weak, other), coefficients)
                tried.append((error, int(numpy.count_nonzero(coefficients)), coefficients))
    least = min(error for error, _, _ in tried)
    near = [each for each in tried if each[0] <= NEAR * least]
    error, _, coefficients = min(near, key=lambda each: (each[1], each[0]))
    return names, coefficients, error


def _error(problems: Sequence[Problem], coefficients: Array) -> float:
    """Return what is left of both recordings' rates: a held-out one may hardly move."""
    left = sum(float(numpy.sum((p.rate - p.terms @ coefficients) ** 2)) for p in problems)
    return left / sum(float(p.rate @ p.rate) for p in problems)


def _sparse(problem: Problem) -> Iterator[Array]:
    """Yield coefficients over thresholds, each an ensemble's median, unbiased on what is left."""
    import pysindy

    for threshold in THRESHOLDS:
        single = pysindy.STLSQ(threshold=threshold, alpha=1e-4)
        bags = pysindy.EnsembleOptimizer(single, bagging=True, n_models=BAGS)
        rows, rate = problem.terms, problem.rate[:, None]
        bags.fit(rows, rate)
        kept = numpy.median(numpy.stack([c.ravel() for c in bags.coef_list]), axis=0) != 0
        if not kept.any():
            continue
        coefficients = numpy.zeros(rows.shape[1])
        coefficients[kept] = numpy.linalg.lstsq(rows[:, kept], problem.rate, rcond=None)[0]
        yield coefficients


def _weak(t: Array, state: Array, features: Array) -> Problem:
    """Return integrals against test functions, by pysindy's weak library."""
    import pysindy

    rows = numpy.stack([state, *features], axis=1)
    library = pysindy.WeakPDELibrary(
        pysindy.PolynomialLibrary(degree=1, include_bias=False),
        spatiotemporal_grid=t,
        is_uniform=True,
        K=200,
        H_xt=[12 * (t[1] - t[0])],
        p=3,
    )
    numpy.random.seed(0)  # the library draws its domains from the global state
    library.fit([pysindy.AxesArray(rows, {"ax_time": 0, "ax_coord": 1})])
    data = pysindy.AxesArray(rows, {"ax_time": 0, "ax_coord": 1})
    rates = numpy.asarray(library.convert_u_dot_integral(data))
    terms = numpy.asarray(library.transform([data])[0])
    return Problem(terms[:, 1:], rates[:, 0])


def read(
    folder: Path, label: str, setup: Setup, window: int, latent: Latent | None
) -> tuple[Array, Columns]:
    """Return times and states of a recording, smoothed, gaps bridged."""
    path = folder / f"{label}.csv"
    header = path.read_text(encoding="utf-8").partition("\n")[0].split(",")
    table = numpy.genfromtxt(path, delimiter=",", skip_header=1)
    columns = {name.partition(" [")[0]: table[:, i] for i, name in enumerate(header)}
    t = columns.pop("time")
    driven = next(iter(columns))
    for name, column in columns.items():
        there = numpy.isfinite(column)
        whole = numpy.interp(t, t[there], column[there])
        columns[name] = whole if name == driven else _smooth(whole, window)
    better = latent(folder, label) if latent else {}
    return t, {**setup.derive(t, {**columns, **better}), **better}


def _smooth(column: Array, window: int) -> Array:
    return savgol_filter(column, window, 3) if window else column
