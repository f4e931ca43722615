"""Units of an effect's coefficients, from the units of its site."""

from __future__ import annotations

from ...dimensions import infer
from ...dimensions.forms import DISPLAY, PSEUDO
from ...elements import Sf
from ...equations.accounts import pseudo_elements
from ...errors import ParameterError
from ...graph import BondGraph
from ...units import parse_unit
from ..candidates.places import OUTPUT
from ..candidates.value import Coefficient
from .places import Site


def unit_of(graph: BondGraph, site: Site, coefficient: Coefficient) -> str:
    """Return a coefficient's unit at a site; empty where the site's domain is not known.

    Parameters
    ----------
    graph : BondGraph
    site : Site
    coefficient : Coefficient

    Returns
    -------
    str
    """
    if site.kind == OUTPUT:
        words = {"u": graph.outputs[site.at[0]].unit or infer(graph).units.get(site.at[0]) or ""}
    else:
        words = _words(graph, site)
    try:
        unit = coefficient.unit.format(**words)
    except KeyError:
        return ""
    if coefficient.unit and not any(words.values()):
        return ""  # beside numbers without units, one unit alone would contradict
    try:
        parse_unit(unit)
    except ParameterError:
        return ""
    return _plain(unit)


def _words(graph: BondGraph, site: Site) -> dict[str, str]:
    element = graph.elements.get(site.at[0])
    known = PSEUDO if site.at[0] in pseudo_elements(graph) else DISPLAY.get(site.domain)
    if known is None:
        return {}
    words = dict(zip("efqp", known, strict=True))
    return words | {"u": words["f" if isinstance(element, Sf) else "e"]}


def _plain(unit: str) -> str:
    """Write a unit of one word without its brackets."""
    for word in ("N", "m", "rad", "V", "A", "C", "Wb", "Pa", "K", "W", "J"):
        unit = unit.replace(f"({word})", word)
    return unit
