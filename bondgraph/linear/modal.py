"""Modal table: what each eigenvalue is, which elements carry it and which feed it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi
import numpy
import sympy

from ..codegen.program import Program
from ..codegen.to_casadi import to_casadi
from ..elements import OnePort, Storage
from ..equations import Equations
from ..steady import SteadyState
from .system import LinearSystem

# Beside the fastest eigenvalue, smaller real parts are rounding noise: the mode neither grows
# nor decays.
NEUTRAL = 1e-13
# Elements named as carrying a mode take part at least this much as the one that carries most.
DOMINANT = 0.5


@dataclass(frozen=True)
class Mode:
    """One eigenvalue and what it means.

    Attributes
    ----------
    eigenvalue : complex
        In 1/s.
    growth : int
        1 growing, -1 decaying, 0 neither.
    carriers : mapping of str to float
        Participation factors summed over each element's states, largest first;
        they add up to one.
    energies : mapping of str to float
        Share of each storage in the mode's energy, largest first; they add up
        to one. Empty where the energy is not positive or not known.
    feeds : mapping of str to float
        Contribution of each dissipator and source to the growth rate, 1/s,
        largest first: positive feeds the mode, negative drains it. They add up
        to the real part of the eigenvalue. Empty where `energies` is.

    Examples
    --------
    >>> import math
    >>> mode = Mode(complex(-3, 4), -1)
    >>> mode.damping_ratio, round(mode.frequency_hz * 2 * math.pi, 9)
    (0.6, 4.0)
    """

    eigenvalue: complex
    growth: int
    carriers: Mapping[str, float] = field(default_factory=dict)
    energies: Mapping[str, float] = field(default_factory=dict)
    feeds: Mapping[str, float] = field(default_factory=dict)

    @property
    def frequency_hz(self) -> float:
        """Frequency of the oscillation, Hz; zero for a real eigenvalue."""
        return abs(self.eigenvalue.imag) / (2 * math.pi)

    @property
    def natural_hz(self) -> float:
        """Undamped natural frequency, Hz."""
        return abs(self.eigenvalue) / (2 * math.pi)

    @property
    def damping_ratio(self) -> float | None:
        """Damping ratio; negative where growing, None for an eigenvalue at zero."""
        size = abs(self.eigenvalue)
        return -self.eigenvalue.real / size if size else None

    @property
    def time_constant(self) -> float:
        """Time in which the amplitude changes by a factor e, s."""
        return 1 / abs(self.eigenvalue.real) if self.growth else math.inf

    @property
    def stable(self) -> bool:
        """Whether the mode decays."""
        return self.growth < 0

    @property
    def elements(self) -> tuple[str, ...]:
        """Elements that carry the mode, largest first."""
        largest = max(self.carriers.values(), default=0.0)
        return tuple(
            name for name, share in self.carriers.items() if share >= DOMINANT * largest > 0
        )

    @property
    def telling(self) -> Mapping[str, float]:
        """The feeds, where they tell of this mode.

        That is where its carriers hold most of its energy; else the mode
        merely drives parts that hold more, and the balance is theirs.
        """
        held = sum(self.energies.get(name, 0.0) for name in self.elements)
        return self.feeds if held > 0.5 else {}


def growths(eigenvalues: numpy.ndarray) -> numpy.ndarray:
    """Say of each eigenvalue whether it grows (1), decays (-1) or neither (0).

    Parameters
    ----------
    eigenvalues : (..., n) complex array

    Returns
    -------
    (..., n) int array

    Examples
    --------
    >>> growths(numpy.array([1e-20 + 3j, -2.0])).tolist()
    [0, -1]
    """
    if not eigenvalues.size:
        return numpy.zeros(eigenvalues.shape, dtype=int)
    scale = numpy.abs(eigenvalues).max(axis=-1, keepdims=True)
    real = numpy.real(eigenvalues)
    return numpy.where(numpy.abs(real) > NEUTRAL * scale, numpy.sign(real), 0).astype(int)


def modal_table(system: LinearSystem) -> tuple[Mode, ...]:
    """Describe every eigenvalue of a linear system.

    Parameters
    ----------
    system : LinearSystem

    Returns
    -------
    tuple of Mode
        In the order of ``system.poles()``.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble, linearize
    >>> v = One("v")
    >>> graph = assemble("msd", Se("F", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 0.5)))
    >>> mode = modal_table(linearize(graph))[0]
    >>> mode.elements, round(mode.feeds["b"], 9)
    (('m', 'k'), -0.125)
    """
    poles = system.poles()
    shares = system.participation()
    vectors = system.shapes()
    flows = _Variations(system.at) if len(poles) else None
    grow = growths(poles)
    return tuple(
        Mode(
            complex(pole),
            int(grow[index]),
            _by_element(system.states, shares[:, index]),
            *(flows.balance(vectors[:, index], complex(pole)) if flows else ({}, {})),
        )
        for index, pole in enumerate(poles)
    )


def _by_element(states: tuple[str, ...], shares: numpy.ndarray) -> dict[str, float]:
    """Sum the shares of the states of each element."""
    totals: dict[str, float] = {}
    for state, share in zip(states, shares, strict=True):
        name = state.rpartition(".")[0] or state
        totals[name] = totals.get(name, 0.0) + float(share)
    return _largest_first(totals)


def _largest_first(values: Mapping[str, float]) -> dict[str, float]:
    # rounded, so that shares that are equal but for the last bit keep their order
    return dict(sorted(values.items(), key=lambda item: -float(f"{item[1]:.9g}")))


class _Variations:
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
            rows += [_port(equations, name, element.coenergy, element)]
            rows += [_port(equations, name, element.state, element)]
        for name in self.others:
            rows += [equations.ports[f"{name}.e"], equations.ports[f"{name}.f"]]
        self.matrix = _jacobian(point, rows)

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
        return _largest_first(held), _largest_first(told)


def _port(equations: Equations, name: str, symbol: sympy.Symbol, element: Storage) -> sympy.Expr:
    key = next(key for key, value in element.symbols.items() if value == symbol)
    return equations.ports[f"{name}.{key}"]


def _jacobian(point: SteadyState, rows: list[sympy.Expr]) -> numpy.ndarray:
    """Differentiate expressions in the equations' variables by the states, at a point.

    Algebraic variables follow the states.
    """
    equations = point.equations
    program = Program.pruned(
        "ports",
        [
            ("t", [equations.time]),
            ("x", (*equations.states, *equations.algebraic)),
            ("u", equations.inputs),
            ("p", equations.parameters),
        ],
        equations.assignments,
        {"rows": rows, "residuals": equations.residuals},
    )
    order = len(equations.states)
    x = casadi.SX.sym("x", order + len(equations.algebraic))
    u = [point.inputs[symbol.name] for symbol in equations.inputs]
    p = [point.parameters[symbol.name] for symbol in equations.parameters]
    found = [casadi.densify(casadi.jacobian(of, x)) for of in to_casadi(program)(0, x, u, p)]
    ports, residuals = (part.full() for part in casadi.Function("slopes", [x], found)(point.vector))
    if not equations.algebraic:
        return ports
    follow = numpy.linalg.solve(residuals[:, order:], -residuals[:, :order])
    return ports[:, :order] + ports[:, order:] @ follow
