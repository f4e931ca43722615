"""Bond graphs as bare lists, and their raw equations in exact arithmetic modulo a prime.

A `Sketch` names elements, values and bonds. `Sketch.graph` writes it in the language under test;
`Raw` writes down what each element and junction says, one row each, with every effort, flow and
state an unknown, and solves that linear pencil in a prime field. Nothing there knows causality,
and nothing is rounded: a wrong sign anywhere shows in the first comparison.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import sympy

from bondgraph import GY, TF, C, I, One, R, Se, Sf, Zero, assemble
from bondgraph.equations import Equations
from bondgraph.graph import BondGraph

PRIME = 2**61 - 1
JUNCTIONS = {"0": Zero, "1": One}
TWO_PORTS = {"TF": TF, "GY": GY}
ONE_PORTS = {"R": R, "C": C, "I": I, "Se": Se, "Sf": Sf}
STATES = {"C": "q", "I": "p"}


@dataclass(frozen=True)
class Sketch:
    """Elements by name as (kind, value), and bonds as (tail, head) in the order written.

    Sources have no value: each is an input named like its element. But a source in ``signals``
    follows a variable, such as ``c.e``, times a gain.
    """

    elements: dict[str, tuple[str, Fraction | None]]
    bonds: tuple[tuple[str, str], ...]
    signals: dict[str, tuple[str, Fraction]] = field(default_factory=dict)

    def of(self, *kinds: str) -> list[str]:
        return [name for name, (kind, _) in self.elements.items() if kind in kinds]

    def graph(self, symbolic: bool = False, name: str = "sketch") -> BondGraph:
        """Write the sketch with bonds and `assemble`, with numbers or with symbols as values."""
        made = {
            label: self._element(label, kind, value, symbolic)
            for label, (kind, value) in self.elements.items()
            if label not in self.signals
        }
        for label, (heard, gain) in self.signals.items():
            name, _, port = heard.partition(".")
            law = sympy.Rational(gain.numerator, gain.denominator) * getattr(made[name], port)
            made[label] = ONE_PORTS[self.elements[label][0]](label, law)
        free = [label for label in self.of("Se", "Sf") if label not in self.signals]
        inputs = [sympy.Symbol(f"u_{label}", real=True) for label in free]
        chains = [made[tail] >> made[head] for tail, head in self.bonds]
        return assemble(name, *made.values(), *chains, inputs=inputs)

    def _element(self, name, kind, value, symbolic):
        if kind in JUNCTIONS:
            return JUNCTIONS[kind](name)
        if kind in ("Se", "Sf"):
            return ONE_PORTS[kind](name, sympy.Symbol(f"u_{name}", real=True))
        number = sympy.Rational(value.numerator, value.denominator)
        law = sympy.Symbol(f"a_{name}", real=True, nonzero=True) if symbolic else number
        return (TWO_PORTS | ONE_PORTS)[kind](name, law)

    def renamed(self, names: dict[str, str]) -> Sketch:
        """Return the same sketch under other names."""
        return Sketch(
            {names[name]: what for name, what in self.elements.items()},
            tuple((names[tail], names[head]) for tail, head in self.bonds),
            {
                names[name]: (names[heard[:-2]] + heard[-2:], gain)
                for name, (heard, gain) in self.signals.items()
            },
        )

    def valued(self, values: dict[str, Fraction]) -> Sketch:
        """Return the same sketch with other values."""
        elements = {
            name: (kind, values.get(name, value)) for name, (kind, value) in self.elements.items()
        }
        return Sketch(elements, self.bonds, self.signals)

    @property
    def residues(self) -> dict[str, int]:
        """Values of the symbols of `graph`, modulo `PRIME`."""
        return {
            f"a_{name}": residue(value)
            for name, (_, value) in self.elements.items()
            if value is not None
        }


class Raw:
    """The pencil ``E z' = A z + B u`` of a sketch, over fractions, solved modulo `PRIME`.

    ``z`` holds e and f of every bond and the state of every storage.
    """

    def __init__(self, sketch: Sketch) -> None:
        self.sketch = sketch
        self.bonds = [self._inwards(*bond) for bond in sketch.bonds]
        self.storages = sketch.of("C", "I")
        self.sources = [name for name in sketch.of("Se", "Sf") if name not in sketch.signals]
        count = 2 * len(sketch.bonds)
        self.place = {name: count + index for index, name in enumerate(self.storages)}
        self.size = count + len(self.storages)
        self.rows: list[tuple[dict[int, Fraction], dict[int, Fraction], str | None]] = []
        for name in sketch.elements:
            self._write(name)
        assert len(self.rows) == self.size

    def _inwards(self, tail: str, head: str) -> tuple[str, str]:
        """A passive one-port takes power whichever way its arrow is drawn."""
        return (head, tail) if self.sketch.elements[tail][0] in "RCI" else (tail, head)

    def ends(self, name: str) -> list[tuple[int, int]]:
        """Bonds of an element as (index, +1 towards it or -1 away from it)."""
        return [
            (index, 1 if head == name else -1)
            for index, (tail, head) in enumerate(self.bonds)
            if name in (tail, head)
        ]

    def sides(self, name: str) -> list[tuple[int, int]]:
        """In side, then out side of a two-port, as (index, +1 where power goes in to out)."""
        first, second = self.ends(name)
        if first[1] < 0 < second[1]:
            first, second = second, first
        return [first, (second[0], -second[1])]

    def _write(self, name: str) -> None:
        kind, value = self.sketch.elements[name]
        if kind in JUNCTIONS:
            self._junction(kind, self.ends(name))
        elif kind in TWO_PORTS:
            self._two_port(kind, Fraction(value), self.sides(name))
        else:
            ((bond, _),) = self.ends(name)
            self._one_port(name, kind, value, 2 * bond, 2 * bond + 1)

    def _row(self, values, rates=None, source=None) -> None:
        """One equation: rates times z' is values times z, plus a source."""
        self.rows.append((values, rates or {}, source))

    def _junction(self, kind, ends) -> None:
        shared, summed = (0, 1) if kind == "0" else (1, 0)
        (first, _), *others = ends
        for bond, _ in others:
            self._row({2 * first + shared: 1, 2 * bond + shared: -1})
        total: dict[int, Fraction] = {}
        for bond, sign in ends:
            total[2 * bond + summed] = total.get(2 * bond + summed, 0) + sign
        self._row(total)

    def _two_port(self, kind, ratio, sides) -> None:
        (into, s_in), (out, s_out) = sides
        e_in, f_in, e_out, f_out = 2 * into, 2 * into + 1, 2 * out, 2 * out + 1
        if kind == "TF":
            self._row({e_in: 1, e_out: -ratio})
            self._row({f_out: s_out, f_in: -ratio * s_in})
        else:
            self._row({e_in: 1, f_out: -ratio * s_out})
            self._row({e_out: 1, f_in: -ratio * s_in})

    def _one_port(self, name, kind, value, e, f) -> None:
        if kind == "R":
            self._row({e: 1, f: -value})
        elif kind == "C":
            self._row({e: value, self.place[name]: -1})
            self._row({f: 1}, {self.place[name]: 1})
        elif kind == "I":
            self._row({f: value, self.place[name]: -1})
            self._row({e: 1}, {self.place[name]: 1})
        elif name in self.sketch.signals:
            heard, gain = self.sketch.signals[name]
            column, sign = self.named()[heard]
            row = {e if kind == "Se" else f: Fraction(-1)}
            row[column] = row.get(column, 0) + sign * gain
            self._row(row)
        else:
            self._row({e if kind == "Se" else f: -1}, source=name)

    def floats(self) -> tuple[np.ndarray, np.ndarray]:
        """E and A as float arrays, for a numeric eigenvalue solver."""
        e, a = np.zeros((self.size, self.size)), np.zeros((self.size, self.size))
        for row, (values, rates, _) in enumerate(self.rows):
            for column, value in rates.items():
                e[row, column] = value
            for column, value in values.items():
                a[row, column] = value
        return e, a

    def determinant(self, s: int) -> int:
        """``det(s E - A)`` modulo the prime: zero at a random s means a singular pencil."""
        return eliminate(self._matrix(s), [0] * self.size)[0]

    def solve(self, s: int, inputs: dict[str, int], start: dict[str, int]) -> dict[str, int]:
        """Laplace transforms at s of every variable, by name: ``name.e``, ``gear.f_out``, ``c.q``."""
        begin = {self.place[name]: value for name, value in start.items()}
        right = [
            sum(residue(value) * begin[column] for column, value in rates.items())
            + (0 if source is None else inputs[source])
            for _, rates, source in self.rows
        ]
        determinant, z = eliminate(self._matrix(s), right)
        assert determinant != 0
        return {name: sign * z[column] % PRIME for name, (column, sign) in self.named().items()}

    def named(self) -> dict[str, tuple[int, int]]:
        """Column and sign of every port variable and state, by qualified name."""
        found = {}
        for name, (kind, _) in self.sketch.elements.items():
            if kind in JUNCTIONS:
                bond, _ = self.ends(name)[0]
                found[f"{name}.e" if kind == "0" else f"{name}.f"] = (2 * bond + (kind == "1"), 1)
            elif kind in TWO_PORTS:
                for side, (bond, sign) in zip(("in", "out"), self.sides(name), strict=True):
                    found[f"{name}.e_{side}"] = (2 * bond, 1)
                    found[f"{name}.f_{side}"] = (2 * bond + 1, sign)
            else:
                ((bond, _),) = self.ends(name)
                found[f"{name}.e"], found[f"{name}.f"] = (2 * bond, 1), (2 * bond + 1, 1)
        return found | {
            f"{n}.{STATES[self.sketch.elements[n][0]]}": (c, 1) for n, c in self.place.items()
        }

    def _matrix(self, s: int) -> list[list[int]]:
        matrix = [[0] * self.size for _ in range(self.size)]
        for row, (values, rates, _) in enumerate(self.rows):
            for column, value in values.items():
                matrix[row][column] -= residue(value)
            for column, value in rates.items():
                matrix[row][column] += s * residue(value)
        return matrix


class Derived:
    """Derived equations of a linear graph, evaluated modulo `PRIME` with all parameters given.

    Every variable becomes a row of coefficients: states, then inputs (with their rates), then
    one for the constant.
    """

    def __init__(self, equations: Equations, parameters: dict[str, int] | None = None) -> None:
        self.equations = equations
        self.names = [symbol.name for symbol in (*equations.states, *equations.inputs)]
        self.width = len(self.names) + 1
        self.known: dict[sympy.Basic, list[int]] = {}
        for place, symbol in enumerate((*equations.states, *equations.inputs)):
            self.known[symbol] = [int(place == column) for column in range(self.width)]
        for symbol in equations.parameters:
            self.known[symbol] = self._constant(parameters[symbol.name])
        for symbol, expression in equations.assignments:
            self.known[symbol] = self.row(expression)

    def row(self, expression: sympy.Basic) -> list[int]:
        if expression in self.known:
            return self.known[expression]
        if expression.is_Rational:
            return self._constant(residue(Fraction(int(expression.p), int(expression.q))))
        if expression.is_Add:
            return [
                sum(column) % PRIME for column in zip(*map(self.row, expression.args), strict=True)
            ]
        if expression.is_Mul:
            total = self._constant(1)
            for argument in expression.args:
                total = self._times(total, self.row(argument))
            return total
        if expression.is_Pow and expression.exp.is_Integer:
            return self._constant(
                pow(self._number(self.row(expression.base)), int(expression.exp), PRIME)
            )
        raise AssertionError(f"{expression} is not linear arithmetic")

    @property
    def matrix(self) -> list[list[int]]:
        """A, modulo the prime."""
        size = len(self.equations.states)
        return [self.row(rate)[:size] for rate in self.equations.derivatives]

    def determinant(self, s: int) -> int:
        """``det(s - A)``, the characteristic polynomial at s."""
        return eliminate(self._pencil(s), [0] * len(self.equations.states))[0]

    def dependent(self, start: dict[str, int]) -> dict[str, int]:
        """States of dependent storages by element, where inputs are zero."""
        values = [start.get(name, 0) for name in self.names] + [1]
        return {
            name: self._dot(self.row(expression), values)
            for name, expression in self.equations.dependent.items()
        }

    def solve(self, s: int, inputs: dict[str, int], start: dict[str, int]) -> dict[str, int]:
        """Laplace transforms at s of every port variable, for inputs by symbol name."""
        size = len(self.equations.states)
        given = dict(inputs)
        for symbol, rate in self.equations.input_rates.items():
            given[rate.name] = s * given[symbol.name] % PRIME
        drive = [given[name] for name in self.names[size:]] + [0]
        right = [
            start[name] + self._dot(self.row(rate)[size:], drive)
            for name, rate in zip(self.names, self.equations.derivatives, strict=False)
        ]
        determinant, x = eliminate(self._pencil(s), right)
        assert determinant != 0
        return {
            name: self._dot(self.row(port), x + drive)
            for name, port in self.equations.ports.items()
        }

    def _pencil(self, s: int) -> list[list[int]]:
        return [
            [(s if row == column else 0) - value for column, value in enumerate(values)]
            for row, values in enumerate(self.matrix)
        ]

    def _constant(self, value: int) -> list[int]:
        return [0] * (self.width - 1) + [value % PRIME]

    def _number(self, row: list[int]) -> int:
        assert not any(row[:-1]), "a variable stands where only a number may"
        return row[-1]

    def _times(self, first: list[int], second: list[int]) -> list[int]:
        if any(first[:-1]):
            first, second = second, first
        factor = self._number(first)
        return [factor * value % PRIME for value in second]

    @staticmethod
    def _dot(row: list[int], values: list[int]) -> int:
        return sum(a * b for a, b in zip(row, values, strict=True)) % PRIME


def residue(value: Fraction | int) -> int:
    """Turn a fraction into its residue modulo the prime."""
    exact = Fraction(value)
    return exact.numerator * pow(exact.denominator, -1, PRIME) % PRIME


def eliminate(matrix: list[list[int]], right: list[int]) -> tuple[int, list[int]]:
    """Determinant and solution of a square system modulo the prime; no solution where singular."""
    rows = [[value % PRIME for value in (*row, b)] for row, b in zip(matrix, right, strict=True)]
    size, determinant = len(rows), 1
    for column in range(size):
        pivot = next((row for row in range(column, size) if rows[row][column]), None)
        if pivot is None:
            return 0, []
        if pivot != column:
            rows[column], rows[pivot] = rows[pivot], rows[column]
            determinant = -determinant
        top = rows[column]
        determinant = determinant * top[column] % PRIME
        scale = pow(top[column], -1, PRIME)
        top = rows[column] = [value * scale % PRIME for value in top]
        for row in range(size):
            factor = rows[row][column]
            if row != column and factor:
                rows[row] = [(a - factor * b) % PRIME for a, b in zip(rows[row], top, strict=True)]
    return determinant % PRIME, [row[-1] for row in rows]
