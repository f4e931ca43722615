"""The result is the same to the bit, however the work is cut and whoever does it."""

from __future__ import annotations

import concurrent.futures as cf
import multiprocessing
import pickle

import numpy as np
import pytest

from bondgraph import CompiledModel
from bondgraph.errors import SweepError
from bondgraph.models import LIBRARY, bicycle_brake
from bondgraph.simulation import simulate
from bondgraph.sweeps import Count, Energy, Final, Peak, grid, outcomes, sweep
from tests.showcase import GRAPHS

from .cases import dies_at_three, dies_once, oscillator
from .same import assert_same

BRAKE = bicycle_brake.graph()
POINTS = grid(V0=np.linspace(0.5, 1.5, 13), F_k=[-5, 500, 700, 900, 1100])
ENDS = (Final("F_f"), Final("V_c"), Count("friction", "stick"), Energy())
ALONG = (*ENDS, Peak("x_c"))
SPAN = dict(t_span=0.2)


@pytest.fixture(scope="module")
def model():
    return CompiledModel(BRAKE)


@pytest.fixture(scope="module")
def serial(model):
    return {kept: sweep(model, POINTS, kept, executor="serial", **SPAN) for kept in (ENDS, ALONG)}


@pytest.mark.parametrize("chunk", [1, 7, 64, 1000])
@pytest.mark.parametrize("kept", [ENDS, ALONG], ids=["ends", "along"])
def test_chunks_do_not_matter(model, serial, kept, chunk):
    assert_same(sweep(model, POINTS, kept, chunk=chunk, **SPAN), serial[kept])


@pytest.mark.parametrize("kept", [ENDS, ALONG], ids=["ends", "along"])
def test_threads_do_not_matter(model, serial, kept):
    found = sweep(model, POINTS, kept, executor="threads", workers=3, **SPAN)
    assert_same(found, serial[kept])
    with cf.ThreadPoolExecutor(2) as pool:
        assert_same(sweep(model, POINTS, kept, executor=pool, chunk=5, **SPAN), serial[kept])
        assert pool.submit(int, 3).result() == 3  # it stays its owner's


def test_processes_do_not_matter(model, serial):
    found = sweep(model, POINTS, ALONG, executor="processes", workers=2, chunk=9, **SPAN)
    assert_same(found, serial[ALONG])
    assert found.attrs["executor"] == "2 processes"


def test_a_process_pool_of_ones_own(model, serial):
    with cf.ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert_same(sweep(model, POINTS, ENDS, executor=pool, chunk=9, **SPAN), serial[ENDS])
        assert pool.submit(int, 3).result() == 3


def test_threads_on_the_virtual_machine_have_models_of_their_own(model):
    few = grid(V0=[0.6, 0.9, 1.2, 1.5])
    asked = dict(t_span=0.02, backend="vm")
    one = sweep(model, few, ALONG, executor="serial", **asked)
    assert_same(sweep(model, few, ALONG, executor="threads", workers=2, chunk=1, **asked), one)


def test_the_choice_is_told(model):
    little = sweep(model, grid(V0=[1.0]), ENDS, **SPAN)
    assert little.attrs["executor"] == "this process"
    one = sweep(model, POINTS, ENDS, workers=1, **SPAN)
    assert one.attrs["executor"] == "this process: one worker"


def test_a_point_that_kills_its_worker_is_found_and_takes_no_other_with_it():
    points = grid(k=[1, 2, 3, 4, 5, 6])
    found = sweep(
        oscillator(), points, dies_at_three, t_span=0.1, executor="processes", workers=2, chunk=3
    )
    assert outcomes(found).tolist() == [*["finished"] * 2, "worker died", *["finished"] * 3]
    assert "2 times" in found.message.values[2]
    values = found["dies_at_three"].values
    assert np.isnan(values[2]) and np.delete(values, 2).tolist() == [1, 2, 4, 5, 6]


def test_a_worker_killed_once_costs_no_point(tmp_path, monkeypatch):
    monkeypatch.setenv("DIES_ONCE", str(tmp_path / "died"))
    points = grid(k=[1, 2, 3, 4])
    with cf.ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        found = sweep(oscillator(), points, dies_once, t_span=0.1, executor=pool, chunk=2)
    assert (tmp_path / "died").exists()
    assert found["dies_once"].values.tolist() == [1, 2, 3, 4]


def test_a_function_that_does_not_pickle_is_named_at_the_start():
    asked = dict(t_span=0.1, executor="processes")
    with pytest.raises(SweepError, match=r"cannot be sent to other processes.*threads"):
        sweep(oscillator(), grid(k=[1]), lambda run: run.t_end, **asked)


EVERY = {name: None for name in LIBRARY} | GRAPHS


@pytest.mark.parametrize("name", sorted(EVERY))
def test_graphs_pickle_and_run_the_same(name):
    import bondgraph.models

    graph = EVERY[name]() if EVERY[name] else getattr(bondgraph.models, name).graph()
    again = pickle.loads(pickle.dumps(graph))
    assert list(again.elements) == list(graph.elements) and again.bonds == graph.bonds
    with pytest.raises(TypeError):
        again.elements["new"] = None
    one, other = simulate(graph, 0.01), simulate(again, 0.01)
    assert one.outcome is other.outcome and one.x_end.tobytes() == other.x_end.tobytes()
