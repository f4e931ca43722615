"""What a trial says of its own parameters."""

from types import SimpleNamespace

import pytest

from bondgraph.discrepancy.discovery.bench import LOOSE, Trial
from bondgraph.discrepancy.discovery.run import _part_of


def strain(value, given=0.05):
    fitted = SimpleNamespace(fit=SimpleNamespace(values={"b": value}), given={"b": given})
    return Trial.strain.fget(fitted)


def test_an_element_that_is_not_there_is_no_endless_strain():
    assert strain(0.05) == 0
    assert strain(1e-9) == pytest.approx(1 / LOOSE**2) == strain(0.0)


@pytest.mark.parametrize("ratio", [1.5, 3.0, 20.0])
def test_many_times_as_much_strains_as_its_logarithm(ratio):
    assert strain(0.05 * ratio) < ((ratio - 1) / LOOSE) ** 2
    assert strain(0.05 * ratio) > strain(0.05 * (1 + ratio) / 2)


def test_parts_of_an_explanation():
    one, two, both, none = (
        SimpleNamespace(added=[SimpleNamespace(label=label) for label in labels])
        for labels in ("a", "b", "ab", "")
    )
    assert _part_of(one, both) and _part_of(two, both)
    assert not any(
        _part_of(*pair) for pair in [(none, both), (both, both), (both, one), (one, two)]
    )
