"""Points: products, columns, designs, and what is refused before anything runs."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from bondgraph.errors import BondGraphError, SweepError
from bondgraph.sweeps import Final, grid, latin_hypercube, samples, sobol, sweep, uniform

from .cases import oscillator


def test_a_grid_is_the_product_with_the_last_axis_fastest():
    points = grid({"spring.q": [0, 1]}, m=[1, 2, 3], k=[5, 6])
    rows = zip(*(points.columns[name].tolist() for name in ("spring.q", "m", "k")), strict=True)
    assert list(rows) == list(itertools.product([0, 1], [1, 2, 3], [5, 6]))
    assert points.shape == (2, 3, 2) and points.dims == ("spring.q", "m", "k")


def test_samples_by_columns_and_by_rows_are_the_same():
    columns = samples({"m": [1, 2], "k": ([3, 4], "N/mm")})
    rows = samples([{"m": 1, "k": (3, "N/mm")}, {"m": 2, "k": (4, "N/mm")}])
    for points in (columns, rows):
        assert {name: c.tolist() for name, c in points.columns.items()} == {
            "m": [1, 2],
            "k": [3, 4],
        }
        assert points.units == {"m": "", "k": "N/mm"} and points.dims == ("point",)


@pytest.mark.parametrize("design", [uniform, latin_hypercube, sobol])
def test_designs_fill_their_box_and_repeat_by_seed(design):
    box = {"a": (-1, 3), "b": (10, 20, "N/mm")}
    one, same, other = design(box, 64, seed=5), design(box, 64, seed=5), design(box, 64, seed=6)
    for name, (low, high) in {"a": (-1, 3), "b": (10, 20)}.items():
        column = one.columns[name]
        assert (column >= low).all() and (column < high).all()
        assert (column == same.columns[name]).all() and (column != other.columns[name]).any()
        assert abs(column.mean() - (low + high) / 2) < (high - low) / 8
    assert one.units["b"] == "N/mm"


def test_a_latin_hypercube_has_one_point_in_each_slice():
    points = latin_hypercube({"a": (0, 1), "b": (5, 7)}, 50, seed=1)
    assert sorted(np.floor(points.columns["a"] * 50)) == list(range(50))
    assert sorted(np.floor((points.columns["b"] - 5) * 25)) == list(range(50))


BAD = [
    (grid, "at least one point"),
    (lambda: grid(m=[]), "at least one point"),
    (lambda: samples([]), "at least one point"),
    (lambda: samples({"m": [1, 2], "k": [1]}), "length.*m 2, k 1"),
    (lambda: samples([{"m": 1}, {"k": 1}]), "point 1 has no 'm'"),
    (lambda: samples([{"m": (1, "g")}, {"m": (1, "kg")}]), "2 units"),
    (lambda: grid(m=["heavy"]), "'m' must be numbers"),
    (lambda: grid(m=[[1, 2]]), "one row"),
    (lambda: uniform({"m": (2, 1)}, 5, seed=0), "lo < hi"),
    (lambda: uniform({"m": (1, float("inf"))}, 5, seed=0), "finite"),
    (lambda: uniform({}, 5, seed=0), "none"),
    (lambda: latin_hypercube({"m": (1, 2)}, 0, seed=0), "none"),
    (lambda: sobol({"m": (1, 2)}, 100, seed=0), "powers of two.*128"),
]


@pytest.mark.parametrize(("make", "match"), BAD)
def test_what_makes_no_points_is_refused(make, match):
    with pytest.raises(SweepError, match=match):
        make()


REFUSED = [
    (dict(points=grid(mm=[1])), "'mm' is not known"),
    (dict(points=grid(m=([1], "N"))), "'m'.*'N'"),
    (dict(points={"m": [1]}), "grid.*or samples"),
    (dict(points=3), "points are"),
    (dict(quantity="final:nothing"), "'nothing' is not known"),
    (dict(quantity="count:spring:stick"), "no switching element 'spring'"),
    (dict(quantity="peek:speed"), "did you mean peak"),
    (dict(quantity="peak:speed@2"), "outside the run"),
    (dict(quantity="energy:lost"), "'lost' is not known"),
    (dict(quantity=[]), "at least one quantity"),
    (dict(quantity=["final:speed", Final("speed")]), "given twice"),
    (dict(quantity=3), "cannot be read"),
    (dict(parameters={"mm": 1}), "'mm' is not known"),
    (dict(points=grid(k=[1]), parameters={"m": -1}), "'m' is -1"),
    (dict(points=grid(k=[1]), parameters={"m": (1, "N")}), "'N' does not measure"),
    (dict(initial={"p": 1}), "state 'p' is not known"),
    (dict(inputs={"pull": 1}), "input 'pull' is not known"),
    (dict(rtol=0.5), "rtol is 0.5"),
    (dict(max_step=-1), "max_step"),
    (dict(solver="euler"), "solver 'euler'"),
    (dict(t_span=-1), "run forward"),
    (dict(t_span="soon"), "t_span"),
    (dict(t_eval=[0, 5]), "t_eval"),
    (dict(executor="cloud"), "executor 'cloud'"),
    (dict(workers=0), "workers"),
    (dict(chunk=0), "chunk"),
    (dict(resume=True), "resume needs out"),
]


@pytest.mark.parametrize(("changes", "match"), REFUSED)
def test_what_no_point_could_do_is_one_error_at_the_start(changes, match):
    told = []
    asked = dict(points=grid(m=[1]), quantity="final:speed", t_span=1.0, progress=told.append)
    asked |= changes
    with pytest.raises(BondGraphError, match=match):
        sweep(oscillator(), asked.pop("points"), asked.pop("quantity"), **asked)
    assert told == []
