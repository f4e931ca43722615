"""A page that leads to several reports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from .blocks import Markup, Section, Text
from .folder import write_folder
from .page import Heading, render


@dataclass(frozen=True)
class Entry:
    """A report as an index lists it.

    Attributes
    ----------
    model : str
    page : str
        Path of the page from the index; empty where there is none.
    headline : str
    sentences : tuple of str
        The verdict at its shortest, or why there is none.
    description : str
    good : bool
    """

    model: str
    page: str
    headline: str
    sentences: tuple[str, ...]
    description: str
    good: bool


def write_index(folder: str | Path, title: str, entries: Sequence[Entry]) -> Path:
    """Write ``index.html``, which lists reports with their verdicts.

    Parameters
    ----------
    folder : str or Path
        Made where it does not exist.
    title : str
    entries : sequence of Entry

    Returns
    -------
    Path
        Of the page.

    Raises
    ------
    BondGraphError
        Where the folder cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> entry = Entry("cart", "cart/index.html", "Stable", ("cart is stable.",), "a cart", True)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     "<h3><a href=" in write_index(folder, "models", [entry]).read_text(encoding="utf-8")
    True
    """
    marked = [entry for entry in entries if not entry.good]
    count = f"{len(marked)} of {len(entries)} to look at" if marked else "All stable"
    told = [f"{entry.model}: {entry.headline}." for entry in marked]
    heading = Heading(title, "Stability reports", count, told, not marked)
    sections = [
        Section(
            "Reports",
            (
                Text("Each name leads to a report of its own, in the folder of that name."),
                *(Markup(_card(entry)) for entry in entries),
            ),
        )
    ]
    return (
        write_folder(folder, [], {}, {"index.html": render(heading, sections, {})}) / "index.html"
    )


def _card(entry: Entry) -> str:
    name = escape(entry.model)
    title = f'<a href="{escape(entry.page)}">{name}</a>' if entry.page else name
    lines = "".join(f"<p>{escape(sentence)}</p>" for sentence in entry.sentences)
    return (
        f'<div class="card"><h3>{title}</h3><p class="note">{escape(entry.description)}</p>'
        f'<div class="verdict {"good" if entry.good else "bad"}">'
        f'<p class="headline">{escape(entry.headline)}</p>{lines}</div></div>'
    )
