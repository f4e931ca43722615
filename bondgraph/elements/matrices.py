"""Matrices of expressions: whether they are symmetric, and their inverses.

Both at a cost that depends on the size of the matrix, hardly on its entries: these may
come from a file that somebody else wrote.
"""

from __future__ import annotations

import itertools

import sympy
from sympy.polys.matrices import DomainMatrix
from sympy.polys.matrices.exceptions import DMNonInvertibleMatrixError

from ..laws import exact

MOST_TERMS = 40  # of a determinant, up to which fractions are cancelled
MOST_OPERATIONS = 12  # of an entry that is worked out; longer ones are carried as they are
DIGITS, TOLERANCE = 30, 1e-20


def is_symmetric(matrix: sympy.Matrix) -> bool:
    """Whether a square matrix is symmetric, as far as numbers for its symbols tell.

    Examples
    --------
    >>> a, b = sympy.symbols("a b")
    >>> is_symmetric(sympy.Matrix([[1, a * (a + b)], [a**2 + a * b, 1]]))
    True
    """
    pairs = itertools.combinations(range(matrix.rows), 2)
    unlike = [(matrix[i, j], matrix[j, i]) for i, j in pairs if matrix[i, j] != matrix[j, i]]
    if not unlike:
        return True
    symbols = sorted(matrix.free_symbols, key=str)
    # square roots of primes: no rational relation makes unlike entries look alike
    values = {
        symbol: exact(sympy.sqrt(sympy.prime(place + 1)).evalf(DIGITS))
        for place, symbol in enumerate(symbols)
    }
    return all(_alike(*(entry.xreplace(values) for entry in pair)) for pair in unlike)


def _alike(first: sympy.Expr, second: sympy.Expr) -> bool:
    left, right = first.evalf(DIGITS), second.evalf(DIGITS)
    return bool(abs(left - right) <= TOLERANCE * (1 + abs(left)))


def inverse_of(matrix: sympy.Matrix) -> sympy.Matrix | None:
    """Return the inverse of a matrix of expressions; None where it has none.

    Examples
    --------
    >>> a, b = sympy.symbols("a b")
    >>> inverse_of(sympy.Matrix([[a + b, b], [b, b]]))
    Matrix([
    [ 1/a,          -1/a],
    [-1/a, (a + b)/(a*b)]])
    """
    carried = {entry: sympy.Dummy() for entry in set(matrix) if _is_carried(entry)}
    entries = DomainMatrix.from_Matrix(matrix.applyfunc(lambda entry: carried.get(entry, entry)))
    if all(entry.is_Rational for entry in matrix):
        try:
            return entries.to_field().inv().to_Matrix()
        except DMNonInvertibleMatrixError:
            return None
    # free of division, whose greatest common divisors swell beyond four symbolic rows
    adjugate, det = entries.adj_det()
    below = entries.domain.to_sympy(det)
    back = {dummy: entry for entry, dummy in carried.items()}
    if below.xreplace(back) == 0:
        return None
    tidy = sympy.cancel if len(sympy.Add.make_args(below)) <= MOST_TERMS else sympy.factor_terms
    return adjugate.to_Matrix().applyfunc(lambda entry: tidy(entry / below).xreplace(back))


def _is_carried(entry: sympy.Expr) -> bool:
    """Whether an entry is no ratio of small polynomials, which alone are worked out."""
    if entry.count_ops() > MOST_OPERATIONS:
        return True
    return not all(_is_worked_out(part) for part in sympy.preorder_traversal(entry))


def _is_worked_out(part: sympy.Basic) -> bool:
    if isinstance(part, sympy.Pow):
        return bool(part.exp.is_Integer) and (not part.base.is_Add or abs(part.exp) == 1)
    return isinstance(part, sympy.Symbol | sympy.Rational | sympy.Add | sympy.Mul)
