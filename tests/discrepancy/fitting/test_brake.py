"""The bicycle brake: 0.3 s at 20 kHz with 87 events, five parameters off by five per cent each."""

from __future__ import annotations

import numpy as np
import pytest

from bondgraph import CompiledModel, fit, simulate
from bondgraph.discrepancy import Measurement
from bondgraph.models import bicycle_brake


@pytest.mark.slow
def test_a_squeal_in_segments():
    """The data are the model's own, at a finer tolerance: scipy's brake is tests/oracles' matter."""
    model = CompiledModel(bicycle_brake.graph())
    t = np.linspace(0, 0.3, 6001)
    run = simulate(model, (0, 0.3), {"tau": 0.02}, t_eval=t, rtol=1e-8)
    rng = np.random.default_rng(1)
    data = {name: run[name] * 1.0 for name in ("x_c", "V_c")}
    noise = {name: 0.02 * column.std() for name, column in data.items()}
    rows = Measurement(t, {n: data[n] + rng.normal(0, noise[n], len(t)) for n in data})
    free = ["k_f", "zeta_f", "mu_s", "v_s", "V0"]
    starts = {
        name: run.parameters[name] * (1.05 if place % 2 else 1 / 1.05)
        for place, name in enumerate(free)
    }
    found = fit(model, rows, free, parameters={"tau": 0.02, **starts})
    assert found.outcome.ok and found.gap == 0
    for name in free:
        true = run.parameters[name]
        assert abs(found.values[name] - true) < 4 * found.std[name] < 0.25 * true
    for channel in found.channels:
        assert channel.rmse == pytest.approx(noise[channel.signal], rel=0.05)
