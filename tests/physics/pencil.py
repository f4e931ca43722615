"""The matrix pencil of a plan, from its raw equations: assembled without causality, exactly.

Also whether the raw equations of a plan that is not linear have a unique solution, nearly always:
by the pencil of their slopes at a random point.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from ..sketches import PRIME, eliminate, residue
from .plans import JUNCTIONS, Plan
from .raw import Rows, Values


class Pencil:
    """The pencil ``E z' = A z + B u`` of a linear plan; z holds e and f of all bonds, and states.

    Exact: the coefficients are what residuals of fractions are at unit vectors.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.rows = Rows(plan)
        self.count = len(plan.bonds)
        self.states = list(plan.storages)
        self.size = 2 * self.count + len(self.states)
        self.place = {name: 2 * self.count + k for k, name in enumerate(self.states)}
        self.A = [self._probe(z=column) for column in range(self.size)]
        self.E = {self.place[name]: self._probe(rate=name) for name in self.states}
        self.B = {name: self._probe(source=name) for name in plan.inputs}

    def _probe(self, z: int = -1, rate: str = "", source: str = "") -> list[tuple[int, Fraction]]:
        """Return the coefficients of one unknown, rate or input: row and value, where not zero."""
        zero, one = Fraction(0), Fraction(1)
        unit = [one if index == z else zero for index in range(self.size)]
        values = Values(
            unit[: self.count],
            unit[self.count : 2 * self.count],
            dict(zip(self.states, unit[2 * self.count :], strict=True)),
            {name: one if name == rate else zero for name in self.states},
            {name: one if name == source else zero for name in self.plan.inputs},
        )
        found = self.rows.residuals(values)
        assert len(found) == self.size, "as many equations as unknowns"
        return [(row, value) for row, (_, value) in enumerate(found) if value]

    def _matrix(self, s: int) -> list[list[int]]:
        """``s E - A`` modulo the prime, up to the sign of all."""
        matrix = [[0] * self.size for _ in range(self.size)]
        for column, entries in enumerate(self.A):
            for row, value in entries:
                matrix[row][column] = residue(value)
        for column, entries in self.E.items():
            for row, value in entries:
                matrix[row][column] = (matrix[row][column] + s * residue(value)) % PRIME
        return matrix

    def determinant(self, s: int) -> int:
        """``det(s E - A)`` modulo the prime, up to a sign; zero at random: a singular pencil."""
        return eliminate(self._matrix(s), [0] * self.size)[0]

    def solve(self, s: int, inputs: Mapping[str, int], start: Mapping[str, int]) -> dict[str, int]:
        """Laplace transforms at s of all port variables and states, by name."""
        right = [0] * self.size
        for name, entries in self.E.items():
            begin = start[self.states[name - 2 * self.count]]
            for row, value in entries:
                right[row] += residue(value) * begin
        for name, entries in self.B.items():
            for row, value in entries:
                right[row] -= residue(value) * inputs[name]
        determinant, z = eliminate(self._matrix(s), right)
        assert determinant != 0
        return {name: sign * z[column] % PRIME for name, (column, sign) in self.named().items()}

    def named(self) -> dict[str, tuple[int, int]]:
        """Column and sign of every port variable and state, by qualified name."""
        found = {}
        for end, ends in self.rows.at.items():
            kind, bond = self.plan.kind(end), ends[0][0]
            if kind in JUNCTIONS:
                letter = "e" if kind == "0" else "f"
                found[f"{end}.{letter}"] = (bond + self.count * (letter == "f"), 1)
            elif kind in ("TF", "GY"):
                for side, (index, sign) in zip(("in", "out"), self.rows.sides(end), strict=True):
                    found[f"{end}.e_{side}"] = (index, 1)
                    found[f"{end}.f_{side}"] = (index + self.count, sign)
            else:
                found[f"{end}.e"], found[f"{end}.f"] = (bond, 1), (bond + self.count, 1)
        letters = self.plan.storages
        return found | {f"{name}.{letters[name]}": (self.place[name], 1) for name in self.states}

    def eigenvalues(self, shift: float = 0.7310585) -> np.ndarray:
        """Finite eigenvalues, by shift and inversion, which sends the infinite ones to zero.

        ``E`` has columns for states only, so that ``(s E - A)^-1 E`` has all its eigenvalues
        other than zero in the block of the states.
        """
        a, e = np.zeros((self.size, self.size)), np.zeros((self.size, self.size))
        for column, entries in enumerate(self.A):
            for row, value in entries:
                a[row, column] = -value
        for column, entries in self.E.items():
            for row, value in entries:
                e[row, column] = value
        inverse = np.linalg.solve(shift * e - a, e[:, 2 * self.count :])[2 * self.count :]
        inverted = np.linalg.eigvals(inverse) if inverse.size else np.zeros(0)
        return shift - 1 / inverted[np.abs(inverted) > 1e-7]


def is_singular(plan: Plan, rows: Rows, seed: int, modes: Mapping[str, int] | None = None) -> bool:
    """Whether the raw equations, linearised at a random point, have no unique solution.

    Slopes are differences in mpmath's digits; what should vanish has far fewer digits left.
    """
    m, rng = rows.m, random.Random(seed)
    digits = m.mp.dps
    delta = m.mpf(10) ** (-digits // 2)
    count, states = len(plan.bonds), list(plan.storages)
    size = 2 * count + len(states)
    start = [m.mpf(rng.uniform(0.2, 0.8)) for _ in range(size)]
    rates = [m.mpf(rng.uniform(0.2, 0.8)) for _ in states]
    inputs = {name: m.mpf(rng.uniform(0.2, 0.8)) for name in plan.inputs}

    def at(z: list[Any], slopes: list[Any]) -> list[Any]:
        named = dict(zip(states, z[2 * count :], strict=True))
        moving = dict(zip(states, slopes, strict=True))
        v = Values(z[:count], z[count : 2 * count], named, moving, inputs, modes or {})
        return [value for _, value in rows.residuals(v)]

    here, s = at(start, rates), m.mpf(rng.uniform(1, 2))
    columns = []
    for column in range(size):
        nudged = [v + delta * (k == column) for k, v in enumerate(start)]
        place = column - 2 * count
        moved = [v + delta * s * (k == place) for k, v in enumerate(rates)]
        ahead = at(nudged, moved)
        columns.append([(value - old) / delta for value, old in zip(ahead, here, strict=True)])
    return smallest_pivot(columns) < m.mpf(10) ** (-digits // 4)


def smallest_pivot(rows: list[list[Any]]) -> Any:
    """Return the least pivot of an elimination that takes the largest in each column."""
    rows, least = [list(row) for row in rows], None
    for column in range(len(rows)):
        best = max(range(column, len(rows)), key=lambda row: abs(rows[row][column]))
        rows[column], rows[best] = rows[best], rows[column]
        top = rows[column]
        least = abs(top[column]) if least is None else min(least, abs(top[column]))
        if top[column] == 0:
            return least
        for row in rows[column + 1 :]:
            if row[column]:
                factor = row[column] / top[column]
                row[column:] = [
                    a - factor * b for a, b in zip(row[column:], top[column:], strict=True)
                ]
    return least
