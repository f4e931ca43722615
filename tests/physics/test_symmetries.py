"""What is only a way of drawing must not change the physics.

Characteristic polynomials are compared exactly, at random points modulo a prime.
"""

import dataclasses

from hypothesis import given, settings
from hypothesis import strategies as st

from bondgraph import derive
from bondgraph.errors import BondGraphError

from ..sketches import JUNCTIONS, PRIME, Derived, Sketch
from ..strategies import sketches

POINTS = (123456789, 987654321987, 5**20)


def fingerprint(sketch: Sketch):
    """Number of states and characteristic polynomial at some points; or that there is none."""
    try:
        derived = Derived(derive(sketch.graph()))
    except BondGraphError:
        return None
    return len(derived.equations.states), [derived.determinant(s % PRIME) for s in POINTS]


@settings(max_examples=50, deadline=None)
@given(data=st.data(), sketch=sketches(loops=0))
def test_arrows_between_junctions_of_a_tree(data, sketch):
    plain = {name for name, (kind, _) in sketch.elements.items() if kind in JUNCTIONS}
    bonds = tuple(
        (head, tail) if {tail, head} <= plain and data.draw(st.booleans()) else (tail, head)
        for tail, head in sketch.bonds
    )
    assert fingerprint(dataclasses.replace(sketch, bonds=bonds)) == fingerprint(sketch)


@settings(max_examples=40, deadline=None)
@given(data=st.data(), sketch=sketches())
def test_arrows_of_one_ports(data, sketch):
    ends = {name for name, (kind, _) in sketch.elements.items() if kind in ("R", "C", "I")}
    bonds = tuple(
        (head, tail) if {tail, head} & ends and data.draw(st.booleans()) else (tail, head)
        for tail, head in sketch.bonds
    )
    inner = {name for bond in bonds for name in bond if set(bond) & ends} - ends
    two_ports = {name for name in inner if sketch.elements[name][0] not in JUNCTIONS}
    if two_ports:  # turned round all the same, so the arrow drawn does not count
        turned = tuple((h, t) if t in ends else (t, h) for t, h in bonds)
        assert fingerprint(dataclasses.replace(sketch, bonds=turned)) == fingerprint(sketch)
    assert fingerprint(dataclasses.replace(sketch, bonds=bonds)) == fingerprint(sketch)


@settings(max_examples=40, deadline=None)
@given(data=st.data(), sketch=sketches())
def test_names(data, sketch):
    names = list(sketch.elements)
    shuffled = data.draw(st.permutations(names))
    other = sketch.renamed(dict(zip(names, (f"x{name}" for name in shuffled), strict=True)))
    assert fingerprint(other) == fingerprint(sketch)


@settings(max_examples=60, deadline=None)
@given(data=st.data(), sketch=sketches(aligned=True))
def test_order_of_writing(data, sketch):
    """Other storages may become the dependent ones; the poles stay."""
    bonds = tuple(data.draw(st.permutations(sketch.bonds)))
    elements = dict(data.draw(st.permutations(list(sketch.elements.items()))))
    assert fingerprint(Sketch(elements, bonds)) == fingerprint(sketch)


@settings(max_examples=40, deadline=None)
@given(sketch=sketches(sources=False, aligned=True))
def test_duality(sketch):
    """Efforts and flows exchanged throughout: 0 and 1, C and I; R and n inverted; GY inverted."""
    other = {"0": "1", "1": "0", "C": "I", "I": "C"}
    elements = {
        name: (other.get(kind, kind), 1 / value if kind in ("R", "TF", "GY") else value)
        for name, (kind, value) in sketch.elements.items()
    }
    assert fingerprint(Sketch(elements, sketch.bonds)) == fingerprint(sketch)
