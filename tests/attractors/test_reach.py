"""What the own start of the brake ends in along parameters, against the brake on plain scipy."""

import json

import numpy
import pytest
import sympy

from bondgraph import BondGraphError, C, CompiledModel, I, One, R, Sf, Zero, assemble, reach
from bondgraph.models import bicycle_brake, quarter_car
from bondgraph.stability import Vary

from ..cycles.graphs import VAN_DER_POL_PERIOD
from . import brakes


@pytest.fixture(scope="module")
def brake():
    return CompiledModel(bicycle_brake.graph())


@pytest.fixture(scope="module")
def by_tau(brake):
    return reach(brake, ("tau", 0.01, 0.05, 9), {"mu_s": 0.5})


def squeals(**given):
    p = brakes.brake(**given)
    return brakes.frequency(p, brakes.own(p))


def test_fast_application_squeals_slow_does_not(by_tau):
    assert by_tau.outcomes[0] == "cycle" and by_tau.outcomes[-1] == "steady"
    last = by_tau.changes[-1]
    assert (last.before.outcome, last.after.outcome) == ("cycle", "steady")
    # the steady state is stable all along: no eigenvalue tells of it
    assert all(point.stable for point in by_tau.points)
    assert squeals(tau=last.low) is not None and squeals(tau=last.high) is None
    assert last.high - last.low <= 1e-3 * last.high


def test_points_are_those_of_scipy(by_tau):
    for point in by_tau.points[::2]:
        expected = squeals(tau=point.value)
        assert (point.outcome == "cycle") is (expected is not None)
        if expected is not None:
            assert point.frequency_hz == pytest.approx(expected, rel=1e-5)


def test_jump_from_cycle_to_cycle(by_tau):
    first = by_tau.changes[0]
    assert (first.before.outcome, first.after.outcome) == ("cycle", "cycle")
    low, high = squeals(tau=first.low), squeals(tau=first.high)
    assert (first.before.frequency_hz, first.after.frequency_hz) == pytest.approx(
        (low, high), rel=1e-5
    )
    assert high / low > 1.3


def test_larger_force_and_friction_squeal(brake):
    force = reach(brake, Vary("F_k", 600, 1300, 5), {"mu_s": 0.42, "tau": 0.02})
    assert force.outcomes[0] == "steady" and force.outcomes[-1] == "cycle"
    change = force.changes[0]
    given = {"mu_s": 0.42, "tau": 0.02}
    assert squeals(**given, F_k=change.low) is None
    assert squeals(**given, F_k=change.high) is not None
    static = reach(brake, "mu_s=0.41:0.5:4", {"tau": 0.02})
    assert static.outcomes[0] == "steady" and static.outcomes[-1] == "cycle"
    # within one cycle the frequency falls bit by bit, which is no change
    assert len(static.changes) == 1


def test_margin_shrinks_to_the_first_stick(brake):
    found = reach(brake, ("tau", 0.01, 0.05, 9), {"mu_s": 0.42})
    assert set(found.outcomes) == {"steady"} and not found.changes
    margins = numpy.array([point.margins["friction"] for point in found.points])
    counts = numpy.array([point.entered["friction"] for point in found.points])
    assert ((margins == 0) == (counts > 0)).all()
    assert (numpy.diff(margins) >= 0).all() and margins[-1] > 0.4
    p = brakes.brake(mu_s=0.42, tau=0.02)
    once = next(point for point in found.points if point.value == pytest.approx(0.02))
    assert once.entered["friction"] == len(brakes.sticks(p, brakes.own(p), 0.3)) == 1


def test_in_own_units(brake):
    given = {"mu_s": 0.5, "tau": 0.02}
    plain = reach(brake, ("k_f", 300e3, 400e3, 2), given)
    other = reach(brake, ("k_f", 300, 400, 2, "N/mm"), given)
    assert plain.values.tolist() == other.values.tolist() and other.unit == "N/mm"


def test_words_and_json(by_tau):
    assert "stick-slip cycle" in by_tau.words and "in the steady state above" in by_tau.words
    told = json.loads(json.dumps(by_tau.to_json(), allow_nan=False))
    assert len(told["points"]) == 9 and told["changes"][-1]["after"]["outcome"] == "steady"
    assert told["units"]["x_c"] == "m"


def test_models_without_contacts():
    assert set(reach(quarter_car.graph(), ("b_s", 800, 1600, 3)).outcomes) == {"steady"}


def test_along_an_input():
    # a motor on a law that falls and rises: where the speed stands on the falling part it swings
    push = sympy.Symbol("push")
    law = R("r", effort=lambda f: (f - 1.5) ** 3 - (f - 1.5))
    parts = (I("m", 1), law)
    flow, shaft = Zero("flow"), One("shaft")
    graph = assemble(
        "motor",
        Sf("pump", push) >> flow >> (C("air", 1), shaft),
        shaft >> parts,
        inputs={push: "m^3/s"},
    )
    found = reach(graph, ("push", 0.5, 1.5, 3), sharp=1e-3)
    assert found.outcomes == ("steady", "cycle", "cycle") and found.unit == "m^3/s"
    # the slope of the law is zero, and the linear verdict changes, at 1.5 - 1/sqrt(3)
    assert found.changes[0].value == pytest.approx(1.5 - 3**-0.5, rel=5e-3)


def test_from_another_start(brake):
    given = {"mu_s": 0.42, "tau": 0.03}
    own = reach(brake, ("V0", 0.8, 0.9, 2), given)
    pulled = reach(brake, ("V0", 0.8, 0.9, 2), given, initial={"V_c": 3.0})
    assert own.outcomes != pulled.outcomes or own.points[0].margins != pulled.points[0].margins


def test_a_point_that_cannot_run_is_named(brake):
    found = reach(brake, ("k_f", -350e3, 350e3, 2), {"tau": 0.02})
    assert found.outcomes == ("refused", "cycle")
    assert "must be positive" in found.points[0].note and "must be positive" in found.notes[0]
    with pytest.raises(BondGraphError, match="must be positive"):
        reach(brake, ("k_f", -350e3, -300e3, 2))


def test_refusals(brake):
    with pytest.raises(BondGraphError, match="mu_z"):
        reach(brake, ("mu_z", 0, 1, 3))
    with pytest.raises(BondGraphError, match="sharp"):
        reach(brake, ("mu_s", 0.4, 0.5, 3), sharp=0)


def test_budget_is_said(brake):
    found = reach(brake, ("tau", 0.01, 0.05, 9), {"mu_s": 0.5}, budget=1e-9)
    assert "raise budget" in found.notes[0]


def test_own_start_on_an_unstable_steady_state_is_pushed():
    mu = sympy.Symbol("mu", positive=True)
    law = R("r", effort=lambda f: mu * (f**3 / 3 - f))
    graph = assemble("vdp", One("loop") >> (I("L", 1), C("c", 1), law), parameters={mu: 1.0})
    found = reach(graph, ("mu", 0.5, 1.0, 2))
    assert found.outcomes == ("cycle", "cycle") and not found.changes
    assert found.points[1].frequency_hz == pytest.approx(1 / VAN_DER_POL_PERIOD, rel=1e-6)
