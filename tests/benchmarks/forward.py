"""What sensitivities cost beside the run itself: ``python -m tests.benchmarks.forward``."""

from __future__ import annotations

import numpy as np

from bondgraph import CompiledModel, sensitivities, simulate
from bondgraph.models import bicycle_brake

from .timing import Timing, interleave

NAMES = ("V0", "F_k", "zeta_f", "mu_s", "v_s", "k_f", "tau", "k_w")


def race(rounds: int = 9) -> dict[str, Timing]:
    """Time the brake's limit cycle, 0.3 s at rtol 1e-6 with 6001 samples, with 8 parameters and without."""
    model, times = CompiledModel(bicycle_brake.graph()), np.linspace(0, 0.3, 6001)
    given = {"parameters": {"tau": 0.02}, "t_eval": times}
    return interleave(
        {
            "simulate": lambda: simulate(model, 0.3, **given),
            "sensitivities": lambda: sensitivities(model, 0.3, NAMES, **given),
        },
        rounds=rounds,
    )


def errors(tolerances: tuple[float, ...] = (1e-6, 1e-8, 1e-10)) -> dict[float, float]:
    """Greatest error of any sensitivity, of its range, away from events; beside rtol 1e-13."""
    model, times = CompiledModel(bicycle_brake.graph()), np.linspace(0, 0.3, 301)
    runs = {
        rtol: sensitivities(model, 0.3, NAMES, {"tau": 0.02}, t_eval=times, rtol=rtol)
        for rtol in (*tolerances, 1e-13)
    }
    best = runs[1e-13]
    events = np.array([event.t for event in best.trajectory.events])
    far = np.abs(times[:, None] - events).min(axis=1) > 1e-5
    size = np.abs(best.x).max(axis=2)
    moving = size > 0

    def error(rtol: float) -> float:
        apart = np.abs(runs[rtol].x - best.x)[:, :, far].max(axis=2)
        return float((apart[moving] / size[moving]).max())

    return {rtol: error(rtol) for rtol in tolerances}


if __name__ == "__main__":
    found = race()
    for name, timing in found.items():
        print(f"{name:14} {1e3 * timing.median:6.2f} ms CPU")
    print(f"ratio          {found['sensitivities'].median / found['simulate'].median:6.2f}")
    for rtol, error in errors().items():
        print(f"rtol {rtol:g}: error {error:.0e}")
