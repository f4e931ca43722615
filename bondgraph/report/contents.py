"""What the report says of any model: parameters, operating point, eigenvalues, equations."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy
import sympy

from ..causality import CausalGraph
from ..dimensions import infer, si_unit
from ..elements import Friction
from ..equations import derive
from ..errors import ParameterError
from ..graph import BondGraph
from ..plot import friction_curve, growth_rates, pretty, root_locus
from ..stability import Edge, Locus, Mode, StabilityResult
from ..stability.verdict import duration
from ..text import to_text
from ..units import from_si
from .blocks import Bullets, Figure, Markup, Panel, Section, Table, Text
from .mathml import state_equations
from .svg import inline

# Beside the states and what they add up from, smaller values are what the solver leaves of zero.
NOISE = 1e-12
CARRIERS = 3


def number(value: float, digits: int = 6) -> str:
    """Write a number with a few digits, as every table of the report does.

    Examples
    --------
    >>> number(1264.60010198), number(8.88178e-09), number(2250.0), number(-0.0)
    ('1264.6', '8.88178e-9', '2250', '0')
    """
    if value == 0:
        return "0"
    return re.sub(
        r"e([+-])0*(\d)", lambda found: f"e{found[1].strip('+')}{found[2]}", f"{value:.{digits}g}"
    )


def slug(text: str) -> str:
    """Return a text as part of a file's name.

    Examples
    --------
    >>> slug("rear mass/k_f")
    'rear-mass-k_f'
    """
    return re.sub(r"[^A-Za-z0-9_-]+", "-", text).strip("-") or "plot"


def model_section(result: StabilityResult, causal: CausalGraph, description: str) -> Section:
    """Describe the model: words, drawing and size."""
    graph = result.graph
    states = len(result.system.states)
    size = (
        f"{len(graph.elements)} elements, {len(graph.bonds)} bonds, "
        f"{states} state{'s' * (states != 1)}."
    )
    words = [*_paragraphs(description), Text(size, "note")]
    return Section("Model", (*words, *_drawing(causal)))


def _paragraphs(description: str) -> list[Text]:
    """Split a docstring into paragraphs; headings of its sections become part of theirs."""
    text = re.sub(r"(?m)^(.+)\n-{3,}$", r"\1:", description.strip())
    return [Text(" ".join(part.split())) for part in re.split(r"\n\s*\n", text) if part.strip()]


def _drawing(causal: CausalGraph) -> list[Markup]:
    try:
        from ..draw import to_svg
    except ImportError:
        return []
    name = causal.graph.name
    svg = inline(to_svg(causal), "bond-graph", f"Bond graph of {name} with causal strokes")
    return [Markup(f'<div class="drawing">{svg}</div>')]


def parameter_section(result: StabilityResult) -> Section:
    """List the parameters that the equations rest on."""
    graph, values = result.graph, result.point.parameters
    used = _with_ancestors(graph, result)
    rows = []
    for symbol, row in graph.parameters.items():
        if symbol.name not in used or symbol.name not in values:
            continue
        value = values[symbol.name]
        source = row.source
        if symbol.name in result.overrides:
            source = "set for this report"
        elif row.derived:
            source = f"{row.source or 'derived'}: {_plain(row.value)}"
        unit, own = _coherent(row.unit), row.unit or "1"
        in_si = number(value) if unit == own else f"{number(value)} {pretty(unit)}"
        shown = number(from_si(value, row.unit))
        rows.append((symbol.name, shown, pretty(own), in_si, row.meaning, source))
    head = ("name", "value", "unit", "SI value", "meaning", "source")
    idle = [symbol.name for symbol in graph.parameters if symbol.name not in used]
    blocks: list[object] = [Table(head, tuple(rows), "crlrll", labelled=True)]
    if not rows:
        blocks = [Text("The laws hold numbers: there are no parameters.")]
    if idle:
        blocks.append(Text(f"In the table but not in these equations: {', '.join(idle)}.", "note"))
    return Section("Parameters", tuple(blocks))


def _with_ancestors(graph: BondGraph, result: StabilityResult) -> set[str]:
    """Return the names of the parameters in the equations and of those they derive from."""
    waiting = list(derive(graph).parameters)
    used: set[str] = set()
    while waiting:
        symbol = waiting.pop()
        if symbol.name in used:
            continue
        used.add(symbol.name)
        row = graph.parameters[symbol]
        if row.derived and symbol.name not in result.overrides:
            waiting += [inner for inner in row.value.free_symbols if inner in graph.parameters]
    return used


def _plain(expression: sympy.Expr) -> str:
    return str(expression).replace("**", "^")


def _coherent(unit: str) -> str:
    try:
        return si_unit(unit) or "1"
    except ParameterError:
        return unit


def point_section(result: StabilityResult) -> Section:
    """List states, outputs, inputs and modes at the operating point."""
    point, graph = result.point, result.graph
    units = infer(graph).units
    noise = _noise(result)
    meanings = {name: output.meaning for name, output in graph.outputs.items()}
    units = {**units, **{name: output.unit or "1" for name, output in graph.outputs.items()}}
    units |= {symbol.name: unit for symbol, unit in graph.inputs.items()}
    rows = tuple(
        (
            kind,
            name,
            number(0.0 if abs(value) <= noise.get(name, 0.0) else value),
            pretty(units.get(name) or ""),
            meanings.get(name, ""),
        )
        for kind, table in (
            ("state", point.states),
            ("output", point.outputs),
            ("input", point.inputs),
        )
        for name, value in table.items()
    )
    blocks: list[object] = [
        Text("The point where all rates are zero, found by solving."),
        Table(("", "name", "value", "unit", "meaning"), rows, "lcrll"),
    ]
    if point.modes:
        held = ", ".join(f"{name}: {mode}" for name, mode in point.modes.items())
        blocks.append(Text(f"Contacts at this point: {held}."))
    return Section("Operating point", tuple(blocks))


def _noise(result: StabilityResult) -> dict[str, float]:
    """Return the size below which a state or output is nothing but rounding."""
    import scipy.linalg

    system = result.system
    if not system.states:
        return {}
    scale = numpy.diag(scipy.linalg.matrix_balance(system.A, permute=False)[1])
    x = numpy.array(list(result.point.states.values()))
    states = NOISE * numpy.abs(x / scale).max() * scale
    outputs = numpy.abs(system.C) @ states
    names = (*system.states, *system.outputs)
    return dict(zip(names, map(float, (*states, *outputs)), strict=True))


def eigenvalue_section(result: StabilityResult) -> Section:
    """List the modes and what carries, feeds and drains them."""
    rows = tuple(_mode_row(mode) for mode in result.rows if mode.eigenvalue.imag >= 0)
    head = (
        "eigenvalue [1/s]",
        "frequency [Hz]",
        "damping ratio",
        "stable?",
        "time constant",
        "dominated by",
        "fed and drained by [1/s]",
    )
    states = result.system.states
    matrix = tuple(
        (name, *(number(value) for value in row))
        for name, row in zip(states, result.system.A, strict=True)
    )
    return Section(
        "Eigenvalues",
        (
            Table(head, rows, "rrrlrll"),
            Text(
                "Time constant: in which the amplitude changes by a factor e. Dominated by: "
                "participation factors, summed over the states of each element. Fed and drained: "
                "what each dissipator or source adds to the growth rate, its power in the mode "
                "over twice the mode's energy; the sum is the real part.",
                "note",
            ),
            Table(
                ("A [SI]", *states),
                matrix,
                "c" + "r" * len(states),
                "State matrix: rate of each row's state for a change of each column's.",
                labelled=True,
            ),
        ),
    )


def _mode_row(mode: Mode) -> tuple[str, ...]:
    value = mode.eigenvalue
    pair = f" ± {number(abs(value.imag), 7)}j" if value.imag else ""
    ratio = mode.damping_ratio
    return (
        f"{number(value.real, 7)}{pair}",
        number(mode.frequency_hz),
        "" if ratio is None else number(ratio, 4),
        {1: "unstable", -1: "stable", 0: "neither"}[mode.growth],
        duration(mode.time_constant) if mode.growth else "",
        _shares(mode),
        _feeds(mode),
    )


def _shares(mode: Mode) -> str:
    told = [f"{name} {mode.carriers[name]:.0%}" for name in mode.elements[:CARRIERS]]
    more = len(mode.elements) - CARRIERS
    return ", ".join([*told, *([f"{more} more"] if more > 0 else [])])


def _feeds(mode: Mode) -> str:
    largest = max(map(abs, mode.telling.values()), default=0.0)
    told = sorted(mode.telling.items(), key=lambda item: -abs(item[1]))
    shown = [f"{name} {rate:+.4g}" for name, rate in told if abs(rate) > 1e-3 * largest]
    return ", ".join(shown[: 2 * CARRIERS])


def locus_section(loci: Sequence[Locus]) -> Section | None:
    """Show the eigenvalues along each varied parameter, with their edges."""
    if not loci:
        return None
    blocks: list[object] = []
    for locus in loci:
        blocks.append(_locus_figure(locus))
        if locus.crossings:
            blocks.append(_crossings(locus))
        else:
            blocks.append(Text(f"No mode changes its stability along {locus.name}."))
    return Section("How far the edge is", tuple(blocks))


def _locus_figure(locus: Locus) -> Figure:
    numbers = _locus_numbers(locus)
    where = f"from {_shown(locus.values[0], locus)} to {_shown(locus.values[-1], locus)}"
    return Figure(
        f"Eigenvalues along {locus.name}.",
        (
            Panel(
                f"locus-{slug(locus.name)}",
                root_locus(locus),
                f"Root locus over {locus.name} {where}",
                numbers,
            ),
            Panel(
                f"growth-{slug(locus.name)}",
                growth_rates(locus),
                f"Growth rate of each mode over {locus.name} {where}",
                numbers,
            ),
        ),
        f"{len(locus.values)} points {where}. Left of zero a mode decays, in the shaded part it "
        f"grows. Crosses: operating point, {locus.name} = {_shown(locus.at, locus)}. Full "
        f"diamonds: edge of stability; hollow: a further mode changes while another one grows "
        f"already. Curves may run on beyond the frame.",
    )


def _locus_numbers(locus: Locus) -> dict[str, numpy.ndarray]:
    columns = {f"{locus.name} [{_coherent(locus.unit)}]": locus.values}
    for index, column in enumerate(locus.eigenvalues.T, start=1):
        columns[f"growth rate {index} [1/s]"] = column.real
        columns[f"frequency {index} [Hz]"] = column.imag / (2 * numpy.pi)
    return columns


def _crossings(locus: Locus) -> Table:
    rows = tuple(_crossing(edge, locus) for edge in locus.crossings)
    head = (locus.name, "unit", "kind", "frequency [Hz]", "growing side", "meaning", "dominated by")
    return Table(head, rows, "rllrlll")


def _crossing(edge: Edge, locus: Locus) -> tuple[str, ...]:
    side = {True: "above", False: "below", None: "the branch ends"}[edge.unstable_above]
    return (
        number(from_si(edge.value, locus.unit), 8),
        pretty(locus.unit or "1"),
        "Hopf" if edge.kind == "hopf" else "fold",
        number(edge.frequency_hz, 8),
        side,
        "edge of stability" if edge.boundary else "a further mode",
        _shares(edge.mode),
    )


def _shown(value: float, locus: Locus) -> str:
    return f"{number(from_si(float(value), locus.unit))}{' ' + pretty(locus.unit) if locus.unit else ''}"


def friction_section(result: StabilityResult) -> Section | None:
    """Show the law of each contact at the operating point."""
    names = [name for name, item in result.graph.of(Friction) if item.smoothing is None]
    if not names:
        return None
    figures = tuple(
        Figure(
            f"{name}.",
            (
                Panel(
                    f"friction-{slug(name)}",
                    friction_curve(result.graph, name, result.point),
                    f"Friction of {name} over its slip",
                ),
            ),
            "Friction over slip with the parameters of this report. At zero slip it takes any "
            "value between the two limits.",
        )
        for name in names
    )
    return Section("Friction", figures)


def equation_section(result: StabilityResult) -> Section:
    """Show the state equations as formulas, and the assignments as they are computed."""
    equations = derive(result.graph)
    formulas = state_equations(equations)
    blocks: list[object] = []
    if equations.contacts:
        blocks.append(
            Text(
                "While slipping; σ is +1 or -1, the direction of slip. A contact that sticks holds "
                "its slip at zero, and its effort follows from the rates."
            )
        )
    if formulas:
        blocks.append(Markup(f'<div class="formulas">{"".join(formulas)}</div>'))
    blocks.append(Text("In full, with the assignments in the order they are computed in:"))
    blocks.append(Text(to_text(equations), "code"))
    return Section("Equations", tuple(blocks))


def causality_section(causal: CausalGraph) -> Section:
    """List the stroke of each bond with its reason, and what lost integral causality."""
    rows = tuple(
        (stroke.bond, stroke.effort_out_of, stroke.reason.value, stroke.because)
        for stroke in causal.strokes
    )
    blocks: list[object] = [
        Text(
            "Each bond's effort is decided at one end and its flow at the other; the stroke is "
            "drawn where the effort arrives."
        ),
        Table(("bond", "effort out of", "reason", "because"), rows, "ccll"),
    ]
    if causal.derivative:
        blocks += [Text("Derivative causality:"), Bullets(causal.warnings)]
    else:
        blocks.append(Text("All storage is in integral causality."))
    return Section("Causality", tuple(blocks))


def assumption_section(result: StabilityResult) -> Section:
    """List warnings, notes of the graph, and what the verdict takes for granted."""
    said = [
        *result.warnings,
        *result.graph.notes,
        *(f"units: {text}" for text in infer(result.graph).problems),
        "the eigenvalues are those of the linearised equations: they tell of small motions about "
        "the operating point",
    ]
    if result.loci:
        said.append(
            "whether an edge is crossed softly or hard (first Lyapunov coefficient) is not computed"
        )
    return Section("Warnings and assumptions", (Bullets(tuple(dict.fromkeys(said))),))


def solver_section(result: StabilityResult, figures: Iterable[Figure]) -> Section:
    """List how each computation ended."""
    found = "isolated" if result.point.isolated else "one of many: a state is free"
    rows = [("steady state", "found", found)]
    for locus in result.loci:
        good = len(locus.values) - len(locus.gaps)
        rows.append(
            (f"locus over {locus.name}", f"{good} of {len(locus.values)} points", _reasons(locus))
        )
    for figure in figures:
        if figure.run is not None:
            rows.append((f"run of {figure.title}", figure.run.outcome.value, _run(figure)))
    return Section("Solver outcomes", (Table(("computation", "outcome", "details"), tuple(rows)),))


def _reasons(locus: Locus) -> str:
    return "; ".join(dict.fromkeys(gap.reason for gap in locus.gaps))


def _run(figure: Figure) -> str:
    run = figure.run
    assert run is not None
    residual = run.energy.relative_residual
    energy = "no energy audit" if residual is None else f"relative energy residual {residual:.1e}"
    return (
        f"to {number(run.t_end)} s in {run.steps} steps ({run.backend}), {len(run.events)} changes "
        f"of mode, {energy}"
    )
