"""Random bond graphs against a pencil of raw equations, assembled without causality.

The pencil has every effort, flow and state as an unknown. It is compared with the derived
equations exactly, modulo a prime: characteristic polynomials at random points, and the Laplace
transforms of every port variable for random inputs and initial states. A numeric comparison
through scipy's generalized eigenvalues stands beside it.
"""

import random

import numpy
import pytest
import scipy.linalg
import scipy.optimize
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from bondgraph import Equations, derive, linearize
from bondgraph.errors import AlgebraicLoopError, BondGraphError, CausalConflictError

from ..sketches import PRIME, Derived, Fraction, Raw, Sketch, residue
from ..strategies import sketches

SEEDS = st.integers(0, 2**31)
BIG = settings(
    deadline=None,
    suppress_health_check=[
        HealthCheck.too_slow,
        HealthCheck.filter_too_much,
        HealthCheck.data_too_large,
    ],
)


def check(sketch: Sketch, seed: int, symbolic: bool = False) -> None:
    """Derive and compare everything; or be told why not, and check that it is so."""
    try:
        equations = derive(sketch.graph(symbolic))
    except (CausalConflictError, AlgebraicLoopError) as error:
        assert error.elements
        point = random.Random(seed).randrange(1, PRIME)
        assert Raw(sketch).determinant(point) == 0, "refused, though there is a solution"
    else:
        compare(equations, sketch, seed)


def compare(equations: Equations, sketch: Sketch, seed: int) -> None:
    """Compare derived equations with the raw ones: poles, and responses of every variable."""
    rng = random.Random(seed)
    first, second = (rng.randrange(1, PRIME) for _ in range(2))
    raw = Raw(sketch)
    derived = Derived(equations, sketch.residues)
    # one polynomial is a constant times the other: the same finite eigenvalues
    at_first, at_second = raw.determinant(first), raw.determinant(second)
    assert at_first != 0, "derived, though the raw equations have no unique solution"
    assert (
        at_first * derived.determinant(second) % PRIME
        == at_second * derived.determinant(first) % PRIME
    )
    inputs = {name: rng.randrange(PRIME) for name in raw.sources}
    start = {state.name: rng.randrange(PRIME) for state in equations.states}
    begin = {name.rpartition(".")[0]: value for name, value in start.items()}
    found = derived.solve(first, {f"u_{name}": value for name, value in inputs.items()}, start)
    assert found == raw.solve(first, inputs, begin | derived.dependent(start))


@settings(BIG, max_examples=150)
@given(sketches(), SEEDS)
def test_numbers_as_parameters(sketch, seed):
    check(sketch, seed)


@settings(BIG, max_examples=50)
@given(sketches(), SEEDS)
def test_symbols_as_parameters(sketch, seed):
    """Any values must do, so the comparison takes random ones."""
    rng = random.Random(seed)
    values = {
        name: Fraction(rng.randrange(1, 10**9))
        for name, (_, value) in sketch.elements.items()
        if value is not None
    }
    check(sketch.valued(values), seed, symbolic=True)


@settings(BIG, max_examples=15)
@given(sketches(junctions=14, loops=6, ones=2, chain=1, sources=False), SEEDS)
def test_large_meshes(sketch, seed):
    check(sketch, seed)


@settings(BIG, max_examples=100)
@given(sketches(signals=True), SEEDS)
def test_sources_that_follow_other_variables(sketch, seed):
    """Signals carry no power: what they close may be refused by name, never answered wrongly."""
    try:
        equations = derive(sketch.graph())
    except BondGraphError as error:
        assert str(error)
    else:
        compare(equations, sketch, seed)


@pytest.mark.slow
@settings(BIG, max_examples=1000)
@given(sketches(signals=True), SEEDS)
def test_a_thousand_with_signals(sketch, seed):
    try:
        equations = derive(sketch.graph())
    except BondGraphError:
        return
    compare(equations, sketch, seed)


@pytest.mark.slow
@settings(BIG, max_examples=1000)
@given(sketches(), SEEDS)
def test_a_thousand(sketch, seed):
    check(sketch, seed)


@pytest.mark.slow
@settings(BIG, max_examples=200)
@given(sketches(junctions=14, loops=7, ones=3, chain=1), SEEDS)
def test_hundreds_of_large_meshes(sketch, seed):
    check(sketch, seed)


@settings(BIG, max_examples=50)
@given(sketches(junctions=4, loops=1))
def test_finite_eigenvalues_by_scipy(sketch):
    try:
        graph = sketch.graph()
        count = len(derive(graph).states)
    except BondGraphError:
        assume(False)
    assume(count)
    inputs = [symbol.name for symbol in graph.inputs]
    found = linearize(graph, at={}, inputs=dict.fromkeys(inputs, 0.0)).poles()
    e, a = Raw(sketch).floats()
    values, left, right = scipy.linalg.eig(a, e, left=True, right=True)
    nearest = numpy.argsort(numpy.where(numpy.isfinite(values), numpy.abs(values), numpy.inf))[
        :count
    ]
    values, left, right = values[nearest], left[:, nearest], right[:, nearest]
    slope = numpy.abs(numpy.einsum("ik,ij,jk->k", left.conj(), e, right))
    size = numpy.linalg.norm(a) + numpy.abs(values) * numpy.linalg.norm(e)
    # what rounding may do to each eigenvalue; equal ones in one chain are left to the exact test
    blur = 1e-14 * size / numpy.maximum(slope, 1e-300)
    assume((blur < 1e-8).all())
    distance = numpy.abs(found[:, None] - values[None, :])
    rows, columns = scipy.optimize.linear_sum_assignment(distance)
    assert (distance[rows, columns] <= 1e-8 * (1 + numpy.abs(values[columns]))).all()


def sketch_of(elements: str, bonds: str) -> Sketch:
    """Write a sketch in short: ``C4=2/3`` or ``0a``; ``a>b``."""
    found = {}
    for word in elements.split():
        name, _, value = word.partition("=")
        kind = name[0] if name[0] in "01" else name.rstrip("123456789")
        found[name] = (kind, Fraction(value) if value else None)
    return Sketch(found, tuple(tuple(bond.split(">")) for bond in bonds.split()))


# Graphs that were once refused, answered wrongly or took for ever: strokes alone do not show
# which storages depend on each other where terms cancel round a loop of junctions.
ONCE_WRONG = {
    "two bonds that cancel": sketch_of(
        "0a 1b 0c I1=3 Sf1 I2=1 R1=2", "1b>0a 0c>1b 0a>1b 0a>I1 0a>Sf1 0a>I2 0c>R1"
    ),
    "a gyrator that cancels": sketch_of(
        "1a 1b 0c GY1=3 C1=1 C2=1", "1a>GY1 GY1>1b 1a>0c 1a>1b 0c>1b 1b>C1 0c>C2"
    ),
    "the wrong one of two": sketch_of(
        "0a 1b 1c 0d TF1=1/2 TF2=2/3 C1=1/2 TF3=-2 R1=7/5 I1=2/3",
        "TF1>0a TF2>TF1 TF2>1b 0a>1c 0d>1b 1c>0a TF3>1c TF3>C1 0d>R1 0d>I1",
    ),
    "a choice to take back": sketch_of(
        "1a 1b 0c TF1=-5/3 GY1=7/5 C1=1", "TF1>1a 1b>TF1 0c>1a GY1>1b 0c>GY1 1a>C1"
    ),
    "many to choose from": sketch_of(
        "1a 1b 0c 0d 1e 0f 0g 0h GY1=5/3 GY2=2/3 GY3=2/3 C1=1 R1=1 R2=1 I1=3 I2=1/2 C2=1/2 I3=2/3 "
        "TF1=7/5 C3=2/3 TF2=1/2 R3=5/3 TF3=1 C4=2/3 R4=1 GY4=-5/4 C5=1 C6=1",
        "1b>1a 1a>0c 0d>0c 1e>0c 0f>1b 0c>GY1 GY1>0g GY2>1a GY2>0h 0d>GY3 0g>GY3 0h>0c 1a>1e 0c>0h "
        "1a>C1 0d>R1 R2>1e I1>1e I2>1e C2>0f TF1>0f TF1>I3 0g>TF2 TF2>C3 0g>TF3 R3>TF3 C4>0g GY4>0h "
        "R4>GY4 C5>0h 0h>C6",
    ),
}


@pytest.mark.parametrize("name", ONCE_WRONG)
@pytest.mark.parametrize("symbolic", [False, True])
def test_once_wrong(name, symbolic):
    check(ONCE_WRONG[name], 1, symbolic)


class TestThePencil:
    """The reference itself, on graphs solved by hand."""

    def rc(self):
        elements = {
            "s": ("Se", None),
            "v": ("1", None),
            "r": ("R", Fraction(2)),
            "c": ("C", Fraction(3)),
        }
        return Sketch(elements, (("s", "v"), ("v", "r"), ("c", "v")))

    def test_characteristic_polynomial(self):
        """s + 1/(rc), up to a factor."""
        raw = Raw(self.rc())
        s, z = 1234567, 7654321
        pole = residue(Fraction(1, 6))
        left = raw.determinant(s) * (z + pole) % PRIME
        assert left == raw.determinant(z) * (s + pole) % PRIME

    def test_transforms(self):
        s = 1000
        found = Raw(self.rc()).solve(s, {"s": 5}, {"c": 7})
        # q = (7 + 5/2) / (s + 1/6), with r = 2, c = 3
        q = Fraction(19, 2) / (s + Fraction(1, 6))
        assert found["c.q"] == residue(q)
        assert found["c.e"] == residue(q / 3)
        assert found["r.e"] == residue(5 - q / 3)
        assert found["v.f"] == found["r.f"] == found["c.f"] == residue((5 - q / 3) / 2)

    def test_wrong_equations_are_noticed(self):
        sketch = self.rc()
        other = sketch.valued({"c": Fraction(4)})
        equations = derive(other.graph())
        raw, derived = Raw(sketch), Derived(equations)
        s, z = 99, 101
        left = raw.determinant(s) * derived.determinant(z) % PRIME
        assert left != raw.determinant(z) * derived.determinant(s) % PRIME

    def test_singular_pencils_have_no_determinant(self):
        elements = {"s": ("Sf", None), "z": ("Sf", None), "v": ("1", None)}
        assert Raw(Sketch(elements, (("s", "v"), ("z", "v")))).determinant(77) == 0


@settings(BIG, max_examples=60)
@given(sketches(junctions=8, loops=4))
def test_derivation_of_any_graph_is_quick_or_named(sketch):
    """No other exception, whatever is drawn."""
    try:
        derive(sketch.graph())
    except BondGraphError as error:
        assert str(error)
        assert len(str(error)) < 600
