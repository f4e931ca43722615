"""What goes wrong at a point is named in its cell and takes no other with it."""

from __future__ import annotations

import numpy as np
import pytest
import xarray

from bondgraph import CompiledModel, I, One, Se, assemble
from bondgraph.models import bicycle_brake
from bondgraph.sweeps import Progress, grid, outcomes, samples, sweep

from .cases import of_two_shapes, oscillator, raises_at_three

SPAN = dict(t_span=1.0, initial={"spring.q": 0.1})


def test_values_that_the_model_refuses():
    masses = [2.0, -1.0, 0.0, float("nan"), float("inf"), 3.0]
    found = sweep(oscillator(), samples({"m": masses}), ("final:speed", "peak:speed"), **SPAN)
    ends = sweep(oscillator(), samples({"m": masses}), "final:speed", **SPAN)
    for dataset in (found, ends):
        assert outcomes(dataset).tolist() == ["finished", *["refused"] * 4, "finished"]
        for row in range(1, 5):
            assert dataset.message.values[row].startswith("refused: parameter 'm'")
        assert np.isnan(dataset["final:speed"].values[1:5]).all()
        assert np.isnan(dataset.t_end.values[1:5]).all()
        assert np.isfinite(dataset["final:speed"].values[[0, 5]]).all()
    alone = sweep(oscillator(), samples({"m": [3.0]}), "final:speed", **SPAN)
    assert ends["final:speed"].values[5] == alone["final:speed"].item()


def test_all_points_refused_is_no_error():
    found = sweep(oscillator(), samples({"m": [-1.0, -2.0]}), "final:speed", **SPAN)
    assert outcomes(found).tolist() == ["refused"] * 2
    assert np.isnan(found["final:speed"]).all()


def test_a_run_that_stops_keeps_its_outcome_and_time():
    mass = I("m", 1)
    escape = assemble("escape", Se("push", mass.p**2) >> One("v") >> mass)
    # p' = p^2 reaches infinity at 1/p0
    starts = [0.1, 1.0, 2.0]
    found = sweep(escape, samples({"m.p": starts}), "final:m.p", t_span=0.75)
    assert outcomes(found)[:1].tolist() == ["finished"] and outcomes(found)[2] != "finished"
    assert found["final:m.p"].values[0] == pytest.approx(1 / (1 / 0.1 - 0.75), rel=1e-5)
    assert np.isnan(found["final:m.p"].values[2])
    assert found.t_end.values[2] == pytest.approx(0.5, abs=1e-3)
    assert found.message.values[2]


def test_a_run_beyond_its_limits_is_told():
    found = sweep(
        bicycle_brake.graph(), grid(V0=[0.5, 1.4]), "final:V_c", t_span=0.5, max_events=10
    )
    assert outcomes(found).tolist() == ["event limit", "finished"]


def test_a_signal_that_is_no_number_is_no_success():
    found = sweep(
        oscillator(), grid(k=[1.0, 8.0]), "final:root", t_span=1.0, initial=SPAN["initial"]
    )
    # cos(omega) is positive for k = 1, negative for k = 8
    assert outcomes(found).tolist() == ["finished", "non-finite"]
    assert "final:root" in found.message.values[1]


def test_a_function_that_fails_at_a_point():
    found = sweep(oscillator(), grid(k=[1, 3, 5]), raises_at_three, executor="serial", **SPAN)
    assert outcomes(found).tolist() == ["finished", "quantity failed", "finished"]
    assert "ZeroDivisionError: three" in found.message.values[1]
    assert found["raises_at_three"].values[[0, 2]].tolist() == [1.0, 5.0]


@pytest.mark.parametrize("chunk", [1, 2, 5])
def test_an_array_of_another_shape_than_the_first_has_failed(chunk):
    found = sweep(oscillator(), grid(k=[1, 2, 3, 4, 2.5]), of_two_shapes, chunk=chunk, **SPAN)
    named = outcomes(found).tolist()
    assert named == ["finished", "finished", "quantity failed", "quantity failed", "finished"]
    assert found["of_two_shapes"].shape == (5, 2)
    assert np.isnan(found["of_two_shapes"].values[2:4]).all()


def test_words_for_outcomes_survive_the_file(tmp_path):
    sweep(oscillator(), grid(m=[1, -1]), "final:speed", out=tmp_path / "s", **SPAN)
    with xarray.open_dataset(tmp_path / "s" / "dataset.nc") as read:
        assert outcomes(read).tolist() == ["finished", "refused"]
        assert read["final:speed"].units == "m/s" and read["m"].units == "kg"
        assert str(read.message.values[1]).startswith("refused")


def test_progress_counts_every_point_once():
    told: list[Progress] = []
    points = grid(m=[1, 2, -1, 3], k=[1, 2, 3, 4, 5])
    sweep(CompiledModel(oscillator()), points, "final:speed", chunk=3, progress=told.append, **SPAN)
    assert [now.done for now in told] == [3, 6, 9, 12, 15, 18, 20]
    last = told[-1]
    assert (last.total, last.failed, last.resumed, last.left) == (20, 5, 0, 0.0)
    assert last.rate == pytest.approx(20 / last.seconds)


def test_nothing_is_printed(capfd):
    sweep(oscillator(), grid(m=[1, -1]), "final:speed", **SPAN)
    assert capfd.readouterr() == ("", "")
