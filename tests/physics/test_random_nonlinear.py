"""Random nonlinear graphs: what is derived satisfies the raw equations at random points.

Laws of R, C, I and of fields are polynomials or monotone functions; ratios, resistances and
sources follow states and other variables; dissipators heat. Everything is evaluated in 60
digits, in equations as derived and without codegen, and put into the raw equations of every
junction and element; so are energies, and power along a random motion.
"""

from dataclasses import replace
from fractions import Fraction

import mpmath
import pytest
import sympy

from bondgraph import derive
from bondgraph.errors import BondGraphError

from .checks import UnsolvedError, follows_raw, refused_rightly, traits
from .draws import Menu
from .plans import Part, Plan
from .points import DIGITS, Point
from .tally import campaign

BATCH, BATCHES, CONTACTS = 75, 4, 50
NONLINEAR = Menu(
    junctions=4, loops=1, ones=2, chain=1, fields=1, sensors=1, blocks=1, signals=2, pairs=1,
    heats=1, curved=0.6,
)  # fmt: skip
DRY = replace(NONLINEAR, switches=2, switching=("Friction", "Clutch"), signals=1)


def check(plan: Plan, seed: int) -> list[str]:
    """Compare at the points of a random motion; or be told by name why there are none."""
    try:
        equations = derive(plan.graph())
    except BondGraphError as error:
        assert error.elements, "no element is named"
        refused = ["refused", "refused " + type(error).__name__]
        modes = dict.fromkeys(plan.of("Friction", "Clutch"), 1)
        # at a random point: what modulation makes singular where it may be is not looked for
        return refused if refused_rightly(plan, seed, modes) else [*refused, "refused, regular"]
    given = {contact.direction: mpmath.mpf(1) for contact in equations.contacts}
    modes = {contact.name: 1 for contact in equations.contacts}
    found = ["derived", *traits(equations)]
    if equations.switches:  # a friction that decides a flow says nothing before it is in a mode
        return [*found, "open"]
    try:
        follows_raw(plan, equations, seed, modes, given)
    except UnsolvedError:
        return [*found, "unsolved"]
    return [*found, "compared"]


@pytest.mark.parametrize("batch", range(BATCHES))
def test_random_graphs(batch):
    tally = campaign(f"nonlinear {batch}", NONLINEAR, BATCH, check)
    assert tally["graphs"] == BATCH == tally["derived"] + tally["refused"]
    assert tally["compared"] >= 0.7 * BATCH
    assert tally["algebraic"] >= 0.25 * BATCH
    assert tally["dependent"] >= 0.15 * BATCH
    assert tally["modulated"] >= 0.15 * BATCH
    assert tally["heat"] >= 0.2 * BATCH
    assert tally["block"] >= 0.2 * BATCH
    assert tally["unsolved"] <= 0.08 * BATCH
    assert tally["refused, regular"] <= 0.08 * BATCH


def test_dry_friction_slipping_either_way():
    """Left open where friction alone bears on a C: its effort would have to be the C's."""
    tally = campaign("dry", DRY, CONTACTS, check)
    assert tally["graphs"] == CONTACTS
    assert tally["contact"] >= 0.4 * CONTACTS
    assert tally["compared"] >= 0.25 * CONTACTS


class TestTheReference:
    """The oracle itself notices what is wrong."""

    def spring(self, law="energy cubic"):
        one = Fraction(1)
        parts = {
            "v": Part("1"),
            "c": Part("C", law, (one,)),
            "i": Part("I", "linear", (2 * one,)),
            "r": Part("R", "effort cubic", (one,)),
        }
        return Plan(parts, (("v", "c"), ("i", "v"), ("v", "r")))

    def test_rates_by_hand(self):
        """``q' = p/2``, ``p' = -(q + q^3) - (p/2 + (p/2)^3)`` at q = 1/2, p = 1."""
        equations = derive(self.spring().graph())
        spring = next(state for state in equations.states if state.name == "c.q")
        given = {s: mpmath.mpf({"c.q": "0.5", "i.p": "1"}[s.name]) for s in equations.states}
        point = Point(equations, 1, given)
        rates = {state.name: rate for state, rate in point.rates.items()}
        assert rates == {"c.q": mpmath.mpf("0.5"), "i.p": mpmath.mpf("-1.25")}
        with mpmath.workdps(DIGITS):
            (change,) = point.change(spring**2)
        assert abs(change - mpmath.mpf("0.5")) < 1e-12

    def test_other_laws_are_noticed(self):
        other = derive(self.spring("energy growth").graph())
        with pytest.raises(AssertionError, match="c: the raw equation is missed"):
            follows_raw(self.spring(), other, 1)

    def test_lost_power_is_noticed(self):
        equations = derive(self.spring().graph())
        wrong = replace(equations, dissipated={"r": sympy.Integer(0)})
        with pytest.raises(AssertionError, match="power is made or lost"):
            follows_raw(self.spring(), wrong, 1)
