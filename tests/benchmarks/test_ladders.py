"""The ladders raced are ladders: their eigenvalues against closed forms."""

import sys

import numpy
import pytest

from . import growth, ladders


def modes(cells):
    """Half angles of a ladder driven at one end and open at the other."""
    return (2 * numpy.arange(1, cells + 1) - 1) * numpy.pi / (2 * (2 * cells + 1))


def eigenvalues(ladder, states):
    rates, jacobian = ladders.functions(ladder)
    assert rates.size_in(0) == rates.size_out(0) == (states, 1)
    return numpy.linalg.eigvals(jacobian(numpy.zeros(states)).full())


@pytest.mark.parametrize("cells", [1, 2, 9, 60])
def test_rc(cells):
    expected = -4 / (0.5 * 3) * numpy.sin(modes(cells)) ** 2
    found = eigenvalues(ladders.rc(cells, 0.5, 3), cells)
    assert numpy.sort(found.real) == pytest.approx(numpy.sort(expected), rel=1e-9)
    assert abs(found.imag).max() < 1e-12


@pytest.mark.parametrize("resistance", [0, 0.1])
@pytest.mark.parametrize("cells", [1, 2, 9, 40])
def test_lc_and_rlc(cells, resistance):
    inertance, capacitance = 5, 3
    natural = 2 / numpy.sqrt(inertance * capacitance) * numpy.sin(modes(cells))
    decay = resistance / (2 * inertance)
    roots = numpy.sqrt((decay**2 - natural**2).astype(complex))
    expected = numpy.concatenate([-decay + roots, -decay - roots])
    found = eigenvalues(ladders.rlc(2 * cells, resistance, inertance, capacitance), 2 * cells)
    assert numpy.sort_complex(found.round(9)) == pytest.approx(
        numpy.sort_complex(expected.round(9)), abs=1e-8
    )


def test_jacobians_are_sparse():
    _, jacobian = ladders.functions(ladders.rc(200))
    assert jacobian.nnz_out(0) == 3 * 200 - 2


def test_a_ladder_is_measured_in_its_own_process():
    command = [sys.executable, "-m", "tests.benchmarks.ladders"]
    assert 0 < growth.measured(command, "rlc", 10, 2) < growth.TIME_LIMIT
    with pytest.raises(growth.Unavailable, match="no_such_ladder"):
        growth.measured(command, "no_such_ladder", 10, 1)


def test_what_takes_too_long_is_over_the_limit(monkeypatch):
    monkeypatch.setattr(growth, "TIME_LIMIT", 1)
    with pytest.raises(growth.OverLimit):
        growth.measured([sys.executable, "-c", "while True: pass"], "rc", 10, 1)


def test_a_peer_that_cannot_be_installed_is_named_and_left_out(monkeypatch, tmp_path):
    monkeypatch.setattr(growth, "ROOT", tmp_path)
    monkeypatch.setattr(growth, "KINDS", ())
    peer = growth.Peer("nobody 0", f"{tmp_path}/nowhere", "none.py")
    (row,) = growth.race((10,), [peer])
    assert row.name == "nobody 0"
    assert row.note.startswith("not run: ")


def test_exponents_are_those_of_powers():
    rows = [growth.Row("rc", n, growth.OURS, 1e-4 * n**1.1) for n in growth.SIZES]
    ((kind, exponent, seconds),) = growth.exponents(rows)
    assert (kind, exponent) == ("rc", pytest.approx(1.1))
    assert seconds == pytest.approx(1e-4 * 1e4**1.1)
