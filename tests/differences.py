"""Central differences of runs: what sensitivities are held against.

Five points are used, and of several steps the mean of those two neighbours that agree best: far steps
leave the linear range, near ones meet the rounding of the runs.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bondgraph import CompiledModel, simulate

ENOUGH = 2e-7
STEPS = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 4e-6, 2e-6)


class Differences(NamedTuple):
    """By one parameter or initial state.

    Attributes
    ----------
    x : (n, nt) array
    far : (nt,) array of bool
        Samples in the same mode in all runs.
    events : (ne,) array or None
        Of the event times; None where their number differs.
    scale : (n,) array
        Size of each state's derivative.
    doubt : float
        By how much the two steps differ, relative to that, in states that move at all.
    """

    x: np.ndarray
    far: np.ndarray
    events: np.ndarray | None
    scale: np.ndarray
    doubt: float


def differences(
    model: CompiledModel,
    until: float,
    name: str,
    times: np.ndarray,
    *,
    parameters: Mapping[str, Any] | None = None,
    initial: Mapping[str, Any] | None = None,
    size: float | None = None,
    steps: tuple[float, ...] = STEPS,
    rtol: float = 1e-12,
    moving: np.ndarray | None = None,
    **options: Any,
) -> Differences:
    """Differentiate runs by a parameter, or by a state of which a usual size is given.

    States that are not ``moving`` do not depend on it: of those rounding alone is seen.
    """
    parameters, initial = dict(parameters or {}), dict(initial or {})

    def run(value):
        given = dict(parameters), dict(initial)
        given[size is not None][name] = value
        return simulate(model, until, *given, t_eval=times, rtol=rtol, **options)

    base = simulate(model, until, parameters, initial, t_eval=times, rtol=rtol, **options)
    middle = base.parameters[name] if size is None else base[name][0]
    found = (_five(base, run, middle, s * (size or abs(middle))) for s in steps)
    moving = np.full(len(base.x), True) if moving is None else moving
    best = None
    for one, other in itertools.pairwise(found):
        far = one[1] & other[1]
        if far.sum() < 0.5 * len(times):
            continue
        scale = np.abs(other[0]).max(axis=1)
        apart = np.abs(one[0] - other[0])[:, far].max(axis=1)
        doubt = float((apart[moving] / scale[moving]).max())
        if best is None or doubt < best.doubt:
            events = None if one[2] is None or other[2] is None else (one[2] + other[2]) / 2
            best = Differences((one[0] + other[0]) / 2, far, events, scale, doubt)
        if best.doubt < ENOUGH:
            break
    assert best is not None, f"no step by {name} leaves the modes as they are"
    return best


def _five(base, run, middle, step):
    runs = {share: run(middle + share * step) for share in (-2, -1, 1, 2)}
    times = {share: np.array([event.t for event in r.events]) for share, r in runs.items()}
    here = np.array([event.t for event in base.events])
    same = all(len(of) == len(here) for of in times.values())
    far = np.full(len(base.t), same)
    for of in times.values() if same else ():
        low, high = np.minimum(of, here) - 1e-12, np.maximum(of, here) + 1e-12
        inside = (base.t[:, None] >= low) & (base.t[:, None] <= high)
        far &= ~inside.any(axis=1)

    def slope(of):
        return (8 * (of[1] - of[-1]) - (of[2] - of[-2])) / (12 * step)

    x = slope({share: r.x for share, r in runs.items()})
    return x, far, slope(times) if same else None
