"""CasADi functions called through their buffers: a microsecond a call."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from .table import is_casadi

Array = np.ndarray


def evaluator(function: Any) -> Callable[..., Array]:
    """Return a CasADi function of one result as a plain one; others as they are.

    Parameters
    ----------
    function : casadi.Function or callable
        Of dense column vectors.

    Returns
    -------
    callable
        To the result, shape (n,).

    Examples
    --------
    >>> import casadi
    >>> x = casadi.SX.sym("x", 2)
    >>> evaluator(casadi.Function("double", [x], [2 * x]))(np.array([1.0, 3.0])).tolist()
    [2.0, 6.0]
    """
    if not is_casadi(function):
        return function
    buffer, trigger = function.buffer()
    arguments = [np.zeros(function.nnz_in(i)) for i in range(function.n_in())]
    result = np.zeros(function.nnz_out(0))
    for i, argument in enumerate(arguments):
        buffer.set_arg(i, argument.data)
    buffer.set_res(0, result.data)

    def evaluate(*given: Any) -> Array:
        for argument, value in zip(arguments, given, strict=True):
            argument[:] = value
        trigger()
        return result.copy()

    evaluate.buffer = buffer  # type: ignore[attr-defined]  # keeps it alive
    return evaluate


class PerThread:
    """A CasADi function of one result called through buffers that each thread has of its own.

    Parameters
    ----------
    function : casadi.Function
        Of dense column vectors.

    Examples
    --------
    >>> import casadi
    >>> x = casadi.SX.sym("x", 2)
    >>> PerThread(casadi.Function("double", [x], [2 * x]))(np.array([1.0, 3.0])).tolist()
    [2.0, 6.0]
    """

    def __init__(self, function: Any) -> None:
        self.function = function
        self.kept = threading.local()

    def __call__(self, *given: Any) -> Array:
        """Return the result, shape (n,)."""
        if not hasattr(self.kept, "call"):
            self.kept.call = evaluator(self.function)
        found: Array = self.kept.call(*given)
        return found
