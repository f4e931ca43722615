"""Transients of circuits against ngspice, which knows nodes and branches and no causality."""

import numpy as np
import pytest

from bondgraph import simulate

from .circuits import CIRCUITS
from .ngspice import transient
from .presence import need


@pytest.mark.parametrize("name", CIRCUITS)
def test_transient(name, tmp_path):
    need("ngspice")
    circuit = CIRCUITS[name]()
    t, *expected = transient(
        circuit.netlist,
        tuple(circuit.same),
        until=circuit.until,
        step=circuit.step,
        folder=tmp_path,
    )
    run = simulate(circuit.graph, (0, t[-1]), t_eval=t, rtol=1e-8)
    assert run.outcome.ok
    for values, ours in zip(expected, circuit.same.values(), strict=True):
        # of each signal's own range, which is at most twice the supply
        assert np.abs(run[ours] - values).max() < 1e-5 * np.ptp(values)
