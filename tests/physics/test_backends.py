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


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
class TestBackends:
    def test_agree(self, case):
        program = case.program(**everything(case.equations))
        by_casadi, by_numpy = to_casadi(program), to_numpy(program)
        for arguments in case.points(20):
            for first, second in zip(by_casadi(*arguments), by_numpy(*arguments), strict=True):
                found = first.full().ravel()
                assert numpy.isfinite(found).all()
                # equal up to the order of sums: measured beside the largest of a vector
                numpy.testing.assert_allclose(
                    found, second, rtol=1e-13, atol=1e-13 * numpy.abs(found).max(initial=0)
                )

    def test_a_trajectory_in_one_call_is_its_points(self, case):
        function = to_numpy(case.program(rates=case.equations.derivatives))
        points = list(case.points(5))
        t, _, u, p, d = points[0]
        whole = function(t, numpy.array([point[1] for point in points]).T, u, p, d)[0]
        single = [function(t, point[1], u, p, d)[0] for point in points]
        assert numpy.array_equal(whole.T, single)
