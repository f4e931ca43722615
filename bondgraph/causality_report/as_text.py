"""The report as plain text."""

from __future__ import annotations

from collections.abc import Iterable

from ..describe import plain
from .value import (
    BondCausality,
    CausalityReport,
    JunctionDecision,
    LoopReport,
    ModeCausality,
    StorageCausality,
)


def to_text(report: CausalityReport) -> str:
    """Write the report as plain text.

    Parameters
    ----------
    report : CausalityReport

    Returns
    -------
    str
        Sections: bonds, junctions, storages, loops, rates of inputs, signals,
        modes, disconnected parts, and what was put right. What a model does
        not have is left out.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble
    >>> from bondgraph.causality_report import report_causality
    >>> loop = One("loop")
    >>> rc = assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3)))
    >>> print(to_text(report_causality(rc)))
    rc: causality of 3 bonds; all storage is independent
    <BLANKLINE>
    Bonds: -> shows where power is positive, | is the causal stroke, at the end that decides the flow
      E ->| loop  source: Se 'E' decides its effort
      loop ->| r  propagated: through 1 'loop', from: integral causality of C 'c'
      loop |-> c  integral: integral causality of C 'c'
    <BLANKLINE>
    Junctions: the one bond that decides what is shared
      1 loop: r decides the flow, by loop>r; E and c follow
        why: all other bonds take it, so this one has to decide; through 1 'loop', from: integral causality of C 'c'
    <BLANKLINE>
    Storage
      c.q: C in integral causality, a state
    """
    wide = max((len(_arrow(bond)) for bond in report.bonds), default=0)
    sections: list[tuple[str, Iterable[str]]] = [
        (
            "Bonds: -> shows where power is positive, | is the causal stroke, "
            "at the end that decides the flow",
            [f"{_arrow(bond):<{wide}}  {bond.reason}: {bond.because}" for bond in report.bonds],
        ),
        (
            "Junctions: the one bond that decides what is shared",
            [line for item in report.junctions for line in _junction(item)],
        ),
        ("Storage", [line for item in report.storages for line in _storage(item)]),
        ("Loops", [line for item in report.loops for line in _loop(item)]),
        (
            "Rates of inputs that are needed, since a dependent storage follows them",
            [f"{rate} of {name}" for name, rate in report.input_rates],
        ),
        (
            "Signals: laws that use a variable of another element",
            [f"{item.source}.{item.variable} -> {item.target}" for item in report.signals],
        ),
        (mode_heading(report), [line for item in report.modes for line in _mode(item)]),
        (
            "Disconnected parts, each solved on its own",
            [", ".join(part) for part in report.parts],
        ),
        ("Put right", report.turned),
    ]
    blocks = [
        "\n".join([title, *(f"  {line}" for line in lines)]) for title, lines in sections if lines
    ]
    return "\n\n".join([headline(report), *blocks])


def headline(report: CausalityReport) -> str:
    """Say the whole in one line."""
    bonds, dependent = len(report.bonds), len(report.dependent)
    said = [f"{report.model}: causality of {bonds} bond{'s' * (bonds != 1)}"]
    if dependent:
        said.append(f"{dependent} of {len(report.storages)} storages dependent")
    elif report.storages:
        said.append("all storage is independent")
    loops = len(report.loops)
    if loops:
        said.append(f"{loops} loop{'s' * (loops != 1)}")
    return "; ".join(said)


def mode_heading(report: CausalityReport) -> str:
    """Say which modes are listed."""
    if len(report.modes) < report.possible_modes:
        return (
            f"Modes of a single change, of {report.possible_modes} in all: states that each binds"
        )
    return "Modes: states that each binds"


def listed(names: Iterable[str]) -> str:
    """Join names as a sentence does.

    Examples
    --------
    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    words = list(names)
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} and {words[-1]}"


def constraint_of(item: StorageCausality) -> str:
    """Write what the state of a dependent storage is."""
    sides = [item.state]
    for value in (item.constraint, item.expanded):
        if value is not None and plain(value) not in sides:
            sides.append(plain(value))
    if len(sides) == 1:
        return f"{item.state} follows from its law, which is not solved for it"
    return " = ".join(sides)


def solved_as(item: LoopReport) -> str:
    """Say how a loop was dealt with."""
    if item.solved == "linear":
        return f"linear, solved symbolically for {listed(item.tearing)}"
    kept = f"algebraic variable{'s' * (len(item.tearing) != 1)}"
    return f"not linear, {listed(item.tearing)} kept as {kept}"


def effect_of(item: ModeCausality) -> str:
    """Say what a mode does to the states."""
    if item.impossible:
        return f"cannot be: {item.impossible}"
    said = []
    for bound in item.bound:
        value = "" if bound.value is None else f" = {plain(bound.value)}"
        by = f", bound by {listed(bound.bound_by)}" if bound.bound_by else ""
        said.append(f"{bound.state}{value}{by}")
    said += [f"{name} stays implicit" for name in item.algebraic]
    return "; ".join(said) or "all states are free"


def _arrow(bond: BondCausality) -> str:
    arrow = "->|" if bond.flow_out_of == bond.head else "|->"
    return f"{bond.tail} {arrow} {bond.head}"


def _junction(item: JunctionDecision) -> Iterable[str]:
    follow = f"; {listed(item.followers)} follow{'s' * (len(item.followers) == 1)}"
    yield f"{item.kind} {item.junction}: {item.decided_by} decides the {item.shared}, by {item.bond}{follow}"
    yield f"  why: {item.because}"


def _storage(item: StorageCausality) -> Iterable[str]:
    if item.integral:
        yield f"{item.state}: {item.kind} in integral causality, a state"
        return
    yield f"{item.state}: {item.kind} in derivative causality, no state of its own"
    by = f", bound by {listed(item.bound_by)}" if item.bound_by else ""
    yield f"  constraint: {constraint_of(item)}{by}"
    yield f"  why: {item.because}"
    yield f"  done: {item.done}"
    if item.idle_initial:
        yield "  its initial value is not used"


def _loop(item: LoopReport) -> Iterable[str]:
    yield f"{item.kind}: {' -> '.join((*item.variables, item.variables[0]))}"
    yield f"  done: {solved_as(item)}"
    yield f"  without it: {item.remedy}"


def _mode(item: ModeCausality) -> Iterable[str]:
    yield f"{', '.join(f'{name} {mode}' for name, mode in item.modes.items())}: {effect_of(item)}"
    for bound in item.bound:
        yield f"  {bound.state}: {bound.because}"
