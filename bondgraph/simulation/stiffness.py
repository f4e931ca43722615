"""Stiffness: whether an explicit integrator would be held up by modes long gone.

A mode that decays fast leaves the motion at once, but its rate bounds an explicit step to the
end: `span * |rate| / 3.3` steps, by the stability region of Dormand and Prince's method [1]_.

References
----------
.. [1] E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996,
   section IV.2.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy

from .buffered import evaluator
from .inputs import at
from .table import is_casadi

if TYPE_CHECKING:
    from .compiled import CompiledModel

Array = numpy.ndarray

REACH = 3.3  # of the stability region along the negative real axis
# Beside fewer steps than these, setting up an implicit integrator costs more: 10 ms, a step of
# compiled code a microsecond. Its matrices are dense: 7 s for a ladder of 1000 capacitors.
MANY = 20_000
FEW_STATES = 30
# A fast mode holds an integrator up where the motion itself needs so many times fewer steps.
SLOWER = 10.0
DAMPED = 0.5  # least share of decay in a rate; a fast oscillation has to be followed
GONE = 30.0  # decay times after which a mode has left the motion
STEPS_A_RADIAN = 2.0
# Implicit Euler steps, in shares of the run, after which the rates are looked at again: rates of a
# nonlinear model may be far from those at its start, such as at Robertson's zero concentrations.
LOOKS = (1e-9, 1e-7, 1e-5, 1e-3)
DENSE = 64  # states up to which all eigenvalues are computed
ROUNDS = 24  # of the power method beyond


@dataclass(frozen=True)
class Stiffness:
    """What an explicit integrator would be held up by.

    Attributes
    ----------
    rate : float
        Of the fastest well-damped mode, 1/s; zero where there is none.
    steps : float
        That its stability would take over the run.
    needed : float
        That the motion itself needs, by a rough estimate.
    many : float
        Steps from which on an implicit integrator is cheaper.

    Examples
    --------
    >>> Stiffness(-1e6, 1e6 / 3.3, 100.0).stiff
    True
    """

    rate: float
    steps: float
    needed: float
    many: float = MANY

    @property
    def stiff(self) -> bool:
        """Whether an implicit integrator is the better choice."""
        return self.steps > self.many and self.steps > SLOWER * self.needed


class Probe:
    """Rates of a model's modes along a rough preview of its run.

    Parameters
    ----------
    model : CompiledModel
        Without switching elements.
    """

    def __init__(self, model: CompiledModel) -> None:
        rhs = model.modes.functions(0).rhs
        self._n = model.modes.n
        self._slopes = _slopes(rhs, self._n) if is_casadi(rhs) and self._n else None
        self._lock = threading.Lock()  # the function keeps its arguments in one place

    def __call__(
        self, span: tuple[float, float], x: Array, p: Array, inputs: Any, looks: Any = LOOKS
    ) -> Stiffness:
        """Return the stiffest point of a preview that starts in x.

        Parameters
        ----------
        span : (float, float)
            Start and end, s.
        x : (n,) array
        p : (np,) array
        inputs : InputTable or callable
        looks : sequence of float
            Lengths of the preview's steps, in shares of the span; none for x alone.
        """
        worst = Stiffness(0.0, 0.0, 0.0)
        if self._slopes is None:
            return worst
        length = span[1] - span[0]
        u = at(inputs, numpy.array(span[:1]))[:, 0]
        with self._lock, numpy.errstate(all="ignore"):
            for slopes in self._preview(span[0], x, u, p, [length * share for share in looks]):
                found = _judged(slopes, length)
                found = replace(
                    found,
                    needed=max(found.needed, len(getattr(inputs, "knots", ()))),
                    many=MANY * max(1.0, self._n / FEW_STATES),
                )
                if found.stiff and found.steps > worst.steps:
                    worst = found
        return worst

    def _preview(self, t: float, x: Array, u: Array, p: Array, steps: list[float]) -> Iterator[Any]:
        """Give the Jacobian at the start, and after implicit Euler steps."""
        assert self._slopes is not None
        for step in (*steps, None):
            rates, jacobian = self._slopes(t, x, u, p)
            if not numpy.isfinite(rates).all():
                return
            yield jacobian
            if step is None or self._n > DENSE:
                return
            try:
                x = x + numpy.linalg.solve(numpy.eye(self._n) / step - jacobian, rates)
            except numpy.linalg.LinAlgError:
                return
            t += step


def _slopes(rhs: Any, n: int) -> Callable[..., tuple[Array, Any]]:
    """Return a function of ``(t, x, u, p)`` to rates and their Jacobian, dense only if small."""
    import casadi

    given = [casadi.SX.sym("a", rhs.numel_in(i)) for i in range(5)]
    rates = rhs(*given)[:n]
    jacobian = casadi.jacobian(rates, given[1])
    if n <= DENSE:
        both = casadi.Function("slopes", given, [casadi.densify(casadi.veccat(rates, jacobian))])
        call = evaluator(both)

        def small(t: float, x: Array, u: Array, p: Array) -> tuple[Array, Array]:
            values = call(t, x, u, p, 0.0)
            return values[:n], values[n:].reshape(n, n).T

        return small
    sparse = casadi.Function("slopes", given, [casadi.densify(rates), jacobian])

    def large(t: float, x: Array, u: Array, p: Array) -> tuple[Array, Any]:
        values, matrix = sparse(t, x, u, p, [])
        return values.full().ravel(), matrix

    return large


def _judged(jacobian: Any, length: float) -> Stiffness:
    """Judge one Jacobian for a run of some length."""
    if not isinstance(jacobian, numpy.ndarray):
        return _of_rates(numpy.array([_dominant(jacobian)]), length)
    # no eigenvalue exceeds this; most models are decided by it
    bound = numpy.abs(jacobian).sum(axis=1).max()
    if not math.isfinite(bound) or bound * length <= MANY * REACH:
        return Stiffness(0.0, 0.0, 0.0)
    return _of_rates(numpy.linalg.eigvals(jacobian), length)


def _of_rates(rates: Array, length: float) -> Stiffness:
    size = numpy.abs(rates)
    damped = -rates.real > DAMPED * size
    if not damped.any():
        return Stiffness(0.0, 0.0, 0.0)
    fastest = numpy.flatnonzero(damped)[numpy.argmax(size[damped])]
    decay = numpy.maximum(-rates.real, 0.0)
    lasts = numpy.minimum(length, GONE / numpy.maximum(decay, GONE / length))
    swings = numpy.abs(rates.imag) > size * math.sqrt(1 - DAMPED**2)
    needed = numpy.where(swings, STEPS_A_RADIAN * size * lasts, GONE)
    return Stiffness(
        float(rates.real[fastest]), float(length * size[fastest] / REACH), float(needed.max())
    )


def _dominant(matrix: Any) -> complex:
    """Return the largest eigenvalue of a sparse matrix where it is real; zero where it is not."""
    import casadi

    # no fixed pattern, so that no mode is left out for its shape
    v = numpy.modf(numpy.arange(1, matrix.shape[0] + 1) * 0.6180339887498949)[0] - 0.5
    rate = 0.0
    for _ in range(ROUNDS):
        size = numpy.linalg.norm(v)
        if not (math.isfinite(size) and size > 0):
            return 0.0
        v = v / size
        moved = casadi.mtimes(matrix, v).full().ravel()
        rate = float(v @ moved)
        off, v = moved - rate * v, moved
    return rate if numpy.linalg.norm(off) < 0.5 * abs(rate) else 0.0
