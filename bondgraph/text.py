"""Equations for reading: plain text, LaTeX, and the JSON of the command line.

A small model is shown with its rates expanded to states, inputs and
parameters; a large one as ordered assignments that share intermediate results,
as it is computed.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import sympy

from . import describe
from .causality_report import report_causality
from .causality_report.as_json import findings
from .codegen.program import Program
from .codegen.to_latex import align, latex, latex_name, latex_names
from .dimensions import infer, si_unit
from .equations import Equations
from .errors import ParameterError

# Above these a model's rates are not expanded: states, and operations in all rates together.
EXPANDED_STATES = 40
EXPANDED_OPERATIONS = 4000
# A rational rate up to this size is also tried as one fraction.
TIDY_OPERATIONS = 60


def expanded(equations: Equations) -> dict[sympy.Symbol, sympy.Expr] | None:
    """Return each state's rate in states, inputs and parameters, for reading.

    Parameters
    ----------
    equations : Equations

    Returns
    -------
    dict of Symbol to Expr, or None
        None where the model is too large for that to be readable.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble, derive
    >>> loop = One("loop")
    >>> expanded(derive(assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3)))))
    {c.q: 1/2 - c.q/6}
    """
    found = _expanded(equations, ())
    return None if found is None else found[1]


def _expanded(
    equations: Equations, kept: Collection[sympy.Symbol]
) -> tuple[dict[sympy.Symbol, sympy.Expr], dict[sympy.Symbol, sympy.Expr]] | None:
    """Return the kept variables that the rates rest on, and the rates, both expanded."""
    if len(equations.states) > EXPANDED_STATES or _size(equations) > EXPANDED_OPERATIONS:
        return None
    known: dict[sympy.Basic, sympy.Expr] = {}
    shared: dict[sympy.Symbol, sympy.Expr] = {}
    for symbol, expression in _needed(equations, equations.derivatives):
        value = expression.xreplace(known)
        if symbol in kept and not value.is_Atom:
            shared[symbol] = _tidy(value)
        else:
            known[symbol] = value
    rates = {
        state: _tidy(rate.xreplace(known))
        for state, rate in zip(equations.states, equations.derivatives, strict=True)
    }
    return shared, rates


def _contact_variables(equations: Equations) -> set[sympy.Symbol]:
    """Slips and efforts of contacts: with them named, expanded rates stay readable."""
    return {symbol for item in equations.contacts for symbol in (item.slip, item.effort)}


def _size(equations: Equations) -> int:
    """Count the operations that the expanded rates would have, without expanding."""
    sizes: dict[sympy.Basic, int] = {}

    def of(expression: sympy.Expr) -> int:
        inner = sum(
            expression.count(symbol) * sizes.get(symbol, 0) for symbol in expression.free_symbols
        )
        return int(sympy.count_ops(expression)) + inner

    for symbol, expression in equations.assignments:
        sizes[symbol] = of(expression)
    return sum(of(rate) for rate in equations.derivatives)


def _tidy(expression: sympy.Expr) -> sympy.Expr:
    """Cancel what cancels in a small rational expression; keep the shorter form."""
    if sympy.count_ops(expression) > TIDY_OPERATIONS or not expression.is_rational_function():
        return expression
    return min(expression, sympy.cancel(expression), key=sympy.count_ops)


def to_text(equations: Equations) -> str:
    """Write the equations as plain text.

    Parameters
    ----------
    equations : Equations

    Returns
    -------
    str
        Sections: states, inputs, intermediate variables in order, state
        equations, algebraic equations, contacts, switching elements, signal
        blocks, energies of fields, dependent storage, outputs, loops and
        warnings. What a model does not have is left out.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble, derive
    >>> loop = One("loop")
    >>> print(to_text(derive(assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3))))))
    rc: 1 state
    <BLANKLINE>
    States
      c.q
    <BLANKLINE>
    Intermediate variables, in order
      E.e = 1
      c.e = c.q/3
      r.e = E.e - c.e
      loop.f = r.e/2
    <BLANKLINE>
    State equations
      der(c.q) = loop.f
    <BLANKLINE>
    State equations, expanded
      der(c.q) = 1/2 - c.q/6
    """
    units = infer(equations.graph).units
    count = len(equations.states)
    title = f"{equations.name}: {count} state{'s' * (count != 1)}"
    algebraic = len(equations.algebraic)
    if algebraic:
        title += f", {algebraic} algebraic variable{'s' * (algebraic != 1)}"
    shared, rates = _expanded(equations, _contact_variables(equations)) or ({}, {})
    sections = [
        ("States", _with_units((symbol.name for symbol in equations.states), units)),
        ("Inputs", _with_units(*_inputs(equations))),
        (
            "Intermediate variables, in order",
            [_line(symbol.name, value) for symbol, value in _needed(equations)],
        ),
        ("Algebraic equations", [_line("0", residual) for residual in equations.residuals]),
        (
            "State equations",
            _rates(dict(zip(equations.states, equations.derivatives, strict=True))),
        ),
        (
            "State equations, expanded",
            [*(_line(symbol.name, value) for symbol, value in shared.items()), *_rates(rates)],
        ),
        ("Contacts", list(_contacts(equations))),
        ("Switching elements", describe.switch_lines(equations)),
        ("Signal blocks", describe.block_lines(equations)),
        (
            "Energies of fields",
            [_line(name, value) for name, value in describe.field_energies(equations).items()],
        ),
        (
            "Dependent storage, no states of their own",
            [
                _line(_state_name(equations, name), value)
                for name, value in equations.dependent.items()
            ],
        ),
        ("Outputs", _outputs(equations)),
        ("Algebraic loops", [str(loop) for loop in equations.loops]),
        (
            "Warnings",
            [line for line in equations.warnings if line not in map(str, equations.loops)],
        ),
    ]
    blocks = [_section(heading, lines) for heading, lines in sections if lines]
    return "\n\n".join([title, *blocks])


def _section(heading: str, lines: Iterable[str]) -> str:
    return "\n".join([heading, *(f"  {line}" for line in lines)])


def _line(left: str, right: sympy.Expr) -> str:
    return f"{left} = {_plain(right)}"


def _plain(expression: sympy.Expr) -> str:
    return str(expression).replace("**", "^")


def _rates(rates: Mapping[sympy.Symbol, sympy.Expr]) -> list[str]:
    return [_line(f"der({state.name})", rate) for state, rate in rates.items()]


def _with_units(names: Iterable[str], units: Mapping[str, str | None]) -> list[str]:
    return [f"{name} [{units[name]}]" if units.get(name) else name for name in names]


def _inputs(equations: Equations) -> tuple[list[str], dict[str, str | None]]:
    """Return names and units of inputs; a rate of an input has its unit per second."""
    units = {symbol.name: unit for symbol, unit in equations.graph.inputs.items()}
    for symbol, rate in equations.input_rates.items():
        units[rate.name] = f"{units[symbol.name]}/s" if units.get(symbol.name) else ""
    return [symbol.name for symbol in equations.inputs], dict(units)


def _needed(
    equations: Equations, results: Iterable[sympy.Expr] | None = None
) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
    """Return the assignments that given expressions rest on, or all that is shown."""
    if results is None:
        results = [*equations.derivatives, *equations.residuals, *equations.outputs.values()]
        results += [*equations.dependent.values(), *_contact_variables(equations)]
        results += [item.breakaway for item in equations.contacts]
        results += sorted(describe.switch_variables(equations), key=str)
        results += describe.field_energies(equations).values()
    arguments = [("all", sorted(equations.arguments, key=str))]
    program = Program.pruned("shown", arguments, equations.assignments, {"results": results})
    return program.assignments


def _state_name(equations: Equations, element: str) -> str:
    return f"{element}.{'q' if equations.graph[element].kind == 'C' else 'p'}"


def _contacts(equations: Equations) -> Iterable[str]:
    for contact in equations.contacts:
        limit = _plain(contact.breakaway)
        yield (
            f"{contact.name}: {contact.direction} is the sign of {contact.slip}; "
            f"at rest it sticks while |{contact.effort}| <= {limit}"
        )


def _outputs(equations: Equations) -> list[str]:
    lines = []
    for name, expression in equations.outputs.items():
        output = equations.graph.outputs[name]
        unit = f" [{output.unit}]" if output.unit else ""
        lines.append(
            _line(name, expression) + unit + (f"  {output.meaning}" if output.meaning else "")
        )
    return lines


def to_latex(equations: Equations) -> str:
    r"""Write the equations as LaTeX.

    Parameters
    ----------
    equations : Equations

    Returns
    -------
    str
        An ``align*`` environment for amsmath or MathJax: the state equations
        expanded (slip and effort of contacts keep their names), or for a large
        model all assignments; then algebraic equations, switching elements and
        dependent storage. What is zero for a switching element is given case
        by case: its modes, each while its margin is positive.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble, derive
    >>> loop = One("loop")
    >>> print(to_latex(derive(assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3))))))
    \begin{align*}
    \dot{q}_{\mathrm{c}} &= \frac{1}{2} - \frac{q_{\mathrm{c}}}{6}
    \end{align*}
    """
    names = _latex_names(equations)
    found = _expanded(equations, _contact_variables(equations))
    if found is None:
        rows = _latex_rows(_needed(equations), names)
        rates = dict(zip(equations.states, equations.derivatives, strict=True))
        residuals = [*equations.residuals, *describe.switch_cases(equations)]
        dependent = dict(equations.dependent)
    else:
        rows, rates = _latex_rows(found[0].items(), names), found[1]
        zeros = (*equations.residuals, *describe.switch_cases(equations))
        residuals = [equations.substituted(value) for value in zeros]
        dependent = {
            name: equations.substituted(value) for name, value in equations.dependent.items()
        }
    rows += [(latex_name(state.name, dots=1), rate) for state, rate in rates.items()]
    rows += [("0", residual) for residual in residuals]
    rows += [
        (latex_name(_state_name(equations, name)), value)
        for name, value in dependent.items()
        if value not in equations.algebraic
    ]
    return align(rows, names)


def _latex_rows(
    pairs: Iterable[tuple[sympy.Symbol, sympy.Expr]], names: Mapping[sympy.Basic, str]
) -> list[tuple[str, sympy.Expr]]:
    return [(latex(symbol, names), value) for symbol, value in pairs]


def _latex_names(equations: Equations) -> dict[sympy.Basic, str]:
    """Name every symbol; the direction of a contact's slip is a sigma."""
    names: dict[sympy.Basic, str] = {}
    for contact in equations.contacts:
        names[contact.direction] = latex_name(f"{contact.name}.sigma")
    symbols = sorted(equations.arguments - names.keys(), key=str)
    return latex_names([*symbols, *(symbol for symbol, _ in equations.assignments)]) | names


def to_json(equations: Equations, values: Mapping[str, float] | None = None) -> dict[str, Any]:
    """Return what ``bondgraph equations --format json`` prints.

    Parameters
    ----------
    equations : Equations
    values : mapping of str to float, optional
        SI values of parameters.

    Returns
    -------
    dict
        Expressions are text in sympy's notation, values and units are SI. The
        rates of a small model are expanded and ``assignments`` is empty; those
        of a large one rest on ``assignments``, which are in order. ``switches``
        tells the modes of switching elements, ``energies`` those of fields;
        ``storages``, ``reductions``, ``loops``, ``signals`` and ``input_rates``
        are as `bondgraph.causality_report.to_json` describes them.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble, derive
    >>> loop = One("loop")
    >>> to_json(derive(assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3)))))["states"]
    [{'name': 'c.q', 'derivative': '1/2 - c.q/6'}]
    """
    rates = expanded(equations)
    assignments = _needed(equations) if rates is None else ()
    residuals = equations.residuals
    if rates is None:
        rates = dict(zip(equations.states, equations.derivatives, strict=True))
    else:
        residuals = tuple(equations.substituted(residual) for residual in residuals)
    return {
        "schema": 1,
        "states": [{"name": s.name, "derivative": str(rate)} for s, rate in rates.items()],
        "algebraic": [
            {"name": symbol.name, "residual": str(residual)}
            for symbol, residual in zip(equations.algebraic, residuals, strict=True)
        ],
        "assignments": [{"name": s.name, "expression": str(value)} for s, value in assignments],
        "inputs": [symbol.name for symbol in equations.inputs],
        "parameters": {
            symbol.name: {"value": (values or {}).get(symbol.name), "unit": _si(row.unit)}
            for symbol, row in equations.graph.parameters.items()
        },
        "causality": [
            {
                "bond": stroke.bond,
                "effort_out_of": stroke.effort_out_of,
                "reason": stroke.reason.value,
                "because": stroke.because,
            }
            for stroke in equations.causal.strokes
        ],
        "warnings": list(equations.warnings),
        "switches": describe.switches_json(equations),
        "energies": {
            name: str(value) for name, value in describe.field_energies(equations).items()
        },
        **findings(report_causality(equations, modes=False)),
    }


def _si(unit: str) -> str:
    try:
        return si_unit(unit)
    except ParameterError:
        return unit
