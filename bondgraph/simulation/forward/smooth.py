"""Sensitivities of smooth models: integrated beside the states, by the run's own solver.

The states are x and S = dx/dtheta column by column, the algebraic variables z and Z = dz/dtheta,
whose equations are the linearised ones. All of them are held to the tolerance.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import casadi
import numpy

from ...errors import SimulationError
from ..inputs import at
from ..smooth import SmoothFunctions, SmoothProblem, from_rates, integrate_smooth
from .result import Sensitivities

if TYPE_CHECKING:
    from ..trajectory import Trajectory

Array = numpy.ndarray


def augmented(functions: SmoothFunctions, q: int) -> SmoothFunctions:
    """Return functions of a model together with its linearisation in q directions.

    Parameters
    ----------
    functions : SmoothFunctions
    q : int

    Returns
    -------
    SmoothFunctions
        Of x, then the columns of S; z, then those of Z; p, then those of P.

    Examples
    --------
    >>> from bondgraph import C, One, R, assemble, CompiledModel
    >>> model = CompiledModel(assemble("rc", One("loop") >> (R("r", 2), C("c", 5))))
    >>> both = augmented(model.smooth, 1)
    >>> both.rates(0, [20, 1], [], [], [])[0].full().ravel().tolist()
    [-2.0, -0.1]
    """
    n, nz, m, np = functions.n, functions.nz, functions.m, functions.np
    t, u = casadi.SX.sym("t"), casadi.SX.sym("u", m)
    x, z, p = (
        casadi.SX.sym(label, size, 1 + q) for label, size in zip("xzp", (n, nz, np), strict=True)
    )
    ode, alg, powers = functions.rates(t, x[:, 0], z[:, 0], u, p[:, 0])
    place = casadi.vertcat(x[:, 0], z[:, 0], p[:, 0])
    both = casadi.jacobian(casadi.vertcat(ode, alg), place)
    moved = both @ casadi.vertcat(x[:, 1:], z[:, 1:], p[:, 1:])
    rates = casadi.Function(
        "augmented",
        [t, *(casadi.vec(part) for part in (x, z)), u, casadi.vec(p)],
        [
            casadi.densify(casadi.vec(casadi.horzcat(ode, moved[:n, :]))),
            casadi.densify(casadi.vec(casadi.horzcat(alg, moved[n:, :]))),
            powers,
        ],
    )
    names = [*functions.names, *(f"d{c}({name})" for c in range(q) for name in functions.names)]
    return from_rates(rates, tuple(names))


def beside(
    functions: SmoothFunctions,
    run: Trajectory,
    names: tuple[str, ...],
    seeds: Any,
    deadline: float,
) -> Sensitivities:
    """Return the sensitivities of a run by integrating it once more beside them.

    Parameters
    ----------
    functions : SmoothFunctions
        From `augmented`, for as many directions as names.
    run : Trajectory
    names : tuple of str
    seeds : callable
        Values and initial state to derivatives of parameters and of the initial state.
    deadline : float
        On the monotonic clock.

    Raises
    ------
    SimulationError
        Where the linearised equations cannot be integrated to the end of the run.
    """
    q = len(names)
    n, nz = functions.n // (1 + q), functions.nz // (1 + q)
    assert run.kept is not None
    own, options = run.kept.problem, run.kept.options
    assert isinstance(own, SmoothProblem)
    x0, z0, t0 = own.x0, own.z0, own.t_span[0]
    by_p, by_x = seeds(run.parameters, x0)
    p = numpy.array([run.parameters[symbol.name] for symbol in run.model.equations.parameters])
    p = numpy.concatenate([p, by_p.T.ravel()])
    x = numpy.concatenate([x0, by_x.T.ravel()])
    z = _consistent(functions, t0, x, at(own.inputs, numpy.array([t0]))[:, 0], p, z0)
    times = run.t
    if run.t_end > t0:
        problem = SmoothProblem(
            functions=functions,
            parameters=p,
            x0=x,
            z0=z,
            t_span=(t0, run.t_end),
            inputs=own.inputs,
            solver=own.solver,
            options=replace(
                options,
                atol=0.0,  # meant for states
                time_budget=max(deadline - time.monotonic(), 0.0),
                t_eval=times,
            ),
        )
        found = integrate_smooth(problem)
        if not found.outcome.ok:
            raise SimulationError(
                f"the sensitivities end at t = {found.t_end:g} s, before their run does "
                f"({found.outcome.value}): {found.outcome.advice}"
            )
        xs, zs, x, z = found.x, found.z, found.x_end, found.z_end
    else:
        xs, zs = numpy.tile(x, (len(times), 1)), numpy.tile(z, (len(times), 1))
    return Sensitivities(
        trajectory=run,
        wrt=names,
        x=xs.reshape(len(times), 1 + q, n)[:, 1:].transpose(2, 1, 0),
        x_end=x.reshape(1 + q, n)[1:].T,
        events=numpy.zeros((0, q)),
        z=zs.reshape(len(times), 1 + q, nz)[:, 1:].transpose(2, 1, 0),
        seeds=by_p,
    )


def _consistent(
    functions: SmoothFunctions, t: float, x: Array, u: Array, p: Array, z0: Array
) -> Array:
    """Return z and, by the linearised equations, Z at the start."""
    nz = len(z0)
    z = numpy.concatenate([z0, numpy.zeros(functions.nz - nz)])
    if nz:
        left, matrix, _ = functions.residual(t, x, z, u, p)
        inner = matrix.full()[:nz, :nz]
        z[nz:] = -numpy.linalg.solve(inner, left.full()[nz:].reshape(-1, nz).T).T.ravel()
    return z
