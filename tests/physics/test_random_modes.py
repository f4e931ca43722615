"""Random graphs with switching elements, in every mode that can be derived.

Each mode's equations satisfy the raw equations in which each switching element says what it
says in that mode, on the state vector of the whole graph; a mode that cannot be is named.
"""

import itertools
import random
from fractions import Fraction
from functools import partial

import mpmath
import pytest

from bondgraph import derive, in_mode
from bondgraph.errors import BondGraphError
from bondgraph.modes import mode_equations

from .checks import EXACT, UnsolvedError, follows_raw, refused_rightly, traits
from .draws import Menu
from .plans import CONTACTS, SWITCHES, Part, Plan
from .points import DIGITS
from .tally import campaign

BATCH, BATCHES = 50, 4
SWITCHED = Menu(junctions=4, loops=1, ones=2, chain=1, sensors=1, switches=3, curved=0.2)


def check(plan: Plan, seed: int) -> list[str]:
    """Go through all modes, by both ways there are to one."""
    graph, names = plan.graph(), plan.of(*SWITCHES)
    found = ["switched"] if names else []
    try:
        base = derive(graph)
    except BondGraphError as error:
        assert error.elements
        base = None
        found.append("refused")
    rng = random.Random(seed)
    subsets = [itertools.combinations(names, size) for size in range(len(names) + 1)]
    for held in itertools.chain.from_iterable(subsets):
        codes = {name: 0 if name in held else slipping(plan, name, rng) for name in names}
        labels = {name: graph[name].label(code) for name, code in codes.items()}
        alone = partial(of_itself, graph, labels)
        found += by_any_way(plan, seed, codes, alone)
        if base is not None:
            found += by_any_way(plan, seed, codes, partial(of_whole, base, held))
    return found


def slipping(plan: Plan, name: str, rng: random.Random) -> int:
    """Draw a mode in which the flow is not held."""
    return rng.choice((1, -1)) if plan.parts[name].kind in CONTACTS else 1


def of_itself(graph, labels):
    """Derive the graph of a mode like any other graph."""
    return derive(in_mode(graph, labels)), None


def of_whole(base, held):
    """Derive a mode on the states of the whole graph."""
    mode = mode_equations(base, held)
    return mode.equations, mode


def by_any_way(plan: Plan, seed: int, codes, derived) -> list[str]:
    """Derive one mode, and compare it with the raw equations of that mode."""
    try:
        equations, mode = derived()
    except BondGraphError as error:
        assert error.elements
        regular = [] if refused_rightly(plan, seed, codes) else ["refused, regular"]
        return ["mode refused", *regular]
    given = {contact.direction: mpmath.mpf(codes[contact.name]) for contact in equations.contacts}
    if mode is not None:
        given |= {s: mpmath.mpf(codes[name]) for name, s in mode.directions.items()}
    given |= {s: mpmath.mpf(0) for s in equations.inputs if ".imposed" in s.name}
    try:
        point = follows_raw(plan, equations, seed, codes, given, steps=1)
    except UnsolvedError:
        return ["mode unsolved"]
    if mode is not None:
        states_are_whole(plan, point, mode)
        return ["mode compared", "whole", *(["bound"] if mode.bound else [])]
    return ["mode compared", *(f"mode {trait}" for trait in traits(equations))]


def states_are_whole(plan: Plan, point, mode) -> None:
    """The rate of each state of the whole graph, bound or not, is that of its motion."""
    with mpmath.workdps(DIGITS):
        moving = point.change(*mode.states)
        for state, rate, change in zip(mode.states, mode.derivatives, moving, strict=True):
            assert abs(point.value(rate) - change) <= EXACT * (1 + abs(change)) ** 2, state
    assert set(mode.bound) <= set(point.known) - set(point.rates)


@pytest.mark.parametrize("batch", range(BATCHES))
def test_random_graphs(batch):
    tally = campaign(f"switched {batch}", SWITCHED, BATCH, check)
    assert tally["graphs"] == BATCH
    assert tally["switched"] >= 0.6 * BATCH
    assert tally["refused"] <= 0.45 * BATCH
    assert tally["mode compared"] >= 2 * BATCH
    assert tally["whole"] >= 0.8 * BATCH
    assert tally["bound"] >= 0.1 * BATCH
    assert tally["mode unsolved"] <= 0.2 * tally["mode compared"]
    # a slipping clutch that bears on a C alone: friction is not asked for its flow
    assert tally["refused, regular"] <= 0.2 * tally["mode refused"]


def test_the_constraint_of_a_mode_is_noticed():
    """Equations of one mode are not those of another."""
    one = Fraction(1)
    plan = Plan(
        {"v": Part("1"), "d": Part("Diode", numbers=(one, one)), "c": Part("C", numbers=(one,)),
         "i": Part("I", numbers=(one,)), "r": Part("R", numbers=(one,))},
        tuple(("v", name) for name in "dcir"),
    )  # fmt: skip
    equations = derive(in_mode(plan.graph(), {"d": "conducting"}))
    follows_raw(plan, equations, 1, {"d": 1})
    with pytest.raises(AssertionError, match="d: the raw equation is missed"):
        follows_raw(plan, equations, 1, {"d": 0})
