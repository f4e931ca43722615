"""A graph, its balances by hand, and what follows from the balances alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy

from bondgraph.graph import BondGraph

Expr = sympy.Expr


def rate(quantity: sympy.Symbol) -> sympy.Symbol:
    """Rate of a quantity, as balances use it."""
    return sympy.Symbol(f"d{quantity.name}", real=True)


def quantities(names: str) -> tuple[tuple[sympy.Symbol, ...], list[sympy.Symbol]]:
    """Quantities, and a list of these with their rates after them: ``x, (v, i, dv, di)``."""
    plain = tuple(sympy.Symbol(name, real=True) for name in names.split())
    return plain, [*plain, *map(rate, plain)]


@dataclass(frozen=True)
class Case:
    """One graph and its balances.

    Attributes
    ----------
    graph : BondGraph
    x : tuple of Symbol
        The quantities.
    balances : tuple of Expr
        Each is zero: in quantities, their rates, parameters and inputs. Rates enter linearly. One
        without rates ties the quantities.
    states : mapping of str to Expr
        The graph's states, in quantities.
    values : mapping of Symbol to number
        Values of the parameters, exact, for eigenvalues.
    rests : tuple of mappings
        Values of the quantities, where not zero, about which eigenvalues are wanted.
    """

    graph: BondGraph
    x: tuple[sympy.Symbol, ...]
    balances: tuple[Expr, ...]
    states: Mapping[str, Expr]
    values: Mapping[sympy.Symbol, object]
    rests: tuple[Mapping[sympy.Symbol, object], ...] = ({},)

    def rates(self) -> dict[str, Expr]:
        """Rates of the states in states, inputs and parameters, from the balances alone.

        Balances ``E dx = f(x)`` are combined by rows K with ``K E = dS/dx`` into the rates of the
        states ``s = S(x)``; where E is singular, rows that annul it tie x, with S, to the states.
        """
        x = list(self.x)
        left, right = self._split()
        states = sympy.Matrix(list(self.states.values()))
        rows = left.T.gauss_jordan_solve(states.jacobian(x).T)
        combined = rows[0].xreplace(dict.fromkeys(rows[1], sympy.Integer(0))).T
        named = [sympy.Symbol(name, real=True) for name in self.states]
        ties = [(row.T * right)[0] for row in left.T.nullspace()]
        meaning = [state - name for state, name in zip(states, named, strict=True)]
        (solution,) = sympy.solve([*meaning, *ties], x, dict=True)
        assert set(solution) == set(x)
        driven = sum(
            (states.diff(u) * sympy.Symbol(f"der({u})", real=True) for u in self.graph.inputs),
            sympy.zeros(len(states), 1),
        )
        found = (combined * right + driven).subs(solution)
        return dict(zip(self.states, found, strict=True))

    def poles(self, rest: Mapping[sympy.Symbol, object]) -> np.ndarray:
        """Roots of ``det(s E - A)``, exact until the roots, as complex numbers."""
        s, x = sympy.Symbol("s"), list(self.x)
        left, right = self._split()
        at = dict.fromkeys((*x, *self.graph.inputs), sympy.Integer(0)) | dict(rest)
        pencil = (s * left - right.jacobian(x)).subs(at).subs(dict(self.values))
        exact = sympy.Poly(pencil.det(), s)
        digits = [coefficient.evalf(40) for coefficient in exact.all_coeffs()]
        roots = sympy.Poly(digits, s).nroots(n=30, maxsteps=200) if exact.degree() else []
        return np.array([complex(root) for root in roots])

    def _split(self) -> tuple[sympy.Matrix, sympy.Matrix]:
        balances = sympy.Matrix(self.balances)
        changes = [rate(item) for item in list(self.x)]
        left = balances.jacobian(changes)
        return left, -balances.subs(dict.fromkeys(changes, 0))


def vanishes(expression: Expr) -> bool:
    """Whether an expression is zero for all values.

    Sines and cosines are made letters, and what is rational in all is added up exactly, fraction
    by fraction; the numerator must lie in the ideal of the circles. This takes a hundredth of the
    time of sympy's simplification, which is left for roots and exponentials.
    """
    angles = sorted({wave.args[0] for wave in expression.atoms(sympy.sin, sympy.cos)}, key=str)
    sines, cosines = (sympy.symbols(f"{name}_:{len(angles)}", real=True) for name in ("sin", "cos"))
    waves = (*map(sympy.sin, angles), *map(sympy.cos, angles))
    rational = expression.xreplace(dict(zip(waves, sines + cosines, strict=True)))
    others = sorted(rational.free_symbols - {*sines, *cosines}, key=str)
    symbols = (*sines, *cosines, *others)
    if not symbols or not rational.is_rational_function(*symbols):
        return sympy.simplify(expression) == 0
    top = sympy.field(symbols, sympy.QQ)[0].from_expr(rational).numer
    circles = [s**2 + c**2 - 1 for s, c in zip(sines, cosines, strict=True)]
    return top.rem([top.ring.from_expr(circle) for circle in circles]) == 0
