"""Plots of attractors: what is drawn, at the numbers found."""

import pytest

from bondgraph import BondGraphError, C, I, One, R, assemble, find_attractors, reach
from bondgraph.models import bicycle_brake
from bondgraph.plot import attractor_plot, new_axes, reach_plot, save

from ..cycles.graphs import van_der_pol


@pytest.fixture(scope="module")
def squeal():
    return find_attractors(bicycle_brake.graph(), {"mu_s": 0.5, "tau": 0.02})


@pytest.fixture(scope="module")
def by_tau():
    return reach(bicycle_brake.graph(), ("tau", 0.01, 0.05, 5), {"mu_s": 0.5})


def labels(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


class TestAttractorPlot:
    def test_cycles_steady_state_and_push(self, squeal, tmp_path):
        ax = attractor_plot(squeal, ("x_c", "V_c"))
        assert labels(ax)[:3] == ["cycle, 143.3 Hz", "cycle, 108.6 Hz", "steady state, stable"]
        curve = next(line for line in ax.lines if line.get_label() == "cycle, 143.3 Hz")
        assert curve.get_xdata().min() == pytest.approx(1.63360e-3, abs=1e-8)
        assert curve.get_xdata().max() == pytest.approx(3.66899e-3, abs=1e-8)
        dot = next(line for line in ax.lines if line.get_label() == "steady state, stable")
        assert dot.get_xdata()[0] == pytest.approx(900 / 350e3, rel=1e-6)
        assert save(ax, tmp_path / "plane.png").stat().st_size > 10_000

    def test_the_signals_show_the_push(self, squeal):
        ax = attractor_plot(squeal)
        assert (ax.get_xlabel(), ax.get_ylabel()) == ("theta_w [rad]", "omega_r [rad/s]")
        assert "smallest push that leaves" in labels(ax)

    def test_sticks_are_full_dots(self, squeal):
        ax = attractor_plot(squeal, ("x_c", "V_c"))
        dots = [line for line in ax.lines if line.get_marker() == "o" and line.get_markersize() < 5]
        assert {line.get_markerfacecolor() == "white" for line in dots} == {True, False}
        assert all(len(line.get_xdata()) == 1 for line in dots) and len(dots) == 4

    def test_unstable_point_is_hollow(self):
        ax = new_axes()
        assert attractor_plot(find_attractors(van_der_pol()), ax=ax) is ax
        dot = next(line for line in ax.lines if "not stable" in str(line.get_label()))
        assert dot.get_markerfacecolor() == "white" and dot.get_xdata()[0] == 0.0

    def test_one_state(self):
        found = find_attractors(assemble("rc", One("l") >> (R("r", 2), C("c", 3, initial=1))))
        assert attractor_plot(found).get_xlabel() == "c.q [1]"

    def test_nothing_to_draw(self):
        graph = assemble(
            "grows", One("l") >> (I("m", 1, initial=1), C("k", 1), R("r", effort=lambda f: -f))
        )
        with pytest.raises(BondGraphError, match="neither"):
            attractor_plot(find_attractors(graph))


class TestReachPlot:
    def test_outcomes_and_changes(self, by_tau, tmp_path):
        ax = reach_plot(by_tau, "x_c")
        assert labels(ax) == ["steady state", "cycle"]
        cuts = [line.get_xdata()[0] for line in ax.lines if line.get_linestyle() == "--"]
        assert len(by_tau.changes) == len([text for text in ax.texts])
        cycle = next(line for line in ax.lines if line.get_label() == "cycle")
        swings = [p.amplitudes["x_c"].peak_to_peak for p in by_tau.points if p.outcome == "cycle"]
        assert cycle.get_ydata().tolist() == swings and len(cuts) <= len(by_tau.changes)
        assert ax.get_ylim()[0] < 0 < max(swings) < ax.get_ylim()[1]
        assert save(ax, tmp_path / "reach.png").stat().st_size > 5_000

    def test_a_displacement_unless_named(self, by_tau):
        assert reach_plot(by_tau).get_ylabel() == "swing of x_c [m]"

    def test_unknown_signal(self, by_tau):
        with pytest.raises(BondGraphError, match="nonsense"):
            reach_plot(by_tau, "nonsense")
