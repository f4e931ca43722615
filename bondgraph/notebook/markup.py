"""Small pieces of HTML: tables, headings, numbers with units. All texts are escaped."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape

from ..units import pretty

_CELL = "text-align: left; padding: 0.15em 1em 0.15em 0;"
MOST_ROWS = 60


def block(title: str, *parts: str) -> str:
    """Return parts under a heading, as one element.

    Parameters
    ----------
    title : str
        Plain text.
    *parts : str
        HTML.

    Returns
    -------
    str

    Examples
    --------
    >>> block("a < b")
    '<div><p><strong>a &lt; b</strong></p></div>'
    """
    return f"<div><p><strong>{escape(title)}</strong></p>{''.join(parts)}</div>"


def paragraph(text: str) -> str:
    """Return plain text as a paragraph; nothing where there is no text."""
    return f"<p>{escape(text)}</p>" if text else ""


def items(lines: Iterable[str]) -> str:
    """Return plain lines as a list; nothing where there are none."""
    body = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f"<ul>{body}</ul>" if body else ""


def folded(summary: str, body: str) -> str:
    """Return HTML that opens at a click; nothing where there is none."""
    return f"<details><summary>{escape(summary)}</summary>{body}</details>" if body else ""


def scrolled(body: str) -> str:
    """Return HTML that scrolls by itself where it is wider than the page."""
    return f'<div style="overflow-x: auto">{body}</div>'


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; of very long ones the first rows, with a note.

    Parameters
    ----------
    head : sequence of str
        Headings; none are written where all are empty.
    rows : iterable of sequences of str

    Returns
    -------
    str
        Empty where there are no rows.

    Examples
    --------
    >>> table(("", ""), [("k", "3 N/m")]).count("<td")
    2
    """
    lines = [tuple(row) for row in rows]
    if not lines:
        return ""
    top = "".join(f'<th style="{_CELL}">{escape(cell)}</th>' for cell in head)
    top = f"<thead><tr>{top}</tr></thead>" if any(head) else ""
    body = "".join(
        "<tr>" + "".join(f'<td style="{_CELL}">{escape(cell)}</td>' for cell in row) + "</tr>"
        for row in lines[:MOST_ROWS]
    )
    left = len(lines) - MOST_ROWS
    note = paragraph(f"and {left} more") if left > 0 else ""
    return f'<table style="margin: 0.4em 0">{top}<tbody>{body}</tbody></table>{note}'


def number(value: float | None, unit: str = "", digits: int = 5) -> str:
    """Write a number with its unit, as text.

    Parameters
    ----------
    value : float or None
    unit : str
    digits : int

    Returns
    -------
    str
        A dash where there is none.

    Examples
    --------
    >>> number(-1234.5678, "N*m"), number(None), number(float("inf"), "s")
    ('−1234.6 N·m', '–', '∞ s')
    """
    if value is None or math.isnan(value):
        return "–"
    shown = ("-" if value < 0 else "") + "∞" if math.isinf(value) else f"{value:.{digits}g}"
    shown = shown.replace("-", "\N{MINUS SIGN}")
    return f"{shown} {pretty(unit)}".strip()
