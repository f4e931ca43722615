"""Program -> LaTeX.

Names become symbols: ``zeta_f`` is a Greek letter with a subscript,
``rear.mass.p`` the letter p with where it belongs, ``der(x)`` has a dot. What
comes out is read by LaTeX (amsmath) and by MathJax.
"""

from __future__ import annotations

import functools
import re
import unicodedata
from collections.abc import Iterable, Mapping

import sympy
from sympy.printing.latex import LatexPrinter

from .program import Program

_SMALL = "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi rho sigma tau"
_LARGE = "Gamma Delta Theta Lambda Xi Sigma Upsilon Phi Psi Omega"
# Without pi: a parameter of that name is not the number.
GREEK = frozenset(f"{_SMALL} upsilon phi chi psi omega {_LARGE}".split())
_ESCAPES = {
    "_": r"\ ",
    " ": r"\ ",
    "\\": r"\backslash ",
    "^": r"\wedge ",
    "~": r"\sim ",
    ">": r"\to ",
} | {letter: "\\" + letter for letter in "#$%&{}"}
_DOTS = {1: r"\dot", 2: r"\ddot"}
_DERIVATIVE = re.compile(r"der\((.*)\)")
_NUMBERED = re.compile(r"(.*\D)(\d+)")
_COMMAND = re.compile(r"\\[a-zA-Z]+")
# A sum that shows more letters than this is broken into lines.
LINE = 75


def latex_name(name: str, dots: int = 0) -> str:
    r"""Write a symbol's name as LaTeX.

    Parameters
    ----------
    name : str
        Such as ``k_f``, ``omega_t``, ``rear.mass.p`` or ``der(rear.mass.p)``.
    dots : int
        Time derivatives to put on top.

    Returns
    -------
    str

    Examples
    --------
    >>> print(latex_name("zeta_f"), latex_name("V0"), latex_name("rear.mass.p", dots=1))
    \zeta_{f} V_{0} \dot{p}_{\mathrm{rear,mass}}
    """
    while derivative := _DERIVATIVE.fullmatch(name):
        name, dots = derivative[1], dots + 1
    path, _, last = name.rpartition(".")
    if not last or not path:
        path, last = "", name
    letter, *rest = [part for part in last.split("_") if part] or [last]
    numbered = _NUMBERED.fullmatch(letter)
    if numbered:
        letter, rest = numbered[1].rstrip("#") or "#", [numbered[2], *rest]
    below = [_subscript(part) for part in rest]
    if path:
        below.append(rf"\mathrm{{{','.join(_escaped(part) for part in path.split('.'))}}}")
    base = _letter(letter)
    if dots:
        base = f"{_DOTS[dots]}{{{base}}}" if dots in _DOTS else f"{base}^{{({dots})}}"
    return base + (f"_{{{','.join(below)}}}" if below else "")


def latex_names(symbols: Iterable[sympy.Symbol]) -> dict[sympy.Basic, str]:
    r"""Name symbols so that no two look the same.

    Parameters
    ----------
    symbols : iterable of Symbol

    Returns
    -------
    dict of Symbol to str
        The names of `latex_name`; in full where that would not tell two apart.

    Examples
    --------
    >>> print(*latex_names(sympy.symbols("k_1 k1 m")).values())
    k_{1} \mathrm{k1} m
    """
    names: dict[sympy.Basic, str] = {}
    taken: set[str] = set()
    for symbol in symbols:
        short = latex_name(symbol.name)
        names[symbol] = rf"\mathrm{{{_escaped(symbol.name)}}}" if short in taken else short
        taken.add(names[symbol])
    return names


def _letter(text: str) -> str:
    found = _greek(text)
    if found:
        return found
    return text if len(text) == 1 and text.isalpha() else rf"\mathrm{{{_escaped(text)}}}"


def _subscript(text: str) -> str:
    found = _greek(text)
    if found:
        return found
    return (
        text
        if text.isdigit() or (len(text) == 1 and text.isalpha())
        else rf"\mathrm{{{_escaped(text)}}}"
    )


def _greek(text: str) -> str:
    """Return the command of a Greek letter, given by its name or as the letter itself."""
    if len(text) == 1 and not text.isascii():
        words = unicodedata.name(text, "").replace("MICRO SIGN", "GREEK SMALL LETTER MU").split()
        if len(words) == 4 and words[0] == "GREEK":
            text = words[3].lower() if words[1] == "SMALL" else words[3].capitalize()
            text = text.replace("amda", "ambda")
    return f"\\{text}" if text in GREEK else ""


def _escaped(text: str) -> str:
    return "".join(_ESCAPES.get(letter, letter) for letter in text)


class _Printer(LatexPrinter):
    """sympy's printer with this module's names."""

    def __init__(self, names: Mapping[sympy.Basic, str]) -> None:
        super().__init__({"mul_symbol": r" \, "})
        self._names = names

    def _print_Symbol(self, expr: sympy.Symbol, style: str = "plain") -> str:
        return self._names.get(expr) or latex_name(expr.name)

    _print_Dummy = _print_Symbol

    def _print_ExpBase(self, expr: sympy.Expr, exp: str | None = None) -> str:
        """Keep what is more than a symbol or number on the line, where it can be read."""
        argument = expr.args[0]
        if argument.is_Atom or (-argument).is_Atom:
            return str(super()._print_ExpBase(expr, exp))
        power = "" if exp is None else f"^{{{exp}}}"
        return rf"\exp{power}\left({self._print(argument)}\right)"

    def _print_Heaviside(self, expr: sympy.Expr, exp: str | None = None) -> str:
        shown = rf"\operatorname{{H}}{{\left({self._print(expr.args[0])} \right)}}"
        return shown if exp is None else f"{{{shown}}}^{{{exp}}}"


def latex(expression: sympy.Basic, names: Mapping[sympy.Basic, str] | None = None) -> str:
    r"""Write an expression as LaTeX.

    Parameters
    ----------
    expression : Expr
    names : mapping of Symbol to str, optional
        LaTeX of symbols that do not follow from their names.

    Returns
    -------
    str

    Examples
    --------
    >>> k, x = sympy.symbols("k_f rear.bending.q")
    >>> print(latex(-k * x))
    - k_{f} \, q_{\mathrm{rear,bending}}
    """
    return str(_Printer(names or {}).doprint(expression))


def align(
    rows: Iterable[tuple[str, sympy.Expr]], names: Mapping[sympy.Basic, str] | None = None
) -> str:
    r"""Write equations under each other as an ``align*`` environment.

    Parameters
    ----------
    rows : iterable of (str, Expr)
        Left side as LaTeX, right side as expression. Long sums are broken.
    names : mapping of Symbol to str, optional
        As in `latex`.

    Returns
    -------
    str
        Empty where there are no rows.

    Examples
    --------
    >>> print(align([("y", sympy.Symbol("x") ** 2)]))
    \begin{align*}
    y &= x^{2}
    \end{align*}
    """
    write = functools.partial(latex, names=names or {})
    lines = []
    for left, right in rows:
        first, *further = _broken(right, write)
        lines.append(f"{left} &= {first}")
        lines += [rf"&\quad {line}" for line in further]
    body = " \\\\\n".join(lines)
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}" if lines else ""


def _broken(expression: sympy.Expr, write: functools.partial[str]) -> list[str]:
    """Write a long sum in several lines, each but the first starting with its sign."""
    whole = write(expression)
    if _shown(whole) <= LINE or not isinstance(expression, sympy.Add):
        return [whole]
    lines, line = [], ""
    for term in expression.as_ordered_terms():
        text = write(term)
        signed = text if text.startswith("-") else f"+ {text}"
        if line and _shown(line) + _shown(signed) > LINE:
            lines.append(line)
            line = ""
        line = f"{line} {signed}".strip()
    lines.append(line)
    return [lines[0].removeprefix("+ "), *lines[1:]]


def _shown(text: str) -> int:
    """Count the letters that a piece of LaTeX shows, roughly."""
    plain = _COMMAND.sub("x", text.replace(r"\mathrm", "").replace(r"\frac", ""))
    return sum(letter not in "{}_^\\, &" for letter in plain)


def to_latex(program: Program, names: Mapping[sympy.Basic, str] | None = None) -> str:
    r"""Write a program's assignments and results.

    Parameters
    ----------
    program : Program
    names : mapping of Symbol to str, optional
        As in `latex`.

    Returns
    -------
    str
        An ``align*`` environment; entries of results are numbered from one.

    Examples
    --------
    >>> x, y = sympy.symbols("x y")
    >>> print(to_latex(Program("f", (("x", (x,)),), ((y, 2 * x),), (("rate", (y + 1,)),))))
    \begin{align*}
    y &= 2 \, x \\
    \mathrm{rate}_{1} &= y + 1
    \end{align*}
    """
    rows = [(latex(symbol, names), value) for symbol, value in program.assignments]
    for label, expressions in program.results:
        rows += [(latex_name(f"{label}_{i}"), value) for i, value in enumerate(expressions, 1)]
    return align(rows, names)
