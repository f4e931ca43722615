"""The command ``bondgraph symbolic``: a small model in symbols."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import click

from . import options as opt

if TYPE_CHECKING:
    import sympy

    from bondgraph.graph import BondGraph
    from bondgraph.symbolic import RouthHurwitz, SymbolicSystem, TransferFunction


@click.command()
@opt.model_argument
@click.option(
    "--at",
    "point",
    multiple=True,
    metavar="NAME=EXPR",
    help="Operating point of a state or input; others stay symbols. Repeatable.",
)
@click.option(
    "--mode",
    "fixed",
    multiple=True,
    metavar="NAME=MODE",
    help="Hold a contact in stick, slip+ or slip-.",
)
@opt.set_option
@click.option(
    "--transfer",
    multiple=True,
    metavar="OUT:IN",
    help="Transfer function; OUT may be a port variable, IN a parameter. Repeatable.",
)
@click.option("--routh", is_flag=True, help="Routh-Hurwitz conditions for stability.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "latex", "json"]),
    default="text",
    help="What to print.",
)
@click.option("--json", "as_json", is_flag=True, help="The same as --format json.")
@opt.debug_option
def symbolic(
    model: str,
    point: tuple[str, ...],
    fixed: tuple[str, ...],
    settings: tuple[str, ...],
    transfer: tuple[str, ...],
    routh: bool,
    form: str,
    as_json: bool,
) -> None:
    """Analyse a small model in symbols: Jacobians, characteristic polynomial, stability."""
    pairs = [_pair(word) for word in transfer]
    modes, values = opt.read_modes(fixed), opt.read_settings(settings)
    from bondgraph.symbolic import symbolic_system

    from .load import load_model

    graph = load_model(model)
    own = {symbol.name for symbol in graph.inputs}
    system = symbolic_system(
        graph,
        _point(graph, point),
        modes=modes,
        parameters=values,
        inputs=[name for _, name in pairs if name not in own],
        outputs=[name for name, _ in pairs],
    )
    found = [system.transfer_function(*pair) for pair in pairs]
    conditions = system.routh_hurwitz() if routh else None
    if as_json or form == "json":
        opt.print_json(_json(system, found, conditions))
        return
    show = _latex if form == "latex" else _text
    click.echo("\n\n".join(show(system, found, conditions)))


def _pair(word: str) -> tuple[str, str]:
    output, colon, source = word.rpartition(":")
    if not colon or not output or not source:
        raise click.UsageError(f"--transfer {word!r}: write OUT:IN")
    return output, source


def _point(graph: BondGraph, words: Iterable[str]) -> dict[str, sympy.Expr]:
    """Read the operating point; expressions may use parameters, inputs and states."""
    from bondgraph.errors import LawError
    from bondgraph.expressions import parse

    names: dict[str, Any] = {symbol.name: symbol for symbol in (*graph.parameters, *graph.inputs)}
    for element in graph.elements.values():
        names |= {symbol.name: symbol for symbol in element.symbols.values()}
    found = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not name.strip() or not text.strip():
            raise click.UsageError(f"--at {word!r}: write NAME=EXPR")
        try:
            found[name.strip()] = parse(text, names)
        except LawError as error:
            raise click.UsageError(f"--at {name.strip()}: {error}") from None
    return found


def _tried(function: Callable[[], Any]) -> tuple[Any, str]:
    """Return a result, or None and why there is none."""
    from bondgraph.symbolic import SymbolicError

    try:
        return function(), ""
    except SymbolicError as error:
        return None, str(error)


def _plain(expression: object) -> str:
    return str(expression).replace("**", "^")


def _text(
    system: SymbolicSystem, found: list[TransferFunction], conditions: RouthHurwitz | None
) -> Iterable[str]:
    """Give the sections of the text, one by one."""
    yield _section(
        "State equations",
        [f"der({state.name}) = {_plain(rate)}" for state, rate in system.rates.items()],
    )
    if system.residuals:
        yield _section("Algebraic equations", [f"0 = {_plain(item)}" for item in system.residuals])
    if system.outputs:
        lines = [f"{name} = {_plain(value)}" for name, value in system.outputs.items()]
        yield _section("Outputs", lines)
    if system.at:
        point = [f"{symbol.name} = {_plain(value)}" for symbol, value in system.at.items()]
        drift = [
            f"der({state.name}) = {_plain(rate)} there" for state, rate in system.drift.items()
        ]
        yield _section("Operating point", point + drift)
    for name, matrix, rows, columns in _matrices(system):
        yield _section(name, _entries(matrix, rows, columns) or ["zero"])
    polynomial, why = _tried(system.characteristic_polynomial)
    yield _section("Characteristic polynomial", [str(polynomial) if polynomial else why])
    poles, why = _tried(system.poles)
    lines = [f"{_plain(pole)}{f', {n} times' * (n > 1)}" for pole, n in (poles or {}).items()]
    yield _section("Poles", lines or [why or "none"])
    for item in found:
        lines = [f"({item.numerator})", f"/ ({item.denominator})", f"at s = 0: {_gain(item)}"]
        yield _section(f"Transfer function from {item.input} to {item.output}", lines)
    if conditions is not None:
        lines = [f"{_plain(item)} > 0" for item in conditions.conditions]
        yield _section("Routh-Hurwitz", [conditions.status.value, *conditions.reasons, *lines])


def _section(heading: str, lines: Iterable[str]) -> str:
    return "\n".join([heading, *(f"  {line}" for line in lines)])


def _matrices(system: SymbolicSystem) -> Iterable[tuple[str, Any, list[str], list[str]]]:
    states, inputs = [[symbol.name for symbol in group] for group in (system.states, system.inputs)]
    outputs = list(system.outputs)
    yield "A, of rates along states", system.A, [f"der({name})" for name in states], states
    if inputs:
        yield "B, of rates along inputs", system.B, [f"der({name})" for name in states], inputs
    if outputs:
        yield "C, of outputs along states", system.C, outputs, states
    if outputs and inputs:
        yield "D, of outputs along inputs", system.D, outputs, inputs


def _entries(matrix: Any, rows: list[str], columns: list[str]) -> list[str]:
    return [
        f"{row} along {column}: {_plain(matrix[i, j])}"
        for i, row in enumerate(rows)
        for j, column in enumerate(columns)
        if matrix[i, j] != 0
    ]


def _gain(item: TransferFunction) -> str:
    gain = item.dcgain()
    return _plain(gain) if gain.is_finite is not False else "infinite: a free integrator"


def _latex(
    system: SymbolicSystem, found: list[TransferFunction], conditions: RouthHurwitz | None
) -> Iterable[str]:
    yield system.to_latex()
    polynomial, _ = _tried(system.characteristic_polynomial)
    if polynomial is not None:
        yield f"\\[\n{polynomial.to_latex()}\n\\]"
    for item in found:
        yield f"\\[\n{item.to_latex()}\n\\]"
    if conditions is not None:
        yield conditions.to_latex()


def _json(
    system: SymbolicSystem, found: list[TransferFunction], conditions: RouthHurwitz | None
) -> dict[str, Any]:
    """Return the JSON object: expressions are text in sympy's notation, in SI."""
    polynomial, why = _tried(system.characteristic_polynomial)
    poles, _ = _tried(system.poles)
    return {
        "schema": 1,
        "model": system.name,
        "states": [{"name": s.name, "derivative": str(rate)} for s, rate in system.rates.items()],
        "inputs": [symbol.name for symbol in system.inputs],
        "parameters": [symbol.name for symbol in system.parameters],
        "outputs": [{"name": name, "expression": str(v)} for name, v in system.outputs.items()],
        "algebraic": [
            {"name": symbol.name, "residual": str(item)}
            for symbol, item in zip(system.algebraic, system.residuals, strict=True)
        ],
        "at": {symbol.name: str(value) for symbol, value in system.at.items()},
        "drift": {state.name: str(rate) for state, rate in system.drift.items()},
        **{name: _rows(getattr(system, name)) for name in "ABCD"},
        "characteristic_polynomial": _words(polynomial.coefficients) if polynomial else None,
        "poles": None
        if poles is None
        else [{"pole": str(p), "times": n} for p, n in poles.items()],
        "transfer": [
            {
                "output": item.output,
                "input": item.input,
                "numerator": _words(item.numerator.coefficients),
                "denominator": _words(item.denominator.coefficients),
                "dcgain": str(item.dcgain()) if item.dcgain().is_finite is not False else None,
            }
            for item in found
        ],
        "routh_hurwitz": None if conditions is None else _conditions(conditions),
        "warnings": [why] if why else [],
    }


def _conditions(found: RouthHurwitz) -> dict[str, Any]:
    return {
        "status": found.status.name.lower(),
        "polynomial": _words(found.polynomial.coefficients),
        "integrators": found.integrators,
        "conditions": _words(found.conditions),
        "violated": _words(found.violated),
        "reasons": list(found.reasons),
    }


def _words(expressions: Iterable[object]) -> list[str]:
    return [str(item) for item in expressions]


def _rows(matrix: Any) -> list[list[str]]:
    return [[str(matrix[i, j]) for j in range(matrix.cols)] for i in range(matrix.rows)]
