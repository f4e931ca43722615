"""Growing horizons: fits that begin with the first moments of recordings.

Where a contact sticks and slips, or something swings freely, runs of a wrong model soon have
nothing to do with the data, and a fit to whole recordings finds the next minimum. Their first
moments tell the parameters roughly, longer parts ever better.

References
----------
Bock, Recent advances in parameter identification techniques for O.D.E., in: Numerical Treatment
of Inverse Problems, Birkhäuser 1983, 95-121.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...errors import BondGraphError
from ...simulation import CompiledModel
from ..fitting import fit
from ..measurement import Measurement

SHARES = (1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2)  # of each recording
FEWEST = 20  # samples, and more than there are unknowns
STEPS = 25


def grown_horizon(
    model: CompiledModel,
    rows: Sequence[Measurement],
    free: Sequence[str],
    start: Mapping[str, float],
    seconds: float,
    **options: Any,
) -> dict[str, float] | None:
    """Fit parameters to longer and longer first parts of recordings.

    Parameters
    ----------
    model : CompiledModel
    rows : sequence of Measurement
    free : sequence of str
        Parameters, and states whose start is sought.
    start : mapping of str to float
        Parameters to start from.
    seconds : float
        Wall-clock limit of all of them.
    **options
        Of `fit`.

    Returns
    -------
    dict of str to float or None
        Parameters; None where no part could be fitted.
    """
    values, reached = dict(start), False
    for share in SHARES:
        ends = [float(row.t[0] + share * (row.t[-1] - row.t[0])) for row in rows]
        least = min(int((row.t <= end).sum()) for row, end in zip(rows, ends, strict=True))
        if least < max(FEWEST, 2 * len(free)):
            continue
        parts = [row.between(row.start, end) for row, end in zip(rows, ends, strict=True)]
        try:
            found = fit(
                model,
                parts,
                free,
                parameters=values,
                loss="linear",
                max_iterations=STEPS,
                time_budget=seconds / len(SHARES),
                **options,
            )
        except BondGraphError:
            continue
        values, reached = {**values, **found.values}, True
    return values if reached else None
