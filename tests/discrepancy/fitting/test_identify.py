"""What the data can tell: on matrices written by hand, and on models whose products alone are seen."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, assemble, fit
from bondgraph.discrepancy import Measurement
from bondgraph.discrepancy.fitting.chain import Link, eliminated, followed, lengths
from bondgraph.discrepancy.fitting.identify import identified
from bondgraph.discrepancy.fitting.noise import correlation_time

NONE = np.zeros((0, 3))


def test_a_quotient_alone_is_seen():
    rows = np.array([[4.0, -4.0, 1.0], [2.0, -2.0, 0.0]])
    (first, second) = identified(rows, NONE, np.ones(2), ["k", "m"], [True, True]).directions
    assert first.words == "only k/m is seen: k and m along (+0.71, +0.71) are not"
    assert first.uncertainty == math.inf and not first.seen
    assert second.seen and second.uncertainty == pytest.approx(1 / (20 * 2) ** 0.5)


def test_powers_are_told():
    rows = np.array([[1.0, 2.0, 0.0]]) * 10
    found = identified(rows, NONE, np.ones(2), ["a", "b"], [True, True])
    assert found.directions[0].words.startswith("only a*b^2 is seen")


def test_a_prior_closes_what_the_data_leave_open():
    rows = np.array([[30.0, 30.0, 0.0]])
    prior = np.array([[10.0, 0.0, 0.0]])
    found = identified(rows, prior, np.ones(2), ["N", "mu"], [True, True])
    exact = np.linalg.inv(np.array([[1000.0, 900.0], [900.0, 900.0]]))
    assert found.covariance == pytest.approx(exact)
    assert found.directions[0].uncertainty == math.inf  # still unseen by the data


def test_one_that_has_no_effect_is_named():
    rows = np.array([[5.0, 0.0, 0.0]])
    found = identified(rows, NONE, np.ones(2), ["a", "b"], [True, False])
    assert found.std.tolist() == [0.2, math.inf]
    assert found.directions[0].words == "b is not seen"


def test_a_weak_direction_is_finite_and_named():
    rows = np.array([[10.0, 0.0, 0.0], [0.0, 0.5, 0.0]])
    found = identified(rows, NONE, np.ones(2), ["a", "b"], [True, True])
    assert found.std.tolist() == [0.1, 2.0]
    assert found.directions[0].words == "b is seen to a factor of 7.4 only"


def random_chain(rng, own, q, parts):
    links = []
    for k in range(parts):
        n = own if k else 1
        last = k == parts - 1
        onward = None if last else rng.normal(size=(own, n + q + 1))
        weight = np.zeros(0) if last else -rng.uniform(1, 50, own)
        links.append(Link(n, rng.normal(size=(9, n + q + 1)), onward, weight))
    return links


@pytest.mark.parametrize("parts", [1, 2, 6])
def test_elimination_is_dense_least_squares(parts):
    rng, own, q = np.random.default_rng(parts), 3, 2
    links = random_chain(rng, own, q, parts)
    sizes = [1] + [own] * (parts - 1)
    edges = np.concatenate([[0], np.cumsum(sizes)])
    width = edges[-1] + q
    rows = []
    for k, link in enumerate(links):
        here = slice(edges[k], edges[k + 1])
        for part in (link.data, link.onward):
            if part is not None:
                row = np.zeros((len(part), width + 1))
                row[:, here], row[:, edges[-1] :] = part[:, : link.own], part[:, link.own :]
                if part is link.onward:
                    row[:, edges[k + 1] : edges[k + 2]] += np.diag(link.onward_next)
                rows.append(row)
    dense = np.concatenate(rows)
    answer = np.linalg.lstsq(dense[:, :-1], -dense[:, -1], rcond=None)[0]
    reduced, backs = eliminated(links, q)
    first = np.linalg.lstsq(reduced[:, :-1], -reduced[:, -1], rcond=None)[0]
    assert first == pytest.approx(np.concatenate([answer[:1], answer[-q:]]))
    steps = [first[:1], *followed(backs, first[:1], first[1:])]
    assert np.concatenate(steps) == pytest.approx(answer[:-q])
    square = np.sum((dense @ np.append(answer, 1)) ** 2)
    assert lengths(links, steps, first[1:]) == pytest.approx(square)


def test_correlation_time_of_a_first_order_process():
    """AR(1) with coefficient a: (1 + a)/(1 - a); white noise: 1."""
    rng = np.random.default_rng(0)
    white = rng.normal(size=50_000)
    red = np.zeros_like(white)
    for i in range(1, len(red)):
        red[i] = 0.8 * red[i - 1] + white[i]
    assert correlation_time(white) == 1.0
    assert correlation_time(red) == pytest.approx(9, rel=0.15)


m, k, b = sympy.symbols("m k b", positive=True)


def test_free_motion_tells_quotients_only():
    """A free oscillator's position has k/m and b/m in it, and a prior on m gives all three."""
    graph = assemble(
        "free",
        One("v") >> (I("mass", m), C("spring", stiffness=k, initial=1), R("damper", b)),
        parameters={m: 1, k: 90, b: 1},
    )
    t = np.linspace(0, 2, 400)
    w = (100 - 0.25) ** 0.5
    x = np.exp(-0.5 * t) * (np.cos(w * t) + 0.5 / w * np.sin(w * t))
    rows = Measurement(t, {"spring.q": x + np.random.default_rng(0).normal(0, 0.01, len(t))})
    found = fit(graph, rows, ["m", "k", "b"])
    assert found.unidentified[0].words.startswith("only m/k and m/b are seen")
    assert set(found.std.values()) == {math.inf}
    assert not np.isnan(found.covariance).any() and not np.isnan(found.correlation).any()
    assert found.values["k"] / found.values["m"] == pytest.approx(100, rel=1e-3)
    assert "only m/k" in found.advice
    assert found.interval("k")[1] > 1e100
    held = fit(graph, rows, ["m", "k", "b"], priors={"m": (1, 0.01)})
    assert held.std["k"] / held.values["k"] == pytest.approx(0.01, rel=0.05)
    assert held.values["m"] == pytest.approx(1, abs=1e-4)
