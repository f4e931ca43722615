"""Dimensions: units of all variables are found, contradictions are named, nothing is made up."""

from __future__ import annotations

import time
from types import SimpleNamespace

import pytest
import sympy
from hypothesis import given, settings

from bondgraph import (
    GY,
    RS,
    TF,
    Block,
    C,
    CField,
    CheckValve,
    Clutch,
    De,
    Df,
    Diode,
    EndStop,
    Friction,
    Heat,
    I,
    ICField,
    IField,
    Integrator,
    Lag,
    One,
    R,
    RField,
    Se,
    Sf,
    Switch,
    Zero,
    assemble,
    models,
)
from bondgraph.dimensions import infer, si_unit
from bondgraph.files import loads
from bondgraph.graph import TIME
from bondgraph.models import LIBRARY
from bondgraph.units import check_compatible

from .strategies import sketches
from .test_files import SWITCHED_BY_HAND

NAMES = "m k b w F r n mu V L J c x0 v0"
s = SimpleNamespace(**{name: sympy.Symbol(name, positive=True) for name in NAMES.split()})


def oscillator(parameters, **laws):
    """A mass, a spring and a damper behind a source of flow."""
    v = One("v")
    parts = {"m": I("m", s.m), "k": C("k", stiffness=s.k), "b": R("b", s.b)} | laws
    return assemble("g", Sf("w", s.w) >> v >> tuple(parts.values()), parameters=parameters)


UNITS = {s.m: (2, "kg"), s.k: (8, "N/mm"), s.b: (3, "N*s/m"), s.w: (1, "m/s")}


class TestLibrary:
    @pytest.mark.parametrize("name", sorted(LIBRARY))
    def test_no_problems(self, name):
        assert infer(getattr(models, name).graph()).problems == ()

    @pytest.mark.parametrize("name", sorted(LIBRARY))
    def test_every_variable_has_a_unit_and_every_bond_a_domain(self, name):
        found = infer(getattr(models, name).graph())
        assert all(found.units.values())
        assert "unknown" not in found.domains.values()

    def test_states_of_the_brake(self):
        units = infer(models.bicycle_brake.graph()).units
        assert units["wheel.rotor.p"] == "N*m*s"
        assert units["wheel.spokes.q"] == "rad"
        assert units["rear.mass.p"] == "N*s"
        assert units["rear.bending.q"] == "m"
        assert units["line.fluid.q"] == "m^3"

    def test_ports_of_the_brake(self):
        found = infer(models.bicycle_brake.graph())
        units = found.units
        assert (units["wheel.hub.f"], units["wheel.torque.e"]) == ("rad/s", "N*m")
        assert (units["friction.e"], units["friction.f"]) == ("N", "m/s")
        assert (units["line.fluid.e"], units["line.flow.f"]) == ("Pa", "m^3/s")
        assert (units["rotor_radius.e_in"], units["rotor_radius.f_out"]) == ("N*m", "m/s")
        assert "friction.speed" not in units
        assert found.domains["rotor_radius"] == "rotation>translation"
        assert found.domains["line.flow>line.hose"] == "hydraulic"

    @pytest.mark.parametrize("name", sorted(LIBRARY))
    def test_outputs_that_are_port_variables_agree(self, name):
        graph = getattr(models, name).graph()
        own = {
            symbol: f"{label}.{key}"
            for label, element in graph.elements.items()
            for key, symbol in element.symbols.items()
        }
        units = infer(graph).units
        for output in graph.outputs.values():
            if output.expression in own:
                check_compatible(units[own[output.expression]], output.unit)


class TestSeeds:
    """One unit anywhere is enough for everything that hangs together."""

    @pytest.mark.parametrize(
        "unit, law",
        [
            ("kg", lambda a: I("x", a)),
            ("N/mm", lambda a: C("x", stiffness=a)),
            ("mm/N", lambda a: C("x", a)),
            ("N*s/m", lambda a: R("x", a)),
            ("m/N/s", lambda a: R("x", flow=lambda e: a * e)),
            ("kN", lambda a: Se("x", a)),
            ("km/hour", lambda a: Sf("x", a)),
            ("N*s^2/m^2", lambda a: R("x", effort=lambda f: a * f * abs(f))),
            ("N/m^3", lambda a: C("x", energy=lambda q: a * q**4 / 4)),
            ("m", lambda a: C("x", 3, initial=a)),
            ("N", lambda a: Friction("x", kinetic=lambda speed: a)),
        ],
    )
    def test_translation(self, unit, law):
        v = One("v")
        graph = assemble("g", v >> law(s.c), v >> I("mass", 3), parameters={s.c: (2, unit)})
        found = infer(graph)
        assert (found.units["mass.p"], found.units["v.f"]) == ("N*s", "m/s")
        assert found.problems == ()

    @pytest.mark.parametrize(
        "unit, units",
        [
            ("kg*m^2", ("N*m", "rad/s", "rad", "N*m*s")),
            ("mH", ("V", "A", "C", "Wb")),
            ("Pa*s^2/m^3", ("Pa", "m^3/s", "m^3", "Pa*s")),
        ],
    )
    def test_domains_of_an_inertance(self, unit, units):
        v = One("v")
        graph = assemble("g", v >> (I("i", s.m), C("c", 2)), parameters={s.m: (1, unit)})
        found = infer(graph).units
        assert (found["i.e"], found["i.f"], found["c.q"], found["i.p"]) == units

    def test_entropy_is_the_flow_of_heat(self):
        node = One("node")
        graph = assemble("g", Se("T", s.c) >> node >> R("r", 2), parameters={s.c: (300, "K")})
        assert infer(graph).units["node.f"] == "W/K"

    def test_an_input(self):
        force = sympy.Symbol("force")
        graph = assemble("g", Se("F", force) >> One("v") >> I("m", 2), inputs={force: "N"})
        assert infer(graph).units["m.p"] == "N*s"

    def test_an_output(self):
        mass = I("m", 2)
        graph = assemble("g", Se("F", 1) >> One("v") >> mass, outputs={"speed": (mass.f, "m/s")})
        assert infer(graph).units["m.p"] == "N*s"

    def test_a_derived_parameter_without_a_unit(self):
        graph = assemble(
            "g",
            One("v") >> (I("m", s.m), C("k", 2)),
            parameters={s.m: s.k / s.w**2, s.k: (3, "N/m"), s.w: (5, "1/s")},
        )
        assert infer(graph).units["k.q"] == "m"

    def test_through_a_transformer(self):
        a, b = One("a"), One("b")
        graph = assemble(
            "g",
            a >> I("m", s.m),
            a >> TF("drum", s.r) >> b >> R("r", 3),
            parameters={s.m: (2, "kg"), s.r: (3, "1/m")},
        )
        found = infer(graph)
        assert found.units["r.e"] == "N*m"
        assert found.domains["drum"] == "translation>rotation"

    @pytest.mark.parametrize("unit", ["V*s", "N*m/A", "V/(rad/s)"])
    def test_through_a_gyrator(self, unit):
        i, w = One("i"), One("w")
        graph = assemble(
            "motor",
            Se("battery", s.V) >> i >> GY("k_m", s.k) >> w >> I("J", 2),
            i >> I("L", s.L),
            parameters={s.V: (12, "V"), s.k: (1, unit), s.L: (1, "H")},
        )
        found = infer(graph)
        assert (found.units["J.p"], found.units["L.p"]) == ("N*m*s", "Wb")
        assert found.problems == ()

    def test_through_modulation(self):
        first, second = I("first", s.m), I("second", 3)
        graph = assemble(
            "g",
            One("a") >> (first, R("b", 2)),
            Se("F", s.c * first.f) >> One("v") >> second,
            parameters={s.m: (2, "kg"), s.c: (3, "N*m*s/m")},
        )
        assert infer(graph).units["second.p"] == "N*m*s"

    def test_an_unnamed_domain_is_shown_in_base_units(self):
        graph = assemble(
            "g", Se("mu", s.c) >> One("v") >> R("r", 2), parameters={s.c: (1, "J/mol")}
        )
        found = infer(graph)
        assert found.units["mu.e"] == "kg*m^2/(s^2*mol)"
        assert found.units["v.f"] == "mol/s"
        assert found.domains["v"] == "unknown"


class TestSilence:
    """What nobody said is not known, and is no problem."""

    def test_numbers_say_nothing(self):
        v = One("v")
        graph = assemble("g", Se("F", 1) >> v >> (I("m", 2), R("b", effort=lambda f: f**3)))
        found = infer(graph)
        assert set(found.units.values()) == {None}
        assert set(found.domains.values()) == {"unknown"}
        assert found.problems == ()

    @pytest.mark.parametrize(
        "law",
        [
            Se("extra", 9.81 * s.m),  # the number is an acceleration
            R("extra", effort=lambda f: 100 * f + s.b * f),
            R("extra", effort=lambda f: s.F * sympy.tanh(1000 * f)),
            R("extra", effort=lambda f: s.F * sympy.sign(f) * sympy.exp(-((f / s.v0) ** 2))),
            C("extra", effort=lambda q: s.k * q * (1 + 3 * q**2)),
            C("extra", effort=lambda q: sympy.Piecewise((0, q < s.x0), (s.k * (q - s.x0), True))),
            Se("extra", s.F * sympy.sin(10 * TIME)),
            Se("extra", s.F * sympy.Min(1, TIME / 2)),
            R("extra", effort=lambda f: s.mu * s.F * f / sympy.sqrt(f**2 + s.v0**2)),
        ],
    )
    def test_bare_numbers_among_units_are_no_problem(self, law):
        extra = {s.F: (3, "N"), s.v0: (1, "cm/s"), s.x0: (1, "mm"), s.mu: (1, "", "friction")}
        graph = oscillator(UNITS | extra, extra=law)
        assert infer(graph).problems == ()
        assert infer(graph).units["extra.e"] == "N"

    def test_a_number_as_ratio_leaves_the_other_side_open(self):
        a, b = One("a"), One("b")
        graph = assemble(
            "g",
            a >> I("m", s.m),
            a >> TF("lever", 2) >> b >> R("r", 3),
            parameters={s.m: (1, "kg")},
        )
        found = infer(graph)
        assert (found.units["a.f"], found.units["b.f"]) == ("m/s", None)
        assert found.domains["lever"] == "translation>unknown"

    def test_a_documented_pure_number_as_ratio_keeps_the_domain(self):
        a, b = One("a"), One("b")
        graph = assemble(
            "g",
            a >> I("m", s.m),
            a >> TF("lever", s.n) >> b >> R("r", 3),
            parameters={s.m: (1, "kg"), s.n: (3, "", "ratio of the lever")},
        )
        assert infer(graph).units["b.f"] == "m/s"

    def test_a_parameter_without_unit_or_words_says_nothing(self):
        assert infer(oscillator(UNITS | {s.b: 3})).problems == ()

    def test_no_unit_at_all_needs_no_pint(self):
        assert infer(oscillator({s.m: (2, "", "mass"), s.b: 3})).units["m.p"] is None

    def test_parameters_in_a_circle(self):
        graph = oscillator({s.m: s.k * s.b, s.k: s.m / s.b, s.b: (3, "N*s/m"), s.w: (1, "m/s")})
        assert infer(graph).units["m.p"] == "N*s"

    def test_open_port(self):
        v = One("v")
        graph = assemble("g", v >> I("m", s.m), ports={"v": v}, parameters={s.m: (2, "kg")})
        assert infer(graph).units["v.f"] == "m/s"

    def test_a_lone_open_junction(self):
        v = Zero("v")
        assert infer(assemble("g", v, ports={"v": v})).units == {"v.e": None}

    @settings(max_examples=60, deadline=None)
    @given(sketches())
    def test_random_graphs(self, sketch):
        found = infer(sketch.graph(symbolic=True))
        assert found.problems == ()
        assert set(found.units.values()) <= {None}


class TestProblems:
    def problem(self, graph):
        (found,) = infer(graph).problems
        return found

    def test_a_stiffness_in_the_wrong_domain(self):
        shaft = Sf("motor", s.w) >> One("shaft") >> (C("spring", stiffness=s.k), I("rotor", s.J))
        units = {s.w: (1, "rad/s"), s.k: (3, "N/m"), s.J: (1, "kg*m^2")}
        said = self.problem(assemble("g", shaft, parameters=units))
        assert said.startswith("C 'spring' (k in N/m) takes effort in N and flow in m/s")
        assert "Sf 'motor' (w in rad/s) makes it N*m and rad/s" in said

    def test_the_majority_is_believed(self):
        found = infer(oscillator(UNITS | {s.w: (1, "rad/s")}))
        assert found.problems[0].startswith("Sf 'w' (w in rad/s)")
        assert found.units["m.p"] == "N*s"

    def test_a_power_of_time_too_many(self):
        said = self.problem(oscillator(UNITS | {s.b: (3, "N/m")}))
        assert said.startswith("R 'b' (b in N/m) has effort in N, but its law is in kg*m/s^3")
        assert said.endswith("effort is in N by Sf 'w' (w in m/s)")

    @pytest.mark.parametrize(
        "two_port, wanted",
        [(TF("drum", s.n), "a ratio in 1/m, not in kg"), (GY("drum", s.n), "a ratio in ")],
    )
    def test_a_ratio(self, two_port, wanted):
        a, b = One("a"), One("b")
        graph = assemble(
            "g",
            a >> I("m", s.m),
            a >> two_port >> b >> I("J", s.J),
            parameters={s.m: (1, "kg"), s.n: (1, "kg"), s.J: (1, "kg*m^2")},
        )
        said = self.problem(graph)
        assert said.startswith(
            f"{two_port.kind} 'drum' (n in kg) joins efforts in N by I 'm' (m in kg)"
        )
        assert wanted in said
        assert "N*m by I 'J' (J in kg*m^2)" in said

    def test_a_sum(self):
        spring = C("k", effort=lambda q: s.k * q + s.b * q)
        said = infer(oscillator(UNITS, k=spring)).problems[0]
        assert said.startswith("C 'k' (b in N*s/m, k in N/mm) joins ")
        assert "b*k.q in N*s" in said and "k*k.q in N" in said

    def test_an_argument(self):
        source = Se("push", s.F * sympy.exp(-TIME / s.x0))
        units = UNITS | {s.F: (1, "N"), s.x0: (1, "m")}
        said = self.problem(oscillator(units, push=source))
        assert said.endswith("has the argument of exp in s/m, where a pure number is wanted")

    def test_an_exponent(self):
        spring = C("k", effort=lambda q: s.k * s.x0 * (q / s.x0) ** s.m)
        said = self.problem(oscillator(UNITS | {s.x0: (1, "m")}, k=spring))
        assert "has the exponent m in kg" in said

    def test_a_breakaway(self):
        contact = Friction("pad", kinetic=lambda speed: s.F, breakaway=s.k)
        said = self.problem(oscillator(UNITS | {s.F: (1, "N")}, pad=contact))
        assert said.startswith("Friction 'pad' (F in N, k in N/mm) has its breakaway in N, but")

    def test_an_initial_state(self):
        spring = C("k", stiffness=s.k, initial=s.F)
        said = self.problem(oscillator(UNITS | {s.F: (1, "N")}, k=spring))
        assert "has its initial state in m, but its law is in N" in said

    def test_a_derived_parameter(self):
        said = self.problem(oscillator(UNITS | {s.m: (s.k / s.b, "kg")}))
        assert said == "parameter 'm' is declared in kg, but its expression k/b is in 1/s"

    def test_an_output(self):
        mass = I("m", s.m)
        graph = assemble(
            "g",
            One("v") >> (mass, R("b", 2)),
            parameters={s.m: (1, "kg")},
            outputs={"speed": (mass.f, "m/s"), "wrong": (mass.p / s.m, "rad/s")},
        )
        said = self.problem(graph)
        assert said.startswith("output 'wrong' is declared in rad/s, but its expression is in m/s")

    def test_a_unit_that_does_not_exist(self):
        found = infer(oscillator(UNITS | {s.b: (3, "Nn*s/m")}))
        assert found.problems[0].startswith("b: unit 'Nn*s/m' is not known")
        assert found.units["b.e"] == "N"


class TestFields:
    """Each port of a field has the units of its own bond; the joint law says them."""

    def beam(self, **units):
        v, w = One("v"), One("w")
        field = CField(
            "x", ("a", "b"), energy=lambda q, p: s.k * q**2 / 2 + s.b * q * p + s.c * p**2
        )
        parameters = {getattr(s, key): (1, unit) for key, unit in units.items()}
        return assemble(
            "g", v >> (I("m", 1), field["a"]), w >> (I("n", 1), field["b"]), parameters=parameters
        )

    def test_ports_in_two_domains(self):
        found = infer(self.beam(k="N/m", b="N/rad", c="N*m/rad"))
        assert found.problems == ()
        assert found.domains["x.a"] == "translation" and found.domains["x.b"] == "rotation"
        assert [found.units[key] for key in ("x.a.q", "x.a.e", "m.p")] == ["m", "N", "N*s"]
        assert [found.units[key] for key in ("x.b.q", "x.b.e", "n.p")] == ["rad", "N*m", "N*m*s"]

    def test_coupling_carries_the_domain_over(self):
        found = infer(self.beam(k="N/m", b="N/rad"))
        assert found.problems == () and found.units["x.b.e"] == "N*m"

    def test_a_coupling_that_makes_no_energy_is_named(self):
        said = infer(self.beam(k="N/m", b="N/m", c="N*m/rad")).problems
        assert "C 'x.a' (b in N/m, k in N/m) has effort in N, but its law is in kg/s^2" in said[0]

    def test_a_solenoid(self):
        i, v = One("i"), One("v")
        field = ICField(
            "s", {"coil": "I", "gap": "C"}, energy=lambda p, q: p**2 * (1 + q / s.x0) / (2 * s.L)
        )
        parameters = {s.L: (1, "mH"), s.x0: (1, "mm")}
        graph = assemble(
            "g",
            i >> GY("g", 1) >> field["coil"],
            v >> (I("m", 1), field["gap"]),
            i >> R("r", 1),
            parameters=parameters,
        )
        found = infer(graph)
        assert found.problems == ()
        assert (found.units["s.coil.p"], found.units["s.gap.q"], found.units["v.f"]) == (
            "Wb",
            "m",
            "m/s",
        )

    def test_conduction_between_two_temperatures(self):
        one, two = Zero("one"), Zero("two")
        wall = RField(
            "wall", ("hot", "cold"), flow=lambda t, u: (s.c * (t - u) / t, s.c * (u - t) / u)
        )
        graph = assemble(
            "g",
            Se("T", s.V) >> one >> wall["hot"],
            two >> (C("c", effort=sympy.exp), wall["cold"]),
            parameters={s.V: (300, "K"), s.c: (2, "W/K")},
        )
        found = infer(graph)
        assert found.problems == ()
        assert (found.units["wall.cold.e"], found.units["wall.cold.f"], found.units["c.q"]) == (
            "K",
            "W/K",
            "J/K",
        )

    def test_mutual_inductance_and_matrices_of_resistance(self):
        i, j = Zero("i"), Zero("j")
        coils = IField("coils", ("one", "two"), inertance=[[s.L, s.m], [s.m, s.L]])
        mesh = RField("mesh", ("one", "two"), resistance=[[s.r, s.b], [s.b, s.r]])
        units = {s.L: (1, "H"), s.m: (0.2, "H"), s.r: (1, "ohm"), s.b: (1, "ohm")}
        graph = assemble(
            "g",
            i >> (coils["one"], mesh["one"]),
            j >> (coils["two"], mesh["two"]),
            parameters=units,
        )
        found = infer(graph)
        assert found.problems == () and found.units["coils.two.p"] == "Wb"
        bonds = (i >> (mesh["one"], coils["one"]), j >> (mesh["two"], coils["two"]))
        wrong = assemble("g", *bonds, parameters=units | {s.b: (1, "F")})
        assert any(
            said.startswith("R 'mesh.one' (b in F, r in ohm)") for said in infer(wrong).problems
        )


class TestHeat:
    def warm(self, pseudo, heat, **units):
        v, room = One("v"), Zero("room", pseudo=pseudo)
        parameters = {getattr(s, key): (1, unit) for key, unit in units.items()}
        pad = v >> RS("pad", s.b, pseudo=pseudo) >> room >> heat
        return assemble("g", v >> I("m", s.m), pad, parameters=parameters)

    def test_entropy_flows_at_a_temperature(self):
        found = infer(self.warm(False, C("c", effort=sympy.exp), m="kg", b="N*s/m"))
        assert found.problems == ()
        assert (found.units["room.e"], found.units["pad_heat.f"], found.units["c.q"]) == (
            "K",
            "W/K",
            "J/K",
        )
        assert found.units["pad.f"] == "m/s" and found.domains["room"] == "thermal"

    def test_heat_flows_on_a_pseudo_bond(self):
        wall = R("wall", s.r)
        found = infer(self.warm(True, (C("c", s.c), wall), m="kg", b="N*s/m", c="J/K", r="K/W"))
        assert found.problems == ()
        units = [found.units[key] for key in ("room.e", "pad_heat.f", "c.q", "wall.f")]
        assert units == ["K", "W", "J", "W"]
        assert found.domains["wall"] == found.domains["room>c"] == "thermal"

    def test_units_of_heat_are_checked(self):
        (said,) = infer(self.warm(True, C("c", s.c), c="J/K/kg")).problems
        assert said.startswith("C 'c' (c in J/K/kg) has effort in K, but its law is in ")

    def test_entropy_into_another_domain_is_named(self):
        v, w = One("v"), Zero("w")
        wrong = v >> RS("pad", 3) >> w >> (C("c", s.c), R("r", s.r))
        units = {s.c: (1, "m^3/Pa"), s.r: (1, "Pa*s/m^3")}
        said = infer(assemble("g", v >> I("m", 1), wrong, parameters=units)).problems
        assert said[0].startswith("Heat 'pad_heat' takes effort in K and flow in W/K, but C 'c'")

    def test_a_power_of_its_own_is_checked(self):
        room = Zero("room", pseudo=True)
        lamp = Heat("lamp", s.F, pseudo=True)
        for unit, count in (("kW", 0), ("J", 1)):
            graph = assemble("g", lamp >> room >> C("c", 500), parameters={s.F: (1, unit)})
            said = infer(graph).problems
            assert len(said) == count
        assert said[0].startswith("Heat 'lamp' (F in J) has its power in W, but its law is in N*m")

    def test_a_transformer_on_a_pseudo_bond_does_not_crash(self):
        room, w = Zero("room", pseudo=True), One("w")
        bonds = (room >> C("c", 5), room >> TF("n", s.n) >> w >> I("i", 1))
        graph = assemble("g", *bonds, parameters={s.n: (1, "m")})
        assert infer(graph).problems == ()


class TestSwitching:
    @pytest.mark.parametrize(
        "make, good, wrong, words",
        [
            (lambda: Diode("x", drop=s.c), "N", "V", "takes effort in V"),
            (lambda: CheckValve("x", resistance=s.c), "N*s/m", "N/m", "its resistance in kg/s"),
            (lambda: Clutch("x", s.c), "kN", "m/s", "effort in N"),
            (lambda: Clutch("x", 3, static=s.c), "N", "N*m", "its static capacity in N"),
            (lambda: EndStop("x", gap=s.c, restitution=0), "mm", "N", "its gap in m"),
            (lambda: EndStop("x", gap=1, restitution=s.c), "%", "m/s", "its restitution in 1"),
            (
                lambda: EndStop("x", gap=1, restitution=0, rest=s.c),
                "mm/s",
                "m",
                "its speed of rest in m/s",
            ),
            (lambda: Switch("x", closed=s.x0 - s.c), "mm", "N", "joins "),
        ],
    )
    def test_laws(self, make, good, wrong, words):
        units = UNITS | {s.x0: (1, "m")}
        for unit, problems in ((good, 0), (wrong, 1)):
            found = infer(oscillator(units | {s.c: (1, unit)}, x=make()))
            assert len(found.problems) == problems, found.problems
            assert found.units["x.e"] == "N" and found.units["x.f"] == "m/s"
        assert "'x' (" in found.problems[0] and words in found.problems[0]

    def test_a_gap_and_a_capacity_tell_the_domain(self):
        v = One("v")
        for element, unit in ((Clutch("x", s.c), "N*m"), (Diode("x", drop=s.c), "N*m")):
            v = One("v")
            graph = assemble("g", v >> (I("J", 1), element), parameters={s.c: (1, unit)})
            assert infer(graph).units["J.p"] == "N*m*s"
        stop = EndStop("x", gap=s.x0, restitution=0)
        graph = assemble("g", One("v") >> (I("m", 1), stop), parameters={s.x0: (1, "mm")})
        assert infer(graph).units["m.p"] == "N*s"


def test_every_kind_of_element_goes_through():
    found = infer(loads(SWITCHED_BY_HAND))
    assert found.problems == ()
    heat = [found.units[key] for key in ("thermometer", "pad_heat.f", "mass.q", "rub_heat.e")]
    assert heat == ["K", "W", "J", "K"]
    assert {key for key, unit in found.units.items() if unit} == {
        key for key in found.units if found.domains.get(key.rpartition(".")[0]) == "thermal"
    } | {"thermometer"}


class TestSignals:
    def test_sensors(self):
        v, z = One("v"), Zero("z")
        graph = assemble(
            "g",
            v >> (I("m", s.m), Df("speed")),
            v >> z >> (C("k", 3), De("force")),
            parameters={s.m: (1, "kg")},
        )
        found = infer(graph)
        assert (found.units["speed"], found.units["force"]) == ("m/s", "N")
        assert found.problems == ()

    def turning(self, *blocks, **units):
        parameters = {s.J: (1, "kg*m^2")} | {
            getattr(s, key): (1, unit) for key, unit in units.items()
        }
        return infer(
            assemble("g", self.v >> (I("J", s.J), C("k", 2)), blocks, parameters=parameters)
        )

    @property
    def v(self):
        return self.__dict__.setdefault("junction", One("v"))

    def test_an_integral_has_the_unit_of_its_signal_times_s(self):
        found = self.turning(Integrator("angle", self.v.f), Integrator("x", s.r * self.v.f), r="m")
        assert (found.units["angle.y"], found.units["x.y"]) == ("rad", "m")
        assert found.problems == ()

    def test_a_lag_has_the_unit_of_its_signal(self):
        found = self.turning(Lag("slow", self.v.f, s.b), Lag("x", s.r * self.v.f, 2), r="m", b="ms")
        assert (found.units["slow.y"], found.units["x.y"]) == ("rad/s", "m/s")
        assert found.problems == ()

    def test_a_block_has_the_unit_of_its_rate_times_s(self):
        found = self.turning(Block("b", lambda y: s.F - y / s.x0), F="K/s", x0="s")
        assert (found.units["b.y"], found.problems) == ("K", ())
        assert self.turning(Block("free", lambda y: 3 - y)).units["free.y"] is None

    def test_what_is_heard_of_a_block_carries_on(self):
        w, block = One("w"), Block("b", lambda y: s.V / s.x0 - y / s.x0)
        graph = assemble(
            "g",
            Se("F", s.k * block.y) >> w >> I("m", 1),
            block,
            parameters={s.V: (1, "m"), s.x0: (1, "s"), s.k: (1, "N/m")},
        )
        found = infer(graph)
        assert (found.units["b.y"], found.units["m.p"], found.problems) == ("m", "N*s", ())

    @pytest.mark.parametrize(
        "block, unit, words",
        [
            (
                lambda v: Lag("x", v.f, s.r),
                "m",
                "Lag 'x' (r in m) has its time constant in s, but its law is in m",
            ),
            (
                lambda v: Integrator("x", v.f, initial=s.r),
                "N",
                "Integrator 'x' (r in N) has its rate in kg*m/s^3, but its law is in 1/s",
            ),
            (
                lambda v: Block("x", lambda y: s.r - y / s.J),
                "m/s",
                "Block 'x' (J in kg*m^2, r in m/s) has its rate in ",
            ),
        ],
    )
    def test_wrong_units_are_named(self, block, unit, words):
        (said,) = self.turning(block(self.v), r=unit).problems[:1]
        assert words in said

    def test_two_claims_on_one_signal_are_told_apart_from_efforts(self):
        found = self.turning(Block("x", lambda y: s.F, initial=s.r), F="m/s", r="N")
        (said,) = found.problems
        assert said.startswith("Block 'x' (F in m/s, r in N) has its ")
        assert "; the signal is in " in said and "effort" not in said


def ladder(cells):
    """An RC ladder, all cells with the same parameters."""
    parts, before = [], Se("E", s.V)
    for number in range(cells):
        one, zero = One(f"i{number}"), Zero(f"u{number}")
        parts += [before >> one >> zero >> C(f"c{number}", s.c), one >> R(f"r{number}", s.r)]
        before = zero
    return assemble("ladder", parts, parameters={s.V: (1, "V"), s.c: (1, "uF"), s.r: (1, "kohm")})


def test_cost_is_about_linear():
    infer(ladder(2))  # pint is loaded

    def seconds(graph):
        times = []
        for _ in range(3):
            start = time.process_time()
            assert infer(graph).problems == ()
            times.append(time.process_time() - start)
        return min(times)

    assert seconds(ladder(200)) < 4 * 3 * seconds(ladder(50))


@pytest.mark.parametrize(
    "unit, expected",
    [
        ("N/mm", "N/m"),
        ("kN*ms", "N*s"),
        ("g", "kg"),
        ("mH", "H"),
        ("bar", "Pa"),
        ("km/hour", "m/s"),
        ("rpm", "rad/s"),
        ("N*m/deg", "N*m/rad"),
        ("degC", "K"),
        ("%", ""),
        ("", ""),
        ("kg*m^2", "kg*m^2"),
    ],
)
def test_si_unit(unit, expected):
    assert si_unit(unit) == expected
