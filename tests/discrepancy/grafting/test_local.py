"""What yields behind a flow source begins as it moved while it was rigid."""

import numpy
import pytest
import sympy

from bondgraph import TF, C, One, R, Sf, Zero, assemble, simulate
from bondgraph.discrepancy.grafting import graft, sites
from bondgraph.discrepancy.grafting.local import starts

SPEED = sympy.Symbol("speed", positive=True)


def turned(towards: bool):
    """A shaft that a source turns at a speed, against oil; its bond may point either way."""
    road, hub = Sf("road", SPEED if towards else -SPEED), One("hub")
    first = road >> hub if towards else hub >> road
    return assemble("shaft", first, hub >> R("oil", 2), parameters={SPEED: (3, "rad/s")})


@pytest.mark.parametrize("towards", [True, False])
def test_an_inertia_behind_a_coupling_begins_at_the_speed_of_the_source(towards):
    shaft = turned(towards)
    (bond,) = [site.name for site in sites(shaft) if "road" in site.name and "bond" in site.name]
    spring = {"stiffness": 50.0, "damping": 1.0}
    coupled = graft(shaft, "compliant_coupling", bond, parameters=spring).graph
    grown = graft(coupled, "added_inertia", "hub", parameters={"inertance": 0.1}).graph
    run = simulate(grown, 5.0, {"speed": 4})
    hub = run["added_inertia.p"] / 0.1
    assert hub[0] == pytest.approx(hub[-1], rel=1e-3)  # at last it turns with the source again
    assert abs(hub[0]) == pytest.approx(4)
    assert numpy.ptp(hub) > 0.1  # the oil winds it up in between


def test_flows_are_those_of_the_source_only_where_nothing_but_compliances_is_between():
    road, hub, rim = Sf("road", SPEED), One("hub"), One("rim")
    between = Zero("between")
    graph = assemble(
        "wheel",
        road >> hub >> between >> (C("tyre", stiffness=1), rim),
        rim >> TF("gear", 2) >> One("chain") >> R("oil", 2),
        parameters={SPEED: 3},
    )
    found = starts(graph)
    assert found[hub.f] == SPEED and found[rim.f] == SPEED
    assert graph.elements["chain"].f not in found
