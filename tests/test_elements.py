"""Elements: one law each, in the forms it has; frozen; symbols of their own."""

import dataclasses
import inspect

import numpy
import pytest
import sympy

import bondgraph
from bondgraph import GY, TF, C, Friction, I, One, R, Se, Sf, Zero, elements
from bondgraph.causality import PREFERRED
from bondgraph.elements import Element, Storage
from bondgraph.errors import GraphError, LawError

x = sympy.Symbol("x", real=True)


class TestNames:
    @pytest.mark.parametrize("name", ["", "  ", None, 3, "a.b", "a>b"])
    @pytest.mark.parametrize("make", [One, Zero, lambda n: R(n, 1), lambda n: TF(n, 2)])
    def test_bad_names_are_refused(self, make, name):
        with pytest.raises(GraphError):
            make(name)

    def test_repr_tells_kind_and_name(self):
        assert repr(R("damper", 2)) == "R('damper')"
        assert repr(One("v")) == "1('v')"

    def test_elements_are_compared_by_identity(self):
        assert One("v") != One("v")
        v = One("v")
        assert {v: 1}[v] == 1

    def test_port_variables_of_namesakes_differ(self):
        assert R("r", 1).e != R("r", 1).e

    def test_elements_are_frozen(self):
        with pytest.raises(dataclasses.FrozenInstanceError):
            R("r", 1).name = "s"


class TestSources:
    def test_laws(self):
        assert Se("battery", 12).effort == 12
        assert Sf("road", 0.5).flow == sympy.Rational(1, 2)

    def test_modulated_by_a_bare_port_variable(self):
        mass = I("mass", 2)
        follower = Sf("follower", mass.f)
        assert follower.laws == {"flow": mass.f}
        assert set(follower.symbols) == {"e", "f"}

    @pytest.mark.parametrize("value", ["12", None, True, float("nan"), float("inf"), 1j, [1]])
    def test_what_is_no_real_expression_is_refused(self, value):
        with pytest.raises(LawError, match="battery"):
            Se("battery", value)


class TestR:
    def test_linear_in_both_forms(self):
        damper = R("damper", 0.5)
        assert damper.effort == damper.f / 2
        assert damper.flow == 2 * damper.e

    def test_zero_resistance_gives_effort_only(self):
        wire = R("wire", 0)
        assert wire.effort == 0
        assert wire.flow is None

    def test_affine_law_is_inverted(self):
        preload = R("preload", effort=lambda f: 3 * f + 2)
        assert sympy.expand(preload.flow - (preload.e - 2) / 3) == 0
        leak = R("leak", flow=lambda e: e / 4 - 1)
        assert sympy.expand(leak.effort - 4 * (leak.f + 1)) == 0

    @pytest.mark.parametrize(
        "law", [lambda f: f + f**3, sympy.tanh, sympy.Abs, lambda f: sympy.S(5)]
    )
    def test_other_laws_keep_their_direction(self, law):
        assert R("pad", effort=law).flow is None
        assert R("diode", flow=law).effort is None

    @pytest.mark.parametrize(
        "laws",
        [{}, {"resistance": 1, "effort": abs}, {"effort": abs, "flow": abs}],
    )
    def test_takes_exactly_one_law(self, laws):
        with pytest.raises(LawError, match="exactly one of resistance, effort, flow"):
            R("damper", **laws)


class TestStorage:
    def test_linear_forms(self):
        spring, tank = C("spring", stiffness=8), C("tank", 0.125)
        assert spring.law == 8 * spring.q and tank.law == 8 * tank.q
        assert spring.inverse == spring.e / 8 and tank.inverse == tank.e / 8
        assert spring.energy == 4 * spring.q**2 and tank.energy == 4 * tank.q**2
        mass = I("mass", 2)
        assert (mass.law, mass.inverse, mass.energy) == (mass.p / 2, 2 * mass.f, mass.p**2 / 4)

    def test_law_from_energy_and_energy_from_law(self):
        duffing = C("duffing", energy=lambda q: q**2 / 2 + q**4 / 4)
        assert sympy.expand(duffing.law - duffing.q - duffing.q**3) == 0
        same = C("same", effort=lambda q: q + q**3)
        assert sympy.expand(same.energy - same.q**2 / 2 - same.q**4 / 4) == 0
        relativistic = I("electron", energy=lambda p: sympy.sqrt(1 + p**2))
        assert relativistic.law == relativistic.p / sympy.sqrt(1 + relativistic.p**2)

    def test_unknown_energy_and_inverse_are_none(self):
        gas = C("gas", effort=lambda q: 1 / (1 - q))
        assert gas.energy is None
        assert gas.inverse is None

    def test_slack_spring_has_no_inverse(self):
        slack = C("slack", stiffness=0)
        assert slack.law == 0
        assert slack.inverse is None

    @pytest.mark.parametrize("make", [lambda: C("c", 0), lambda: I("i", 0)])
    def test_no_storage_at_all_is_refused(self, make):
        with pytest.raises(LawError, match="is zero"):
            make()

    @pytest.mark.parametrize(
        "make",
        [
            lambda: C("c"),
            lambda: C("c", 1, stiffness=2),
            lambda: I("i"),
            lambda: I("i", 1, energy=abs),
        ],
    )
    def test_takes_exactly_one_law(self, make):
        with pytest.raises(LawError, match="exactly one of"):
            make()

    def test_initial_state(self):
        assert C("c", 1).initial == 0
        assert I("m", 2, initial=0.1).initial == sympy.Rational(1, 10)

    def test_no_float_dust_in_laws(self):
        assert C("c", 0.1).law.atoms(sympy.Float) == set()
        assert C("c", effort=lambda q: 0.1 * q**3 + 0.7 * q).law.atoms(sympy.Float) == set()


class TestFriction:
    def make(self, **changes):
        return Friction("pad", **{"kinetic": lambda v: 3 + sympy.exp(-v)} | changes)

    def test_breakaway_is_the_static_limit_of_the_law_unless_given(self):
        assert self.make().breakaway == 4
        assert self.make(breakaway=7).breakaway == 7

    def test_effort_is_along_the_slip(self):
        pad = self.make()
        assert pad.slipping(sympy.Integer(1)) == 3 + sympy.exp(-pad.f)
        assert pad.slipping(sympy.Integer(-1)) == -3 - sympy.exp(pad.f)

    def test_smooth_form(self):
        pad = self.make(smoothing=0.01)
        assert float(pad.smoothed().subs(pad.f, 1)) == pytest.approx(3 + numpy.exp(-1))
        assert float(pad.smoothed().subs(pad.f, -1)) == pytest.approx(-3 - numpy.exp(-1))
        with pytest.raises(LawError, match="smoothing width"):
            self.make().smoothed()

    @pytest.mark.parametrize("width", [0, -1, "x"])
    def test_bad_widths_are_refused(self, width):
        with pytest.raises(LawError):
            self.make(smoothing=width)

    def test_breakaway_cannot_depend_on_speed(self):
        speed = []
        with pytest.raises(LawError, match="breakaway"):
            Friction("pad", kinetic=lambda v: speed.append(v) or v, breakaway=lambda v: v)


class TestTwoPorts:
    @pytest.mark.parametrize("make", [TF, GY])
    def test_ratio(self, make):
        assert make("gear", 0.2).ratio == sympy.Rational(1, 5)
        assert set(make("gear", x).symbols) == {"e_in", "f_in", "e_out", "f_out"}

    @pytest.mark.parametrize("make", [TF, GY])
    @pytest.mark.parametrize("ratio", [0, 0.0, "n", None, lambda q: q])
    def test_bad_ratios_are_refused(self, make, ratio):
        with pytest.raises(LawError, match="gear"):
            make("gear", ratio)

    def test_modulated_by_a_bare_state(self):
        angle = C("angle", 1)
        lever = TF("lever", angle.q)
        assert "ratio" not in lever.symbols
        assert lever.laws == {"ratio": angle.q}


class TestReplaced:
    def test_copy_has_other_symbols_and_the_same_law(self):
        spring = C("spring", stiffness=3)
        fresh = {symbol: sympy.Dummy(symbol.name) for symbol in spring.symbols.values()}
        twin = spring.replaced(fresh, name="twin")
        assert (twin.name, spring.name) == ("twin", "spring")
        assert twin.law == 3 * twin.q
        assert twin.q != spring.q


def final_classes():
    return [
        value
        for value in vars(elements).values()
        if inspect.isclass(value) and issubclass(value, Element) and not value.__subclasses__()
    ]


def test_the_field_s_elements_are_all_there():
    assert {cls.__name__ for cls in final_classes()} == {
        *("Se", "Sf", "R", "C", "I", "Heat", "De", "Df"),
        *("Friction", "Clutch", "Diode", "CheckValve", "Switch", "EndStop"),
        *("TF", "GY", "Zero", "One"),
        *("Block", "Integrator", "Lag"),
    }


def test_every_storage_source_and_switch_has_a_preferred_causality():
    kinds = (Storage, elements.EffortSource, elements.FlowSource, elements.Switched)
    for cls in final_classes():
        assert issubclass(cls, kinds) == any(issubclass(cls, kind) for kind in PREFERRED)


def test_only_final_elements_are_public():
    public = {getattr(bondgraph, name) for name in bondgraph.__all__}
    assert set(final_classes()) <= public
    assert not {elements.OnePort, elements.TwoPort, elements.Storage, elements.Junction} & public
