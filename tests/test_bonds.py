"""Bonds are values joined by >>."""

import pytest

from bondgraph import TF, C, I, One, R, Se, Zero, assemble
from bondgraph.bonds import Bond, Chain


def ends(chain):
    return [(bond.tail.name, bond.head.name) for bond in chain.bonds]


def test_a_chain_points_from_left_to_right():
    chain = Se("f", 1) >> One("v") >> TF("n", 2) >> Zero("u") >> C("c", 1)
    assert ends(chain) == [("f", "v"), ("v", "n"), ("n", "u"), ("u", "c")]


def test_a_tuple_fans_out_and_in():
    v = One("v")
    assert ends(v >> (I("m", 1), R("b", 1))) == [("v", "m"), ("v", "b")]
    assert ends([Se("f", 1), Se("g", 1)] >> v) == [("f", "v"), ("g", "v")]


def test_chains_join_at_their_ends():
    left, right = Se("f", 1) >> One("v"), Zero("u") >> R("r", 1)
    assert ends(left >> right) == [("f", "v"), ("v", "u"), ("u", "r")]
    branch = One("a") >> (Zero("b") >> R("r", 1), Zero("c") >> R("s", 1))
    assert set(ends(branch)) == {("a", "b"), ("b", "r"), ("a", "c"), ("c", "s")}
    assert [head.name for head in branch.heads] == ["r", "s"]


def test_chains_are_values():
    chain = One("v") >> R("r", 1)
    assert isinstance(chain, Chain)
    assert isinstance(chain.bonds[0], Bond)
    longer = Se("f", 1) >> chain
    assert (len(chain.bonds), len(longer.bonds)) == (1, 2)


def test_a_port_is_joined_like_an_element():
    v = One("v")
    part = assemble("part", v >> (I("m", 1), R("b", 1)), ports={"v": v})
    assert (Se("f", 1) >> part.port("v")).bonds[0].head.junction is v


@pytest.mark.parametrize("other", [3, "r", None, (), [], {"a": 1}, ("x",)])
def test_nothing_else_is_joined(other):
    with pytest.raises(TypeError, match="joined by >>"):
        One("v") >> other
    with pytest.raises(TypeError, match="joined by >>"):
        other >> One("v")


def test_a_whole_submodel_is_not_joined():
    v = One("v")
    part = assemble("part", v >> (I("m", 1), R("b", 1)), ports={"v": v})
    with pytest.raises(TypeError, match="name its port"):
        One("w") >> part


def test_tuple_to_tuple_is_ambiguous():
    with pytest.raises(TypeError, match="which element goes to which"):
        One("s") >> (One("a"), One("b")) >> (Zero("c"), Zero("d"))
