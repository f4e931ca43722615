"""Drawings for the page: matplotlib axes and ready SVG text, made safe to stand inline."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

from ..plot.style import figure_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SETTINGS: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "halfarrow",
    "path.simplify_threshold": 0.2,
}
_NOTHING = dict.fromkeys(("Date", "Creator", "Format", "Type"))
_PREAMBLE = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<!--.*?-->|<metadata>.*?</metadata>", re.DOTALL)
_FONT = re.compile(r"font(-family)?:( ?[\d.]+px)? '[^;\"]*sans-serif")
_ROOT = re.compile(r"<svg\b[^>]*>", re.DOTALL)


def standalone(ax: Axes) -> str:
    """Return the figure of some axes as an SVG file, without date or maker.

    Parameters
    ----------
    ax : matplotlib.axes.Axes

    Returns
    -------
    str
    """
    import matplotlib

    buffer = io.StringIO()
    with matplotlib.rc_context(_SETTINGS):
        figure_of(ax).savefig(buffer, format="svg", metadata=_NOTHING, transparent=True)
    text = _PREAMBLE.sub("", buffer.getvalue()).strip()
    return '<?xml version="1.0" encoding="utf-8"?>\n' + text + "\n"


def inline(svg: str, name: str, description: str) -> str:
    """Return an SVG ready to stand in an HTML page.

    Its size follows the page, its ids are its own, and it is described to
    those who cannot see it.

    Parameters
    ----------
    svg : str
    name : str
        Prefix of its ids.
    description : str

    Returns
    -------
    str

    Examples
    --------
    >>> inline('<?xml version="1.0"?><svg width="9" viewBox="0 0 9 9"><g id="a"/></svg>', "p", "A")
    '<svg viewBox="0 0 9 9" role="img" aria-label="A"><g id="p-a"/></svg>'
    """
    from html import escape

    text = _PREAMBLE.sub("", svg).strip()
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r"url\(#", f"url(#{name}-", text)
    text = re.sub(r'(?:xlink:)?href="#', f'href="#{name}-', text)
    text = _FONT.sub(_plain_font, text)
    return _ROOT.sub(lambda found: _root(found[0], escape(description)), text, count=1)


def _plain_font(found: re.Match[str]) -> str:
    size = found[2]
    return f"font-size:{size}" if size else "font-family: inherit"


def _root(tag: str, description: str) -> str:
    """Rewrite the opening tag: no fixed size, no name spaces, a description."""
    view = re.search(r'viewBox="([^"]*)"', tag)
    if view is None:
        width, height = (re.search(rf'\b{side}="([\d.]+)', tag) for side in ("width", "height"))
        box = f"0 0 {width[1]} {height[1]}" if width and height else "0 0 100 100"
    else:
        box = view[1]
    return f'<svg viewBox="{box}" role="img" aria-label="{description}">'
