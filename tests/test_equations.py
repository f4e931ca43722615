"""State equations of textbook graphs, pinned conventions, loops, dependent storage, the brake."""

import functools
import itertools

import pytest
import sympy

from bondgraph import (
    GY,
    TF,
    TIME,
    C,
    Friction,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    assign_causality,
    derive,
    in_mode,
    models,
)
from bondgraph.errors import AlgebraicLoopError, BondGraphError, LawError
from bondgraph.modes import contacts

E, F, V, U = sympy.symbols("E F V U", real=True)
b, c, g, k, l, m, n, r, J, L, M = sympy.symbols("b c g k l m n r J L M", positive=True)


def var(name):
    """A state or port variable of the equations, by its qualified name."""
    return sympy.Symbol(name, real=True)


def equal(found, expected):
    return sympy.simplify(found - expected) == 0


def rates(equations):
    return {state.name: rate for state, rate in equations.explicit().items()}


def port(equations, name):
    return equations.substituted(equations.ports[name])


def check_closed(equations):
    """Nothing but states, inputs, parameters and declared unknowns is left, anywhere."""
    given = equations.arguments
    assert len(equations.states) == len(equations.derivatives) == len(equations.initial)
    assert len(equations.algebraic) == len(equations.residuals)
    everything = [
        *equations.derivatives,
        *equations.residuals,
        *equations.outputs.values(),
        *equations.ports.values(),
        *equations.supplied.values(),
        *equations.dissipated.values(),
        *equations.dependent.values(),
        *(energy for energy in equations.energies.values() if energy is not None),
        *(contact.breakaway for contact in equations.contacts),
    ]
    for expression in everything:
        left = equations.substituted(expression).free_symbols - given
        assert not left, (expression, left)
    known = set(given)
    for symbol, expression in equations.assignments:
        assert expression.free_symbols <= known
        known.add(symbol)
    assert not any(value.atoms(sympy.Float) for _, value in equations.assignments)


class TestTextbook:
    def test_rc(self):
        loop = One("loop")
        equations = derive(assemble("rc", Se("s", E) >> loop >> (R("r", r), C("c", c))))
        assert equal(rates(equations)["c.q"], (E - var("c.q") / c) / r)
        check_closed(equations)

    def test_mass_spring_damper(self):
        v = One("v")
        equations = derive(
            assemble("g", Se("s", F) >> v >> (I("m", m), C("k", stiffness=k), R("b", b)))
        )
        found = rates(equations)
        assert equal(found["m.p"], F - k * var("k.q") - b * var("m.p") / m)
        assert equal(found["k.q"], var("m.p") / m)

    def test_parallel_circuit(self):
        node = Zero("node")
        equations = derive(assemble("g", Sf("s", U) >> node >> (R("r", r), C("c", c), I("l", L))))
        found = rates(equations)
        assert equal(found["c.q"], U - var("c.q") / c / r - var("l.p") / L)
        assert equal(found["l.p"], var("c.q") / c)

    def test_two_junctions_and_two_sources(self):
        left, middle, right = One("left"), Zero("middle"), One("right")
        equations = derive(
            assemble(
                "g",
                Se("s", F) >> left >> (I("i", L), middle),
                Sf("v", V) >> middle >> right >> (C("c", c), R("r", r)),
            )
        )
        found = rates(equations)
        p, q = var("i.p"), var("c.q")
        assert equal(found["i.p"], F - r * V - r * p / L - q / c)
        assert equal(found["c.q"], V + p / L)

    def test_dc_motor(self):
        circuit, shaft = One("circuit"), One("shaft")
        equations = derive(
            assemble(
                "motor",
                Se("s", E) >> circuit >> (I("L", L), R("Ra", r)),
                circuit >> GY("motor", k) >> shaft >> (I("J", J), R("b", b)),
            )
        )
        found = rates(equations)
        i, w = var("L.p") / L, var("J.p") / J
        assert equal(found["L.p"], E - r * i - k * w)
        assert equal(found["J.p"], k * i - b * w)

    def test_time_enters_as_itself(self):
        equations = derive(assemble("g", Se("s", sympy.exp(-TIME)) >> One("v") >> I("m", 1)))
        assert rates(equations)["m.p"] == sympy.exp(-TIME)
        assert equations.time is TIME


class TestTwoPortConventions:
    """e_in = n e_out and f_out = n f_in; e_in = r f_out and e_out = r f_in."""

    def pair(self, make, *, drawn="->->", source=Se):
        a, z = One("a"), One("z")
        two = make("two", n)
        first = a >> two if drawn[:2] == "->" else two >> a
        second = two >> z if drawn[2:] == "->" else z >> two
        return derive(
            assemble("g", source("s", E) >> a, first, second, z >> (I("i", L), R("r", r)))
        )

    def test_transformer(self):
        equations = self.pair(TF)
        values = {key: port(equations, f"two.{key}") for key in ("e_in", "f_in", "e_out", "f_out")}
        assert equal(values["e_in"], n * values["e_out"])
        assert equal(values["f_out"], n * values["f_in"])
        assert values["e_in"] == E
        assert equal(rates(equations)["i.p"], E / n - r * var("i.p") / L)

    def test_gyrator(self):
        equations = self.pair(GY)
        values = {key: port(equations, f"two.{key}") for key in ("e_in", "f_in", "e_out", "f_out")}
        assert equal(values["e_in"], n * values["f_out"])
        assert equal(values["e_out"], n * values["f_in"])

    @pytest.mark.parametrize("make", [TF, GY])
    @pytest.mark.parametrize("source", [Se, Sf])
    def test_a_two_port_keeps_no_power(self, make, source):
        a, z = (One("a"), Zero("z")) if source is Se else (Zero("a"), One("z"))
        graph = assemble(
            "g",
            source("s", E) >> a >> make("two", n) >> z >> R("r", r),
            a >> R("x", 1),
            z >> C("c", c),
        )
        equations = derive(graph)
        power = [
            port(equations, f"two.e_{side}") * port(equations, f"two.f_{side}")
            for side in ("in", "out")
        ]
        assert equal(*power)

    @pytest.mark.parametrize("make", [TF, GY])
    def test_sides_follow_the_arrows(self, make):
        """Drawn out of z into a, z is the in side, in whichever order the bonds are written."""
        a, z = Zero("a"), Zero("z")
        two = make("two", n)
        rest = (a >> C("x", 1), z >> R("y", 1))
        forth = derive(assemble("g", two >> a, z >> two, *rest))
        back = derive(assemble("g", z >> two >> a, *rest))
        assert forth.explicit() == back.explicit()
        assert forth.ports["two.e_in"].name == back.ports["two.e_in"].name == "z.e"

    @pytest.mark.parametrize("drawn", ["->->", "-><-", "<-->"])
    @pytest.mark.parametrize("make", [TF, GY])
    def test_an_arrow_against_the_side_turns_the_power_s_sign_only(self, make, drawn):
        """The law is about power that enters at in and leaves at out, however bonds are drawn."""
        equations = self.pair(make, drawn=drawn)
        values = {key: port(equations, f"two.{key}") for key in ("e_in", "f_in", "e_out", "f_out")}
        pairs = (
            [("e_in", "e_out"), ("f_out", "f_in")]
            if make is TF
            else [("e_in", "f_out"), ("e_out", "f_in")]
        )
        for one, other in pairs:
            assert equal(values[one], n * values[other])
        sign = -1 if drawn == "-><-" else 1
        assert equal(values["f_out"], sign * port(equations, "i.f"))


class TestModulation:
    def pendulum(self):
        arm = One("arm")
        angle = C("angle", stiffness=0)
        lever = TF("lever", l * sympy.sin(angle.q))
        return assemble(
            "pendulum", arm >> (I("bob", m * l**2), angle), arm >> lever >> Se("weight", m * g)
        )

    def test_pendulum(self):
        found = rates(derive(self.pendulum()))
        assert equal(found["bob.p"], -m * g * l * sympy.sin(var("angle.q")))
        assert equal(found["angle.q"], var("bob.p") / (m * l**2))

    def test_modulated_source_and_resistor(self):
        v = One("v")
        mass, tank = I("mass", m), C("tank", c)
        equations = derive(
            assemble(
                "g",
                Se("thrust", tank.e * k) >> v >> (mass, R("drag", effort=lambda f: b * f * tank.q)),
                Sf("pump", mass.f) >> tank,
            )
        )
        found = rates(equations)
        p, q = var("mass.p"), var("tank.q")
        assert equal(found["mass.p"], k * q / c - b * q * p / m)
        assert equal(found["tank.q"], p / m)
        check_closed(equations)

    def test_modulated_gyrator(self):
        field = I("field", 1)
        rotor = One("rotor")
        coil = One("coil")
        equations = derive(
            assemble(
                "g",
                Se("uf", E) >> One("exciter") >> (field, R("rf", 1)),
                Se("ua", V) >> coil >> (I("armature", 1), GY("machine", k * field.f) >> rotor),
                rotor >> (I("inertia", 1), R("load", b)),
            )
        )
        found = rates(equations)
        i, a, w = var("field.p"), var("armature.p"), var("inertia.p")
        assert equal(found["armature.p"], V - k * i * w)
        assert equal(found["inertia.p"], k * i * a - b * w)

    def test_a_two_port_s_own_ports_as_signals(self):
        v, w = One("v"), One("w")
        gear = TF("gear", 2)
        spare = Sf("meter", gear.f_out) >> C("count", 1)
        equations = derive(assemble("g", Se("s", 1) >> v >> gear >> w >> I("m", 4), spare))
        assert equal(rates(equations)["count.q"], var("m.p") / 4)


class TestNonlinearLaws:
    def test_law_in_its_own_direction(self):
        v, u = One("v"), Zero("u")
        effort = assemble("g", v >> (I("m", m), R("r", effort=lambda f: b * f**3)))
        assert equal(rates(derive(effort))["m.p"], -b * (var("m.p") / m) ** 3)
        flow = assemble("g", u >> (C("c", c), R("r", flow=sympy.sinh)))
        assert equal(rates(derive(flow))["c.q"], -sympy.sinh(var("c.q") / c))

    def test_law_against_its_direction_is_kept_as_an_algebraic_variable(self):
        u = Zero("u")
        equations = derive(assemble("g", u >> (C("c", c), R("r", effort=lambda f: f**3 + f))))
        flow = var("r.f")
        assert equations.algebraic == (flow,)
        (residual,) = map(equations.substituted, equations.residuals)
        assert equal(residual, var("c.q") / c - flow**3 - flow)
        assert equal(rates(equations)["c.q"], -flow)
        assert any("kept as algebraic variables: r.f" in warning for warning in equations.warnings)
        check_closed(equations)

    def test_flow_law_under_an_imposed_flow(self):
        v = One("v")
        equations = derive(assemble("g", v >> (I("m", m), R("r", flow=lambda e: e**5 + e))))
        (residual,) = map(equations.substituted, equations.residuals)
        effort = var("r.e")
        assert equal(residual, var("m.p") / m - effort**5 - effort)
        assert equal(rates(equations)["m.p"], -effort)

    def test_stribeck_friction_that_must_give_its_flow(self):
        """Se on {C, R}: nothing but the resistor can decide the flow, which its law cannot."""
        v = One("v")

        def stribeck(f):
            return sympy.tanh(f / 10) * (1 + sympy.exp(-(f**2)))

        graph = assemble("g", Se("s", E) >> v >> (C("k", c), R("pad", effort=stribeck)))
        equations = derive(graph)
        (residual,) = map(equations.substituted, equations.residuals)
        flow = equations.algebraic[0]
        assert equal(residual, E - var("k.q") / c - stribeck(flow))
        assert equal(rates(equations)["k.q"], flow)

    def test_a_law_that_says_nothing_of_the_wanted_variable_is_refused(self):
        u = Zero("u")
        with pytest.raises(LawError, match="R 'dry' has a constant effort"):
            derive(assemble("g", u >> (C("c", c), R("dry", effort=lambda f: sympy.S(5)))))

    def test_affine_laws_are_inverted(self):
        u = Zero("u")
        equations = derive(assemble("g", u >> (C("c", c), R("r", effort=lambda f: b * f + 2))))
        assert equal(rates(equations)["c.q"], -(var("c.q") / c - 2) / b)
        assert equations.algebraic == ()

    def test_duffing_by_energy(self):
        u = Zero("u")
        equations = derive(
            assemble(
                "g",
                Sf("s", V) >> u >> (C("c", energy=lambda q: q**2 / 2 + q**4 / 4), I("i", 1)),
            )
        )
        found = rates(equations)
        assert equal(found["i.p"], var("c.q") + var("c.q") ** 3)
        assert equal(found["c.q"], V - var("i.p"))


class TestAlgebraicLoops:
    def test_resistive_loop(self):
        a, z, y = One("a"), Zero("z"), One("y")
        r1, r2, r3 = sympy.symbols("r1 r2 r3", positive=True)
        equations = derive(
            assemble(
                "g",
                Se("s", E) >> a >> (R("r1", r1), z),
                z >> (R("r2", r2), y),
                y >> (R("r3", r3), C("c", c)),
            )
        )
        q = var("c.q")
        node = (E / r1 + q / c / r3) / (1 / r1 + 1 / r2 + 1 / r3)
        assert equal(rates(equations)["c.q"], (node - q / c) / r3)
        assert [loop.solved for loop in equations.loops] == ["linear"]
        check_closed(equations)

    def test_a_mixed_loop_is_kept_as_one_unknown(self):
        a, z = One("a"), Zero("z")
        equations = derive(
            assemble(
                "g",
                Se("s", E) >> a >> (R("r", r), z),
                z >> R("d", flow=lambda e: sympy.exp(e) - 1),
                z >> R("x", 2),
            )
        )
        assert len(equations.algebraic) == 1
        node = equations.algebraic[0]
        (residual,) = map(equations.substituted, equations.residuals)
        others = residual.free_symbols - {node, E, r}
        assert not others
        check_closed(equations)

    def test_a_loop_without_solution_is_named(self):
        """Two bonds side by side: what flows in each of them is nowhere said."""
        u, w = Zero("u"), Zero("w")
        with pytest.raises(AlgebraicLoopError, match="has no unique solution"):
            derive(assemble("g", u >> w, u >> w, u >> C("c", c), w >> R("r", r)))

    def test_a_loop_that_binds_storages_makes_one_dependent(self):
        """Two bonds that cancel leave e = 0 at w, which strokes do not know."""
        u, v, w = Zero("u"), One("v"), Zero("w")
        graph = assemble(
            "g",
            *(v >> u, w >> v, u >> v),
            u >> (I("x", 3), Sf("s", 2), I("y", 1)),
            w >> R("r", 2),
        )
        equations = derive(graph)
        assert len(equations.states) == 1
        assert set(rates(equations).values()) == {sympy.S.Zero}
        assert "a loop of junctions binds the state of 'y'" in equations.warnings[0]
        assert equal(port(equations, "x.f") + port(equations, "y.f"), -2)


class TestDerivativeCausality:
    def test_rigid_pair(self):
        v = One("v")
        equations = derive(assemble("g", Se("s", F) >> v >> (I("a", m), I("b", M), R("r", r))))
        p = var("a.p")
        assert list(rates(equations)) == ["a.p"]
        assert equal(rates(equations)["a.p"], m * (F - r * p / m) / (m + M))
        assert equal(equations.substituted(equations.dependent["b"]), M * p / m)
        assert "I 'b' is in derivative causality" in equations.warnings[0]
        check_closed(equations)

    def test_an_initial_value_that_cannot_be_kept_is_told(self):
        parts = [I("a", m, initial=1), I("b", M, initial=2), R("r", r)]
        equations = derive(assemble("g", One("v") >> parts))
        assert equations.initial == (1,)
        assert "the initial value of 'b' is not used" in equations.warnings[-1]

    def test_gear_between_two_inertias_has_no_float_dust(self):
        a, z = One("a"), One("z")
        equations = derive(
            assemble(
                "g",
                Se("s", 1) >> a >> (I("i", 2), R("r", 0.5)),
                a >> TF("gear", 0.2) >> z >> (I("j", 3), R("x", 0.7)),
            )
        )
        (rate,) = rates(equations).values()
        assert sympy.diff(rate, var("i.p")) == sympy.Rational(-528, 2120)
        check_closed(equations)

    def test_two_capacitors_on_a_node(self):
        u = Zero("u")
        equations = derive(assemble("g", Sf("s", V) >> u >> (C("x", 2), C("y", 3), R("r", 0.5))))
        assert equal(rates(equations)["x.q"], (V - var("x.q")) * sympy.Rational(2, 5))

    def test_dependence_through_a_gyrator(self):
        u, v = Zero("u"), One("v")
        equations = derive(
            assemble("g", u >> (C("c", c), R("r", r)), u >> GY("gy", n) >> v >> I("i", L))
        )
        q = var("c.q")
        # e = r_gy f_v, so the inertia acts as a capacitance L / n^2
        assert equal(rates(equations)["c.q"], -(q / c / r) / (1 + L / (n**2 * c)))

    def test_a_source_straight_on_a_storage_asks_for_its_rate(self):
        equations = derive(assemble("g", Se("s", U) >> C("c", c), inputs=[U]))
        rate = equations.input_rates[U]
        assert equations.inputs == (U, rate)
        assert rate.name == "der(U)"
        assert equal(port(equations, "c.f"), c * rate)
        assert any("the rate of input 'U' is needed" in warning for warning in equations.warnings)

    def test_a_source_given_in_time_is_differentiated(self):
        equations = derive(assemble("g", Se("s", sympy.sin(TIME)) >> C("c", c)))
        assert equal(port(equations, "c.f"), c * sympy.cos(TIME))
        assert equations.inputs == ()

    def test_nonlinear_dependent_storage(self):
        """A hardening spring that follows a capacitor: its rate needs the slope of its law."""
        u = Zero("u")
        law = C("hard", effort=lambda q: q + q**3)
        equations = derive(assemble("g", u >> (C("c", c), law, R("r", r))))
        q, hard = var("c.q"), var("hard.q")
        assert equations.algebraic == (hard,)
        (residual,) = map(equations.substituted, equations.residuals)
        assert equal(residual, q / c - hard - hard**3)
        slope = 1 + 3 * hard**2
        assert equal(rates(equations)["c.q"], -(q / c / r) / (1 + 1 / (c * slope)))
        check_closed(equations)

    def test_cart_pendulum(self):
        """Two dependent masses through modulated transformers, against Lagrange's equations."""
        cart, arm, across, upwards = One("cart"), One("arm"), One("across"), One("upwards")
        sway = Zero("sway")
        angle = C("angle", stiffness=0)
        graph = assemble(
            "cart_pendulum",
            Se("push", F) >> cart >> (I("M", M), sway),
            arm >> (I("J", J), angle),
            arm >> TF("cos", l * sympy.cos(angle.q)) >> sway >> across >> I("mx", m),
            arm
            >> TF("sin", l * sympy.sin(angle.q))
            >> upwards
            >> (I("my", m), Se("weight", m * g)),
        )
        equations = derive(graph)
        check_closed(equations)
        assert equations.causal.derivative == ("mx", "my")
        theta = var("angle.q")
        found = {
            state.name: equations.substituted(rate)
            for state, rate in zip(equations.states, equations.derivatives, strict=True)
        }
        speed, spin = var("M.p") / M, var("J.p") / J
        x2, t2 = found["M.p"] / M, found["J.p"] / J
        assert equal(found["angle.q"], spin)
        sin, cos = sympy.sin(theta), sympy.cos(theta)
        assert equal((M + m) * x2 + m * l * cos * t2 - m * l * sin * spin**2, F)
        assert equal((J + m * l**2) * t2 + m * l * cos * x2 + m * g * l * sin, 0)
        assert speed not in found["angle.q"].free_symbols

    def test_a_law_that_listens_to_a_dependent_mass(self):
        """A force in proportion to an acceleration is as good as a mass."""
        v = One("v")
        slave = I("b", M)
        equations = derive(
            assemble("g", Se("s", F) >> v >> (I("a", m), slave), Se("react", -k * slave.e) >> v)
        )
        assert equal(rates(equations)["a.p"], m * F / (m + M + k * M))
        check_closed(equations)

    def test_the_rate_of_what_a_dependent_mass_answers(self):
        """A second mass driven in proportion to the first one's inertia force: second derivatives."""
        v = One("v")
        slave = I("b", M)
        equations = derive(
            assemble(
                "g",
                Se("s", F) >> v >> (I("a", m), slave, R("r", r)),
                Sf("drive", k * slave.e) >> I("c", L),
            )
        )
        acceleration = (F - r * var("a.p") / m) / (m + M)
        assert equal(port(equations, "b.e"), M * acceleration)
        assert equal(port(equations, "c.e"), -L * k * M * r * acceleration / (m + M))
        check_closed(equations)

    def test_derivatives_of_ever_higher_order_are_refused_by_name(self):
        """A source driven by the flow of the storage it sits on: a differential relation."""
        tank = C("tank", c)
        with pytest.raises(LawError, match="ever higher order"):
            derive(assemble("g", Se("s", k * tank.f) >> tank))


class TestFriction:
    def sled(self):
        v = One("v")
        dry = Friction("dry", kinetic=lambda speed: F + b * speed, breakaway=2 * F)
        return assemble("sled", Se("push", E) >> v >> (I("m", m), C("k", stiffness=k), dry))

    def test_slipping(self):
        equations = derive(self.sled())
        (contact,) = equations.contacts
        d, p, q = contact.direction, var("m.p"), var("k.q")
        assert equations.directions == (d,)
        assert equal(rates(equations)["m.p"], E - k * q - d * (F + b * d * p / m))
        assert contact.breakaway == 2 * F
        assert not contact.stuck

    def test_stuck_holds_the_slip_s_rate(self):
        equations = derive(self.sled(), stuck=["dry"])
        assert equations.contacts[0].stuck
        assert equal(port(equations, "dry.e"), E - k * var("k.q"))
        assert rates(equations)["m.p"] == 0
        assert len(equations.states) == 2
        check_closed(equations)

    def test_only_friction_is_stuck(self):
        for name in ("m", "nothing"):
            with pytest.raises(
                BondGraphError, match=f"{name}: no Friction with modes of graph 'sled'"
            ):
                derive(self.sled(), stuck=[name])

    def test_smooth_form_has_no_contact(self):
        v = One("v")
        dry = Friction("dry", kinetic=lambda speed: F, smoothing=0.5)
        equations = derive(assemble("g", v >> (I("m", m), dry)))
        assert equations.contacts == ()
        assert equal(rates(equations)["m.p"], -F * sympy.tanh(2 * var("m.p") / m))

    def test_two_redundant_stuck_contacts_are_named(self):
        v = One("v")
        pads = [Friction(name, kinetic=lambda speed: F) for name in ("left", "right")]
        graph = assemble("g", v >> (I("m", m), *pads))
        with pytest.raises(AlgebraicLoopError) as caught:
            derive(graph, stuck=["left", "right"])
        assert {"left", "right"} & set(caught.value.elements)


class TestReports:
    def test_powers_and_energies(self):
        v = One("v")
        equations = derive(
            assemble("g", Se("s", F) >> v >> (I("m", m), R("b", b)), v >> Se("w", 3))
        )
        speed = var("m.p") / m
        assert equal(equations.substituted(equations.supplied["s"]), F * speed)
        assert equal(equations.substituted(equations.supplied["w"]), -3 * speed)
        assert equal(equations.substituted(equations.dissipated["b"]), b * speed**2)
        assert equations.energies == {"m": var("m.p") ** 2 / (2 * m)}

    def test_unknown_energies_are_none(self):
        u = Zero("u")
        equations = derive(assemble("g", u >> (C("c", effort=sympy.sinh), R("r", r))))
        assert equations.energies == {"c": None}

    def test_initial_values_and_outputs(self):
        v = One("v")
        mass = I("m", m, initial=2 * m)
        equations = derive(
            assemble(
                "g", Se("s", F) >> v >> (mass, R("b", b)), outputs={"a": (mass.e / m, "m/s^2")}
            )
        )
        assert equations.initial == (2 * m,)
        assert equal(equations.substituted(equations.outputs["a"]), (F - b * var("m.p") / m) / m)

    def test_only_used_parameters_are_listed(self):
        v = One("v")
        graph = assemble("g", Se("s", F) >> v >> I("m", m), parameters={n: 3})
        assert set(graph.parameters) == {F, m, n}
        assert set(derive(graph).parameters) == {F, m}

    def test_ports_of_every_element_are_named(self):
        v = One("v")
        equations = derive(
            assemble("g", Se("s", F) >> v >> (I("m", m), TF("tf", 2) >> One("w") >> C("c", c)))
        )
        assert set(equations.ports) == {
            *("s.e", "s.f", "v.f", "m.e", "m.f", "m.p", "w.f", "c.e", "c.f", "c.q"),
            *("tf.e_in", "tf.f_in", "tf.e_out", "tf.f_out"),
        }

    def test_deriving_twice_gives_the_same(self):
        graph = models.bicycle_brake.graph()
        first, second = derive(graph), derive(graph)
        assert first.assignments == second.assignments
        assert first.states == second.states
        causal = assign_causality(graph)
        assert derive(causal).assignments == first.assignments
        assert derive(causal).causal is causal

    def test_building_twice_gives_the_same(self):
        first, second = (derive(models.bicycle_brake.graph()) for _ in range(2))
        assert first.assignments == second.assignments


def modes_of(graph):
    names = contacts(graph)
    for labels in itertools.product(("stick", "slip+", "slip-"), repeat=len(names)):
        yield dict(zip(names, labels, strict=True))


@pytest.mark.parametrize("name", models.LIBRARY)
class TestLibrary:
    def test_equations_are_closed(self, name):
        graph = getattr(models, name).graph()
        check_closed(derive(graph))
        for stuck in itertools.product(*(((), (contact,)) for contact in contacts(graph))):
            check_closed(derive(graph, stuck=[contact for part in stuck for contact in part]))

    def test_in_every_mode(self, name):
        graph = getattr(models, name).graph()
        for modes in modes_of(graph):
            equations = derive(in_mode(graph, modes))
            check_closed(equations)
            assert equations.contacts == ()


class TestBrake:
    """The brake's equations are Eq. 1 of Procedia Engineering 72 (2014) 471-476."""

    k_t, b_t, k_f, b_f, m_f = sympy.symbols("k_t b_t k_f b_f m_f", real=True)
    J_r, J_t, r_r, w_t = sympy.symbols("J_r J_t r_r omega_t", real=True)

    @functools.cached_property
    def graph(self):
        return models.bicycle_brake.graph()

    def plain(self, expression):
        """Exchange the sheet's symbols for plain real ones of the same name."""
        return expression.xreplace({item: var(item.name) for item in expression.free_symbols})

    def states(self):
        w_r = var("wheel.rotor.p") / self.J_r
        v_c = var("rear.mass.p") / self.m_f
        return w_r, v_c, var("wheel.spokes.q"), var("rear.bending.q")

    def check_equation_1(self, equations):
        found = {name: self.plain(rate) for name, rate in rates(equations).items()}
        force = self.plain(port(equations, "friction.e"))
        w_r, v_c, theta, x_c = self.states()
        torque = self.k_t * theta + self.b_t * (self.w_t - w_r)
        assert equal(found["wheel.rotor.p"], torque - self.r_r * force)
        assert equal(found["rear.mass.p"], force - self.k_f * x_c - self.b_f * v_c)
        assert equal(found["wheel.spokes.q"], self.w_t - w_r)
        assert equal(found["rear.bending.q"], v_c)

    def test_equation_1(self):
        self.check_equation_1(derive(self.graph))

    @pytest.mark.parametrize("mode", ["slip+", "slip-"])
    def test_equation_1_in_each_direction(self, mode):
        self.check_equation_1(derive(in_mode(self.graph, {"friction": mode})))

    def test_equation_1_while_stuck(self):
        self.check_equation_1(derive(self.graph, stuck=["friction"]))

    def test_friction_force(self):
        equations = derive(in_mode(self.graph, {"friction": "slip+"}))
        force = self.plain(port(equations, "friction.e"))
        w_r, v_c, *_ = self.states()
        slip = self.r_r * w_r - v_c
        pressure = var("line.fluid.q") / var("C_h")
        mu = var("mu_k") + (var("mu_s") - var("mu_k")) * sympy.exp(-slip / var("v_s"))
        assert equal(force, var("A_p") * pressure * mu)

    def test_application_is_a_first_order_lag(self):
        found = {name: self.plain(rate) for name, rate in rates(derive(self.graph)).items()}
        pressure = var("line.fluid.q") / var("C_h")
        assert equal(found["line.fluid.q"], (var("p_l") - pressure) / var("R_h"))

    def test_the_tyre_s_inertia_is_reported_and_drops_out(self):
        equations = derive(self.graph)
        assert equations.causal.derivative == ("wheel.tyre",)
        assert any("'wheel.tyre' is in derivative causality" in text for text in equations.warnings)
        assert equal(self.plain(port(equations, "wheel.tyre.p")), self.J_t * self.w_t)
        assert port(equations, "wheel.tyre.e") == 0
        assert "J_t" not in {
            item.name for rate in rates(equations).values() for item in rate.free_symbols
        }

    def test_force_that_keeps_it_stuck(self):
        equations = derive(self.graph, stuck=["friction"])
        w_r, v_c, theta, x_c = self.states()
        torque = self.k_t * theta + self.b_t * (self.w_t - w_r)
        top = self.r_r * torque / self.J_r + (self.k_f * x_c + self.b_f * v_c) / self.m_f
        bottom = self.r_r**2 / self.J_r + 1 / self.m_f
        assert equal(self.plain(port(equations, "friction.e")), top / bottom)

    def test_stuck_the_slip_does_not_change(self):
        equations = derive(self.graph, stuck=["friction"])
        found = {name: self.plain(rate) for name, rate in rates(equations).items()}
        assert equal(self.r_r * found["wheel.rotor.p"] / self.J_r, found["rear.mass.p"] / self.m_f)

    def test_the_stuck_graph_loses_a_state(self):
        whole, stuck = derive(self.graph), derive(in_mode(self.graph, {"friction": "stick"}))
        assert len(whole.states) == 5
        assert len(stuck.states) == 4
        assert set(stuck.states) < set(whole.states)

    def test_both_ways_of_sticking_agree(self):
        """The re-causalised graph and the held contact give one and the same motion."""
        held = rates(derive(self.graph, stuck=["friction"]))
        equations = derive(in_mode(self.graph, {"friction": "stick"}))
        reduced = rates(equations)
        (missing,) = set(held) - set(reduced)
        element = missing.rpartition(".")[0]
        follows = {var(missing): equations.substituted(equations.dependent[element])}
        for name, rate in reduced.items():
            assert equal(self.plain(rate), self.plain(held[name].xreplace(follows)))

    def test_frame_brake_is_the_same_frame_on_a_rigid_wheel(self):
        equations = derive(models.frame_brake.graph())
        found = {name: self.plain(rate) for name, rate in rates(equations).items()}
        force = self.plain(port(equations, "friction.e"))
        _, v_c, _, x_c = self.states()
        assert equal(found["rear.mass.p"], force - self.k_f * x_c - self.b_f * v_c)
        slip = self.plain(port(equations, "friction.f"))
        assert equal(slip, self.r_r * self.w_t - v_c)
