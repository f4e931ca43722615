"""The eigenvalue race: a hundred thousand operating points of the brake over speed and Stribeck speed.

``C, by hand``
    eigenvalues.c on the finished matrices: about the least that eigenvalues can cost.
``numpy.linalg.eigvals``
    One batched call on the finished matrices, without finding operating points or Jacobians.
``halfarrow``
    `eigenvalue_map` from parameters: operating points, Jacobians and eigenvalues.
``loop of numpy``
    numpy called matrix by matrix, on a few of them.
``loop of linearize``
    What one would write with the framework itself, on a few of them.
"""

from __future__ import annotations

import ctypes
import json
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..oracles import brake as oracle
from .native import BaselineUnavailable, compiled
from .report import Limit, Report
from .timing import interleave

Array = NDArray[np.float64]
_Pointer = ctypes.POINTER(ctypes.c_double)

POINTS = 100_000
MANY = 1_000_000
FEW = 200
STATES = 5


def points(count: int = POINTS) -> dict[str, Array]:
    """Speeds and Stribeck speeds, on both sides of the edge."""
    rng = np.random.default_rng(7)
    return {"V0": rng.uniform(0.3, 1.6, count), "v_s": rng.uniform(0.05, 0.3, count)}


def matrices(where: dict[str, Array]) -> Array:
    """The brake's matrices of sliding by the reference's formula, and the line's lag below."""
    p = oracle.figure("fig9")
    slope = -(p.N0 * (p.mu_s - p.mu_k) / where["v_s"]) * np.exp(-where["V0"] / where["v_s"])
    a = np.zeros((len(slope), STATES, STATES))
    a[:, 0, 0] = -(p.b_t + slope * p.r_r**2) / p.J_r
    a[:, 0, 1] = slope * p.r_r / p.J_r
    a[:, 0, 2] = p.k_t / p.J_r
    a[:, 1, 0] = slope * p.r_r / p.m_f
    a[:, 1, 1] = -(p.b_f + slope) / p.m_f
    a[:, 1, 3] = -p.k_f / p.m_f
    a[:, 2, 0], a[:, 3, 1], a[:, 4, 4] = -1, 1, -1 / p.tau
    a[:, 0, 4], a[:, 1, 4] = -p.r_r * p.mu_k / p.J_r, p.mu_k / p.m_f
    return a


def by_hand(a: Array) -> NDArray[np.complex128]:
    """Eigenvalues by eigenvalues.c.

    Raises
    ------
    BaselineUnavailable
        if there is no working C compiler
    """
    function = compiled("eigenvalues.c").many_eigenvalues
    function.argtypes = [ctypes.c_longlong, ctypes.c_int, _Pointer, _Pointer]
    a = np.ascontiguousarray(a)
    found = np.empty(a.shape[:2], dtype=complex)
    results = found.view(float).ctypes.data_as(_Pointer)
    failed = function(len(a), a.shape[1], a.ctypes.data_as(_Pointer), results)
    if failed:
        raise ArithmeticError(f"{failed} of {len(a)} matrices have no eigenvalues")
    return found


def report(rounds: int, everything: bool) -> Report:
    """Race over all points; memory in a process of its own over ten times as many."""
    from bondgraph import eigenvalue_map, linearize, steady_state
    from bondgraph.models import bicycle_brake

    graph, where = bicycle_brake.graph(), points()
    a, base = matrices(where), oracle.parameters(oracle.figure("fig9"))
    try:
        by_hand(a[:1])
    except BaselineUnavailable as reason:
        return Report("eigenvalues", ("contestant",), [], notes=[f"C did not start: {reason}"])

    def linearized() -> None:
        for i in range(FEW // 10):
            own = base | {name: float(column[i]) for name, column in where.items()}
            np.linalg.eigvals(linearize(graph, at=steady_state(graph, own)).A)

    mapped = eigenvalue_map(graph, where, base)
    growth = np.linalg.eigvals(a).real.max(axis=1)
    error = np.abs(mapped.growth - growth).max() / np.abs(growth).max()
    timings = interleave(
        {
            "C, by hand": lambda: by_hand(a),
            "numpy.linalg.eigvals": lambda: np.linalg.eigvals(a),
            "halfarrow": lambda: eigenvalue_map(graph, where, base),
            "loop of numpy": lambda: [np.linalg.eigvals(one) for one in a[:FEW]],
            "loop of linearize": linearized,
        },
        rounds=rounds,
    )
    counts = {"loop of numpy": FEW, "loop of linearize": FEW // 10}
    each = {name: t.median / counts.get(name, POINTS) for name, t in timings.items()}
    unit = each["numpy.linalg.eigvals"]
    rows = [[name, f"{1 / cost:.3g}", f"{unit / cost:.2f}"] for name, cost in each.items()]
    peak = _peak()
    limits = [
        Limit("halfarrow's rate over numpy.linalg.eigvals'", unit / each["halfarrow"], 0.8, True),
        Limit("greatest error of growth, of its range", float(error), 1e-9),
        Limit(f"peak memory at {MANY:.0e} points, GiB", peak, 4),
    ]
    return Report("eigenvalues", ("contestant", "points a CPU s", "of numpy"), rows, limits)


def _peak() -> float:
    """Peak resident memory of a process that maps a million points, GiB."""
    command = [sys.executable, "-m", __name__]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root)
    return float(json.loads(done.stdout)["gib"])


def _main() -> None:
    from bondgraph import eigenvalue_map
    from bondgraph.models import bicycle_brake

    base = oracle.parameters(oracle.figure("fig9"))
    found = eigenvalue_map(bicycle_brake.graph(), points(MANY), base)
    assert np.isfinite(found.growth).all()
    kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({"gib": kib / 2**20}))


if __name__ == "__main__":
    _main()
