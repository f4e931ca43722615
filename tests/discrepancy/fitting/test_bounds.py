"""Steps that a bound cuts off."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from bondgraph import I, One, R, Se, assemble, fit
from bondgraph.discrepancy.measurement import Measurement


def test_an_unknown_that_runs_into_its_bound_does_not_end_the_search():
    """Data that would have a negative quadratic drag, and twice the viscous one to make up for it.

    Cut off at zero, the quadratic part takes back what the viscous one was raised for; a step
    that is not solved anew promises a rise, which is no minimum.
    """
    b = sympy.Symbol("b", positive=True)
    more = sympy.Symbol("more", nonnegative=True)
    v = One("v")
    graph = assemble(
        "pushed",
        Se("push", 1) >> v >> (I("mass", 1), R("air", b)),
        v >> R("more", effort=lambda f: more * f * sympy.Abs(f)),
        parameters={b: 0.55, more: 0.01},
        outputs={"v": v.f},
    )
    t = np.linspace(0, 6, 301)
    run = solve_ivp(lambda _, v: 1 - 1.0 * v + 0.24 * v**2, (0, 6), [0], t_eval=t, rtol=1e-10)
    speed = run.y[0]
    best = minimize_scalar(
        lambda b: np.sum(((1 - np.exp(-b * t)) / b - speed) ** 2), (0.4, 0.8), tol=1e-10
    )
    found = fit(graph, Measurement(t, {"v": speed}), ["b", "more"], segments=None)
    assert found.outcome.ok and found.at_bounds == ("more",)
    assert found.values["b"] == pytest.approx(best.x, rel=1e-4)
