"""Plots of linear systems: units on axes, curves and bars that are what they say."""

import re

import numpy
import pytest
import sympy

from bondgraph import C, CField, I, One, R, Se, assemble, linearize, models, plot
from bondgraph.errors import BondGraphError

CAR = linearize(models.quarter_car.graph())
BRAKE = linearize(models.bicycle_brake.graph())


def drawn():
    yield from plot.bode_plot(CAR, "v_body")
    yield plot.pole_zero_plot(CAR)
    yield plot.step_plot(CAR, ["suspension", "tyre"])
    yield plot.mode_shape_plot(BRAKE.mode_shapes()[1])
    yield plot.energy_plot(BRAKE)


def test_every_axis_that_measures_has_a_unit():
    for ax in drawn():
        labels = [label for label in (ax.get_xlabel(), ax.get_ylabel()) if label]
        assert labels and all(re.fullmatch(r".+ \[\S+\]", label) for label in labels)


def test_the_callers_axes_are_used():
    for draw in (
        lambda ax: plot.pole_zero_plot(CAR, ax=ax),
        lambda ax: plot.step_plot(CAR, "tyre", ax=ax),
        lambda ax: plot.mode_shape_plot(CAR.mode_shapes()[0], ax=ax),
        lambda ax: plot.energy_plot(CAR, ax=ax),
        lambda ax: plot.bode_plot(CAR, ax=ax)[0],
    ):
        ax = plot.new_axes()
        assert draw(ax) is ax
    both = plot.new_axes(), plot.new_axes()
    assert plot.bode_plot(CAR, ax=both) == both


def test_axes_without_a_grid_are_divided_too():
    from matplotlib.figure import Figure

    ax = Figure().add_axes((0.1, 0.1, 0.8, 0.8))
    above, below = plot.bode_plot(CAR, "tyre", ax=ax)
    assert above is ax and above.get_position().y0 > below.get_position().y1


def test_bode_shows_the_response():
    response = CAR.frequency_response()
    above, below = plot.bode_plot(response, "v_body", "v_road")
    assert above.lines[0].get_ydata() == pytest.approx(abs(response["v_body", "v_road"]))
    assert below.lines[0].get_ydata() == pytest.approx(response.phase("v_body", "v_road"))
    assert above.lines[0].get_xdata() == pytest.approx(response.omega / 2 / numpy.pi)
    assert above.get_ylabel() == "magnitude [1]"
    assert plot.bode_plot(response)[0].get_ylabel() == "magnitude [SI]"


def test_curves_differ_without_colour():
    above, _ = plot.bode_plot(CAR)
    styles = [line.get_linestyle() for line in above.lines]
    assert len(styles) == 4 == len(set(styles))


def test_step_and_impulse():
    impulse = CAR.impulse_response()
    ax = plot.step_plot(impulse, "tyre")
    assert ax.lines[-1].get_ydata() == pytest.approx(impulse["tyre", "v_road"])
    assert ax.lines[-1].get_label() == "tyre, impulse of v_road"
    with pytest.raises(BondGraphError, match="outputs of one unit share an axis"):
        plot.step_plot(CAR)
    with pytest.raises(BondGraphError, match="nothing to plot"):
        plot.step_plot(CAR, [])


def test_poles_and_zeros_stand_where_they_are():
    ax = plot.pole_zero_plot(CAR, "v_body", "v_road")
    marks = {line.get_label(): line for line in ax.lines}
    assert marks["poles"].get_xdata() == pytest.approx(CAR.poles().real)
    assert marks["poles"].get_ydata() == pytest.approx(CAR.poles().imag)
    assert marks["zeros"].get_xdata() == pytest.approx([-50 / 3])
    assert {line.get_label() for line in plot.pole_zero_plot(BRAKE).lines} & {"poles", "zeros"} == {
        "poles"
    }


def test_bars_of_a_mode_shape():
    shape = CAR.mode_shapes()[2]
    ax = plot.mode_shape_plot(shape)
    lengths = [bar.get_width() for bar in ax.patches]
    assert lengths == pytest.approx([abs(value) for value in shape.motion.values()])
    against = [bool(bar.get_hatch()) for bar in ax.patches]
    assert against == [abs(shape.phase(name)) > 90 for name in shape.motion]
    words = [text.get_text() for text in ax.texts]
    assert any("∠ \N{MINUS SIGN}116°" in word for word in words)
    wide = plot.mode_shape_plot(BRAKE.mode_shapes()[1], within_unit=True)
    assert max(bar.get_width() for bar in wide.patches) == pytest.approx(1)


def test_bars_of_energy_add_up():
    ax = plot.energy_plot(BRAKE)
    ends = {}
    for bar in ax.patches:
        row = round(bar.get_y() + bar.get_height() / 2)
        ends[row] = ends.get(row, 0) + bar.get_width()
    assert list(ends.values()) == pytest.approx([1, 1, 1], abs=5e-3)
    faces = [(tuple(bar.get_facecolor()), bar.get_hatch()) for bar in ax.patches[::3]]
    assert len(set(faces)) == len(faces)


def test_models_with_little_to_show():
    u = sympy.Symbol("u")
    bare = assemble("g", Se("s", u) >> One("v") >> R("r", 2), inputs=[u])
    lone = assemble("h", One("v") >> (I("m", 1), R("b", 2)))
    for system in (linearize(bare), linearize(lone)):
        plot.energy_plot(system)
        plot.pole_zero_plot(system)
        for shape in system.mode_shapes():
            plot.mode_shape_plot(shape)
    field = CField("beam", ("a", "b"), stiffness=[[2, -1], [-1, 2]])
    pair = assemble(
        "pair", One("a") >> (I("m", 1), field["a"]), One("b") >> (I("n", 1), field["b"])
    )
    shown = plot.energy_plot(linearize(pair))
    assert shown.get_xlim()[0] < 0.01
    free = linearize(assemble("free", One("v") >> (I("m", 1), C("x", stiffness=0))))
    assert plot.energy_plot(free).get_yticklabels()
