"""From blocks to HTML. Every text is escaped here and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

from .blocks import Bullets, Figure, Markup, Section, Table, Text
from .svg import inline

_ALIGN = {"l": "", "r": ' class="number"', "c": ""}
# Cells of more letters keep a readable width where the table scrolls.
LONG = 20


@dataclass(frozen=True)
class Heading:
    """What stands at the top of a page.

    Attributes
    ----------
    title : str
        The model's name.
    kind : str
        What the page is, such as ``Stability report``.
    headline : str
        A word or two: the verdict at a glance.
    verdict : sequence of str
        Sentences.
    good : bool
        Whether the verdict needs no attention; decides the colour.
    lede : str
        What the page is about, in a sentence below the title.
    """

    title: str
    kind: str
    headline: str
    verdict: Sequence[str]
    good: bool
    lede: str = ""


def render(heading: Heading, sections: Sequence[Section], drawings: Mapping[str, str]) -> str:
    """Return the whole page.

    Parameters
    ----------
    heading : Heading
    sections : sequence of Section
    drawings : mapping of str to str
        SVG of each panel by name.

    Returns
    -------
    str
    """
    home = files(__package__)
    page = Template((home / "page.html").read_text(encoding="utf-8"))
    return page.substitute(
        title=escape(heading.title),
        kind=escape(heading.kind),
        lede=f'<p class="lede">{escape(heading.lede)}</p>' if heading.lede else "",
        style=(home / "page.css").read_text(encoding="utf-8"),
        state="good" if heading.good else "bad",
        headline=escape(heading.headline),
        verdict="\n".join(f"<p>{escape(sentence)}</p>" for sentence in heading.verdict),
        contents=_contents(sections),
        sections="\n".join(_section(section, drawings) for section in sections),
    )


def _contents(sections: Sequence[Section]) -> str:
    """List the chapters, where there are several."""
    items = "\n".join(
        f'<li><a href="#{_anchor(section.title)}">{escape(section.title)}</a></li>'
        for section in sections
    )
    if len(sections) < 2:
        return ""
    return f'<nav aria-label="Contents"><p>Contents</p><ol>\n{items}\n</ol></nav>'


def _section(section: Section, drawings: Mapping[str, str]) -> str:
    inner = "\n".join(_block(block, drawings) for block in section.blocks)
    anchor = _anchor(section.title)
    return f'<section id="{anchor}">\n<h2>{escape(section.title)}</h2>\n{inner}\n</section>'


def _anchor(title: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-") or "section"


def _block(block: Any, drawings: Mapping[str, str]) -> str:
    if isinstance(block, Text):
        return _text(block)
    if isinstance(block, Bullets):
        items = "".join(f"<li>{escape(item)}</li>" for item in block.items)
        return f"<ul>{items}</ul>"
    if isinstance(block, Table):
        return table(block)
    if isinstance(block, Figure):
        return _figure(block, drawings)
    if isinstance(block, Markup):
        return block.html
    raise TypeError(f"a report cannot show {type(block).__name__}")


def _text(text: Text) -> str:
    if text.kind == "code":
        return f"<pre>{escape(text.words)}</pre>"
    kind = f' class="{escape(text.kind)}"' if text.kind != "plain" else ""
    return f"<p{kind}>{escape(text.words)}</p>"


def table(block: Table) -> str:
    """Return a table that scrolls sideways where the page is narrow.

    Examples
    --------
    >>> table(Table(("a",), (("<b>",),)))
    '<div class="wide"><table>...<tr><td>&lt;b&gt;</td></tr></tbody></table></div>'
    """
    align = block.align.ljust(len(block.head), "l")
    caption = f"<caption><span>{escape(block.caption)}</span></caption>" if block.caption else ""
    head = "".join(
        f'<th scope="col"{_ALIGN[kind]}>{escape(word)}</th>'
        for word, kind in zip(block.head, align, strict=False)
    )
    rows = "".join(f"<tr>{_row(row, align, block.labelled)}</tr>" for row in block.rows)
    return (
        f'<div class="wide"><table>{caption}<thead><tr>{head}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
    )


def _row(row: Iterable[str], align: str, labelled: bool) -> str:
    cells = []
    for index, (word, kind) in enumerate(zip(row, align, strict=False)):
        text = escape(word)
        if kind == "c" and text:
            text = f"<code>{text}</code>"
        style = ' class="words"' if kind == "l" and len(word) > LONG else _ALIGN[kind]
        if labelled and index == 0:
            cells.append(f'<th scope="row"{style}>{text}</th>')
        else:
            cells.append(f"<td{style}>{text}</td>")
    return "".join(cells)


def _figure(figure: Figure, drawings: Mapping[str, str]) -> str:
    panels = "".join(
        f'<div class="panel">{inline(drawings[panel.name], panel.name, panel.description)}'
        f'<p class="files">{_link(panel.name, "svg")} {_link(panel.name, "csv")}</p></div>'
        for panel in figure.panels
    )
    caption = f"<strong>{escape(figure.title)}</strong> {escape(figure.caption)}"
    count = min(len(figure.panels), 2)
    return (
        f'<figure><div class="panels columns-{count}">{panels}</div>'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _link(name: str, kind: str) -> str:
    return f'<a href="plots/{escape(name)}.{kind}">{kind.upper()}</a>'
