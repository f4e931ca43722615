"""Sweeps through dask's executor, on a real cluster of two processes on this machine."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest

from bondgraph.models import bicycle_brake
from bondgraph.sweeps import Final, Peak, grid, outcomes, sweep

from .cases import oscillator
from .same import assert_same

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    from dask import config

    settings = {
        "distributed.scheduler.allowed-failures": 0,
        "temporary-directory": str(tmp_path_factory.mktemp("dask")),
        "distributed.admin.log-format": "",
    }
    with (
        config.set(settings),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def test_two_workers_find_the_same_as_one_thread(client, tmp_path):
    points = grid(V0=np.linspace(0.5, 1.5, 20), F_k=[-1, 600, 900])
    kept = (Final("F_f"), "count:friction:stick", Peak("x_c"))
    asked = dict(t_span=0.1)
    graph = bicycle_brake.graph()
    here = sweep(graph, points, kept, executor="serial", **asked)
    there = sweep(
        graph, points, kept, executor=client.get_executor(), chunk=4, out=tmp_path / "s", **asked
    )
    assert_same(there, here)
    assert there.attrs["executor"].endswith("of 2 workers")


def test_functions_need_not_be_importable_there(client):
    factor = 3.0
    found = sweep(
        oscillator(),
        grid(k=[1, 2, 3]),
        lambda run: factor * run.parameters["k"],
        t_span=0.1,
        executor=client.get_executor(),
    )
    assert found["quantity"].values.tolist() == [3.0, 6.0, 9.0]


def test_a_killed_worker_is_one_outcome(client):
    def deadly(run):
        if run.parameters["k"] == 2:
            os.kill(os.getpid(), signal.SIGKILL)
        return 1.0

    found = sweep(
        oscillator(), grid(k=[1, 2, 3]), deadly, t_span=0.1, executor=client.get_executor(), chunk=2
    )
    assert outcomes(found).tolist() == ["finished", "worker died", "finished"]
