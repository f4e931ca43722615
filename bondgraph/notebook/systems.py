"""Views of linear systems: the damping table, and the matrices with their names."""

from __future__ import annotations

from collections.abc import Sequence

import numpy

from ..codegen.to_latex import latex_name
from ..linear import LinearSystem, growths
from ..units import pretty
from .markup import block, number, paragraph, table

LARGEST = 12  # rows or columns of a matrix that is written out


def html(system: LinearSystem) -> str:
    """Return poles, frequencies, damping and the elements that carry each mode.

    Parameters
    ----------
    system : LinearSystem

    Returns
    -------
    str
    """
    rows = [
        (
            _pole(row.pole),
            number(row.frequency_hz, "Hz") if row.pole.imag else "–",
            number(row.damping_ratio),
            number(row.time_constant, "s"),
            ", ".join(row.elements),
        )
        for row in system.damping_table()
        if row.pole.imag >= 0
    ]
    names = [
        (kind, _with_units(which, units))
        for kind, which, units in (
            ("states", system.states, system.state_units),
            ("inputs", system.inputs, system.input_units),
            ("outputs", system.outputs, system.output_units),
        )
        if which
    ]
    modes = ", ".join(f"{name} {mode}" for name, mode in system.at.modes.items())
    head = ("pole [1/s]", "frequency", "damping ratio", "time constant", "carried by")
    return block(
        f"Linear system {system.at.equations.name}, {_stability(system)}",
        table(head, rows) or paragraph("no states"),
        table(("", ""), names),
        paragraph(f"modes: {modes}" if modes else ""),
    )


def latex(system: LinearSystem) -> str:
    r"""Return the state equations with matrices and named vectors.

    Parameters
    ----------
    system : LinearSystem

    Returns
    -------
    str
        An ``align*`` environment. Of large matrices only the size is written.
    """
    x, u, y = (
        _column([latex_name(name) for name in names])
        for names in (system.states, system.inputs, system.outputs)
    )
    rates = _column([latex_name(name, dots=1) for name in system.states])
    lines = [
        f"{left} &= {_sum((first, x), (second, u))}"
        for left, first, second in ((rates, system.A, system.B), (y, system.C, system.D))
        if left
    ]
    if not lines:
        return r"$\text{no states and no outputs}$"
    body = " \\\\\n".join(lines)
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"


def _sum(*products: tuple[numpy.ndarray, str]) -> str:
    terms = [f"{_matrix(matrix)} {vector}" for matrix, vector in products if matrix.size]
    return " + ".join(terms) or "0"


def _matrix(values: numpy.ndarray) -> str:
    if max(values.shape) > LARGEST:
        rows, columns = values.shape
        return rf"\left[{rows} \times {columns}\right]"
    rows = [" & ".join(_number(value) for value in row) for row in values]
    return _brackets(rows)


def _column(names: Sequence[str]) -> str:
    if not names:
        return ""
    if len(names) > LARGEST:
        names = [*names[:2], r"\vdots", names[-1]]
    return _brackets(names)


def _brackets(rows: Sequence[str]) -> str:
    body = r" \\ ".join(rows)
    return rf"\begin{{bmatrix}} {body} \end{{bmatrix}}"


def _number(value: float) -> str:
    """Write a number with four digits, as LaTeX."""
    text = f"{value:.4g}"
    if "inf" in text or "nan" in text:
        return rf"\text{{{text}}}"
    digits, _, power = text.partition("e")
    return rf"{digits} \cdot 10^{{{int(power)}}}" if power else digits


def _pole(pole: complex) -> str:
    if not pole.imag:
        return number(pole.real)
    return f"{number(pole.real)} ± {number(pole.imag)} i"


def _with_units(names: Sequence[str], units: Sequence[str]) -> str:
    return ", ".join(
        f"{name} [{pretty(unit)}]" if unit else name
        for name, unit in zip(names, units, strict=True)
    )


def _stability(system: LinearSystem) -> str:
    if any(mode > 0 for mode in growths(system.poles())):
        return "unstable"
    return "stable" if system.stable else "neither growing nor decaying in some mode"
