"""Eigenvalues of many matrices, against matrices made from their eigenvalues, and LAPACK."""

import numpy
import pytest

from bondgraph.simulation.native import find_compiler
from bondgraph.stability.maps.eigen import diagonal_blocks, eigenvalues, falling
from bondgraph.stability.maps.small import eigvals

COMPILED = [False, pytest.param(True, marks=pytest.mark.skipif(not find_compiler(), reason="no C"))]


def made_of(rng, pairs, reals):
    """Matrices with known eigenvalues: blocks turned by a random, well-conditioned basis."""
    n = 2 * len(pairs) + len(reals)
    block = numpy.zeros((n, n))
    for place, (real, imag) in enumerate(pairs):
        at = slice(2 * place, 2 * place + 2)
        block[at, at] = [[real, imag], [-imag, real]]
    for place, real in enumerate(reals):
        block[2 * len(pairs) + place, 2 * len(pairs) + place] = real
    basis, _ = numpy.linalg.qr(rng.normal(size=(n, n)))
    return basis @ block @ basis.T


@pytest.mark.parametrize("compiled", COMPILED)
def test_known_eigenvalues_are_found(compiled):
    rng = numpy.random.default_rng(4)
    cases = [([(-1, 5), (2, 9)], [-3.0]), ([(0, 1)], [4.0, -4.0, 1e-3]), ([(-1, 5), (-1, 7)], [2])]
    matrices = numpy.array([made_of(rng, *case) for case in cases])
    for row, (pairs, reals) in zip(falling(eigvals(matrices, compiled)), cases, strict=True):
        wanted = [complex(a, s * b) for a, b in pairs for s in (1, -1)] + [
            complex(r) for r in reals
        ]
        assert min(abs(row - w).min() for w in wanted) < 1e-13
        distances = abs(row[:, None] - numpy.array(wanted)[None, :])
        assert distances.min(axis=0).max() < 1e-12 and distances.min(axis=1).max() < 1e-12


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 7, 10])
@pytest.mark.parametrize("kind", ["dense", "graded", "sparse"])
@pytest.mark.skipif(not find_compiler(), reason="no C")
def test_compiled_agrees_with_lapack(n, kind):
    rng = numpy.random.default_rng(n)
    matrices = rng.normal(size=(500, n, n))
    if kind == "graded":
        sizes = 10 ** rng.uniform(-6, 6, size=(500, n))
        matrices *= sizes[:, :, None] / sizes[:, None, :]
    if kind == "sparse":
        matrices *= rng.random(matrices.shape) < 0.6
        matrices += numpy.eye(n) * rng.normal(size=(500, n))[:, None]
    before = matrices.copy()
    found, expected = eigvals(matrices, compiled=True), numpy.linalg.eigvals(matrices)
    assert (matrices == before).all()
    off = abs(found[:, :, None] - expected[:, None, :])
    worst = numpy.maximum(off.min(axis=1).max(axis=1), off.min(axis=2).max(axis=1))
    near = worst / abs(expected).max(axis=1)
    assert (
        numpy.median(near) < 1e-14 and near.max() < 1e-7
    )  # near-defective ones are ill-conditioned


@pytest.mark.skipif(not find_compiler(), reason="no C")
def test_compiled_takes_hard_cases():
    jordan = numpy.diag([2.0] * 3) + numpy.diag([1.0] * 2, 1)
    turning = numpy.roll(numpy.eye(4), 1, axis=0)  # permutations make plain shifts go in circles
    for matrix, expected in ((jordan, [2, 2, 2]), (turning, [1, 1j, -1j, -1])):
        found = falling(eigvals(matrix[None], compiled=True))[0]
        assert found == pytest.approx(numpy.array(expected, dtype=complex), abs=1e-12)
    assert (eigvals(numpy.zeros((2, 3, 3)), compiled=True) == 0).all()


def test_blocks_give_the_eigenvalues_of_the_whole():
    rng = numpy.random.default_rng(8)
    pattern = rng.random((6, 6)) < 0.3
    numpy.fill_diagonal(pattern, True)
    rows, columns = numpy.nonzero(pattern)
    matrices = rng.normal(size=(20, 6, 6)) * pattern
    blocks = diagonal_blocks(rows, columns, 6)
    assert len(blocks) > 1 and sorted(member for block in blocks for member in block) == list(
        range(6)
    )
    entries = [matrices[:, row, column] for row, column in zip(rows, columns, strict=True)]
    found = eigenvalues(entries, rows, columns, blocks, 20)
    expected = falling(numpy.linalg.eigvals(matrices).astype(complex))
    off = abs(found[:, :, None] - expected[:, None, :])
    assert off.min(axis=1).max() < 1e-12 and off.min(axis=2).max() < 1e-12


def test_rows_fall_and_pairs_have_their_positive_part_first():
    found = falling(numpy.array([[-1, 2 - 3j, 2 + 3j, 5]], dtype=complex))
    assert found.tolist() == [[5, 2 + 3j, 2 - 3j, -1]]
