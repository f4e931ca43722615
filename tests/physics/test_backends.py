"""CasADi and NumPy compute the same numbers, over every model in every mode."""

import numpy
import pytest

from bondgraph.codegen.to_casadi import to_casadi
from bondgraph.codegen.to_numpy import to_numpy

from .cases import cases


def everything(equations):
    energies = [energy for energy in equations.energies.values() if energy is not None]
    return {
        "rates": equations.derivatives,
        "residuals": equations.residuals,
        "outputs": equations.outputs.values(),
        "ports": equations.ports.values(),
        "supplied": equations.supplied.values(),
        "dissipated": equations.dissipated.values(),
        "energies": energies,
        "breakaway": [contact.breakaway for contact in equations.contacts],
        "variables": [symbol for symbol, _ in equations.assignments],
    }


def noise(function, arguments, rng):
    """How far results move when arguments move by their last digits: what rounding may do."""
    moved = [
        numpy.asarray(value)[:, None] * (1 + 1e-13 * rng.uniform(-1, 1, size=(len(value), 20)))
        for value in arguments
    ]
    return [numpy.ptp(found, axis=1) for found in function(*moved)]


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
class TestBackends:
    def test_agree(self, case):
        program = case.program(**everything(case.equations))
        by_casadi, by_numpy = to_casadi(program), to_numpy(program)
        rng = numpy.random.default_rng(2)
        for arguments in case.points(20):
            doubts = noise(by_numpy, arguments, rng)
            results = zip(by_casadi(*arguments), by_numpy(*arguments), doubts, strict=True)
            for first, second, doubt in results:
                found = first.full().ravel()
                assert numpy.isfinite(found).all()
                assert (numpy.abs(found - second) <= 1e-13 * numpy.abs(found) + doubt).all()

    def test_a_trajectory_in_one_call_is_its_points(self, case):
        function = to_numpy(case.program(rates=case.equations.derivatives))
        points = list(case.points(5))
        t, _, u, p, d = points[0]
        whole = function(t, numpy.array([point[1] for point in points]).T, u, p, d)[0]
        single = [function(t, point[1], u, p, d)[0] for point in points]
        assert numpy.array_equal(whole.T, single)
