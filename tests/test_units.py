"""Units at the border: compatible units come in, SI stays inside, 2 pi is never guessed."""

import math

import pint
import pytest

from bondgraph.errors import ParameterError
from bondgraph.units import check_compatible, from_si, quantity_parts, to_si

SI = [
    (350, "N/mm", 350e3),
    (1, "", 1.0),
    (20, "degC", 293.15),
    (1, "bar", 1e5),
    (3, "km/h", 3 / 3.6),
    (180, "deg", math.pi),
    (60, "rpm", 2 * math.pi),
    (300, "Hz", 300.0),
    (1, "l/min", 1e-3 / 60),
    (5, "percent", 0.05),
    (1, "N*m*s/rad", 1.0),
]


@pytest.mark.parametrize(("value", "unit", "si"), SI)
def test_there_and_back(value, unit, si):
    assert to_si(value, unit) == pytest.approx(si, rel=1e-14)
    assert from_si(si, unit) == pytest.approx(value, rel=1e-13)


@pytest.mark.parametrize(
    "unit", ["N/(", "2*m", "m+s", "m**x", "5", '"', "blorp", "__import__('os')"]
)
def test_unknown_units_are_refused_by_name(unit):
    with pytest.raises(ParameterError, match=r"unit .* (is not known|cannot be read)"):
        to_si(1, unit)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("mm", "m"), ("N/mm", "N/m"), ("J", "N*m"), ("1/s", "Hz"), ("deg", "rad"), ("rpm", "rad/s"),
     ("degC", "K"), ("delta_degC", "K"), ("kHz", "Hz"), ("", ""), ("rad", "")],
)  # fmt: skip
def test_compatible(unit, expected):
    check_compatible(unit, expected)
    check_compatible(expected, unit)


@pytest.mark.parametrize(
    ("unit", "expected"), [("kg", "N"), ("", "m"), ("m", ""), ("N*m", "N/m"), ("A", "V")]
)
def test_incompatible(unit, expected):
    with pytest.raises(ParameterError, match="does not measure what"):
        check_compatible(unit, expected)


@pytest.mark.parametrize("angular", ["rad/s", "rpm", "deg/s", "turn/s", "krad/s", "cycle/s"])
@pytest.mark.parametrize("cyclic", ["Hz", "kHz"])
def test_hertz_and_angular_speed_are_never_mixed(angular, cyclic):
    for pair in ((angular, cyclic), (cyclic, angular)):
        with pytest.raises(ParameterError, match="2 pi"):
            check_compatible(*pair)


def test_expected_unit():
    assert to_si(1, "kN/m", expected="N/mm") == 1000
    with pytest.raises(ParameterError):
        to_si(1, "kg", expected="N/mm")


def test_quantities():
    registry = pint.UnitRegistry()
    assert quantity_parts(registry.Quantity(2, "N/mm")) == (2.0, "newton / millimeter")
    assert quantity_parts(2.0) is None
    with pytest.raises(ParameterError, match="not one number"):
        quantity_parts(registry.Quantity([1, 2], "N"))
