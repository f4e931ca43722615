"""Views of graphs: the drawing, with causal strokes where they can be assigned."""

from __future__ import annotations

from ..causality import CausalGraph, assign_causality
from ..draw import to_svg
from ..errors import BondGraphError
from ..graph import BondGraph
from ..units import pretty
from .markup import block, folded, items, number, paragraph, scrolled, table


def svg(graph: BondGraph | CausalGraph) -> str:
    """Return the drawing; without strokes where causality fails.

    Parameters
    ----------
    graph : BondGraph or CausalGraph

    Returns
    -------
    str
    """
    return to_svg(_causal(graph)[0])


def html(graph: BondGraph | CausalGraph) -> str:
    """Return the drawing, what the graph is made of, and its warnings.

    Parameters
    ----------
    graph : BondGraph or CausalGraph

    Returns
    -------
    str
    """
    shown, failed = _causal(graph)
    plain = shown if isinstance(shown, BondGraph) else shown.graph
    kinds: dict[str, list[str]] = {}
    for name, element in plain.elements.items():
        kinds.setdefault(element.kind, []).append(name)
    rows = [
        *((kind, str(len(names)), ", ".join(names)) for kind, names in kinds.items()),
        ("bonds", str(len(plain.bonds)), ""),
    ]
    warnings = [*plain.warnings, *(shown.warnings if isinstance(shown, CausalGraph) else ())]
    values = [
        (symbol.name, _value(row.value), pretty(row.unit or "1"), row.meaning)
        for symbol, row in plain.parameters.items()
    ]
    return block(
        f"Bond graph {plain.name}",
        scrolled(to_svg(shown)),
        paragraph(f"Without causal strokes: {failed}" if failed else ""),
        table(("element", "number", "names"), rows),
        folded(
            f"{len(values)} parameters", table(("parameter", "value", "unit", "meaning"), values)
        ),
        items(dict.fromkeys(warnings)),
    )


def _causal(graph: BondGraph | CausalGraph) -> tuple[BondGraph | CausalGraph, str]:
    """Return the graph with causality, or as it is with the reason why not."""
    if isinstance(graph, CausalGraph):
        return graph, ""
    try:
        return assign_causality(graph), ""
    except BondGraphError as error:
        return graph, str(error)


def _value(value: object) -> str:
    try:
        return number(float(value))  # type: ignore[arg-type]
    except TypeError:
        return "–" if value is None else str(value).replace("**", "^")
