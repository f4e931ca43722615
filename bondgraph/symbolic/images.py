"""Polynomials seen at random residues of all symbols but one: quick, and sure when it says no."""

from __future__ import annotations

import random
from collections import defaultdict

import sympy
from sympy.polys.galoistools import gf_degree, gf_gcd, gf_rem

PRIME = 2**61 - 1

Terms = list[tuple[tuple[int, ...], int]]


class Images:
    """Images of polynomials of one ring, all at the same random point modulo a prime.

    Parameters
    ----------
    count : int
        How many generators the ring has.

    Examples
    --------
    >>> from sympy import ZZ, ring
    >>> _, a, b = ring("a, b", ZZ)
    >>> images = Images(2)
    >>> images.may_divide(a + b, a**2 - b**2), images.may_divide(a + 2 * b, a**2 - b**2)
    (True, False)
    >>> images.shared(a * (a + b), b * (a + b))
    [0, 1]
    """

    def __init__(self, count: int) -> None:
        draw = random.Random(0)
        self._values = [draw.randrange(2, PRIME) for _ in range(count)]
        self._inverses = [pow(value, -1, PRIME) for value in self._values]

    def may_divide(self, factor: sympy.Basic, poly: sympy.Basic) -> bool:
        """Tell whether a polynomial that is no number may divide another: no is certain."""
        place = next(place for place, degree in enumerate(factor.degrees()) if degree > 0)
        if poly.degrees()[place] < factor.degrees()[place]:
            return False
        images = [self._along(self._terms(item), place) for item in (poly, factor)]
        return not gf_rem(*images, PRIME, sympy.ZZ)

    def shared(self, first: sympy.Basic, second: sympy.Basic) -> list[int]:
        """Return the generators that a common divisor may hold: all others are ruled out."""
        both = [(self._terms(poly), poly.degrees()) for poly in (first, second)]
        return [
            place
            for place in range(len(self._values))
            if all(degrees[place] > 0 for _, degrees in both)
            and gf_degree(
                gf_gcd(*(self._along(terms, place) for terms, _ in both), PRIME, sympy.ZZ)
            )
            > 0
        ]

    def _terms(self, poly: sympy.Basic) -> Terms:
        """Return the residue of each term."""
        terms = []
        for monomial, coefficient in poly.iterterms():
            residue = int(coefficient) % PRIME
            for value, power in zip(self._values, monomial, strict=True):
                if power:
                    residue = residue * pow(value, power, PRIME) % PRIME
            terms.append((monomial, residue))
        return terms

    def _along(self, terms: Terms, place: int) -> list[int]:
        """Return the residues as a polynomial in one generator, highest power first."""
        inverse = self._inverses[place]
        found: dict[int, int] = defaultdict(int)
        for monomial, residue in terms:
            power = monomial[place]
            found[power] = (found[power] + residue * pow(inverse, power, PRIME)) % PRIME
        top = max((power for power, value in found.items() if value), default=-1)
        return [sympy.ZZ(found.get(power, 0)) for power in range(top, -1, -1)]
