"""Raw equations of a plan: one residual for each thing an element or junction says.

Every effort, flow and state is an unknown; nothing knows causality. `residuals` takes any
arithmetic: fractions give the pencil of a linear plan, exactly, by probing with unit vectors;
mpmath's numbers give what is left over at a point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from .formulae import COUPLES, FOLLOWS, KINETIC, MODULATES, RESISTS, STORES
from .plans import FIELDS, JUNCTIONS, SIGNALS, STATE, Plan

Row = tuple[str, Any]


class Values(NamedTuple):
    """Numbers of all variables: of each bond, state, rate of state, input and mode."""

    e: Sequence[Any]
    f: Sequence[Any]
    states: Mapping[str, Any]
    rates: Mapping[str, Any]
    inputs: Mapping[str, Any]
    modes: Mapping[str, int] = {}


class Rows:
    """Writes the residuals of a plan.

    Parameters
    ----------
    plan : Plan
    functions : module
        sin, exp, ... of the arithmetic.
    number : callable
        Turns a fraction into a number of the arithmetic.
    """

    def __init__(
        self, plan: Plan, functions: Any = None, number: Callable[[Fraction], Any] = Fraction
    ) -> None:
        self.plan = plan
        self.m = functions
        self.number = number
        self.bonds = [plan.inwards(*bond) for bond in plan.bonds]
        self.at: dict[str, list[tuple[int, int]]] = {}
        for index, (tail, head) in enumerate(self.bonds):
            self.at.setdefault(tail, []).append((index, -1))
            self.at.setdefault(head, []).append((index, 1))

    def residuals(self, v: Values) -> list[Row]:
        """Return what each equation leaves over, by the name of its element."""
        found = []
        for name, part in self.plan.parts.items():
            found += [(name, value) for value in self._part(name, part, v)]
        return found

    def energy(self, states: Mapping[str, Any]) -> Any:
        """Return the energy stored in all."""
        total: Any = 0
        for name, part in self.plan.parts.items():
            numbers = [self.number(value) for value in part.numbers]
            if part.law.startswith("pseudo") and part.kind == "C":
                total += states[name]  # heat itself
            elif part.kind in STATE:
                formula = STORES[part.law.rpartition(" ")[2]].energy
                total += formula(self.m, states[name], numbers[0])
            elif part.ports and part.kind != "RField":
                x = [states[f"{name}.{port}"] for port in part.ports]
                given = self._coenergy(part, x)
                total += sum(a * b for a, b in zip(x, given, strict=True)) / 2
                if part.law in COUPLES:  # quartic: x grad = 4 energy
                    total -= COUPLES[part.law][0](*x[:2])
        return total

    def heard(self, name: str, v: Values) -> Any:
        """Return the value of a variable such as ``c.e``."""
        owner, _, letter = name.rpartition(".")
        if letter in ("q", "p", "y"):
            return v.states[owner]
        return (v.e if letter == "e" else v.f)[self.at[owner][0][0]]

    def _part(self, name: str, part: Any, v: Values) -> list[Any]:
        if part.kind in JUNCTIONS:
            return self._junction(part.kind, self.at[name], v)
        if part.kind in FIELDS:
            return self._field(name, part, v)
        numbers = [self.number(value) for value in part.numbers]
        heard = self.heard(part.heard, v) if part.heard else None
        if part.kind in ("TF", "GY"):
            ratio = numbers[0]
            if heard is not None:
                ratio = MODULATES[part.law](self.m, heard, ratio)
            return self._two_port(name, part.kind, ratio, v)
        if part.kind in SIGNALS:
            return [self._signal(part.kind, v.states[name], v.rates[name], heard, *numbers)]
        bond = self.at[name][0][0]
        e, f = v.e[bond], v.f[bond]
        if part.kind in ("Se", "Sf"):
            value = v.inputs[name] if heard is None else None
            if value is None:
                value = FOLLOWS[part.law](self.m, heard, numbers[0])
            return [(e if part.kind == "Se" else f) - value]
        if part.kind in ("De", "Df"):
            return [f if part.kind == "De" else e]
        if part.kind in ("R", "RS"):
            return self._resistor(name, part, numbers[0], heard, e, f, v)
        if part.kind in STATE:
            formula = STORES[part.law.rpartition(" ")[2]].law
            given, rate = (e, f) if part.kind == "C" else (f, e)
            law = formula(self.m, v.states[name], numbers[0])
            return [given - law, rate - v.rates[name]]
        return [self._switch(part, numbers, v.modes[name], e, f)]

    def _junction(self, kind: str, ends: list[tuple[int, int]], v: Values) -> list[Any]:
        shared, summed = (v.e, v.f) if kind == "0" else (v.f, v.e)
        first = shared[ends[0][0]]
        return [
            *(first - shared[bond] for bond, _ in ends[1:]),
            sum(sign * summed[bond] for bond, sign in ends),
        ]

    def sides(self, name: str) -> tuple[tuple[int, int], tuple[int, int]]:
        """In side, then out side of a two-port, as (bond, +1 where power goes in to out)."""
        # in the order written: `at` lists tails and heads in the order of bonds
        first, second = sorted(self.at[name])
        if first[1] < 0 < second[1]:
            first, second = second, first
        return first, (second[0], -second[1])

    def _two_port(self, name: str, kind: str, ratio: Any, v: Values) -> list[Any]:
        (into, s_in), (out, s_out) = self.sides(name)
        e_in, f_in, e_out, f_out = v.e[into], s_in * v.f[into], v.e[out], s_out * v.f[out]
        if kind == "TF":
            return [e_in - ratio * e_out, f_out - ratio * f_in]
        return [e_in - ratio * f_out, e_out - ratio * f_in]

    def _signal(self, kind: str, y: Any, rate: Any, heard: Any, gain: Any, constant: Any) -> Any:
        if kind == "Integrator":
            return rate - gain * heard
        if kind == "Lag":
            return constant * rate + y - gain * heard
        return rate + constant * y - gain * heard

    def _resistor(self, name, part, number, heard, e, f, v) -> list[Any]:
        if heard is not None:
            rows = [e - MODULATES[part.law](self.m, heard, number) * f]
        else:
            gives, _, formula = part.law.rpartition(" ")
            given, asked = (e, f) if gives == "flow" else (f, e)
            rows = [asked - RESISTS[formula](self.m, given, number)]
        if part.kind == "RS":
            heat = self.at[f"{name}_heat"][0][0]
            pseudo = part.law.startswith("pseudo")
            rows.append((v.f[heat] if pseudo else v.e[heat] * v.f[heat]) - e * f)
        return rows

    def _gradient(self, part: Any, x: list[Any]) -> list[Any]:
        rows = [
            sum(self.number(value) * other for value, other in zip(row, x, strict=True))
            for row in part.matrix
        ]
        if part.law in COUPLES:
            more = COUPLES[part.law][1](*x[:2])
            rows[:2] = [row + extra for row, extra in zip(rows, more, strict=False)]
        return rows

    def _coenergy(self, part: Any, states: list[Any]) -> list[Any]:
        if part.law not in ("compliance", "inertance"):
            return self._gradient(part, states)
        rows = [[self.number(value) for value in row] for row in part.matrix]
        return list(self.m.lu_solve(self.m.matrix(rows), self.m.matrix(states)))

    def _field(self, name: str, part: Any, v: Values) -> list[Any]:
        ports = [f"{name}.{port}" for port in part.ports]
        bonds = [self.at[port][0][0] for port in ports]
        kinds = list(part.ports.values())
        if part.kind == "RField":
            e, f = [v.e[bond] for bond in bonds], [v.f[bond] for bond in bonds]
            given, asked = (f, e) if part.law != "conductance" else (e, f)
            rows = self._gradient(part, given)
            if part.law == "cubic":
                rows[0] += given[0] ** 3
            return [a - b for a, b in zip(asked, rows, strict=True)]
        states = [v.states[port] for port in ports]
        coenergy = [v.e[b] if k == "C" else v.f[b] for b, k in zip(bonds, kinds, strict=True)]
        flows = [v.f[b] if k == "C" else v.e[b] for b, k in zip(bonds, kinds, strict=True)]
        if part.law in ("compliance", "inertance"):
            laws = zip(states, self._gradient(part, coenergy), strict=True)
        else:
            laws = zip(coenergy, self._gradient(part, states), strict=True)
        rates = [flow - v.rates[port] for flow, port in zip(flows, ports, strict=True)]
        return [a - b for a, b in laws] + rates

    def _switch(self, part: Any, numbers: list[Any], mode: int, e: Any, f: Any) -> Any:
        if mode == 0:
            return f
        if part.kind in ("Diode", "CheckValve"):
            return e - numbers[0] - numbers[1] * f
        if part.kind in ("Switch", "EndStop"):
            return e
        if part.kind == "Clutch":
            return e - mode * numbers[0]
        return e - mode * KINETIC[part.law](self.m, mode * f, numbers[0])
