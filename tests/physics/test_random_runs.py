"""Random graphs with switching elements, run in time from random states, inputs stepping.

Each ends in a named outcome or a named error; one that finishes has spent no power that it was
not given, jumps at the start and at steps of inputs included.
"""

import random
from collections import Counter

import numpy as np

from bondgraph import CompiledModel, simulate
from bondgraph.errors import BondGraphError

from .draws import draw
from .plans import SWITCHES
from .test_random_modes import SWITCHED

RUNS = 90


def run(seed: int) -> tuple[str, float]:
    """Simulate one random graph; return how it ended, and the energy it cannot account for."""
    rng = random.Random(f"runs-{seed}")
    plan = draw(rng, SWITCHED)
    if not plan.of(*SWITCHES):
        return "no switches", 0.0
    try:
        model = CompiledModel(plan.graph())
        start = {state.name: rng.uniform(-1, 1) for state in model.equations.states}
        levels = {s: [rng.uniform(-1, 1) for _ in range(3)] for s in model.equations.graph.inputs}
        inputs = {s: (np.array([0, 0.3, 0.6]), np.array(values)) for s, values in levels.items()}
        found = simulate(model, 1.0, initial=start, inputs=inputs, time_budget=10.0, max_events=500)
    except BondGraphError as error:
        assert str(error) and error.elements
        return "refused", 0.0
    energy = found.energy
    assert np.isfinite(found.x).all() and found.outcome.advice
    if not found.outcome.ok or energy.stored is None:
        return found.outcome.value, 0.0
    if not model.equations.states:  # nothing there that steps are sized by
        return "finished", 0.0
    lost = abs(energy.supplied - energy.stored - energy.dissipated)
    return "finished", min(abs(energy.relative_residual), lost / 1e-6)


def test_random_graphs_account_for_their_energy():
    found = [run(seed) for seed in range(RUNS)]
    counts = Counter(outcome for outcome, _ in found)
    print(dict(counts))
    assert counts["finished"] >= RUNS / 3
    assert max(lost for _, lost in found) < 1e-4
