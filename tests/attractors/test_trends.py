"""Trends of the own start: the paper's, and those of oscillators whose amplitude is known."""

import math

import pytest
import sympy

from bondgraph import C, I, One, R, assemble, models
from bondgraph.attractors import motions, trends
from bondgraph.errors import BondGraphError, ParameterError

SLIDING = {"mu_s": 0.42, "tau": 0.03}  # the paper's Fig. 6: no stick


def of(graph, parameters=None, **options):
    found, notes = trends(graph, parameters, **options)
    assert not notes
    return {item.parameter: item for item in found}


def test_what_the_paper_says_furthers_vibration():
    found = of(models.bicycle_brake.graph(), SLIDING)
    more = ("mu_s", "v_s", "F_k")
    less = ("mu_k", "tau", "V0", "k_f", "k_w", "zeta_f", "zeta_w")
    assert {found[name].furthers for name in more} == {1}
    assert {found[name].furthers for name in less} == {-1}
    # what does not enter the brake's motion
    assert {found[name].furthers for name in ("r_t", "J_t", "C_h", "A_p")} == {0}
    here = found["tau"].here
    assert here.outcome == "steady" and here.margins["friction"] == pytest.approx(0.2023, abs=1e-3)
    assert found["tau"].lower.margins["friction"] < here.margins["friction"]


def test_an_outcome_that_changes_counts_first():
    """At tau = .027 a tenth less squeals, a tenth more does not."""
    item = of(models.bicycle_brake.graph(), {"mu_s": 0.5, "tau": 0.027}, names=["tau"])["tau"]
    assert (item.lower.outcome, item.upper.outcome) == ("cycle", "steady")
    assert item.furthers == -1 and item.to_json()["lower"]["outcome"] == "cycle"


def test_swings_count_where_it_vibrates_anyway():
    """Van der Pol's e = a (f^3/3 - f / b): amplitude 2 / sqrt(b) for small a."""
    a, b, m = sympy.symbols("a b m", positive=True)
    law = R("r", effort=lambda f: a * (f**3 / 3 - f / b))
    spring = C("c", 1, initial=0.5)
    graph = assemble(
        "vdp",
        One("loop") >> (I("L", m), spring, law),
        parameters={a: 0.2, b: 1.0, m: 1.0},
        outputs={"x": spring.q},
    )
    found = of(graph, names=["b"])["b"]
    assert found.furthers == -1
    for point, value in ((found.lower, 0.9), (found.upper, 1.1)):
        swing = point.amplitudes["x"].peak_to_peak
        assert swing == pytest.approx(4 / math.sqrt(value), rel=0.02)


def test_names_and_shares_are_checked():
    graph = models.bicycle_brake.graph()
    with pytest.raises(ParameterError, match="not known"):
        trends(graph, names=["tauu"])
    with pytest.raises(BondGraphError, match="between 0 and 1"):
        trends(graph, change=1.5)


def test_what_is_left_undone_is_told():
    found, notes = trends(models.bicycle_brake.graph(), budget=0.0)
    assert found == () and "raise budget" in notes[0]


def test_motions_gather_all_of_it():
    found = motions(models.bicycle_brake.graph(), SLIDING, vary=["tau=0.01:0.05:40"])
    assert found.attractors.own.kind == "steady" and len(found.reaches[0].points) == 13
    assert found.trends and set(found.to_json()) == {"attractors", "reach", "trends"}
