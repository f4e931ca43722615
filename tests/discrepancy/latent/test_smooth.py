"""The smoother against dense Gaussian algebra: the covariance of all data, written out in numpy."""

import numpy
import pytest

from bondgraph.discrepancy.latent.linear import Along
from bondgraph.discrepancy.latent.smooth import Weights, smoothed
from bondgraph.errors import SimulationError

NT, N, NY, Q = 23, 3, 2, 2
AT = numpy.array([0, 2, 3, 5, 8, 9, 12, 15, 16, 19, 21, 22])


def _case(seed=0, gaps=0.0, broken=True):
    rng = numpy.random.default_rng(seed)
    h = rng.uniform(0.05, 0.2, NT - 1)
    missed = rng.normal(size=(len(AT), NY))
    missed[rng.random(missed.shape) < gaps] = numpy.nan
    course = Along(
        onward=numpy.eye(N) + 0.2 * rng.normal(size=(NT - 1, N, N)),
        forced=0.1 * rng.normal(size=(NT - 1, N, Q)),
        broken=0.1 * rng.normal(size=(NT - 1, N)) * broken,
        seen=rng.normal(size=(len(AT), NY, N)),
        felt=rng.normal(size=(len(AT), NY, Q)),
        missed=missed,
        rates=rng.normal(size=(NT, N)) * [1.0, 3.0, 0.3],
        x=rng.normal(size=(NT, N)),
        first=numpy.zeros((NT - 1, N, N)),
        second=numpy.zeros((NT - 1, N, N)),
    )
    root = rng.normal(size=(N, N))
    weights = Weights(
        0.3 * root @ root.T + 0.1 * numpy.eye(N), numpy.array([0.5, 2.0]), root[0] ** 2 + 1
    )
    return course, h, weights, rng.normal(size=N)


def _dense(course, h, weights, off):
    """Mean, responses and covariance of all data: what each start, step and sample does to them."""
    size = NT * N
    onward = numpy.eye(size)
    spread = numpy.zeros((size, size))
    spread[:N, :N] = numpy.diag(weights.start**2)
    told = numpy.zeros((size, Q + 1))
    told[:N, -1] = off
    for k in range(NT - 1):
        rows, before = slice((k + 1) * N, (k + 2) * N), slice(k * N, (k + 1) * N)
        onward[rows] += course.onward[k] @ onward[before]
        onward[rows, rows] = numpy.eye(N)
        step = course.onward[k] @ weights.model @ course.onward[k].T
        spread[rows, rows] = 0.5 * h[k] * (weights.model + step)
        told[rows, :-1], told[rows, -1] = course.forced[k], -course.broken[k]
    states = onward @ told
    covariance = onward @ spread @ onward.T
    seen = numpy.zeros((len(AT) * NY, size))
    for i, k in enumerate(AT):
        seen[i * NY : (i + 1) * NY, k * N : (k + 1) * N] = course.seen[i]
    there = numpy.isfinite(course.missed).ravel()
    noise = numpy.tile(weights.noise**2, len(AT))
    whole = seen @ covariance @ seen.T + numpy.diag(noise)
    left = course.missed.ravel() - seen @ states[:, -1]
    responses = seen @ states[:, :-1] + course.felt.reshape(-1, Q)
    gain = covariance @ seen[there].T @ numpy.linalg.inv(whole[numpy.ix_(there, there)])
    moved = (states[:, -1] + gain @ left[there]).reshape(NT, N)
    return responses[there], left[there], whole[numpy.ix_(there, there)], moved


@pytest.mark.parametrize("gaps", [0.0, 0.3])
@pytest.mark.parametrize("seed", [0, 1])
def test_likelihood_is_that_of_the_dense_covariance(seed, gaps):
    course, h, weights, off = _case(seed, gaps)
    found = smoothed(course, h, AT, weights, off)
    _, left, whole, moved = _dense(course, h, weights, off)
    assert found.count == len(left)
    squares = float(found.rows[:, -1] @ found.rows[:, -1])
    assert squares == pytest.approx(left @ numpy.linalg.solve(whole, left), rel=1e-7)
    assert found.log_det == pytest.approx(numpy.linalg.slogdet(whole)[1], rel=1e-7)
    assert numpy.allclose(found.moves[..., -1], moved, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("gaps", [0.0, 0.3])
def test_products_of_responses_are_those_of_the_dense_covariance(gaps):
    course, h, weights, off = _case(2, gaps, broken=False)
    found = smoothed(course, h, AT, weights, off)
    responses, left, whole, _ = _dense(course, h, weights, off)
    table = numpy.column_stack([responses, left])
    expected = table.T @ numpy.linalg.solve(whole, table)
    assert numpy.allclose(found.rows.T @ found.rows, expected, rtol=1e-6, atol=1e-7)


def test_gaps_all_over_tell_nothing():
    course, h, weights, off = _case(3, gaps=1.1, broken=False)
    found = smoothed(course, h, AT, weights, off)
    assert found.count == 0
    assert float(numpy.abs(found.rows).max()) < 1e-9


def test_what_is_not_finite_is_refused():
    course, h, weights, off = _case(4)
    course.onward[3, 0, 0] = numpy.nan
    with pytest.raises((SimulationError, numpy.linalg.LinAlgError)):
        smoothed(course, h, AT, weights, off)
