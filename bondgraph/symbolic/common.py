"""Common divisors of polynomials in many symbols.

Usually there is none. That is shown in numbers: with all symbols but one at
random residues a common divisor would be seen, and with none to be seen for
any symbol there is none. Only symbols for which one shows enter the search.
"""

from __future__ import annotations

import math
from collections import defaultdict
from functools import reduce
from typing import Any

from .images import Images
from .limits import GCD_DENSE, too_large
from .rational import Poly, split_monomial


def lowest_terms(top: Poly, bottom: Poly) -> tuple[Poly, Poly]:
    """Cancel what two polynomials have in common.

    Parameters
    ----------
    top, bottom : Poly
        The second is not zero.

    Returns
    -------
    top, bottom : Poly
        Without a common divisor.

    Raises
    ------
    SymbolicError
        When there is one and it is too large to be found.

    Examples
    --------
    >>> from sympy import ZZ, ring
    >>> _, a, b = ring("a, b", ZZ)
    >>> lowest_terms(2 * a * (a + b), a**2 * (a**2 - b**2))
    (2, a**2 - a*b)
    """
    if not top:
        return top, bottom.ring.one
    divisor = common_divisor(top, bottom)
    return _over(top, divisor), _over(bottom, divisor)


def _over(poly: Poly, divisor: Poly) -> Poly:
    """Divide by what divides; a general division would go over all terms for each term."""
    if len(divisor) == 1:
        return poly.quo_term(next(divisor.iterterms()))
    return poly.exquo(divisor)


def common_divisor(first: Poly, second: Poly) -> Poly:
    """Return the greatest common divisor of two polynomials that are not zero.

    Raises
    ------
    SymbolicError
        When it is too large to be found.

    Examples
    --------
    >>> from sympy import ZZ, ring
    >>> _, a, b = ring("a, b", ZZ)
    >>> common_divisor(6 * a**2 - 6 * b**2, 4 * a + 4 * b)
    2*a + 2*b
    """
    ring = first.ring
    number = math.gcd(int(first.content()), int(second.content()))
    (powers, first), (others, second) = split_monomial(first), split_monomial(second)
    monomial = ring.from_dict({tuple(map(min, powers, others)): ring.domain.one})
    shared = Images(len(ring.gens)).shared(first, second)
    rest = _search(first, second, shared) if shared else ring.one
    return rest * monomial * number


def _search(first: Poly, second: Poly, shared: list[int]) -> Poly:
    """Return the common divisor, which holds shared generators only.

    It divides the coefficient of every product of the other generators.
    """
    for part, whole in ((first, second), (second, first)):
        if not whole.rem(part):
            return part
    degrees = [max(pair) + 1 for pair in zip(first.degrees(), second.degrees(), strict=True)]
    if math.prod(degrees[place] for place in shared) > GCD_DENSE:
        raise too_large("a common divisor of numerator and denominator")
    ring = first.ring
    small = ring.clone(symbols=[ring.symbols[place] for place in shared])
    parts = [*_parts(first, shared, small), *_parts(second, shared, small)]
    found = reduce(lambda a, b: a if a.is_ground else a.gcd(b), sorted(parts, key=len))
    found = found.primitive()[1]
    terms = {}
    for monomial, coefficient in found.iterterms():
        powers = [0] * len(ring.gens)
        for place, power in zip(shared, monomial, strict=True):
            powers[place] = power
        terms[tuple(powers)] = coefficient
    return ring.from_dict(terms)


def _parts(poly: Poly, shared: list[int], small: Any) -> list[Poly]:
    groups: dict[tuple[int, ...], dict[tuple[int, ...], int]] = defaultdict(dict)
    for monomial, coefficient in poly.iterterms():
        key = tuple(0 if place in shared else power for place, power in enumerate(monomial))
        groups[key][tuple(monomial[place] for place in shared)] = coefficient
    return [small.from_dict(group) for group in groups.values()]
