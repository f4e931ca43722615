"""CasADi functions on arrays: each operation against CasADi's own value, point by point."""

import casadi
import numpy
import pytest

from bondgraph.codegen.casadi_to_numpy import on_arrays
from bondgraph.codegen.program import ProgramError

X, Y = casadi.SX.sym("x"), casadi.SX.sym("y")
EXPRESSIONS = {
    "arithmetic": (X + 2 * Y) * (X - Y) / (Y - 3) - X**2,
    "powers": casadi.power(casadi.fabs(X), Y) + X**3 + casadi.sqrt(casadi.fabs(Y)),
    "exponentials": casadi.exp(-X) + casadi.log(casadi.fabs(Y) + 1),
    "small": casadi.expm1(X) + casadi.log1p(Y**2),
    "angles": casadi.sin(X) * casadi.cos(Y) + casadi.tan(X / 4) + casadi.atan2(Y, X),
    "inverse": casadi.asin(X / 9) + casadi.acos(Y / 9) + casadi.atan(X),
    "hyperbolic": casadi.sinh(X) + casadi.cosh(Y) + casadi.tanh(X),
    "areas": casadi.asinh(X) + casadi.acosh(1 + Y**2) + casadi.atanh(X / 9),
    "corners": casadi.fabs(X) + casadi.sign(Y) + casadi.floor(X) + casadi.ceil(Y),
    "choices": casadi.if_else(X > Y, X**2, -Y) + casadi.fmin(X, Y) * casadi.fmax(X, 1),
    "logic": casadi.if_else(
        casadi.logic_or(casadi.logic_and(X >= 0, Y <= 1), casadi.logic_not(X != Y)), X, Y
    ),
    "error": casadi.erf(X) + casadi.fmod(X, 2) + casadi.copysign(X, Y) + casadi.hypot(X, Y),
    "slope": casadi.gradient(casadi.exp(-casadi.fabs(X) / 3) * casadi.tanh(Y), X),
}


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_agrees_with_casadi(name):
    function = casadi.Function("f", [X, Y], [EXPRESSIONS[name]])
    rng = numpy.random.default_rng(3)
    x, y = rng.uniform(-4, 4, (2, 50))
    found = on_arrays(function)([x], [y])[0][0]
    expected = [float(function(a, b)) for a, b in zip(x, y, strict=True)]
    assert found == pytest.approx(expected, rel=1e-14, abs=1e-14)


def test_what_does_not_vary_stays_a_number():
    function = casadi.Function("f", [casadi.vertcat(X, Y)], [casadi.vertcat(X**2, X * Y)])
    square, product = on_arrays(function)([3.0, numpy.arange(4.0)])[0]
    assert numpy.ndim(square) == 0 and square == 9
    assert product.tolist() == [0, 3, 6, 9]


def test_only_structural_nonzeros_come_back():
    jacobian = casadi.jacobian(casadi.vertcat(X * Y, Y), casadi.vertcat(X, Y))
    found = on_arrays(casadi.Function("j", [X, Y], [jacobian]))([2.0], [5.0])[0]
    assert list(map(float, found)) == [5.0, 2.0, 1.0]


def test_what_is_not_finite_is_not_raised():
    found = on_arrays(casadi.Function("f", [X], [1 / X]))([numpy.array([0.0, 2.0])])[0][0]
    assert found.tolist() == [numpy.inf, 0.5]


def test_an_operation_without_a_form_is_named():
    with pytest.raises(ProgramError, match="has no NumPy form"):
        on_arrays(casadi.Function("f", [X], [casadi.erfinv(X)]))
