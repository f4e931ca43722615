"""Scores against explicit least squares; classes of candidates that look alike."""

import numpy as np
import pytest

from bondgraph.discrepancy.screening import ambiguity_classes, chosen, scored, splitters


@pytest.fixture
def case():
    rng = np.random.default_rng(3)
    parameters, responses = rng.normal(size=(400, 3)), rng.normal(size=(400, 6))
    responses[:, 4] = parameters @ [1.0, -2.0, 0.5]
    residual = parameters @ [3.0, 1.0, -2.0] + 0.7 * responses[:, 2] + rng.normal(size=400)
    return residual, responses, parameters


def sum_of_squares(columns, residual):
    return np.sum((residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0]) ** 2)


def test_gains_are_those_of_least_squares_with_one_column_more(case):
    residual, responses, parameters = case
    found = scored(residual, responses, parameters)
    base = sum_of_squares(parameters, residual)
    assert found.rest == pytest.approx(base)
    for i in range(6):
        wide = np.column_stack([parameters, responses[:, i]])
        assert found.gain[i] == pytest.approx(base - sum_of_squares(wide, residual), abs=1e-9)
        if i != 4:
            solved = np.linalg.lstsq(wide, residual, rcond=None)[0]
            assert found.coefficient[i] == pytest.approx(solved[-1])
            spread = np.sqrt(np.linalg.inv(wide.T @ wide)[-1, -1])
            assert found.std[i] == pytest.approx(spread)
    assert found.order()[0] == 2


def test_what_the_parameters_can_do_is_no_candidate_s_merit(case):
    found = scored(*case)
    assert found.gain[4] == 0 and np.isnan(found.coefficient[4]) and found.left[4] < 1e-12
    assert (found.correlation[4] == 0).all()


def test_units_do_not_matter(case):
    residual, responses, parameters = case
    scales = 10.0 ** np.array([-9, 6, -3, 0, 4, 8])
    one, other = scored(*case), scored(residual, responses * scales, parameters * [1e9, 1, 1e-6])
    assert other.gain == pytest.approx(one.gain, rel=1e-6)
    assert other.correlation == pytest.approx(one.correlation, abs=1e-6)


def test_noise_alone_gives_chi_squared_gains():
    rng = np.random.default_rng(11)
    parameters, responses = rng.normal(size=(200, 2)), rng.normal(size=(200, 5))
    gains = np.array([scored(r, responses, parameters).gain for r in rng.normal(size=(2000, 200))])
    # chi squared of one degree of freedom: mean 1, 5 % above 3.841
    assert gains.mean() == pytest.approx(1, abs=0.05)
    assert (gains > 3.841).mean() == pytest.approx(0.05, abs=0.01)


def test_two_at_once_are_found_one_after_the_other():
    rng = np.random.default_rng(5)
    parameters, responses = rng.normal(size=(500, 2)), rng.normal(size=(500, 8))
    residual = 0.5 * responses[:, 6] - 0.3 * responses[:, 1] + 0.5 * rng.normal(size=500)
    found = chosen(2 * residual, 2 * responses, 2 * parameters, most=4, least=12)
    assert [index for index, _ in found] == [6, 1]


def test_columns_of_one_candidate_count_together():
    rng = np.random.default_rng(6)
    responses = rng.normal(size=(300, 5))
    residual = (
        responses[:, 1] + responses[:, 2] + 1.3 * responses[:, 4] + 0.1 * rng.normal(size=300)
    )
    found = chosen(residual, responses, groups=[[0], [1, 2], [3], [4]], most=2)
    assert [index for index, _ in found] == [1, 3]


def test_classes_and_what_splits_them():
    t = np.linspace(0, 1, 300)
    seen = np.array([t, 2 * t + 1e-3 * t**2, np.cos(9 * t)]).T
    found = scored(t, seen)
    assert ambiguity_classes(found.correlation) == [(0, 1), (2,)]
    extra = {
        "same": seen,
        "blind": np.zeros((300, 3)),
        "good": np.array([t, np.sin(20 * t), t]).T,
        "fair": np.array([t, t + 0.3 * np.sin(20 * t), t]).T,
    }
    split = splitters((0, 1), extra)
    assert [item.signal for item in split] == ["good", "fair"]
    assert split[0].likeness < split[1].likeness < 0.98
