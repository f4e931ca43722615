"""Whether an expression is zero, by its value modulo a large prime at a random point.

Quicker than simplification, and sure of what is rational: a sum that is zero has
residue zero, and one that is not has it with a chance of 1 to 10^18. Sine and
cosine keep to the unit circle; other functions count as unknown quantities.
"""

from __future__ import annotations

import random

import sympy

PRIME = 2**61 - 1


class Residues:
    """Residues of symbols and expressions; the same for equal expressions.

    Examples
    --------
    >>> a, b = sympy.symbols("a b")
    >>> residues = Residues()
    >>> residues.is_zero((a + b) ** 2 - a**2 - 2 * a * b - b**2)
    True
    >>> residues.is_zero(sympy.sin(a) ** 2 + sympy.cos(a) ** 2 - b)
    False
    """

    def __init__(self) -> None:
        self._known: dict[sympy.Basic, int] = {}
        self._random = random.Random(0)

    def define(self, symbol: sympy.Symbol, value: sympy.Expr) -> None:
        """Let a symbol stand for an expression."""
        self._known[symbol] = self.of(value)

    def is_zero(self, value: sympy.Expr) -> bool:
        """Whether an expression is zero for all values of its symbols."""
        if value.is_Rational:
            return bool(value == 0)
        return self.of(value) == 0

    def of(self, value: sympy.Basic) -> int:
        """Return the residue of an expression."""
        if value not in self._known:
            self._known[value] = self._compute(value)
        return self._known[value]

    def _compute(self, value: sympy.Basic) -> int:
        if isinstance(value, sympy.Rational):
            return int(value.p) * pow(int(value.q), -1, PRIME) % PRIME
        if isinstance(value, sympy.Add):
            return sum(map(self.of, value.args)) % PRIME
        if isinstance(value, sympy.Mul):
            product = 1
            for factor in value.args:
                product = product * self.of(factor) % PRIME
            return product
        if isinstance(value, sympy.Pow) and isinstance(value.exp, sympy.Integer):
            base = self.of(value.base)
            # no inverse: a division by zero, which is nothing to be called zero
            return pow(base, int(value.exp), PRIME) if base else self._random.randrange(1, PRIME)
        if isinstance(value, sympy.sin | sympy.cos):
            half = self.of(sympy.Function("half")(value.args[0]))
            scale = pow(1 + half * half, -1, PRIME)
            top = 2 * half if isinstance(value, sympy.sin) else 1 - half * half
            return top * scale % PRIME
        return self._random.randrange(1, PRIME)
