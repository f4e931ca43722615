"""Plots: axes with units, the caller's own axes, curves that are what they say."""

from __future__ import annotations

import re
import subprocess
import sys

import numpy as np
import pytest

from bondgraph import eigenvalue_map, plot, simulate, steady_state
from bondgraph.errors import BondGraphError
from bondgraph.models import bicycle_brake, mass_on_belt, quarter_car
from bondgraph.stability import assess

BRAKE = bicycle_brake.graph()
BELT = mass_on_belt.graph()


@pytest.fixture(scope="module")
def belt_run():
    return simulate(BELT, (0, 3), t_eval=np.linspace(0, 3, 3001))


@pytest.fixture(scope="module")
def locus():
    return assess(BRAKE, {"v_s": 0.2}, vary=["V0=0.25:1.5:80"]).loci[0]


def plots(run, locus):
    yield plot.time_response(run, ["v", "slip"])
    yield plot.phase_plane(run, [("x", "v")], since=2.0)
    yield plot.application(run, "x")
    yield plot.friction_curve(BELT, "contact", steady_state(BELT))
    yield plot.root_locus(locus)
    yield plot.growth_rates(locus)


def test_every_axis_has_a_name_and_a_unit(belt_run, locus):
    for ax in plots(belt_run, locus):
        for label in (ax.get_xlabel(), ax.get_ylabel()):
            assert re.fullmatch(r".+ \[\S+\]", label), label


def test_the_callers_axes_are_used(belt_run, locus):
    for draw in (
        lambda ax: plot.time_response(belt_run, "v", ax=ax),
        lambda ax: plot.phase_plane(belt_run, [("x", "v")], ax=ax),
        lambda ax: plot.application(belt_run, "x", ax=ax),
        lambda ax: plot.friction_curve(BELT, "contact", steady_state(BELT), ax=ax),
        lambda ax: plot.root_locus(locus, ax=ax),
        lambda ax: plot.growth_rates(locus, ax=ax),
    ):
        ax = plot.new_axes()
        assert draw(ax) is ax and ax.lines


def test_pyplot_is_not_loaded():
    code = (
        "import sys, bondgraph.plot as p; p.time_response; p.new_axes();"
        "print('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "False"


def test_events_are_marked_where_they_happen(belt_run):
    ax = plot.time_response(belt_run, "slip")
    marks = {str(line.get_label()): line for line in ax.lines}
    times = marks["_stick"].get_xdata()
    assert times == pytest.approx([e.t for e in belt_run.events if e.to_mode == "stick"])
    assert np.abs(marks["_stick"].get_ydata()).max() < 1e-3


def test_a_phase_plane_tells_before_from_after(belt_run):
    ax = plot.phase_plane(belt_run, [("x", "v")], since=2.0)
    sizes = {str(line.get_label()): len(line.get_xdata()) for line in ax.lines}
    assert sizes["v"] == 1001 and sizes["v, before"] == 2000


def test_signals_of_two_units_do_not_share_an_axis(belt_run):
    with pytest.raises(BondGraphError, match=r"v \[m/s\], x \[m\]; use further axes"):
        plot.time_response(belt_run, ["v", "x"])
    scaled = plot.signal(belt_run, "x").scaled(10.0, "m/s").named("10 x")
    ax = plot.time_response(belt_run, ["v", scaled])
    assert ax.get_ylabel() == "v, 10 x [m/s]"
    assert ax.lines[-1].get_ydata() is not None


def test_overview_has_a_row_for_each_unit(belt_run, tmp_path):
    figure = plot.overview(belt_run)
    assert [ax.get_ylabel() for ax in figure.axes] == ["x [m]", "v, slip [m/s]"]
    assert figure.axes[-1].get_xlabel() == "time [s]"
    for ending in ("svg", "png", "pdf"):
        assert plot.save(figure, tmp_path / f"run.{ending}").stat().st_size > 1000
    with pytest.raises(BondGraphError, match="use the ending"):
        plot.save(figure, tmp_path / "run.xyz")
    with pytest.raises(BondGraphError, match="cannot write"):
        plot.save(figure, tmp_path / "missing" / "run.svg")


def test_friction_curve_is_odd_and_upright_at_zero():
    ax = plot.friction_curve(BELT, "contact", steady_state(BELT), span=1.0)
    slip, force = ax.lines[0].get_data()
    assert slip == pytest.approx(-slip[::-1]) and force == pytest.approx(-force[::-1])
    upright = force[slip == 0]
    assert upright.min() == pytest.approx(-4) and upright.max() == pytest.approx(4)
    expected = 10 * (0.25 + 0.15 * np.exp(-np.abs(slip) / 0.1)) * np.sign(slip)
    assert force[slip != 0] == pytest.approx(expected[slip != 0])


def test_friction_curve_knows_what_modulates_the_contact():
    ax = plot.friction_curve(BRAKE, "friction", steady_state(BRAKE, {"F_k": 450.0}))
    assert max(ax.lines[0].get_ydata()) == pytest.approx(0.5 * 450 / 0.4)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("slip [m/s]", "friction [N]")
    with pytest.raises(BondGraphError, match="no Friction"):
        plot.friction_curve(BRAKE, "rear.mass", steady_state(BRAKE))


def test_application_marks_the_time_constant():
    run = simulate(BRAKE, 0.6, {"mu_s": 0.42}, t_eval=np.linspace(0, 0.6, 6001))
    ax = plot.application(run, "N")
    dot = ax.lines[1]
    assert dot.get_xdata()[0] == pytest.approx(30, abs=0.1)  # tau in ms
    assert dot.get_ydata()[0] == pytest.approx(2250 * (1 - np.exp(-1)), rel=1e-2)


def test_root_locus_marks_edge_and_operating_point(locus):
    ax = plot.root_locus(locus)
    diamonds = [line for line in ax.lines if line.get_marker() == "D"]
    edge = [line for line in diamonds if line.get_markerfacecolor() != "white"]
    assert [line.get_ydata()[0] for line in edge] == pytest.approx([locus.edges[0].frequency_hz])
    (cross,) = [line for line in ax.lines if line.get_marker() == "x"]
    assert max(cross.get_xdata()) == pytest.approx(48.397, abs=1)
    assert any("Hopf: V0 = 1.012 m/s" in text.get_text() for text in ax.texts)


def test_any_model_has_a_locus_plot():
    result = assess(quarter_car.graph(), vary=["b_s=100:4000:60"])
    ax = plot.growth_rates(result.loci[0])
    assert ax.get_xlabel() == "b_s [N·s/m]" and len(ax.lines) >= 2


def test_units_are_printed_with_powers():
    assert plot.pretty("kg*m^2/s^3") == "kg·m²/s³"
    assert plot.Signal(np.zeros(2), "ratio").label == "ratio [1]"


def test_a_map_of_a_sweep_marks_what_failed():
    from bondgraph.sweeps import grid, samples, sweep

    masses, stiffs = np.array([-1.0, 0.5, 1.0, 2.0]), np.array([50.0, 75.0, 100.0])
    points = grid(m=masses, k=stiffs)
    found = sweep(BELT, points, ("count:contact:stick", "final:v"), t_span=0.5)
    ax = plot.sweep_map(found)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("mass [kg]", "spring stiffness [N/m]")
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["refused"]
    mesh, cells = ax.collections
    shown = mesh.get_array()
    assert shown.shape == (3, 4) and shown.mask[:, 0].all() and not shown.mask[:, 1:].any()
    assert shown[1, 2] == found["count:contact:stick"].sel(m=1.0, k=75.0)
    hatched = np.array([path.vertices[:4].mean(axis=0) for path in cells.get_paths()])
    assert (hatched[:, 0] < 0).all() and hatched[:, 1].tolist() == stiffs.tolist()
    assert cells.get_hatch()

    curve = plot.sweep_map(found.isel(k=1), "final:v")
    line, crosses = curve.lines
    assert line.get_xdata().tolist() == masses.tolist() and crosses.get_xdata().tolist() == [-1.0]
    assert curve.get_ylabel() == "final:v [m/s]"

    drawn = sweep(BELT, samples({"m": masses, "k": [60, 70, 80, 90]}), "final:v", t_span=0.5)
    cloud = plot.sweep_map(drawn)
    dots, crosses = cloud.collections[:2]
    assert len(dots.get_offsets()) == 3 and crosses.get_offsets().tolist() == [[-1.0, 60.0]]


def test_a_map_says_what_it_cannot_show():
    from bondgraph.sweeps import grid, sweep

    found = sweep(BELT, grid(m=[1.0], k=[50.0, 60.0], c=[0.1, 0.2]), "final:v", t_span=0.1)
    with pytest.raises(BondGraphError, match=r"m, k, c makes no curve and no map; select"):
        plot.sweep_map(found)
    with pytest.raises(BondGraphError, match="did you mean final:v"):
        plot.sweep_map(found, "final:w")
    one = plot.sweep_map(found.isel(m=0))
    assert one.get_xlabel() == "spring stiffness [N/m]"


class TestStabilityMap:
    def axes_of(self, **axes):
        found = eigenvalue_map(BRAKE, axes, product=True)
        return found, plot.stability_map(found)

    def test_boundary_hatching_and_frequency(self):
        found, ax = self.axes_of(V0=np.linspace(0.3, 1.5, 25), v_s=np.linspace(0.04, 0.2, 17))
        assert (ax.get_xlabel(), ax.get_ylabel()) == ("V0 [m/s]", "v_s [m/s]")
        (line,) = [line for line in ax.lines if line.get_label() == "_edge"]
        points = line.get_xydata()
        # unstable below v_s ln(N dmu/(v_s |c_H|)), c_H = -7.137493 N s/m
        edge = points[:, 1] * np.log(225 / (points[:, 1] * 7.137493))
        assert np.abs(points[:, 0] - edge).max() < 0.02
        bar = next(other for other in ax.figure.axes if other is not ax)
        assert bar.get_ylabel() == "frequency of the leading mode [Hz]"
        words = [text.get_text() for text in ax.get_legend().get_texts()]
        assert words == ["unstable", "boundary"]
        assert found.ok.all()

    def test_points_without_a_result_are_grey(self):
        _, ax = self.axes_of(V0=np.linspace(0.3, 1.5, 5), v_s=np.linspace(-0.1, 0.2, 4))
        assert "no result" in [text.get_text() for text in ax.get_legend().get_texts()]

    def test_two_axes_are_wanted(self):
        with pytest.raises(BondGraphError, match="over two axes"):
            self.axes_of(V0=np.linspace(0.3, 1.5, 5))
