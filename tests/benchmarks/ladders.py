"""Ladders: derivation of growing graphs, from elements to CasADi functions.

``python -m tests.benchmarks.ladders rc 1000`` derives one ladder in a fresh process and prints the
CPU seconds it took, without imports.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator

import casadi

from bondgraph import C, I, One, R, Se, Zero, assemble, assign_causality, derive
from bondgraph.bonds import Chain
from bondgraph.codegen import Program
from bondgraph.codegen.to_casadi import to_casadi


def rc(storages: int, resistance: float = 2, capacitance: float = 3) -> Iterator[Chain]:
    """An RC ladder driven by a voltage and open at its end: one storage a cell."""
    before: Se | Zero = Se("source", 1)
    for cell in range(storages):
        loop, node = One(f"loop{cell}"), Zero(f"node{cell}")
        yield before >> loop >> (R(f"r{cell}", resistance), node >> C(f"c{cell}", capacitance))
        before = node


def rlc(
    storages: int, resistance: float = 2, inertance: float = 5, capacitance: float = 3
) -> Iterator[Chain]:
    """An RLC ladder driven by a voltage and open at its end: two storages a cell."""
    before: Se | Zero = Se("source", 1)
    for cell in range(storages // 2):
        loop, node = One(f"loop{cell}"), Zero(f"node{cell}")
        series = R(f"r{cell}", resistance), I(f"l{cell}", inertance)
        yield before >> loop >> (*series, node >> C(f"c{cell}", capacitance))
        before = node


LADDERS: dict[str, Callable[[int], Iterator[Chain]]] = {"rc": rc, "rlc": rlc}


def functions(ladder: Iterator[Chain]) -> tuple[casadi.Function, casadi.Function]:
    """Derive a ladder: its rates, and their sparse Jacobian, as CasADi functions of the state."""
    graph = assemble("ladder", ladder)
    equations = derive(assign_causality(graph))
    program = Program.pruned(
        "rates",
        [("x", equations.states)],
        equations.assignments,
        {"rates": equations.derivatives},
    )
    rates = to_casadi(program)
    x = casadi.SX.sym("x", len(equations.states))
    return rates, casadi.Function("jacobian", [x], [casadi.jacobian(rates(x), x)])


def main() -> None:
    """Derive the ladder named on the command line and print how long it took."""
    kind, storages = sys.argv[1], int(sys.argv[2])
    start = time.process_time()
    rates, _ = functions(LADDERS[kind](storages))
    seconds = time.process_time() - start
    print(json.dumps({"seconds": seconds, "states": rates.size1_in(0)}))


if __name__ == "__main__":
    main()
