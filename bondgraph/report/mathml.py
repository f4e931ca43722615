"""Formulas for the page, as MathML, which browsers show without any library."""

from __future__ import annotations

from html import escape
from typing import Any

import sympy
from sympy.printing.mathml import MathMLPresentationPrinter

from ..codegen.program import Program
from ..equations import Equations

# Larger models are shown as ordered assignments only.
MOST_STATES = 12
MOST_OPERATIONS = 1500


_EXP = sympy.Function("exp")


class _Printer(MathMLPresentationPrinter):
    """Writes ``rear.mass.p`` as p with the element below, and names of ports upright."""

    def _print_Symbol(self, sym: sympy.Symbol, style: str = "plain") -> Any:
        # sympy writes texts as they are, so they are escaped here
        element, dot, port = (escape(part) for part in sym.name.rpartition("."))
        node = super()._print_Symbol(sympy.Symbol(port), style)
        if not dot:
            return node
        whole = self.dom.createElement("msub")
        whole.appendChild(node)
        below = self.dom.createElement("mtext")
        below.appendChild(self.dom.createTextNode(element))
        whole.appendChild(below)
        return whole

    _print_Dummy = _print_Symbol


def formula(expression: sympy.Expr) -> str:
    """Return an expression as presentation MathML, without the ``math`` element.

    Parameters
    ----------
    expression : Expr

    Returns
    -------
    str

    Examples
    --------
    >>> formula(sympy.Symbol("k_f") + 1)
    '<mrow><msub><mi>k</mi><mi>f</mi></msub><mo>+</mo><mn>1</mn></mrow>'
    """
    # as a plain function exp() is not moved into denominators, where it would be small
    plain = expression.replace(sympy.exp, _EXP)
    return str(_Printer().doprint(plain)).replace("<mo>-</mo>", "<mo>&#8722;</mo>")


def equation(left: str, right: sympy.Expr) -> str:
    """Return ``left = right`` as a displayed formula; left is MathML."""
    return f'<math display="block"><mrow>{left}<mo>=</mo>{formula(right)}</mrow></math>'


def rate(state: sympy.Symbol) -> str:
    """Return the time derivative of a state as MathML.

    Examples
    --------
    >>> rate(sympy.Symbol("x"))
    '<mfrac><mrow><mi mathvariant="normal">d</mi><mi>x</mi></mrow>...</mfrac>'
    """
    d = '<mi mathvariant="normal">d</mi>'
    below = f"<mrow>{d}<mi>t</mi></mrow>"
    return f"<mfrac><mrow>{d}{formula(state)}</mrow>{below}</mfrac>"


def state_equations(equations: Equations) -> list[str]:
    """Return the state equations as displayed formulas, expanded for reading.

    Slip and effort of contacts keep their names. None are returned for a model
    that is too large to be read that way.

    Parameters
    ----------
    equations : Equations

    Returns
    -------
    list of str
    """
    if len(equations.states) > MOST_STATES:
        return []
    kept = {symbol for item in equations.contacts for symbol in (item.slip, item.effort)}
    program = Program.pruned(
        "shown",
        [("all", sorted(equations.arguments, key=str))],
        equations.assignments,
        {"rates": [*equations.derivatives, *equations.residuals]},
    )
    known: dict[sympy.Basic, sympy.Expr] = {
        item.direction: sympy.Symbol(f"{item.name}.sigma") for item in equations.contacts
    }
    named: dict[sympy.Symbol, sympy.Expr] = {}
    for symbol, expression in program.assignments:
        value = expression.xreplace(known)
        if symbol in kept and not value.is_Atom:
            named[symbol] = value
        else:
            known[symbol] = value
        if sympy.count_ops(value) > MOST_OPERATIONS:
            return []
    rates = [expression.xreplace(known) for expression in equations.derivatives]
    lines = [equation(formula(symbol), value) for symbol, value in named.items()]
    lines += [
        equation(rate(state), value) for state, value in zip(equations.states, rates, strict=True)
    ]
    lines += [equation("<mn>0</mn>", item.xreplace(known)) for item in equations.residuals]
    return lines
