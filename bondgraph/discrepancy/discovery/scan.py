"""Scans: coefficients of impacts, set by runs before they are fitted.

How often a stop is hit, and when, changes in steps; a fit that follows slopes cannot cross them, and
ends where the number of impacts is wrong. Plain runs tell which of some values is nearest.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

from ...simulation import CompiledModel
from ..measurement import Measurement
from .bench import Bench, Draft
from .follow import nearest

FACTORS = (0.9, 0.97, 1.03, 1.1)
SWEEPS = 2


def scanned(
    model: CompiledModel,
    rows: Sequence[Measurement],
    bench: Bench,
    draft: Draft,
    start: Mapping[str, float],
    seconds: float,
) -> dict[str, float]:
    """Change one coefficient of impacts after the other to what runs nearest to the data.

    Parameters
    ----------
    model : CompiledModel
    rows : sequence of Measurement
    bench : Bench
    draft : Draft
    start : mapping of str to float
        Parameters to start from.
    seconds : float
        Wall-clock limit.

    Returns
    -------
    dict of str to float
        Parameters; the given ones where the draft has no impacts.
    """
    until = time.monotonic() + seconds
    best, off = nearest(model, rows, bench, [start])
    names = [
        grafted.parameters[key]
        for item, grafted in zip(draft.added, draft.grafts, strict=True)
        for key in item.effect.fitted
        if item.effect.impacts
    ]
    for _ in range(SWEEPS):
        before = off
        for name in names:
            for factor in FACTORS:
                if time.monotonic() > until:
                    return best
                trial, found = nearest(model, rows, bench, [{**best, name: best[name] * factor}])
                if found < off:
                    best, off = trial, found
        if not off < before:
            break
    return best
