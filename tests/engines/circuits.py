"""Circuits, each written twice: as a netlist for ngspice and as a bond graph."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from bondgraph import TIME, C, I, One, R, Se, Zero, assemble
from bondgraph.graph import BondGraph

from .ngspice import THERMAL_VOLTAGE

SATURATION = 1e-12  # A
DIODE = f".model DD D(IS={SATURATION} N=1)"


@dataclass(frozen=True)
class Circuit:
    """One circuit in both languages.

    Attributes
    ----------
    graph : BondGraph
    netlist : str
    same : mapping of str to str
        Vectors of ngspice to the graph's names of the same quantity.
    until, step : float
        End of the run and ngspice's longest step, s.
    """

    graph: BondGraph
    netlist: str
    same: dict[str, str]
    until: float
    step: float


def diode(name: str) -> R:
    """Shockley's law, current given by voltage."""
    return R(name, flow=lambda e: SATURATION * (sympy.exp(e / THERMAL_VOLTAGE) - 1))


def series_rlc() -> Circuit:
    """A step of 5 V on R, L and C in series, at rest."""
    return Circuit(
        graph=assemble(
            "series_rlc", Se("s", 5) >> One("i") >> (R("r", 10), I("l", 1e-3), C("c", 1e-6))
        ),
        netlist="V1 in 0 DC 5\nR1 in a 10\nL1 a out 1m IC=0\nC1 out 0 1u IC=0",
        same={"v(out)": "c.e", "i(L1)": "l.f"},
        until=1e-3,
        step=1e-7,
    )


def parallel_rlc() -> Circuit:
    """R, L and C side by side, let go with a charge and a current."""
    node = Zero("u")
    return Circuit(
        graph=assemble(
            "parallel_rlc", node >> (R("r", 1), C("c", 1, initial=1), I("l", 1, initial=1))
        ),
        netlist="R1 u 0 1\nC1 u 0 1 IC=1\nL1 u 0 1 IC=1",
        same={"v(u)": "u.e", "i(L1)": "l.f"},
        until=10,
        step=2e-3,
    )


def half_wave() -> Circuit:
    """A diode behind 10 ohm that charges a capacitor under load, with a snubber across it."""
    loop, across, out = One("loop"), Zero("across"), Zero("out")
    return Circuit(
        graph=assemble(
            "half_wave",
            Se("s", 10 * sympy.sin(100 * sympy.pi * TIME)) >> loop >> (R("rs", 10), across, out),
            across >> (C("snubber", 1e-6), diode("d")),
            out >> (C("smoothing", 100e-6), R("load", 1000)),
        ),
        netlist=(
            f"V1 in 0 SIN(0 10 50)\nRS in a 10\nD1 a out DD\nCS a out 1u IC=0\n"
            f"CL out 0 100u IC=0\nRL out 0 1k\n{DIODE}"
        ),
        same={"v(out)": "out.e", "v(a,out)": "d.e"},
        until=0.04,
        step=4e-6,
    )


def half_wave_bare() -> Circuit:
    """The same without the snubber: the diode's effort stays algebraic."""
    loop, out = One("loop"), Zero("out")
    return Circuit(
        graph=assemble(
            "half_wave_bare",
            Se("s", 10 * sympy.sin(100 * sympy.pi * TIME))
            >> loop
            >> (R("rs", 10), diode("d"), out),
            out >> (C("smoothing", 100e-6), R("load", 1000)),
        ),
        netlist=(
            f"V1 in 0 SIN(0 10 50)\nRS in a 10\nD1 a out DD\n"
            f"CL out 0 100u IC=0\nRL out 0 1k\n{DIODE}"
        ),
        same={"v(out)": "out.e"},
        until=0.04,
        step=4e-6,
    )


def bridge() -> Circuit:
    """Four diodes in a bridge, fed through 10 ohm; each terminal has a capacitance to ground."""
    mains, a, b, out = One("mains"), Zero("a"), Zero("b"), Zero("out")
    source = Se("s", 10 * sympy.sin(100 * sympy.pi * TIME))
    to_a, to_b = One("to_a"), One("to_b")
    forward = [node >> One(f"from_{node.name}") for node in (a, b)]
    return Circuit(
        graph=assemble(
            "bridge",
            source >> mains >> (R("rs", 10), a),
            b >> mains,  # what flows into a leaves b
            *(chain >> (diode(f"up_{k}"), out) for k, chain in enumerate(forward)),
            to_a >> (diode("down_a"), a),
            to_b >> (diode("down_b"), b),
            a >> C("ca", 1e-6),
            b >> C("cb", 1e-6),
            out >> (C("smoothing", 100e-6), R("load", 1000)),
        ),
        netlist=(
            "V1 in b SIN(0 10 50)\nRS in a 10\nD1 a out DD\nD2 b out DD\nD3 0 a DD\nD4 0 b DD\n"
            f"CA a 0 1u IC=0\nCB b 0 1u IC=0\nCL out 0 100u IC=0\nRL out 0 1k\n{DIODE}"
        ),
        same={"v(out)": "out.e", "v(a)": "a.e", "v(b)": "b.e"},
        until=0.04,
        step=4e-6,
    )


CIRCUITS = {
    make.__name__: make for make in (series_rlc, parallel_rlc, half_wave, half_wave_bare, bridge)
}
