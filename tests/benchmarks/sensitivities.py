"""The sensitivity race: derivatives of a run by eight parameters, through all its events.

``one run``
    The brake's limit cycle, 0.3 s at rtol 1e-6, 6001 times of output.
``sensitivities``
    The same run with the derivatives of all states by eight parameters at all times.
``differences``
    What one would do instead: central differences, sixteen runs. At the same tolerance they are
    noise, as their error says.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..oracles import brake as oracle
from .brake import N_OUT, RTOL, T_END
from .report import Limit, Report
from .timing import interleave

WRT = ("k_f", "k_w", "zeta_f", "zeta_w", "V0", "mu_s", "mu_k", "F_k")
STEP = 1e-4
"""Relative step of the differences: about the best at this tolerance."""


def report(rounds: int, everything: bool) -> Report:
    """Race on the limit cycle; truth is a run at a tolerance of 1e-11."""
    from bondgraph import CompiledModel, sensitivities, simulate
    from bondgraph.models import bicycle_brake

    model, base = CompiledModel(bicycle_brake.graph()), oracle.parameters(oracle.figure("fig8"))
    times = np.linspace(0, T_END, N_OUT)

    def one(rtol: float = RTOL, **changed: float) -> Any:
        return simulate(model, (0, T_END), base | changed, t_eval=times, rtol=rtol)

    def exact(rtol: float = RTOL) -> Any:
        return sensitivities(model, (0, T_END), WRT, base, t_eval=times, rtol=rtol)

    def differences() -> Any:
        columns = []
        for name in WRT:
            step = STEP * base[name]
            above, below = (one(**{name: base[name] + sign * step}) for sign in (1, -1))
            columns.append((above.x_end - below.x_end) / (2 * step))
        return np.array(columns).T

    truth = exact(1e-11).x_end
    size = np.abs(truth).max(axis=1, keepdims=True)
    errors = {
        "one run": "",
        "sensitivities": f"{(np.abs(exact().x_end - truth) / size).max():.0e}",
        "differences": f"{(np.abs(differences() - truth) / size).max():.0e}",
    }
    calls = {"one run": one, "sensitivities": exact, "differences": differences}
    timings = interleave(calls, rounds=rounds)
    unit = timings["one run"].median
    rows = [
        [name, f"{1e3 * t.median:.3f}", f"{t.median / unit:.2f}", errors[name]]
        for name, t in timings.items()
    ]
    ratio = timings["sensitivities"].median / unit
    limits = [Limit("sensitivities by 8 parameters over one run", ratio, 4)]
    headings = ("contestant", "CPU ms", "ratio", "error at the end")
    return Report("sensitivities", headings, rows, limits)
