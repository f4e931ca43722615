"""A thousand and more random linear graphs with every linear element against raw equations.

Fields, sensors, signal blocks, modulated sources, chains of two-ports, meshes of junctions and
arrows either way. The seed is fixed and printed; ``HYPOTHESIS_PROFILE=explore`` draws another,
``RANDOM_GRAPHS_SEED=7`` sets it. Each graph is refused by name, rightly, or its equations are
those of the pencil: `checks` says in what.
"""

from fractions import Fraction

import numpy as np
import pytest

from bondgraph import derive
from bondgraph.errors import BondGraphError

from .checks import follows_raw, same_eigenvalues, same_transforms, traits
from .draws import Menu
from .nesting import nested
from .pencil import Pencil
from .plans import Part, Plan
from .tally import campaign

# graphs a test, and tests: small ones, since the ways in which graphs differ are found among them
BATCH, BATCHES, LARGE, NESTED = 125, 8, 24, 60
POWER = Menu(fields=2, sensors=1, pairs=1)
SIGNALS = Menu(junctions=4, ones=2, fields=1, sensors=1, pairs=1, blocks=2, signals=2)
BIG = Menu(junctions=30, loops=8, ones=2, chain=1, fields=2, kinds=("R", "C", "I", "I", "Se"))


def check(plan: Plan, seed: int, make=Plan.graph) -> list[str]:
    """Compare everything; or be told why not, and check that it is so."""
    try:
        equations = derive(make(plan))
    except BondGraphError as error:
        assert error.elements, "no element is named"
        refused = "refused " + type(error).__name__
        if Pencil(plan).determinant(987654321) == 0:
            return ["refused", refused]
        # what a signal closes may be of too high an order; bonds alone never are
        assert any(part.heard for part in plan.parts.values()), f"solvable, but: {error}"
        return ["refused", refused, "refused though solvable"]
    pencil = same_transforms(plan, equations, seed)
    same_eigenvalues(pencil, equations)
    if make is Plan.graph:
        follows_raw(plan, equations, seed)
    return ["derived", *traits(equations)]


@pytest.mark.parametrize("batch", range(BATCHES))
def test_random_graphs(batch):
    menu = SIGNALS if batch % 4 == 3 else POWER
    tally = campaign(f"linear {batch}", menu, BATCH, check)
    assert tally["graphs"] == BATCH
    assert tally["derived"] + tally["refused"] == BATCH
    # so that the generator cannot come to draw trifles
    assert tally["derived"] >= 0.6 * BATCH
    assert tally["dependent"] >= 0.15 * BATCH
    assert tally["loop"] >= 0.25 * BATCH
    assert tally["mesh"] >= 0.2 * BATCH
    assert tally["field"] >= 0.3 * BATCH
    assert tally["sensor"] >= 0.2 * BATCH
    if menu is SIGNALS:
        assert tally["block"] >= 0.3 * BATCH
        assert tally["followed"] >= 0.2 * BATCH
    assert tally["refused though solvable"] <= 0.05 * BATCH


def test_large_meshes():
    tally = campaign("large", BIG, LARGE, check)
    assert tally["graphs"] == LARGE
    assert tally["derived"] >= 0.4 * LARGE
    assert tally["mesh"] >= 0.5 * LARGE


def test_a_thousand_are_drawn():
    assert BATCH * BATCHES + LARGE >= 1000


def test_nested_submodels():
    """What is joined through the ports of submodels has the same equations."""
    tally = campaign(
        "nested", SIGNALS, NESTED, lambda plan, seed: check(plan, seed, lambda p: nested(p, seed))
    )
    assert tally["graphs"] == NESTED
    assert tally["derived"] >= 0.6 * NESTED


def part(kind, *numbers, **more):
    return Part(kind, numbers=tuple(map(Fraction, numbers)), **more)


def bonds(text):
    return tuple(tuple(bond.split(">")) for bond in text.split())


# Graphs that were once refused though they have a solution.
ONCE_WRONG = {
    "two ports of an I-field bound to each other": Plan(
        {
            "z": part("0"),
            "gy": part("GY", "-2/3"),
            "coils": Part(
                "IField", "energy", tuple(map(Fraction, ("9/2", "1/2", "1/2", "7/2"))),
                ports={"one": "I", "two": "I"},
            ),
            "s": part("Sf"),
            "r": part("R", 1),
        },
        bonds("gy>z coils.one>z s>r gy>z z>coils.two"),
    ),
    "a C-field wholly dependent": Plan(
        {
            "a": part("0"), "b": part("1"), "c": part("0"),
            "gy1": part("GY", -3), "gy2": part("GY", -2), "gy3": part("GY", "-5/3"),
            "gy4": part("GY", "7/5"), "store": part("C", "7/5"),
            "beam": Part(
                "CField", "energy", tuple(map(Fraction, ("7/2", "1/2", "1/2", "5/2"))),
                ports={"one": "C", "two": "C"},
            ),
        },
        bonds("a>b gy1>c gy2>c gy3>gy2 gy3>b gy4>c store>gy4 beam.one>a beam.two>a b>gy1"),
    ),
    "an R-field within a loop of junctions": Plan(
        {
            "a": part("1"), "b": part("1"), "c": part("0"), "d": part("0"),
            "gy1": part("GY", "-1/2"), "gy2": part("GY", "5/4"), "gy3": part("GY", -2),
            "s": part("Se"), "gy4": part("GY", 1), "m": part("I", "7/5"), "gy5": part("GY", "-5/4"),
            "wall": Part(
                "RField", "conductance", tuple(map(Fraction, (3, "13/6", "-7/6", "9/2"))),
                ports={"one": "R", "two": "R"},
            ),
            "drive": part("Sf"), "load": part("I", 3),
        },
        bonds(
            "gy1>a a>b gy2>b gy3>gy2 gy3>c d>c a>d gy4>c gy4>s gy5>m d>wall.one d>wall.two "
            "load>drive gy1>b d>gy5"
        ),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ONCE_WRONG)
def test_once_wrong(name):
    assert "derived" in check(ONCE_WRONG[name], 1)


def test_a_dependent_storage_that_drives_its_own_source():
    """Once answered wrongly: a rate asked for but not yet written was taken for zero.

    The source that binds C follows, through others, what C answers; so C is a state after all,
    which is refused.
    """
    plan = Plan(
        {
            "a": part("1"), "b": part("0"), "gy1": part("GY", -3), "m": part("I", "2/3"),
            "gy2": part("GY", 1), "gy3": part("GY", 3), "s": part("Sf", 1, heard="c.f"),
            "gy4": part("GY", -3), "t": part("Se", "-5/4", heard="a.f"), "c": part("C", "2/3"),
            "gy5": part("GY", "5/3"), "gy6": part("GY", "7/5"),
        },
        bonds("a>b gy1>b gy1>a a>gy2 gy3>gy2 m>gy3 gy4>b t>gy5 gy6>gy5 gy6>c gy4>s"),
    )  # fmt: skip
    assert check(plan, 1) == ["refused", "refused LawError", "refused though solvable"]


class TestTheReference:
    """The oracle itself, on a graph solved by hand."""

    def coupled(self, off="1"):
        """Two coils of mutual inductance 1, one shorted by a resistor of 1, one by one of 2."""
        return Plan(
            {
                "left": part("1"), "right": part("1"),
                "coils": Part(
                    "IField", "inertance", tuple(map(Fraction, ("2", off, off, "3"))),
                    ports={"one": "I", "two": "I"},
                ),
                "r": part("R", 1), "s": part("R", 2),
            },
            bonds("coils.one>left left>r right>coils.two s>right"),
        )  # fmt: skip

    def test_eigenvalues(self):
        """``det(s M + R) = (2 s + 1)(3 s + 2) - s^2 = 5 s^2 + 7 s + 2``: at -1 and -2/5."""
        assert np.allclose(sorted(Pencil(self.coupled()).eigenvalues()), [-1, -0.4])

    def test_other_values_are_noticed(self):
        equations = derive(self.coupled("1/2").graph())
        with pytest.raises(AssertionError, match="other eigenvalues"):
            same_transforms(self.coupled(), equations, 3)
        with pytest.raises(AssertionError, match="against"):
            same_eigenvalues(Pencil(self.coupled()), equations)
        with pytest.raises(AssertionError, match="raw equation is missed"):
            follows_raw(self.coupled(), equations, 3)
