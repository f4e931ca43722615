"""Dimensions: units of all variables are found, contradictions are named, nothing is made up."""

from __future__ import annotations

import time
from types import SimpleNamespace

import pytest
import sympy
from hypothesis import given, settings

from bondgraph import GY, TF, C, Friction, I, One, R, Se, Sf, Zero, assemble, models
from bondgraph.dimensions import infer, si_unit
from bondgraph.graph import TIME
from bondgraph.models import LIBRARY
from bondgraph.units import check_compatible

from .strategies import sketches

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
