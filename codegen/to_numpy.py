"""Program -> NumPy function, vectorised over trailing axes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy
import sympy

from .program import Program

Array = numpy.ndarray


def to_numpy(program: Program) -> Callable[..., tuple[Array, ...]]:
    """Build a NumPy function.

    Parameters
    ----------
    program : Program

    Returns
    -------
    callable
        Takes one array per argument, of shape (size, ...), and returns one
        array per result, of shape (size, ...): trailing axes broadcast, so a
        whole trajectory is one call.

    Examples
    --------
    >>> x = sympy.Symbol("x")
    >>> f = to_numpy(Program("f", (("x", (x,)),), (), (("y", (x**2,)),)))
    >>> f([[1.0, 2.0, 3.0]])[0].tolist()
    [[1.0, 4.0, 9.0]]
    """
    names = _Names()
    steps = [
        (names[symbol], names.rename(expression)) for symbol, expression in program.assignments
    ]
    results = [[names.rename(expression) for expression in result] for _, result in program.results]
    inner = sympy.lambdify(
        [[names[symbol] for symbol in symbols] for _, symbols in program.arguments],
        results,
        modules=["numpy", "scipy"] if _needs_scipy(program) else "numpy",
        cse=lambda expressions: (steps, expressions),
    )

    def call(*arguments: Any) -> tuple[Array, ...]:
        arrays = [numpy.asarray(argument, dtype=float) for argument in arguments]
        tails = numpy.broadcast_shapes(*(array.shape[1:] for array in arrays if array.size))
        with numpy.errstate(all="ignore"):  # what is not finite shows in the result
            values = inner(*arrays)
        return tuple(_stack(value, tails) for value in values)

    call.__name__ = program.name
    return call


def _stack(values: list[Any], tails: tuple[int, ...]) -> Array:
    if not values:
        return numpy.zeros((0, *tails))
    return numpy.stack(
        [numpy.broadcast_to(numpy.asarray(value, dtype=float), tails) for value in values]
    )


def _needs_scipy(program: Program) -> bool:
    expressions = [expression for _, expression in program.assignments]
    expressions += [expression for _, result in program.results for expression in result]
    return any(expression.has(sympy.erf) for expression in expressions)


class _Names:
    """Plain Python names for symbols such as ``rear.mass.p``."""

    def __init__(self) -> None:
        self._names: dict[sympy.Basic, sympy.Symbol] = {}

    def __getitem__(self, symbol: sympy.Basic) -> sympy.Symbol:
        if symbol not in self._names:
            self._names[symbol] = sympy.Symbol(f"v{len(self._names)}", real=True)
        return self._names[symbol]

    def rename(self, expression: sympy.Expr) -> sympy.Expr:
        return expression.xreplace({symbol: self[symbol] for symbol in expression.free_symbols})
