"""Names, edits, starts and refusals of grafting."""

import dataclasses

import pytest
import sympy

from bondgraph import (
    BondGraphError,
    Df,
    I,
    Integrator,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    assign_causality,
    load,
    save,
    simulate,
)
from bondgraph.discrepancy.candidates import EFFECTS, FLOW, Change, Coefficient, Effect, resistor
from bondgraph.discrepancy.grafting import find_site, graft, sites
from bondgraph.draw import to_svg
from bondgraph.models import bicycle_brake

from ..machines import dc_motor, mass_spring, two_mass_chain


def test_friction_on_a_rotation_has_a_torque():
    new = graft(dc_motor(), "coulomb_friction", "wheel", parameters={"level": (30, "mN*m")})
    (row,) = [
        row
        for symbol, row in new.graph.parameters.items()
        if symbol.name == "coulomb_friction_level"
    ]
    assert (row.value, row.unit) == (30, "mN*m")
    assert "added by coulomb_friction at wheel" in row.meaning
    new = graft(dc_motor(), "quadratic_drag", "wheel")
    assert new.diff == (
        "+ R 'quadratic_drag' on 1-junction 'wheel'",
        "+ parameter 'quadratic_drag_drag' = 0.1 N*m/(rad/s)^2",
    )
    assert new.elements == ("quadratic_drag",)


def test_an_effect_stands_in_the_submodel_of_its_site():
    graph = bicycle_brake.graph()
    new = graft(graph, "lugre_friction", "rear.caliper")
    added = new.graph.elements.keys() - graph.elements.keys()
    assert all(name.startswith("rear.lugre_friction") for name in added)
    assert new.parameters["level"] == "rear_lugre_friction_level"
    assert new.edits[0].where.endswith("'rear.lugre_friction_root'")


def test_across_submodels_it_stands_above_them():
    graph = bicycle_brake.graph()
    inside = graft(graph, "viscous_damping", "between wheel.hub and wheel.rim")
    assert inside.name == "wheel.viscous_damping"
    across = graft(graph, "compliant_coupling", "bond wheel.hub>rotor_radius")
    assert across.name == "compliant_coupling"
    assert "- bond 'wheel.hub>rotor_radius'" in across.diff


def test_twice_the_same_effect_is_numbered():
    once = graft(mass_spring(), "coulomb_friction", "carriage")
    twice = graft(once.graph, "coulomb_friction", "carriage")
    assert twice.name == "coulomb_friction2"
    assert twice.parameters["level"] == "coulomb_friction2_level"
    with pytest.raises(BondGraphError, match="another name"):
        graft(once.graph, "coulomb_friction", "carriage", name="coulomb_friction")


def test_a_new_spring_begins_where_the_old_one_does():
    new = graft(mass_spring(), "cubic_stiffness", "carriage")
    assert simulate(new.graph, 1e-6, inputs={"push": 0})["cubic_stiffness.q"][0] == 0.01
    assert new.initial({"spring.q": 0.03})["cubic_stiffness.q"] == pytest.approx(0.03)
    pair = graft(two_mass_chain(), "cubic_stiffness", "between first and second")
    assert pair.initial({"spring.q": 0.02})["cubic_stiffness.q"] == pytest.approx(0.02)
    swapped = graft(two_mass_chain(), "cubic_stiffness", "between second and first")
    assert swapped.initial({"spring.q": 0.02})["cubic_stiffness.q"] == pytest.approx(-0.02)
    late = graft(mass_spring(), "transport_delay", "output v")
    assert late.initial({"mass.p": 3.0})["transport_delay_1.y"] == pytest.approx(1.5)


def test_a_force_between_two_acts_on_both_with_opposite_sign():
    new = graft(
        two_mass_chain(), "effort_bias", "between first and second", parameters={"effort": 4}
    )
    run = simulate(new.graph, 1e-4, inputs={"push": 0}, rtol=1e-9)
    assert run.final["mass1.p"] == pytest.approx(-run.final["mass2.p"], rel=1e-3)
    assert abs(run.final["mass1.p"]) == pytest.approx(4e-4, rel=1e-3)


def test_a_detector_gives_way_to_what_its_output_says(tmp_path):
    v = One("v")
    tacho = Df("tacho")
    angle = Integrator("angle", tacho.f)
    graph = assemble("g", Se("push", 2) >> v >> (I("m", 1, initial=3), R("b", 2), tacho), angle)
    new = graft(graph, "sensor_bias", "output tacho", parameters={"offset": 0.25})
    assert simulate(new.graph, 1.0)["tacho"][0] == pytest.approx(3.25)
    assert simulate(new.graph, 1.0).final["angle.y"] == simulate(graph, 1.0).final["angle.y"]
    save(new.graph, tmp_path / "biased.toml")
    assert simulate(load(tmp_path / "biased.toml"), 1.0)["tacho"][0] == pytest.approx(3.25)


def test_the_drawing_shows_what_is_new():
    new = graft(mass_spring(), "coulomb_friction", "carriage")
    plain = to_svg(assign_causality(new.graph))
    shown = to_svg(assign_causality(new.graph), accented=new.elements)
    assert "#0b57d0" not in plain
    (node,) = [part for part in shown.split("<g data-element=") if part.startswith('"coulomb_fr')]
    assert "#0b57d0" in node
    assert 'data-bond="carriage&gt;coulomb_friction" stroke="#0b57d0"' in shown


def test_sites_are_found_by_name_only_where_the_effect_fits():
    graph = two_mass_chain()
    with pytest.raises(BondGraphError, match="leakage fits 0-junction"):
        graft(graph, "leakage", "first")
    with pytest.raises(BondGraphError, match="hydraulic"):
        graft(graph, "leakage", "link")
    with pytest.raises(BondGraphError, match="did you mean first"):
        graft(graph, "viscous_damping", "frist")
    with pytest.raises(BondGraphError, match="did you mean damping"):
        graft(graph, "viscous_damping", "first", parameters={"dampin": 1})
    with pytest.raises(BondGraphError, match="N"):
        graft(graph, "viscous_damping", "first", parameters={"damping": (1, "kg")})
    reverse = find_site(graph, EFFECTS["viscous_damping"], "between second and first")
    assert reverse.at == ("second", "first")


def test_a_spring_s_own_junction_is_no_body():
    pairs = [site.name for site in sites(two_mass_chain()) if site.kind.startswith("between")]
    assert pairs == ["between first and second"]


def test_a_conflict_names_effect_site_and_cause():
    """A source of effort on a 1-junction whose effort nothing else can balance."""
    node = Zero("node")
    graph = assemble("held", Se("battery", 5) >> node >> R("r", 1))
    push = Coefficient("push", "{e}", "held effort", lambda s: 1.0, absent=0.0)

    def build(place, law, symbols):
        return Change((Se(place.name, law["effort"]) >> place.node,))

    held = Effect(
        "held_effort", ("0-junction",), (push,), {"effort": push.symbol}, build, "held", "none"
    )
    with pytest.raises(BondGraphError, match=r"held_effort at 'node'.*battery") as told:
        graft(graph, held, "node")
    assert "battery" in told.value.elements or "node" in told.value.elements


def test_an_effect_of_the_user_s_own_goes_in_like_the_others():
    b = Coefficient("b", "{e}/({f})^3", "cubic damping", lambda s: s.effort / s.flow**3, 0.0, True)
    own = Effect(
        "cubic_damping",
        ("1-junction", "between 1-junctions"),
        (b,),
        {"effort": b.symbol * FLOW**3},
        resistor,
        "damping with the cube of speed",
        "a trial",
    )
    new = graft(mass_spring(), own, "carriage", parameters={"b": 2})
    assert new.diff[0] == "+ R 'cubic_damping' on 1-junction 'carriage'"
    assert new.graph["cubic_damping"].effort.subs(
        new.graph["cubic_damping"].f, 2
    ) == 8 * sympy.Symbol("cubic_damping_b", nonnegative=True)


def test_grafted_is_frozen_and_the_old_graph_untouched():
    graph = mass_spring()
    kept = dict(graph.elements), graph.bonds, dict(graph.parameters), dict(graph.outputs)
    new = graft(graph, "saturation", "source actuator")
    assert (dict(graph.elements), graph.bonds, dict(graph.parameters), dict(graph.outputs)) == kept
    assert new.diff[0].startswith("~ Se 'actuator' : effort = ")
    with pytest.raises(dataclasses.FrozenInstanceError):
        new.name = "other"


def test_a_source_of_flow_can_be_late():
    v = One("v")
    graph = assemble("g", Sf("drive", 2) >> v >> R("r", 1), outputs={"v": v.f})
    new = graft(graph, "transport_delay", "source drive", parameters={"delay": 0.1})
    assert simulate(new.graph, 1.0)["v"][0] == pytest.approx(2)  # a constant was so before
