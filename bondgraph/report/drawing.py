"""The graph's drawing, ready for the page."""

from __future__ import annotations

import re
from collections.abc import Iterable

from ..causality import CausalGraph
from ..draw import to_svg
from .blocks import Markup
from .svg import inline

# A drawing fills the page's width, but grows no larger than this.
LARGEST = 1.2


def drawing(
    causal: CausalGraph, name: str, *, numbers: bool = False, accented: Iterable[str] = ()
) -> list[Markup]:
    """Return the drawing of a graph as a block of the page.

    Parameters
    ----------
    causal : CausalGraph
    name : str
        Prefix of its ids: a page may hold several.
    numbers : bool
        Whether to number the bonds.
    accented : iterable of str
        Elements in blue, as for `bondgraph.draw.to_svg`.

    Returns
    -------
    list of Markup
    """
    words = f"Bond graph of {causal.graph.name} with causal strokes"
    picture = to_svg(causal, numbers=numbers, accented=accented)
    svg = inline(picture, name, f"{words} and numbered bonds" if numbers else words)
    box = re.search(r'viewBox="[\d.-]+ [\d.-]+ ([\d.]+)', svg)
    width = LARGEST * float(box[1]) if box else 1000
    return [
        Markup(
            f'<div class="drawing"><div style="max-width: {width:.0f}px; --natural: {width:.0f}px">{svg}</div></div>'
        )
    ]
