"""Every effect on every fitting site of eight machines: equations, units, files, runs."""

import functools
import math

import numpy
import pytest

from bondgraph import derive, simulate
from bondgraph.dimensions import infer
from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.grafting import graft, sites
from bondgraph.files import dumps, loads

from ..machines import MACHINES, RUNS, samples, scale_at

base = functools.cache(lambda machine: MACHINES[machine]())
PLACES = [
    (machine, effect.name, site)
    for machine in MACHINES
    for effect in EFFECTS.values()
    for site in sites(base(machine), effect)
]


def label(place):
    return f"{place[0]}-{place[1]}-{place[2].name.replace(' ', '_')}"


def first_of_each(places):
    """One site for each effect on each of two machines: those where it is least common first."""
    kept, machines = {}, {}
    for machine, name, site in places:
        if (machine, name) not in kept and machines.get(name, 0) < 2:
            kept[machine, name] = machine, name, site
            machines[name] = machines.get(name, 0) + 1
    return list(kept.values())


FEW = first_of_each(PLACES[::-1])
# Zero or infinity is a limit here, not a value: 1/delay, 1/inertance where it is alone, stiffness.
LIMITS = {"transport_delay", "compliant_coupling", "added_inertia"}


def grown(place):
    machine, name, site = place
    return graft(base(machine), name, site, scale=scale_at(machine, site.domain))


def run(place, graph, **options):
    machine = place[0]
    span = RUNS[machine][0]
    t = numpy.linspace(0, span, 40)
    return simulate(
        graph, span, inputs=samples(machine), t_eval=t, backend="vm", **{"rtol": 1e-6} | options
    )


def test_all_effects_find_a_place():
    assert {name for _, name, _ in PLACES} == set(EFFECTS)


@pytest.mark.parametrize("place", PLACES, ids=label)
def test_it_derives_fits_its_units_and_is_the_same_from_its_file(place):
    old = base(place[0])
    before = dumps(old) if place in FEW else ""
    new = grown(place)
    assert infer(new.graph).problems == ()
    assert all(
        unit or coefficient in ("restitution",) or place[2].kind == "output"
        for coefficient in new.parameters
        for unit in [_row(new, coefficient).unit]
    )
    text = dumps(new.graph)
    again = loads(text)
    assert dumps(again) == text
    if place in FEW:
        assert dumps(old) == before
        here, there = derive(new.graph), derive(again)
        assert [s.name for s in here.states] == [s.name for s in there.states]
        assert str(here.derivatives) == str(there.derivatives)
        assert str(here.assignments) == str(there.assignments)


def _row(new, coefficient):
    name = new.parameters[coefficient]
    return next(row for symbol, row in new.graph.parameters.items() if symbol.name == name)


def check_run(place):
    new = grown(place)
    result = run(place, new.graph)
    assert result.outcome.value == "finished", result.outcome
    assert abs(result.energy.relative_residual) < 1e-4
    if new.effect.passive:
        assert result.energy.dissipated > -1e-9 * abs(result.energy.supplied)


def check_absence(place):
    new = grown(place)
    start = new.effect.start(scale_at(place[0], place[2].domain))
    by_limit = place[1] in LIMITS
    values = {}
    for name, value in new.effect.absent.items():
        near = 1e6 * start[name] if math.isinf(value) else 1e-6 * start[name] * by_limit
        values[new.parameters[name]] = near
    tight = {"rtol": 1e-7 if by_limit else 1e-11, "atol": 1e-16}
    without = run(place, base(place[0]), **tight)
    result = run(place, new.graph, parameters=values, **tight)
    assert result.outcome.value == "finished"
    for name in (*without.states, *base(place[0]).outputs):
        size = abs(without[name]).max() or 1.0
        # the first samples hold the boundary layer of a limit
        gap = abs(result[name] - without[name])[2 * by_limit :].max()
        assert gap <= (1e-4 if by_limit else 1e-9) * size, name


@pytest.mark.parametrize("place", FEW, ids=label)
def test_it_runs_and_dissipates(place):
    check_run(place)


@pytest.mark.parametrize("place", FEW, ids=label)
def test_absent_it_leaves_the_machine_as_it_was(place):
    check_absence(place)


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES, ids=label)
def test_it_runs_and_dissipates_everywhere(place):
    check_run(place)


@pytest.mark.slow
@pytest.mark.parametrize(
    "place",
    # alone in a pipe an inertance has no limit of zero that a solver could follow
    [p for p in PLACES if p[1] != "added_inertia" or p[2].name not in ("pipe", "line")],
    ids=label,
)
def test_absent_everywhere_it_leaves_the_machine_as_it_was(place):
    check_absence(place)
