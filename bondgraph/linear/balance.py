"""Energy balance of a mode: who stores, who feeds, who drains."""

from __future__ import annotations

from collections.abc import Mapping

import numpy
import sympy

from ..elements import OnePort, Storage
from ..equations import Equations
from ..steady import SteadyState
from .variations import slopes


def largest_first(values: Mapping[str, float]) -> dict[str, float]:
    """Order shares: the largest first."""
    # rounded, so that shares that are equal but for the last bit keep their order
    return dict(sorted(values.items(), key=lambda item: -float(f"{item[1]:.9g}")))


class Balance:
    """Small changes of efforts and flows about a point, as linear functions of the states.

    In a mode the stored energy of the variations changes by what flows through
    the other one-ports, so that each one's part in the growth rate is its power
    divided by twice the energy.
    """

    def __init__(self, point: SteadyState) -> None:
        equations = point.equations
        elements = equations.graph.elements
        self.storages = [name for name, element in equations.graph.of(Storage)]
        self.others = [
            name
            for name, element in elements.items()
            if isinstance(element, OnePort) and not isinstance(element, Storage)
        ]
        tails = {bond.tail for bond in equations.graph.bonds}
        self.signs = [1.0 if name in tails else -1.0 for name in self.others]
        rows = []
        for name in self.storages:
            element = elements[name]
            assert isinstance(element, Storage)
            rows += [port_of(equations, name, element.coenergy)]
            rows += [port_of(equations, name, element.state)]
        for name in self.others:
            rows += [equations.ports[f"{name}.e"], equations.ports[f"{name}.f"]]
        self.matrix = slopes(point, rows).states

    def balance(
        self, vector: numpy.ndarray, pole: complex
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Return each storage's share in a mode's energy, and each other port's in its growth."""
        changes = (self.matrix @ vector).reshape(-1, 2)
        split = len(self.storages)
        works = (changes[:, 0].conj() * changes[:, 1]).real
        energy = works[:split].sum() / 2
        if not numpy.isfinite(works).all() or energy <= 0:
            return {}, {}
        held = {
            name: float(work / (2 * energy))
            for name, work in zip(self.storages, works[:split], strict=True)
        }
        parts = {
            name: float(sign * work / (2 * energy))
            for name, sign, work in zip(self.others, self.signs, works[split:], strict=True)
        }
        left = pole.real - sum(parts.values())
        if abs(left) > 1e-6 * abs(pole):
            parts["modulation"] = left
        threshold = 1e-9 * abs(pole)
        told = {name: part for name, part in parts.items() if abs(part) > threshold}
        return largest_first(held), largest_first(told)


def port_of(equations: Equations, name: str, symbol: sympy.Symbol) -> sympy.Expr:
    """Return an element's own variable in the equations' variables."""
    symbols = equations.graph.elements[name].symbols
    key = next(key for key, value in symbols.items() if value == symbol)
    return equations.ports[f"{name}.{key}"]
