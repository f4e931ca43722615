"""A ladder in bondgraph 0.2.0 of PyPI; run by its own Python: ``bondgraph_0_2_0.py rc 10``."""

import json
import sys
import time

from sympy import Integer, Symbol

from bondgraph.core import Bond, BondGraph
from bondgraph.elements import Element_C, Element_I, Element_R, Source_effort
from bondgraph.junctions import JunctionEqualEffort, JunctionEqualFlow


def state_equations(kind: str, storages: int) -> dict:
    """Build the ladder and return the rate of each state."""
    graph = BondGraph()
    before = Source_effort("source", Integer(1))
    for cell in range(storages if kind == "rc" else storages // 2):
        loop, node = JunctionEqualFlow(f"loop{cell}"), JunctionEqualEffort(f"node{cell}")
        graph.add(Bond(before, loop))
        graph.add(Bond(loop, Element_R(f"r{cell}", Integer(2))))
        if kind == "rlc":
            graph.add(Bond(loop, Element_I(f"l{cell}", Integer(5), Symbol(f"p{cell}"))))
        graph.add(Bond(loop, node))
        graph.add(Bond(node, Element_C(f"c{cell}", Integer(3), Symbol(f"q{cell}"))))
        before = node
    return graph.get_state_equations()


if __name__ == "__main__":
    start = time.process_time()
    found = state_equations(sys.argv[1], int(sys.argv[2]))
    print(json.dumps({"seconds": time.process_time() - start, "states": len(found)}))
