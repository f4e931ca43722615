"""Numbers in laws that are off: told as such, and not named as an effect."""

from __future__ import annotations

import numpy
import pytest
import sympy

from bondgraph import GY, TF, C, I, One, R, Samples, Se, Zero, assemble, derive, simulate
from bondgraph.discrepancy import Measurement, Verdict, discover
from bondgraph.discrepancy.discovery.constants import loosened


def loop(load: float):
    """A filter whose load is a plain number."""
    resistance, inductance = sympy.symbols("Re Le", positive=True)
    volts = sympy.Symbol("volts", real=True)
    ring, node = One("ring"), Zero("node")
    store = C("store", 1e-4)
    return assemble(
        "filter",
        Se("source", volts) >> ring >> (R("wire", resistance), I("coil", inductance)),
        ring >> node >> (store, R("load", load)),
        parameters={resistance: (2, "ohm"), inductance: (10, "mH")},
        inputs={volts: "V"},
        outputs={"i": (ring.f, "A"), "u": (node.e, "V")},
    )


def recorded(load: float, seed: int) -> Measurement:
    rng = numpy.random.default_rng(seed)
    t = numpy.linspace(0, 0.1, 501)
    volts = numpy.interp(t, t[::10], rng.normal(0, 5, 51))
    run = simulate(loop(load), t[-1], inputs={"volts": Samples(t, volts)}, t_eval=t)
    columns = {"volts": volts}
    for name in ("i", "u"):
        columns[name] = run[name] + 0.01 * run[name].std() * rng.normal(size=len(t))
    return Measurement(t, columns, holds={"volts": "linear"}, name=f"run {seed}")


def test_a_number_that_is_off_is_no_missing_effect():
    found = discover(loop(20), recorded(14, 0), recorded(14, 1))
    assert found.verdict is Verdict.NONE
    assert "'load'" in found.words[0] and "0.7" in found.words[0]
    gap = found.gap["validation"]["u"]
    assert gap.after < 1.1 * gap.noise_floor < 0.5 * gap.before


@pytest.mark.parametrize(
    "element",
    [
        R("x", 2),
        R("x", flow=lambda e: 2 * e),
        C("x", stiffness=3),
        I("x", 4),
        TF("x", 0.5),
        GY("x", 0.1),
    ],
    ids=lambda element: type(element).__name__,
)
def test_a_factor_of_one_changes_nothing(element):
    b, m, push = sympy.symbols("b m push", positive=True)
    v = One("v")
    rest = (I("mass", m), R("film", b))
    if isinstance(element, TF | GY):
        bonds = (v >> element >> One("other") >> (R("far", b), I("end", m)),)
    else:
        bonds = (v >> element,)
    graph = assemble(
        "g", Se("motor", push) >> v >> rest, *bonds, parameters={b: 1, m: 2}, inputs=[push]
    )
    ((label, name, loose),) = loosened(graph)
    assert label == "x"
    factor = next(symbol for symbol in loose.parameters if symbol.name == name)
    before, after = derive(graph).explicit(), derive(loose).explicit()
    for one, other in zip(before.values(), after.values(), strict=True):
        names = {s: sympy.Symbol(s.name) for s in (one.free_symbols | other.free_symbols)}
        same = other.subs(factor, 1).xreplace(names) - one.xreplace(names)
        assert sympy.simplify(same) == 0
        assert factor in sympy.Tuple(*after.values()).free_symbols


def test_laws_with_parameters_are_left_alone():
    graph = loop(20)
    assert {element for element, _, _ in loosened(graph)} == {"store", "load"}
