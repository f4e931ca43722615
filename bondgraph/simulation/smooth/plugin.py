"""CasADi's integrators, scaled and silent: over one stretch of time at a call.

Output times are built into a CasADi integrator, so time runs from 0 to 1 in each
and its start and length are parameters. So are the sizes of the states, which
makes one absolute tolerance fit all. An integrator object must not be used by two
threads: each run builds its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi
import numpy

from .functions import SmoothFunctions
from .quiet import quiet

Array = numpy.ndarray

# SUNDIALS bounds the error of one step, of which many add up; measured on stiff problems, a
# hundredth of the tolerance leaves an error like that of one-step methods, at twice the steps.
SHARPER = {"cvodes": 1e-2, "idas": 1e-2, "rosenbrock": 1.0}
TIGHTEST = 1e-13
# Below this share of its largest value so far, a state's error is measured absolutely; that of an
# algebraic variable, which remembers nothing and is solved anew in each row, is so everywhere.
FLOOR = 1e-3


class Failed(Exception):  # an answer within this folder, not an error
    """A stretch could not be integrated.

    Attributes
    ----------
    steps : int
        Taken in vain.
    work : bool
        Whether it was for the number of steps.
    """

    def __init__(self, steps: int = 0, *, work: bool = False) -> None:
        super().__init__("a stretch could not be integrated")
        self.steps, self.work = steps, work


@dataclass(frozen=True, eq=False)
class Stretch:
    """What an integrator gave, at k times.

    Attributes
    ----------
    x : (n, k) array
    z : (nz, k) array
    work : (2, k) array
        Energies supplied and dissipated on the way, J.
    steps : int
    """

    x: Array
    z: Array
    work: Array
    steps: int


class Plugin:
    """One CasADi integrator, built anew for each pattern of output times.

    Parameters
    ----------
    functions : SmoothFunctions
    solver : {"cvodes", "idas", "rosenbrock"}
    rtol, atol : float
    max_step : float
        Longest step, s.

    Examples
    --------
    >>> from bondgraph import C, R, Zero, assemble, derive
    >>> from bondgraph.simulation.smooth.functions import smooth_functions
    >>> graph = assemble("rc", Zero("u") >> (C("c", 1), R("r", 1)))
    >>> plugin = Plugin(smooth_functions(derive(graph), ()), "cvodes", 1e-9, 0.0, float("inf"))
    >>> one, none = numpy.ones(1), numpy.zeros(0)
    >>> got = plugin((1.0,), (0.0, 2.0), one, none, numpy.zeros((4, 0)), none, (one, none))
    >>> round(float(got.x[0, 0]), 7)
    0.1353353
    """

    def __init__(
        self, functions: SmoothFunctions, solver: str, rtol: float, atol: float, max_step: float
    ) -> None:
        self.solver = solver
        self._rtol = max(rtol * SHARPER[solver], TIGHTEST)
        self._atol = atol / (FLOOR * rtol)
        self._max_step = max_step
        self._problem = _scaled(functions)
        self._n, self._nz = functions.n, functions.nz
        self._built: dict[tuple[Any, ...], casadi.Function] = {}

    @property
    def built(self) -> int:
        """Number of patterns met so far."""
        return len(self._built)

    def __call__(
        self,
        pattern: tuple[float, ...],
        time: tuple[float, float],
        x: Array,
        z: Array,
        inputs: Array,
        p: Array,
        sizes: tuple[Array, Array],
        max_steps: int = 5000,
    ) -> Stretch:
        """Integrate over one stretch.

        Parameters
        ----------
        pattern : tuple of float
            Output times as shares of the stretch, rising, the last one 1.
        time : (float, float)
            Start and length, s.
        x, z : (n,), (nz,) array
            Consistent values at the start.
        inputs : (4, m) array
            Coefficients of the powers 0 to 3 of the time since the start.
        p : (np,) array
        sizes : ((n,) array, (nz,) array)
            What states and algebraic variables are measured by.
        max_steps : int
            Between two output times.

        Raises
        ------
        Failed
        """
        size_x, size_z = sizes[0] + self._atol, sizes[1] / FLOOR + self._atol
        start = numpy.append(x / size_x, [0.0] if not self._n else [])
        arguments = numpy.concatenate([time, inputs.ravel(), p, size_x, size_z])
        integrator = self._integrator(pattern, time[1], max_steps)
        with quiet():
            try:
                got = integrator(x0=start, z0=z / size_z, p=arguments)
            except RuntimeError as error:
                work = "TOO_MUCH_WORK" in str(error)
                taken = int(integrator.stats().get("n_steps", max_steps if work else 0))
                raise Failed(taken, work=work or taken >= max_steps) from None
        stats = integrator.stats()
        stretch = Stretch(
            got["xf"].full()[: self._n] * size_x[:, None],
            got["zf"].full().reshape(self._nz, len(pattern)) * size_z[:, None],
            got["qf"].full(),
            int(stats.get("nsteps", stats.get("n_steps", 0))),
        )
        if not all(numpy.isfinite(part).all() for part in (stretch.x, stretch.z, stretch.work)):
            raise Failed(stretch.steps)
        return stretch

    def _integrator(
        self, pattern: tuple[float, ...], length: float, max_steps: int
    ) -> casadi.Function:
        longest = 0.0
        if self._max_step < length:
            # rounded down to a power of two, so that stretches of all lengths share a few
            longest = 2.0 ** numpy.floor(numpy.log2(self._max_step / length))
        key = (pattern, max_steps, longest)
        if key not in self._built:
            options = {
                "reltol": self._rtol,
                "abstol": FLOOR * self._rtol,
                "max_num_steps": max_steps,
                "quad_err_con": False,
                "show_eval_warnings": False,
            }
            if self.solver != "rosenbrock":
                options["disable_internal_warnings"] = True
            if longest:
                options["max_step_size"] = longest
            self._built[key] = casadi.integrator(
                "run", self.solver, self._problem, 0.0, list(pattern), options
            )
        return self._built[key]


def _scaled(functions: SmoothFunctions) -> dict[str, casadi.SX]:
    """Write the equations in scaled time, states and algebraic variables."""
    symbol = casadi.SX.sym
    n, nz, m = functions.n, functions.nz, functions.m
    tau, y, w = symbol("tau"), symbol("y", max(n, 1)), symbol("w", nz)
    start, length = symbol("start"), symbol("length")
    u, slope, bend, twist = (symbol(name, m) for name in ("u", "slope", "bend", "twist"))
    p = symbol("p", functions.np)
    size_x, size_z = symbol("size_x", n), symbol("size_z", nz)
    passed = length * tau
    inputs = u + passed * (slope + passed * (bend + passed * twist))
    ode, alg, powers = functions.rates(
        start + passed, y * size_x if n else size_x, w * size_z, inputs, p
    )
    rates = length * ode / size_x if n else casadi.SX.zeros(1)
    return {
        "t": tau,
        "x": y,
        "z": w,
        "p": casadi.vertcat(start, length, u, slope, bend, twist, p, size_x, size_z),
        "ode": rates,
        "alg": alg,
        "quad": length * powers,
    }
