"""Graphs written without care: each derives, or is refused by an error that names elements.

Never by another exception, an internal error or a wait.
"""

import random
from collections import Counter

import pytest

from bondgraph import assemble, derive
from bondgraph.errors import BondGraphError

from .careless import INPUT, parts
from .draws import Menu, draw
from .plans import Plan
from .tally import base_seed, watchdog

BATCH, BATCHES, SPOILT = 300, 3, 300
KINDS = {"GraphError", "CausalConflictError", "SingularLoopError", "AlgebraicLoopError", "LawError"}


def outcome(make) -> str:
    """Derive; return what came of it."""
    with watchdog():
        try:
            derive(make())
        except BondGraphError as error:
            assert "internal" not in str(error)
            assert type(error).__name__ in KINDS
            assert error.elements, f"no element is named: {error}"
            assert len(str(error)) < 1000
            return type(error).__name__
    return "derived"


def count(name, size, make) -> Counter:
    """Count the outcomes of graphs that a seeded generator makes."""
    base, found = base_seed(), Counter()
    for index in range(size):
        seed = f"{name}-{base}-{index}"
        rng = random.Random(seed)
        try:
            found[outcome(lambda rng=rng: make(rng))] += 1
        except Exception as error:
            raise AssertionError(f"random graph {seed!r}: {error!r}") from error
    print(f"{name} (seed {base}): {dict(found)}")
    assert found.total() == size
    return found


@pytest.mark.parametrize("batch", range(BATCHES))
def test_careless_graphs(batch):
    found = count(
        f"careless {batch}", BATCH, lambda rng: assemble("g", *parts(rng), inputs=[INPUT])
    )
    assert found["derived"] >= 0.1 * BATCH
    assert found["GraphError"] >= 0.2 * BATCH
    assert found["CausalConflictError"] >= 0.1 * BATCH


def spoilt(rng: random.Random):
    """A sound plan with one thing wrong: a bond lost, doubled or moved, or a part of another kind."""
    plan = draw(rng, Menu(fields=1, sensors=1, switches=1, blocks=1, signals=1))
    bonds, parts = list(plan.bonds), dict(plan.parts)
    place = rng.randrange(len(bonds))
    what = rng.choice(("lose", "double", "move", "loop", "kind", "lose", "move"))
    tail, head = bonds[place]
    if what == "lose":
        del bonds[place]
    elif what == "double":
        bonds.append((tail, head))
    elif what == "move":
        bonds[place] = (tail, rng.choice([end for bond in bonds for end in bond]))
    elif what == "loop":
        bonds[place] = (tail, tail)
    else:
        heard = {part.heard.partition(".")[0] for part in parts.values()}
        first, second = rng.sample(list(parts), 2)
        if first not in heard and not (parts[first].ports or parts[second].ports):
            parts[first] = parts[second]
    return Plan(parts, tuple(bonds)).graph()


def test_spoilt_graphs():
    found = count("spoilt", SPOILT, spoilt)
    assert found["GraphError"] >= 0.3 * SPOILT
    assert found["derived"] >= 0.05 * SPOILT
