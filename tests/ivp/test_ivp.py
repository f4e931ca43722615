"""Circuits of the test set for initial value problems, against its reference solutions."""

import numpy as np
import pytest

from bondgraph import CompiledModel, Outcome, derive, simulate

from . import ring_modulator, transistor_amplifier


def digits(run, problem):
    """Correct digits of the worst unknown at the end."""
    found = np.array([run[f"y{k + 1}"][-1] for k in range(len(problem.REFERENCE))])
    return -np.log10(np.abs(found / problem.REFERENCE - 1).max())


def ended(problem, **options):
    run = simulate(problem.graph(), problem.T_END, t_eval=[0, problem.T_END], **options)
    assert run.outcome is Outcome.FINISHED
    return run


class TestRingModulator:
    def test_its_equations_are_the_published_ones(self):
        """At random points, all fifteen rates."""
        model = CompiledModel(ring_modulator.graph())
        equations = model.equations
        assert len(equations.states) == 15 and not equations.algebraic
        # the published unknowns in the order of the states: charges and fluxes are their multiples
        scale = {f"y{k}": ring_modulator.C0 for k in (1, 2)}
        scale |= {f"y{k}": ring_modulator.CS for k in (3, 4, 5, 6)} | {"y7": ring_modulator.CP}
        scale |= {"y8": -ring_modulator.LH, "y9": -ring_modulator.LH}
        scale |= {"y10": ring_modulator.LS2, "y11": ring_modulator.LS3}
        scale |= {"y12": ring_modulator.LS2, "y13": ring_modulator.LS3}
        scale |= {"y14": ring_modulator.LS1, "y15": ring_modulator.LS1}
        order = [equations.states.index(_state(equations, name)) for name in scale]
        factors = np.array(list(scale.values()))
        draw = np.random.default_rng(5)
        for _ in range(20):
            t, y = draw.uniform(0, 1e-3), draw.uniform(-0.3, 0.3, 15)
            x = np.zeros(15)
            x[order] = y * factors
            rates = np.array(model.smooth.rates(t, x, [], [], [])[0]).ravel()[order] / factors
            published = ring_modulator.published(t, y)
            # a sum of currents is exact to the rounding of the largest
            assert rates * factors == pytest.approx(published * factors, rel=1e-10, abs=1e-15)

    def test_five_digits_at_1e_8(self):
        assert digits(ended(ring_modulator, rtol=1e-8, solver="cvodes"), ring_modulator) >= 5


class TestTransistorAmplifier:
    def test_two_currents_stay_algebraic(self):
        equations = derive(transistor_amplifier.graph())
        assert len(equations.states) == 5
        assert len(equations.algebraic) == 2
        assert {loop.solved for loop in equations.loops} == {"linear", "algebraic"}

    @pytest.mark.parametrize("solver", ["auto", "idas", "rosenbrock"])
    def test_against_the_reference(self, solver):
        run = ended(transistor_amplifier, rtol=1e-8, solver=solver)
        assert digits(run, transistor_amplifier) >= 7
        assert abs(run.energy.relative_residual) < 1e-8


def _state(equations, output):
    """The state that an output is in proportion to."""
    (symbol,) = equations.substituted(equations.outputs[output]).free_symbols
    return symbol
