"""What the values of this package share when they are written as LaTeX."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import sympy

from ..codegen.to_latex import latex


def aligned(rows: Iterable[str]) -> str:
    r"""Put rows that hold an ``&`` into an ``align*`` environment.

    Examples
    --------
    >>> print(aligned(["a &= b", "c &= d"]))
    \begin{align*}
    a &= b \\
    c &= d
    \end{align*}
    """
    body = " \\\\\n".join(rows)
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"


def conditions_latex(
    conditions: Iterable[sympy.Expr], status: str, names: Mapping[sympy.Basic, str]
) -> str:
    """Write conditions under each other, or what is known where there are none."""
    rows = [f"{latex(item, names)} &> 0" for item in conditions]
    return aligned(rows or [rf"&\text{{{status}}}"])
