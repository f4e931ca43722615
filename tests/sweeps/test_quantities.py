"""Quantities against closed forms: a harmonic, and a mass on a belt."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from bondgraph import simulate
from bondgraph.models import bicycle_brake
from bondgraph.sweeps import (
    Count,
    Energy,
    EventTime,
    Final,
    Mean,
    Minimum,
    Peak,
    Rms,
    Share,
    grid,
    parse_quantity,
    sweep,
)
from tests.oracles.belt import Belt

from .cases import belt, oscillator, two_numbers

STIFF = np.array([2.0, 8.0, 32.0])
OMEGA = np.sqrt(STIFF / 2)  # of 2 kg
START = {"spring.q": 0.1}


def test_a_harmonic():
    kept = (
        Final("spring.q"),
        Final("speed"),
        Final("spring.e"),
        Peak("speed"),
        Minimum("spring.q"),
        Mean("spring.q"),
        Rms("spring.q"),
        Peak("speed", after=1.0),
        Energy(),
    )
    end = 5.0
    found = sweep(oscillator(), grid(k=STIFF), kept, t_span=end, initial=START, rtol=1e-10)
    q = 0.1 * np.cos(OMEGA * end)
    assert np.allclose(found["final:spring.q"], q, atol=1e-8)
    assert np.allclose(found["final:speed"], -0.1 * OMEGA * np.sin(OMEGA * end), atol=1e-7)
    assert np.allclose(found["final:spring.e"], STIFF * q, atol=1e-6)
    times = np.linspace(0, end, 4001)[:, None]
    speed = -0.1 * OMEGA * np.sin(OMEGA * times)
    assert np.allclose(found["peak:speed"], speed.max(axis=0), atol=1e-7)
    assert np.allclose(found["peak:speed@1.0"], speed[times[:, 0] >= 1].max(axis=0), atol=1e-7)
    assert np.allclose(found["min:spring.q"], -0.1, atol=1e-6)
    assert np.allclose(found["mean:spring.q"], 0.1 * np.sin(OMEGA * end) / OMEGA / end, atol=1e-6)
    square = 0.5 + np.sin(2 * OMEGA * end) / (4 * OMEGA * end)
    assert np.allclose(found["rms:spring.q"], 0.1 * np.sqrt(square), atol=1e-6)
    assert abs(found["energy:residual"]).max() < 1e-8
    assert found["final:speed"].units == "m/s" and found["energy:residual"].units == ""


def test_initial_states_and_inputs_are_varied_too():
    points = grid({"spring.q": [0.1, 0.2], "push": ([0.0, 8.0], "N")})
    found = sweep(oscillator(), points, "final:spring.q", t_span=1.0, rtol=1e-10)
    q0, still = np.array([[0.1], [0.2]]), np.array([[0.0, 1.0]])
    expected = still + (q0 - still) * np.cos(2.0)
    assert np.allclose(found["final:spring.q"], expected, atol=1e-8)
    assert found["push"].units == "N"


def test_what_is_varied_goes_before_what_is_shared():
    asked = dict(t_span=1.0, initial=START)
    plain = sweep(oscillator(), grid(k=STIFF), ("final:speed", "peak:speed"), **asked)
    asked |= dict(parameters={"k": 5.0})
    over = sweep(oscillator(), grid(k=STIFF), ("final:speed", "peak:speed"), **asked)
    assert plain["final:speed"].values.tolist() == over["final:speed"].values.tolist()


def test_units_of_points_are_converted():
    plain = sweep(oscillator(), grid(k=[8.0]), "final:speed", t_span=1.0, initial=START)
    small = sweep(oscillator(), grid(k=([8e-3], "N/mm")), "final:speed", t_span=1.0, initial=START)
    assert plain["final:speed"].item() == pytest.approx(small["final:speed"].item(), rel=1e-12)
    assert small["k"].item() == 8e-3 and small["k"].units == "N/mm"


BREAKAWAY = [9.0, 12.0, 15.0]


def test_a_mass_on_a_belt():
    kept = (
        Count("contact", "stick"),
        Count("contact", "slip+"),
        EventTime("contact", "stick"),
        EventTime("contact", "slip+", -1),
        EventTime("contact", "stick", 40),
        Share("contact", "stick"),
        Share("contact", "stick", after=0.5),
    )
    end = 2.0
    found = sweep(belt(), grid(F=BREAKAWAY), kept, t_span=end, rtol=1e-9)
    for i, limit in enumerate(BREAKAWAY):
        oracle = Belt(F_s=limit)
        events = oracle.events(end, 0.0, 0.0)
        sticks = [event.t for event in events if event.entered == "stick"]
        slips = [event.t for event in events if event.entered == "slip+"]
        course = itertools.takewhile(lambda phase: phase.t < end, oracle.phases(0.0, 0.0))
        stuck_from = [(p.t, min(p.end, end)) for p in course if p.mode == "stick"]
        at = found.isel(F=i)
        assert at["count:contact:stick"] == len(sticks)
        assert at["count:contact:slip+"] == len(slips)
        assert at["time:contact:stick:0"].item() == pytest.approx(sticks[0], abs=1e-7)
        assert at["time:contact:slip+:-1"].item() == pytest.approx(slips[-1], abs=1e-6)
        assert np.isnan(at["time:contact:stick:40"]) and at["outcome"] == 0
        for since, name in ((0.0, ""), (0.5, "@0.5")):
            stuck = sum(max(0.0, stop - max(start, since)) for start, stop in stuck_from)
            share = at[f"share:contact:stick{name}"].item()
            assert share == pytest.approx(stuck / (end - since), abs=1e-6)


def test_a_mode_that_never_ends_has_the_whole_share():
    kept = (Share("contact", "stick"), Share("contact", "slip+"))
    start = {"mass.p": 0.5, "spring.q": 0.0}
    found = sweep(belt(), grid(F=[1e4]), kept, t_span=1.0, initial=start)
    assert found["share:contact:stick"].item() == pytest.approx(1.0)
    assert found["share:contact:slip+"].item() == 0.0


def test_the_brake_sticks_as_often_as_its_paper_has_it():
    settings = [dict(mu_s=0.42, tau=0.03), dict(mu_s=0.42, tau=0.02), dict(mu_s=0.5, tau=0.02)]
    found = sweep(bicycle_brake.graph(), settings, "count:friction:stick", t_span=0.5, rtol=1e-9)
    assert found["count:friction:stick"].values.tolist() == [0, 1, 72]  # docs/brake.md


def test_ends_of_a_batch_and_of_single_runs_are_the_same():
    kept = (Final("F_f"), Final("V_c"), Count("friction", "stick"))
    axes = grid(V0=np.linspace(0.5, 1.2, 9), tau=[0.02, 0.05])
    graph = bicycle_brake.graph()
    ends = sweep(graph, axes, kept, t_span=0.2)
    along = sweep(graph, axes, (*kept, Peak("x_c")), t_span=0.2)  # needs the runs' course
    for item in kept:
        assert ends[item.label].values.tobytes() == along[item.label].values.tobytes()


def test_functions_of_a_trajectory():
    kept = {"own": two_numbers, "end": lambda run: run.t_end}
    found = sweep(oscillator(), grid(k=STIFF), kept, t_span=1.0, initial=START)
    assert found["row"].dims == ("k", "row axis 0") and found["row"].shape == (3, 3)
    run = simulate(oscillator(), 1.0, {"k": 8.0}, START, t_eval=np.linspace(0, 1, 4001))
    assert found["row"].sel(k=8.0).values.tolist() == run["spring.q"][:3].tolist()
    assert found["last"].sel(k=8.0).item() == run["spring.q"][-1]
    assert found["end"].values.tolist() == [1.0, 1.0, 1.0]


KINDS = [
    Final("V_c"),
    Peak("rear.mass.p"),
    Peak("x_c", after=0.1),
    Minimum("x_c", after=1e-3),
    Mean("N"),
    Rms("N", after=0.30000000000000004),
    Count("friction", "slip+"),
    Share("friction", "slip-"),
    Share("friction", "stick", after=0.2),
    EventTime("friction", "stick", -2),
    Energy("supplied"),
    Energy(),
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.label)
def test_labels_are_read_again(kind):
    assert parse_quantity(kind.label) == kind


@pytest.mark.parametrize(
    "text",
    [
        "",
        "final",
        "final:",
        "count:friction",
        "count:a:b:c",
        "time:a:b:c",
        "peak:x@soon",
        "share:a",
    ],
)
def test_texts_that_say_nothing_are_refused(text):
    with pytest.raises(Exception, match=r"cannot be read|no time"):
        parse_quantity(text)
