"""Signs of polynomials under the assumptions of their symbols, and what they leave to ask."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from .rational import Poly, Polynomials
from .tidy import factors

MAX_ROUNDS = 5


@dataclass(frozen=True)
class Sign:
    """What is known of a sign: +1, -1 or None, and whether zero is ruled out."""

    value: int | None
    strict: bool = False


UNKNOWN = Sign(None)


@dataclass(frozen=True, eq=False)
class Signs:
    """Signs of polynomials in a ring.

    Attributes
    ----------
    space : Polynomials
    known : mapping of Poly to Sign
        Polynomials, generators among them, of which more is known than is assumed.

    Examples
    --------
    >>> import sympy
    >>> from bondgraph.symbolic.rational import polynomials_over
    >>> m, x = sympy.Symbol("m", positive=True), sympy.Symbol("x", real=True)
    >>> space = polynomials_over([m + x])
    >>> signs = Signs(space, {})
    >>> signs.of(space.quotient(m + x**2).top), signs.of(space.quotient(m + x).top)
    (Sign(value=1, strict=True), Sign(value=None, strict=False))
    """

    space: Polynomials
    known: Mapping[Poly, Sign]

    def of(self, poly: Poly) -> Sign:
        """Return the sign of a polynomial that does not hold the Laplace variable."""
        if poly in self.known:
            return self.known[poly]
        generators = [self._generator(place) for place in range(len(self.space.generators))]
        found = {_term(number, monomial[1:], generators) for monomial, number in poly.iterterms()}
        values = {sign.value for sign in found}
        if len(values) != 1 or None in values:
            return UNKNOWN
        return Sign(values.pop(), any(sign.strict for sign in found))

    def _generator(self, place: int) -> Sign:
        symbol = self.space.ring.gens[1 + place]
        if symbol in self.known:
            return self.known[symbol]
        shown = self.space.shown[place]
        if shown.is_positive or shown.is_negative:
            return Sign(1 if shown.is_positive else -1, strict=True)
        if shown.is_nonnegative or shown.is_nonpositive:
            return Sign(1 if shown.is_nonnegative else -1)
        return Sign(None, bool(shown.is_nonzero))


def _term(number: int, monomial: Iterable[int], generators: list[Sign]) -> Sign:
    value: int | None = 1 if number > 0 else -1
    strict = True
    for power, sign in zip(monomial, generators, strict=True):
        if power:
            strict = strict and sign.strict
            if power % 2 and value is not None:
                value = None if sign.value is None else value * sign.value
    return UNKNOWN if value is None else Sign(value, strict)


def what_is_left(space: Polynomials, positive: Iterable[Poly]) -> tuple[list[Poly], list[Poly]]:
    """Reduce conditions ``p > 0`` to those that the assumptions leave open.

    Parameters
    ----------
    space : Polynomials
    positive : iterable of Poly
        Each is to be positive.

    Returns
    -------
    open : list of Poly
        These must be positive: all of them if and only if all given are. None
        are told where some are violated.
    violated : list of Poly
        Those given that are never positive, or not where all others are.

    Examples
    --------
    >>> import sympy
    >>> from bondgraph.symbolic.rational import polynomials_over
    >>> b, k = sympy.Symbol("b", nonnegative=True), sympy.Symbol("k", positive=True)
    >>> space = polynomials_over([b * k])
    >>> left, never = what_is_left(space, [space.quotient(b**2 * k).top])
    >>> [space.expression(item) for item in left], never
    ([b], [])
    """
    # Long ones first: they are shortened by what the short ones say, and not the other way.
    wanted = sorted(dict.fromkeys(positive), key=_readable, reverse=True)
    pieces = {poly: _pieces(space, Signs(space, {}), poly) for poly in wanted}
    violated = [poly for poly, found in pieces.items() if found is None]
    open_ = {poly: found for poly, found in pieces.items() if found is not None}
    for _ in range(0 if violated else MAX_ROUNDS):
        start = dict(open_)
        for poly in start:
            others = [item for other, found in open_.items() if other != poly for item in found]
            after = _pieces(space, Signs(space, _positive(others)), poly)
            if after is None:
                return [], [poly]
            open_[poly] = after  # all together still say the same
        if open_ == start:
            break
    found = dict.fromkeys(item for pieces in open_.values() for item in pieces)
    return [] if violated else sorted(found, key=_readable), violated


def _positive(polys: Iterable[Poly]) -> dict[Poly, Sign]:
    """Return what is known where these are positive."""
    known: dict[Poly, Sign] = {}
    for poly in polys:
        known |= {poly: Sign(1, strict=True), -poly: Sign(-1, strict=True)}
    return known


def _readable(poly: Poly) -> tuple[int, int, str]:
    return len(poly), sum(map(sum, poly.itermonoms())), str(poly)


def _pieces(space: Polynomials, signs: Signs, poly: Poly) -> list[Poly] | None:
    """Return polynomials that are positive together where this one is; None where it never is."""
    if not poly:
        return None
    whole = signs.of(poly)
    if whole.strict and whole.value is not None:
        return [] if whole.value > 0 else None
    turn, product, pieces = 1, space.ring.one, []
    for factor, power in factors(poly):
        sign = signs.of(factor)
        if sign.value is None and power % 2:
            product = product * factor
        elif sign.value is None:
            if not sign.strict:
                pieces.append(factor**2)
        else:
            if power % 2:
                turn *= sign.value
            if not sign.strict:
                pieces.append(factor * sign.value)
    if product == 1:
        return pieces if turn > 0 else None
    return [*pieces, product * turn]
