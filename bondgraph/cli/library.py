"""Reports on all models of the library."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from bondgraph.errors import BondGraphError

if TYPE_CHECKING:
    from bondgraph.report import Entry


def library_reports(folder: str | Path, names: Iterable[str] | None = None) -> tuple[Entry, ...]:
    """Write a stability report for models of the library, and an index that leads to them.

    A model whose report fails is listed with the reason, and the others go on.

    Parameters
    ----------
    folder : str or Path
        Made where it does not exist; each model has a folder of its own within.
    names : iterable of str, optional
        Models; all of the library unless given.

    Returns
    -------
    tuple of Entry
        As the index lists them; without a page where a report failed.

    Raises
    ------
    BondGraphError
        Where the folder cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     library_reports(folder, ["quarter_car"])[0].headline
    'Stable'
    """
    from bondgraph.models import LIBRARY
    from bondgraph.report import write_index

    chosen = list(LIBRARY if names is None else names)
    entries = tuple(_entry(Path(folder), name, LIBRARY[name]) for name in chosen)
    write_index(folder, "Model library", entries)
    return entries


def _entry(folder: Path, name: str, description: str) -> Entry:
    from bondgraph.attractors import motions
    from bondgraph.report import Entry, headline, stability_planes, write_report
    from bondgraph.stability import assess

    from .load import load_model, report_parts

    parts = report_parts(name)
    try:
        result = assess(load_model(name), vary=parts.ranges)
        maps = stability_planes(result, parts.maps)
        found = motions(result.graph, vary=parts.ranges)
        write_report(result, folder / name, parts.sections({}), parts.description, maps, found)
    except BondGraphError as error:
        return Entry(name, "", "No report", (str(error),), description, False)
    shown, page = tuple(result.verdict.splitlines()), f"{name}/index.html"
    good = result.stable and not found.attractors.beside
    return Entry(name, page, headline(result, found.attractors), shown, description, good)
