"""Transfer functions in numbers against those in symbols."""

import numpy
import pytest
import sympy

from bondgraph import linearize, models, symbolic_system
from bondgraph.errors import BondGraphError
from bondgraph.linear import TransferFunction

from .graphs import driven, following, ladder, unseen


def test_the_oscillator():
    found = driven().transfer_function("x", "F")
    assert found.numerator == pytest.approx([0.5])
    assert found.denominator == pytest.approx([1, 0.25, 4])
    assert (found.unit, str(found)) == ("m/N", "(0.5) / (s^2 + 0.25*s + 4)")


def test_signs_and_rounding_are_written_plainly():
    pair = numpy.array([1e-17 + 2j, 1e-17 - 2j])
    found = TransferFunction("y", "u", numpy.array([0j]), pair, -1.0)
    assert str(found) == "(-s) / (s^2 + 4)" and found.denominator.tolist() == [1, 0, 4]


def test_modes_that_the_channel_does_not_see_are_left_out():
    found = unseen().transfer_function("v", "F")
    assert found.zeros.size == 0
    assert found.poles == pytest.approx([-1.5]) and found.gain == pytest.approx(0.5)


def test_of_a_ladder():
    system = ladder(12)
    found = system.transfer_function("u", "E")
    assert (len(found.zeros), len(found.poles)) == (0, 24)
    response = system.frequency_response()
    assert found(1j * response.omega) == pytest.approx(response["u", "E"], rel=1e-9)
    with pytest.raises(BondGraphError, match="beyond floating-point"):
        ladder(60).transfer_function("u", "E")


def test_that_is_zero():
    system = unseen().with_outputs("other.p")
    found = system.transfer_function("other.p", "F")
    assert (found.gain, found.poles.size, found(3j)) == (0, 0, 0)


def test_more_zeros_than_poles():
    found = following().transfer_function("force", "V")  # 2 s + 3 / s
    assert found.numerator == pytest.approx([2, 0, 3], abs=1e-12)
    assert found.denominator == pytest.approx([1, 0])


def test_rounding_is_no_root():
    """suspension over v_road has a zero at the origin, and nothing beside it."""
    found = linearize(models.quarter_car.graph()).transfer_function("suspension", "v_road")
    assert found.zeros.tolist() == [0] and found.numerator[1] == 0


@pytest.mark.parametrize("output", ["v_body", "acceleration", "suspension", "tyre"])
def test_of_the_quarter_car_in_symbols(output):
    graph = models.quarter_car.graph()
    system = linearize(graph)
    found = system.transfer_function(output, "v_road")
    exact = symbolic_system(graph).transfer_function(output, "v_road")
    values = {name: system.at.parameters[str(name)] for name in exact.expression.free_symbols
              if str(name) in system.at.parameters}  # fmt: skip
    (s,) = exact.expression.free_symbols - values.keys()
    for point in (0.4 + 1j, 30j, 2000.0):
        expected = complex(exact.expression.xreplace(values).subs(s, sympy.sympify(point)))
        assert found(point) == pytest.approx(expected, rel=1e-10)


def test_symbols_are_at_hand():
    system = linearize(models.mass_on_belt.graph()).with_inputs("N").with_outputs("spring.e")
    values = {name: value for name, value in system.at.parameters.items() if name != "N"}
    symbolic = system.symbolic(system.at.states, values)
    assert [s.name for s in symbolic.inputs] == ["N"]
    load = {symbolic.inputs[0]: system.at.parameters["N"]}
    for name in "ABCD":
        found = numpy.array(getattr(symbolic, name).xreplace(load), dtype=float)
        assert found == pytest.approx(getattr(system, name))
