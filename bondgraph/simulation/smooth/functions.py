"""Smooth models as numbers: rates, residuals and powers, and what solves the residuals.

The form all solvers of smooth models share is semi-explicit: ``dx/dt = f`` and
``0 = g`` in states x and algebraic variables z; without z it is an ODE.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi
import numpy
import sympy

from ...codegen.program import Program
from ...codegen.to_casadi import to_casadi
from ...consistent import consistent, newton
from ...equations import Equations
from ...errors import SimulationError
from ...graph import TIME

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class SmoothFunctions:
    """Functions of ``(t, x, z, u, p)`` of a model without contacts.

    Attributes
    ----------
    n, nz, m, np : int
        Numbers of states, algebraic variables, inputs and parameters.
    names : tuple of str
        Of the algebraic variables.
    rates : casadi.Function
        To dx/dt (n,), residuals (nz,), supplied and dissipated power (2,).
    residual : casadi.Function
        To residuals (nz,), their Jacobian in z (nz, nz), and the size of the terms
        in each (nz,).
    slopes : casadi.Function
        To dx/dt, residuals, and the Jacobians of both by x and by z.
    step : casadi.Function, optional
        To the Newton step of the algebraic variables (nz,); None where there are none.
    """

    n: int
    nz: int
    m: int
    np: int
    names: tuple[str, ...]
    rates: casadi.Function
    residual: casadi.Function
    slopes: casadi.Function
    step: casadi.Function | None = None


def smooth_functions(equations: Equations, parameters: Sequence[sympy.Symbol]) -> SmoothFunctions:
    """Turn equations into functions.

    Parameters
    ----------
    equations : Equations
        Without contacts.
    parameters : sequence of Symbol
        Order of the parameter vector.

    Returns
    -------
    SmoothFunctions

    Examples
    --------
    >>> from bondgraph import C, R, Zero, assemble, derive
    >>> law = R("r", effort=lambda f: f + f**3)
    >>> functions = smooth_functions(derive(assemble("g", Zero("u") >> (C("c", 1), law))), ())
    >>> [float(part) for part in functions.rates(0, 10, 2, [], [])[:2]]
    [-2.0, 0.0]
    """
    program = Program.pruned(
        "smooth",
        [
            ("t", [TIME]),
            ("x", equations.states),
            ("z", equations.algebraic),
            ("u", equations.inputs),
            ("p", parameters),
        ],
        equations.assignments,
        {
            "rates": equations.derivatives,
            "residuals": equations.residuals,
            "powers": [
                sympy.Add(*equations.supplied.values()),
                sympy.Add(*equations.dissipated.values()),
            ],
        },
    )
    names = tuple(symbol.name for symbol in equations.algebraic)
    return from_rates(to_casadi(program), names)


def from_rates(rates: casadi.Function, names: tuple[str, ...]) -> SmoothFunctions:
    """Add the derivatives that solvers and checks need.

    Parameters
    ----------
    rates : casadi.Function
        ``(t, x, z, u, p)`` to dx/dt, residuals, powers.
    names : tuple of str
        Of the algebraic variables.

    Returns
    -------
    SmoothFunctions
    """
    sizes = [rates.numel_in(i) for i in range(5)]
    arguments = [casadi.SX.sym(label, size) for size, label in zip(sizes, "txzup", strict=True)]
    x, z, u = arguments[1:4]
    ode, alg, _ = rates(*arguments)
    f_x, f_z, g_x, g_z, g_u = (
        casadi.densify(casadi.jacobian(of, by))
        for of, by in ((ode, x), (ode, z), (alg, x), (alg, z), (alg, u))
    )
    terms = sum(
        (casadi.fabs(slope) @ casadi.fabs(by) for slope, by in ((g_x, x), (g_z, z), (g_u, u))),
        casadi.fabs(alg),
    )
    return SmoothFunctions(
        n=sizes[1],
        nz=sizes[2],
        m=sizes[3],
        np=sizes[4],
        names=names,
        rates=rates,
        residual=casadi.Function("residual", arguments, [alg, g_z, casadi.densify(terms)]),
        slopes=casadi.Function("slopes", arguments, [ode, alg, f_x, f_z, g_x, g_z]),
        step=_newton_step(arguments, alg, z) if names else None,
    )


def _newton_step(arguments: list[casadi.SX], alg: casadi.SX, z: casadi.SX) -> casadi.Function:
    """Return a function to the Newton step, by sparse factors."""
    parts = casadi.Function("parts", arguments, [alg, casadi.jacobian(alg, z)])
    given = [casadi.MX.sym("given", *argument.shape) for argument in arguments]
    left, matrix = parts(*given)
    return casadi.Function("step", given, [-casadi.solve(matrix, left, "qr")])


def solve_algebraic(
    functions: SmoothFunctions, t: float, x: Array, u: Array, p: Array, guess: Array
) -> Array | None:
    """Return algebraic values that fulfil their equations, the nearest to a guess by preference.

    Returns
    -------
    (nz,) array or None
        None where no start of the search leads to a solution.
    """
    return consistent(_residual(functions, t, x, u, p), guess) if functions.nz else guess


def polish(
    functions: SmoothFunctions, t: float, x: Array, u: Array, p: Array, z: Array
) -> Array | None:
    """Return algebraic values solved for to rounding from near ones; None where that fails."""
    return newton(_residual(functions, t, x, u, p), z) if functions.nz else z


def initial_algebraic(
    functions: SmoothFunctions, t: float, x: Array, u: Array, p: Array, guess: Array
) -> Array:
    """Return consistent initial values of the algebraic variables.

    Raises
    ------
    SimulationError
        Naming the variables and how to give a guess.
    """
    found = solve_algebraic(functions, t, x, u, p, guess)
    if found is None:
        names = ", ".join(functions.names)
        raise SimulationError(
            f"no values of the algebraic variables ({names}) fulfil their equations at the initial "
            f"state; check it and the laws, or give a guess: "
            f"initial={{{functions.names[0]!r}: 0.1}}",
            elements=functions.names,
        )
    return found


def _residual(functions: SmoothFunctions, t: float, x: Array, u: Array, p: Array) -> Any:
    def residual(z: Array) -> tuple[Array, Array, Array]:
        left, matrix, terms = functions.residual(t, x, z, u, p)
        return left.full().ravel(), matrix.full(), terms.full().ravel()

    return residual
