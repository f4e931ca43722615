"""What every random graph is held to: raw equations, eigenvalues, power."""

from __future__ import annotations

import random
from collections.abc import Mapping

import mpmath
import numpy as np

from bondgraph import Equations

from ..sketches import PRIME, Derived
from .formulae import precise
from .nesting import flat
from .pencil import Pencil, is_singular
from .plans import Plan
from .points import DIGITS, Point, UnsolvedError, left_over, matrix, values
from .raw import Rows

EXACT = mpmath.mpf(10) ** -12
# Eigenvalues this near are compared by their mean: of a multiple one, rounding leaves the mean.
NEAR = 1e-3


def same_transforms(plan: Plan, equations: Equations, seed: int) -> Pencil:
    """Compare a linear plan's pencil with its derived equations, exactly modulo a prime.

    Characteristic polynomials, which is all finite eigenvalues with their multiplicities; and
    the response of every port variable to random inputs and initial states.
    """
    rng = random.Random(seed)
    first, second = (rng.randrange(1, PRIME) for _ in range(2))
    pencil, derived = Pencil(plan), Derived(equations)
    at_first, at_second = pencil.determinant(first), pencil.determinant(second)
    assert at_first != 0, "derived, though the raw equations have no unique solution"
    assert (
        at_first * derived.determinant(second) % PRIME
        == at_second * derived.determinant(first) % PRIME
    ), "other eigenvalues than the raw equations"
    inputs = {name: rng.randrange(PRIME) for name in plan.inputs}
    start = {state.name: rng.randrange(PRIME) for state in equations.states}
    found = derived.solve(first, {f"u_{name}": value for name, value in inputs.items()}, start)
    begin = {flat(name).rpartition(".")[0]: value for name, value in start.items()}
    begin |= {flat(name): value for name, value in derived.dependent(start).items()}
    expected = pencil.solve(first, inputs, begin)
    assert {flat(name): value for name, value in found.items()} == expected
    return pencil


def same_eigenvalues(pencil: Pencil, equations: Equations) -> None:
    """Compare the finite eigenvalues of a pencil with those of A, in double precision."""
    expected = pencil.eigenvalues()
    rows = np.array(matrix(equations), dtype=float)
    found = np.linalg.eigvals(rows) if rows.size else np.zeros(0)
    assert len(found) == len(expected) == len(equations.states)
    for mine, theirs in clusters(found, expected):
        assert len(mine) == len(theirs), f"{mine} against {theirs}"
        size = 1 + abs(np.mean(theirs))
        assert abs(np.mean(mine) - np.mean(theirs)) <= 1e-8 * size, f"{mine} against {theirs}"


def clusters(found: np.ndarray, expected: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Group the eigenvalues of two spectra by nearness."""
    everything = np.concatenate([found, expected]).astype(complex)
    near = np.abs(everything[:, None] - everything) <= NEAR * (1 + np.abs(everything))
    group = np.arange(len(everything))
    for _ in everything:  # the least number spreads to all that hang together
        group = np.where(near | near.T, group, len(group)).min(axis=1, initial=len(group))
    mine, theirs = group[: len(found)], group[len(found) :]
    return [(found[mine == label], expected[theirs == label]) for label in np.unique(group)]


def follows_raw(
    plan: Plan,
    equations: Equations,
    seed: int,
    modes: Mapping[str, int] | None = None,
    given: Mapping | None = None,
    steps: int = 2,
) -> Point:
    """Walk along a random motion; at each step the raw equations hold, and power is kept.

    Raises
    ------
    UnsolvedError
        Where nonlinear loops were not solved, by the test, at a random state.
    """
    rows = Rows(plan, mpmath, precise)
    known = all(energy is not None for energy in equations.energies.values())
    with mpmath.workdps(DIGITS):
        start = point = Point(equations, seed, given)
        for step in range(steps):
            here = values(plan, point, modes)
            size = 1 + max(map(abs, (*here.e, *here.f)), default=0)
            worst, name = left_over(rows, here)
            assert worst <= EXACT * size**2, f"{name}: the raw equation is missed by {worst}"
            if known:
                energies_and_power(rows, point, here, size**2)
            if step + 1 < steps:
                point = point.after(mpmath.mpf("0.05"))
    return start


def energies_and_power(rows: Rows, point: Point, here, size) -> None:
    """Check what the equations say of energy and power at a point."""
    equations = point.equations
    stored = sum(equations.energies.values())
    assert abs(point.value(stored) - rows.energy(here.states)) <= EXACT * (
        1 + abs(point.value(stored))
    )
    supplied = point.total(equations.supplied.values())
    dissipated = point.total(equations.dissipated.values())
    (rate,) = point.change(stored)
    assert abs(supplied - dissipated - rate) <= EXACT * size, "power is made or lost"


def refused_rightly(plan: Plan, seed: int, modes: Mapping[str, int] | None = None) -> bool:
    """Whether the raw equations of a plan that was refused have no unique solution."""
    with mpmath.workdps(DIGITS):
        return is_singular(plan, Rows(plan, mpmath, precise), seed, modes)


def traits(equations: Equations) -> list[str]:
    """Return what is worth counting about equations."""
    return [
        label
        for label, holds in {
            "dependent": equations.dependent,
            "loop": equations.loops,
            "algebraic": equations.algebraic,
            "states": equations.states,
        }.items()
        if holds
    ]


__all__ = [
    "UnsolvedError",
    "follows_raw",
    "refused_rightly",
    "same_eigenvalues",
    "same_transforms",
    "traits",
]
