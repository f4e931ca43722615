"""What noise alone gains, against brute force: scipy's solvers on drawn noise."""

from types import SimpleNamespace

import numpy
import pytest
from scipy.optimize import nnls

from bondgraph.discrepancy.candidates import Coefficient, Effect, resistor
from bondgraph.discrepancy.candidates.value import FLOW
from bondgraph.discrepancy.latent.null import threshold
from bondgraph.discrepancy.latent.screen import _amounts

DRAWS, ROWS, COUNT = 3000, 60, 500


def _candidate(terms, signed):
    coefficients = tuple(
        Coefficient(f"c{i}", "", "", lambda s: 1.0, 0.0, True, signed=signed) for i in range(terms)
    )
    law = sum(item.symbol * FLOW**i for i, item in enumerate(coefficients))
    effect = Effect(
        "made", ("1-junction",), coefficients, {"effort": law}, resistor, "made", "none"
    )
    return SimpleNamespace(effect=effect, signed=(signed,) * terms)


def _sketch(groups, signed, seed=0):
    rng = numpy.random.default_rng(seed)
    width = sum(map(len, groups))
    factor = rng.normal(size=(ROWS, width + 1)) * 10.0 ** rng.uniform(-3, 3, width + 1)
    candidates = [_candidate(len(group), way) for group, way in zip(groups, signed, strict=True)]
    columns = SimpleNamespace(candidates=candidates, groups=groups)
    return SimpleNamespace(columns=columns, reduced=[SimpleNamespace(factor=factor, count=COUNT)])


@pytest.mark.parametrize(
    ("groups", "signed"),
    [
        ([(0,)], [True]),
        ([(0,)], [False]),
        ([(0, 1)], [True]),
        ([(i,) for i in range(20)], [False] * 20),
        ([(0,), (1, 2), (3,), (4, 5)], [False, True, True, True]),
    ],
)
def test_the_threshold_is_the_quantile_of_brute_force(groups, signed):
    sketch = _sketch(groups, signed)
    factor = sketch.reduced[0].factor
    rng = numpy.random.default_rng(99)
    best = []
    for _ in range(DRAWS):
        noise = rng.normal(size=ROWS)
        gains = []
        for group, free in zip(groups, signed, strict=True):
            part = factor[:, list(group)]
            if free:
                left = noise - part @ numpy.linalg.lstsq(part, noise, rcond=None)[0]
                drop = noise @ noise - left @ left
            else:
                drop = noise @ noise - nnls(part, noise)[1] ** 2
            gains.append(drop - len(group) * numpy.log(COUNT))
        best.append(max(gains))
    low, high = numpy.quantile(best, [0.97, 0.995])
    assert low < threshold(sketch, 0.985, DRAWS) < high


@pytest.mark.parametrize("seed", range(8))
def test_amounts_are_those_of_least_squares_with_bounds(seed):
    """Columns of a hypothesis, some positive: scipy's nnls with twins of opposite sign for the others."""
    rng = numpy.random.default_rng(seed)
    width = int(rng.integers(1, 6))
    table = rng.normal(size=(40, width)) * 10.0 ** rng.uniform(-2, 2, width)
    wanted = rng.normal(size=40) + table @ (rng.normal(size=width) / numpy.ptp(table, axis=0))
    signed = list(rng.random(width) < 0.4)
    twins = numpy.column_stack([table, -table[:, signed]])
    found = nnls(twins / numpy.linalg.norm(twins, axis=0), wanted)[0]
    found = found / numpy.linalg.norm(twins, axis=0)
    expected = found[:width]
    expected[signed] -= found[width:]
    amounts = _amounts(table.T @ table, table.T @ wanted, signed)
    assert numpy.allclose(amounts, expected, rtol=1e-6, atol=1e-9 * numpy.abs(expected).max())
    assert all(amount >= 0 or free for amount, free in zip(amounts, signed, strict=True))
