"""What counts as a small model, and the error for what does not.

Exact polynomials in many parameters grow without warning. Work is therefore
counted as it is done, in products of terms, and given up at a fixed count: the
same model is refused on every machine, after seconds and not hours.
"""

from __future__ import annotations

from ..errors import BondGraphError

# States, and operations of all expanded rates and outputs together.
MAX_STATES = 20
MAX_OPERATIONS = 5000
# Products of terms that one result may cost: some seconds.
MAX_PRODUCTS = 1_000_000
# The same for one product while an expression is read.
MAX_PRODUCT = 20_000
# Terms of one polynomial in a result; nobody reads more.
MAX_TERMS = 4000
# Up to these sympy's factorisation and common divisors are quick; it may not end on random
# polynomials that could hold ten times as many terms by their degrees (dense).
FACTOR_TERMS = 40
FACTOR_DENSE = 200_000
GCD_DENSE = 4000


class SymbolicError(BondGraphError):
    """A symbolic result is too large, not defined, or has no closed form."""


class Budget:
    """Counts the products of terms that one result costs.

    Parameters
    ----------
    what : str
        The result, for the message.
    left : int
        How many products may be made.

    Examples
    --------
    >>> Budget("the determinant", 10).spend(11)
    Traceback (most recent call last):
    ...
    bondgraph.symbolic.limits.SymbolicError: the determinant is too large to be written in symbols...
    """

    def __init__(self, what: str, left: int = MAX_PRODUCTS) -> None:
        self.what = what
        self.left = left

    def spend(self, products: int) -> None:
        """Take products from what is left.

        Raises
        ------
        SymbolicError
            When there are not as many.
        """
        self.left -= products
        if self.left < 0:
            raise too_large(self.what)

    def check(self, terms: int) -> None:
        """Refuse a polynomial of too many terms.

        Raises
        ------
        SymbolicError
        """
        if terms > MAX_TERMS:
            raise too_large(f"{self.what} ({terms} terms)")


def too_large(what: str) -> SymbolicError:
    """Build the error for a result that is too large, with the ways out."""
    return SymbolicError(
        f"{what} is too large to be written in symbols; give numbers to some parameters "
        f"(parameters={{...}}), or use linearize(), which works in numbers"
    )
