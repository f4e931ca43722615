"""Segments: which candidate explains a chain of two masses that scipy has moved."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import C, CompiledModel, I, One, R, Samples, Se, Zero, assemble
from bondgraph.discrepancy.screening import Record, best_length, segmented
from bondgraph.errors import SimulationError

VALUES = {"m1": 1.0, "m2": 1.0, "k1": 100.0, "k2": 150.0, "b1": 0.5, "b2": 0.4}
LAWS = {
    "viscous": lambda f, q: f,
    "coulomb": lambda f, q: sympy.sign(f),
    "drag": lambda f, q: f * sympy.Abs(f),
    "cubic": lambda f, q: q**3,
}
T = np.arange(0, 20, 0.01)
DRIVE = 5 * np.sin(2 * np.pi * (0.3 + 0.15 * T) * T)
INPUTS = {"F": Samples(T, DRIVE)}


def chain():
    """Two masses, the first held to ground and pushed, with every law at every junction."""
    p = {name: sympy.Symbol(name, positive=True) for name in VALUES}
    push, names = sympy.Symbol("F"), []
    v1, v2, joint, rel = One("v1"), One("v2"), Zero("joint"), One("rel")
    k1, k2 = C("k1", stiffness=p["k1"]), C("k2", stiffness=p["k2"])

    def probe(junction, q):
        def law(f):
            coefficients = [sympy.Symbol(f"{junction.name}:{name}", real=True) for name in LAWS]
            names.extend(coefficients)
            return sum(c * phi(f, q) for c, phi in zip(coefficients, LAWS.values(), strict=True))

        return junction >> R(f"probe {junction.name}", effort=law)

    graph = assemble(
        "chain",
        Se("push", push) >> v1 >> (I("m1", p["m1"]), k1, R("b1", p["b1"])),
        v1 >> joint >> v2 >> I("m2", p["m2"]),
        joint >> rel >> (k2, R("b2", p["b2"])),
        probe(v1, k1.q),
        probe(v2, k1.q - k2.q),
        probe(rel, k2.q),
        parameters={p[n]: v for n, v in VALUES.items()} | dict.fromkeys(names, 0.0),
        inputs=[push],
        outputs={"x1": k1.q, "x2": k1.q - k2.q},
    )
    return CompiledModel(graph), [symbol.name for symbol in names]


MODEL, NAMES = chain()


def measured(extra, noise, seed=0, **changed):
    """Positions of the masses by scipy, with forces added on them, and noise."""
    m1, m2, k1, k2, b1, b2 = (VALUES | changed).values()

    def rates(t, y):
        x1, v1, x2, v2 = y
        on1, on2 = extra(x1, v1, x2, v2)
        between = k2 * (x1 - x2) + b2 * (v1 - v2)
        push = np.interp(t, T, DRIVE)
        return v1, (push - k1 * x1 - b1 * v1 - between + on1) / m1, v2, (between + on2) / m2

    found = solve_ivp(
        rates, (0, T[-1]), np.zeros(4), "LSODA", T, rtol=1e-9, atol=1e-12, max_step=0.01
    )
    rng = np.random.default_rng(seed)
    x1, x2 = found.y[0], found.y[2]
    sigma = {"x1": noise * x1.std(), "x2": noise * x2.std()}
    values = {"x1": x1 + sigma["x1"] * rng.normal(size=len(T))}
    values["x2"] = x2 + sigma["x2"] * rng.normal(size=len(T))
    return values, sigma


def steep(v):
    return np.tanh(v / 1e-4)


EFFECTS = {
    "v2:coulomb": (lambda x1, v1, x2, v2: (0, -0.3 * steep(v2)), 0.3),
    "v1:drag": (lambda x1, v1, x2, v2: (-0.8 * v1 * abs(v1), 0), 0.8),
    "v2:viscous": (lambda x1, v1, x2, v2: (0, -0.3 * v2), 0.3),
    "rel:coulomb": (lambda x1, v1, x2, v2: (-0.3 * steep(v1 - v2), 0.3 * steep(v1 - v2)), 0.3),
    "v1:cubic": (lambda x1, v1, x2, v2: (-500 * x1**3, 0), 500),
}


@pytest.mark.parametrize("noise", [0.002, 0.1])
@pytest.mark.parametrize("name", EFFECTS)
def test_the_missing_effect_has_the_largest_gain(name, noise):
    force, size = EFFECTS[name]
    values, sigma = measured(force, noise, k1=103.0, b1=0.52)  # two parameters are wrong as well
    found = best_length(MODEL, [Record(T, values, sigma, INPUTS)], list(VALUES), NAMES)
    scores = found.scores()
    assert NAMES[scores.order()[0]] == name
    assert scores.coefficient[NAMES.index(name)] == pytest.approx(size, rel=0.35)
    assert not found.skipped


@pytest.mark.parametrize("name", ["v2:coulomb", "v1:drag"])
def test_one_of_two_signals_will_do(name):
    values, sigma = measured(EFFECTS[name][0], 0.02)
    found = best_length(
        MODEL, [Record(T, {"x1": values["x1"]}, sigma, INPUTS)], list(VALUES), NAMES
    )
    assert NAMES[found.scores().order()[0]] == name


def test_two_at_once():
    both = [EFFECTS["v2:coulomb"][0], EFFECTS["v1:drag"][0]]
    values, sigma = measured(lambda *y: sum(np.array(force(*y)) for force in both), 0.02)
    found = best_length(MODEL, [Record(T, values, sigma, INPUTS)], list(VALUES), NAMES)
    assert {NAMES[i] for i, _ in found.chosen(most=2)} == {"v2:coulomb", "v1:drag"}


def test_nothing_missing_leaves_noise():
    values, sigma = measured(lambda *y: (0, 0), 0.02, k1=103.0)
    found = segmented(MODEL, [Record(T, values, sigma, INPUTS)], list(VALUES), NAMES, 2.0)
    scores = found.scores()
    assert scores.rest / found.count == pytest.approx(1, abs=0.1)
    assert scores.gain.max() < 15  # of twelve chi squared values of one degree of freedom


def test_gaps_and_several_recordings():
    values, sigma = measured(EFFECTS["v2:coulomb"][0], 0.02)
    values["x2"][300:900] = np.nan
    half = len(T) // 2
    start = {"m1.p": 0.0}  # the rest is fitted, segment by segment
    records = [
        Record(T[part], {n: v[part] for n, v in values.items()}, sigma, INPUTS, start)
        for part in (slice(0, half), slice(half, None))
    ]
    found = segmented(MODEL, records, list(VALUES), NAMES, 1.0)
    assert NAMES[found.scores().order()[0]] == "v2:coulomb"
    assert found.count < 2 * len(T) - 600


def test_the_factor_keeps_all_products():
    values, sigma = measured(EFFECTS["v1:drag"][0], 0.02)
    record = Record(T[:1001], {n: v[:1001] for n, v in values.items()}, sigma, INPUTS)
    one, two = (segmented(MODEL, [record] * n, ["k1"], NAMES[:2], 1.0) for n in (1, 2))
    assert one.reduced.shape == two.reduced.shape == (4, 4)
    assert two.count == 2 * one.count
    products = one.reduced.T @ one.reduced
    assert two.reduced.T @ two.reduced == pytest.approx(2 * products, rel=1e-6, abs=1e-6)


def test_what_cannot_be_followed_is_said():
    values, sigma = measured(EFFECTS["v1:drag"][0], 0.02)
    short = Record(T[:5], {n: v[:5] for n, v in values.items()}, sigma, INPUTS)
    with pytest.raises(SimulationError, match="shorter than a segment"):
        segmented(MODEL, [short], [], NAMES, 1.0)
    with pytest.raises(SimulationError, match="seconds allowed"):
        segmented(MODEL, [Record(T, values, sigma, INPUTS)], [], NAMES, 1.0, time_budget=0.0)
