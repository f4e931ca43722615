"""What would tell explanations apart, where the answer is known on paper."""

import math
from types import SimpleNamespace

import numpy
import pytest

from bondgraph.discrepancy import graft
from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.discovery.apart import harder, laws_part, signals_apart
from bondgraph.discrepancy.discovery.prepare import prepared
from bondgraph.simulation import CompiledModel

from .made import lacking, recorded


def member(name, values, run, site="carriage"):
    """A fitted effect, as a search would leave it."""
    grown = graft(lacking(), name, site, parameters=values)
    own = {grown.parameters[key]: value for key, value in values.items()}
    item = SimpleNamespace(effect=EFFECTS[name], label=f"{name} at {site}", starts=values)
    return SimpleNamespace(
        label=item.label,
        added=(item,),
        grafts=(grown,),
        model=CompiledModel(grown.graph),
        measurements=(run.changed(initial=grown.initial({"spring.q": 0.01, "mass.p": 0.0})),),
        values=own,
    )


def bench(run):
    ready, _ = prepared(run, lacking())
    graph = lacking()
    return SimpleNamespace(graph=graph, model=CompiledModel(graph), recordings=(ready,), given={})


def test_an_offset_and_a_force_are_apart_by_the_offset_where_nothing_is_offset():
    """k x = F: a force of 4 N on 800 N/m moves the spring by 5 mm; an offset moves nothing."""
    run = recorded(lacking(), columns=("x",), count=201, span=2.0)
    force = member("effort_bias", {"effort": 4.0}, run)
    offset = member("sensor_bias", {"offset": 5e-3}, run, "output x")
    start = dict(force.measurements[0].initial)
    force.measurements = (run.changed(initial=start | {"spring.q": 0.015}),)
    found = {item.signal: item for item in signals_apart(bench(run), (force, offset))}
    assert found["spring.q"].difference == pytest.approx(5e-3, rel=1e-3)
    assert found["v"].difference < 1e-6 * found["v"].range
    assert next(iter(found)) == "spring.q", "not the first that is advised"
    assert "x" not in found


def test_a_signal_that_follows_a_measured_one_is_no_advice():
    run = recorded(lacking(), columns=("v",), count=201, span=2.0)
    members = [
        member("viscous_damping", {"damping": 3.0}, run),
        member("quadratic_drag", {"drag": 9.0}, run),
    ]
    names = [item.signal for item in signals_apart(bench(run), members)]
    assert "carriage.f" not in names and "x" in names


def test_laws_part_where_paper_says():
    """b f and d f|f| with b = d R agree at R; they differ by a fifth of the larger from 1.25 R on."""
    run = recorded(lacking(), count=201, span=2.0)
    two = (
        member("viscous_damping", {"damping": 6.0}, run),
        member("quadratic_drag", {"drag": 20.0}, run),
    )
    reach = {"viscous_damping at carriage": {"flow": 0.3}}
    said = laws_part(two, reach)
    assert "flow" in said and "reach 0.3" in said
    beyond = float(said.split("beyond ")[1].split(" ")[0])
    assert beyond == pytest.approx(1.25 * 0.3, rel=0.02)


def test_laws_of_different_variables_part_nowhere():
    run = recorded(lacking(), count=201, span=2.0)
    two = (
        member("viscous_damping", {"damping": 6.0}, run),
        member("cubic_stiffness", {"cubic": 1e4}, run),
    )
    assert laws_part(two, {"viscous_damping at carriage": {"flow": 0.3}}) == ""


def test_driving_harder_shows_what_grows_faster():
    """A cubic spring is felt with the cube of the amplitude; a linear one of the same force is not."""
    run = recorded(lacking(), noise=0.05, count=201, span=2.0)
    found = harder(
        bench(run),
        (
            member("cubic_stiffness", {"cubic": 6e3}, run),
            member("cubic_stiffness", {"cubic": 1.2e4}, run),
        ),
    )
    assert found is None or found[0] > 1
    far = harder(
        bench(run),
        (
            member("cubic_stiffness", {"cubic": 6e3}, run),
            member("cubic_stiffness", {"cubic": 6e5}, run),
        ),
    )
    assert far is not None and far[0] == 1.5
    same = member("cubic_stiffness", {"cubic": 6e3}, run)
    assert harder(bench(run), (same, same)) is None


def test_a_member_that_does_not_run_is_passed_over():
    run = recorded(lacking(), columns=("x",), count=201, span=2.0)
    good = member("viscous_damping", {"damping": 3.0}, run)
    bad = member("viscous_damping", {"damping": 3.0}, run)
    bad.values = {next(iter(bad.values)): math.nan}
    assert signals_apart(bench(run), (good, bad)) == []
    assert signals_apart(bench(run), (good, good))[0].share == 0
    assert numpy.isfinite(signals_apart(bench(run), (good, bad, good))[0].share)
