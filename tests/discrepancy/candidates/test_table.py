"""The table of effects is complete, and each value keeps its promises."""

import itertools
import math

import numpy
import pytest
import sympy

from bondgraph.discrepancy.candidates import (
    DISPLACEMENT,
    EFFECTS,
    EFFORT,
    FLOW,
    Coefficient,
    Effect,
    Scale,
    Signals,
    effects,
    resistor,
)
from bondgraph.discrepancy.candidates.places import KINDS
from bondgraph.errors import LawError

CONTRACT = [
    "viscous_damping",
    "coulomb_friction",
    "stribeck_friction",
    "lugre_friction",
    "quadratic_drag",
    "linear_stiffness",
    "cubic_stiffness",
    "dead_zone",
    "end_stop",
    "hysteresis",
    "effort_bias",
    "flow_bias",
    "leakage",
    "overflow",
    "saturation",
    "orifice_flow",
    "nonlinear_inertance",
    "added_inertia",
    "compliant_coupling",
    "transport_delay",
    "sensor_bias",
    "thermal_fade",
    "run_out",
]
ALL = pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)


def test_every_name_of_the_contract_has_one_effect():
    assert sorted(EFFECTS) == sorted(CONTRACT)
    assert all(name == effect.name for name, effect in EFFECTS.items())


def test_every_kind_of_site_has_an_effect():
    assert {kind for effect in EFFECTS.values() for kind in effect.sites} == set(KINDS)


@ALL
def test_an_effect_can_be_absent_and_starts_from_the_data(effect):
    assert effect.absent, "no value at which it is gone"
    small = effect.start(Scale(2.0, 3.0, 5.0, 7.0))
    assert all(math.isfinite(value) for value in small.values())
    assert not effect.physical(small)
    assert all(effect.absent[name] == 0 for name in effect.linear)
    assert effect.reference and effect.meaning


@ALL
def test_linear_coefficients_enter_linearly(effect):
    """Doubling them all doubles the law, to first order, and at zero nothing is left."""
    symbols = effect.symbols
    share = sympy.Symbol("share", positive=True)
    scaled = {symbols[name]: share * symbols[name] for name in effect.linear}
    if not scaled or set(effect.law) & {"slip", "signal"} or effect.name == "nonlinear_inertance":
        return
    for law in effect.law.values():
        grown = law.xreplace(scaled)
        assert sympy.simplify(grown - share * law) == 0


@pytest.mark.parametrize(
    "effect",
    [e for e in EFFECTS.values() if e.passive and set(e.law) in ({"effort"}, {"flow"})],
    ids=lambda effect: effect.name,
)
def test_resistive_laws_take_power_at_all_flows(effect):
    values = {effect.symbols[name]: value for name, value in effect.start().items()}
    (law,) = effect.law.values()
    for there in numpy.linspace(-3, 3, 25):
        for along in (FLOW, EFFORT):
            if along in law.free_symbols and DISPLACEMENT not in law.free_symbols:
                number = law.subs(values).subs(along, there)
                assert float(number * there) >= 0


def _moving():
    t = numpy.linspace(0, 4, 400)
    flow = numpy.sin(3 * t) + 0.4 * numpy.cos(5 * t)
    return Signals.of(t, flow=flow, effort=2 * flow + numpy.cos(7 * t), momentum=3 * flow)


@ALL
def test_forms_are_columns_that_differ(effect):
    signals = _moving()
    assert effect.forms, "nothing to screen it with"
    for shape in effect.forms:
        columns = [feature.evaluate(signals) for feature in shape.features]
        assert columns
        assert all(column.shape == signals.t.shape for column in columns)
        assert all(numpy.isfinite(column).all() and numpy.any(column) for column in columns)
        for first, second in itertools.combinations(columns, 2):
            assert abs(numpy.corrcoef(first, second)[0, 1]) < 0.9999


@ALL
def test_forms_of_one_effect_differ(effect):
    """Two forms that span the same would be scored twice for nothing."""
    signals = _moving()
    tables = [
        numpy.column_stack([feature.evaluate(signals) for feature in shape.features])
        for shape in effect.forms
    ]
    for one, other in itertools.combinations(tables, 2):
        if one.shape == other.shape:
            left = other - one @ numpy.linalg.lstsq(one, other, rcond=None)[0]
            assert numpy.linalg.norm(left) > 1e-3 * numpy.linalg.norm(other)


@ALL
def test_forms_start_from_the_amounts_of_their_columns(effect):
    names = {item.name for item in effect.coefficients}
    for shape in effect.forms:
        for size in (0.5, -0.5) if shape.signed else (0.5,):
            started = shape.starts([size] * len(shape.features), _moving())
            assert started and set(started) <= names
            assert all(math.isfinite(value) for value in started.values())
            assert not effect.physical(started)


@pytest.mark.parametrize("amount", [0.3, 5.0])
@pytest.mark.parametrize(
    "effect",
    [
        e
        for e in EFFECTS.values()
        if set(e.law) & {"effort", "flow"}
        and not (e.states or e.shapes)
        and e.linear
        and e.sites != ("inertia",)
    ],
    ids=lambda effect: effect.name,
)
def test_a_form_times_its_amount_is_the_law(effect, amount):
    """What screening regresses on is what the element does, with the coefficients it starts from."""
    signals = _moving()
    (shape,) = effect.forms
    values = effect.start() | shape.starts([amount] * len(shape.features), signals)
    (column,) = (feature.evaluate(signals) for feature in shape.features)
    law = effect.law["effort" if "effort" in effect.law else "flow"]
    plain = sympy.lambdify([FLOW, EFFORT, DISPLACEMENT, *effect.symbols.values()], law, "numpy")
    given = [values[name] for name in effect.symbols]
    told = plain(signals.flow, signals.effort, signals.displacement, *given)
    told = told if effect.passive else -told  # a source gives, and columns are what is taken
    near = 0.05 if effect.name == "orifice_flow" else 1e-9  # laminar at small pressures
    assert numpy.linalg.norm(amount * column - told) <= near * amount * numpy.linalg.norm(column)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"sites": ("junction",)}, "kind of site"),
        ({"law": {"effort": sympy.Symbol("stray") * FLOW}}, "stray"),
        ({"coefficients": (Coefficient("b", "", "", lambda s: 1.0),) * 2}, "two coefficients"),
    ],
)
def test_what_is_wrong_is_said(changes, word):
    b = Coefficient("b", "{e}/({f})^3", "cubic damping", lambda s: 1.0, absent=0.0, linear=True)
    given = {
        "name": "cubic_damping",
        "sites": ("1-junction",),
        "coefficients": (b,),
        "law": {"effort": b.symbol * FLOW**3},
        "build": resistor,
        "meaning": "cubic damping",
        "reference": "none",
    }
    Effect(**given)
    with pytest.raises(LawError, match=word):
        Effect(**given | changes)


def test_own_effects_join_and_replace():
    own = EFFECTS["leakage"]
    assert effects("overflow", more=[own]) == (EFFECTS["overflow"], own)
    with pytest.raises(LawError, match="leakage"):
        effects("leakige")


def test_signs_that_no_passive_element_has_are_named():
    assert EFFECTS["viscous_damping"].physical({"damping": -1.0}) == ("damping",)
    assert EFFECTS["cubic_stiffness"].physical({"cubic": -1.0}) == ()
