"""A report on disk: its texts, and each plot as SVG and as the numbers behind it."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy

from ..errors import BondGraphError
from .blocks import Panel, Section
from .svg import standalone
from .words import slug


def panels_of(sections: Iterable[Section]) -> list[Panel]:
    """Return the plots of all sections, in order."""
    return [panel for section in sections for figure in section.figures for panel in figure.panels]


def drawn(sections: Iterable[Section]) -> dict[str, str]:
    """Return the SVG of each plot by its name.

    Raises
    ------
    BondGraphError
        For names that are no names of files, or that stand twice.
    """
    panels = panels_of(sections)
    names = [panel.name for panel in panels]
    for name in names:
        if slug(name) != name or names.count(name) > 1:
            raise BondGraphError(
                f"plot {name!r}: its name is that of files; use letters, digits, '-' and '_', once"
            )
    return {panel.name: standalone(panel.ax) for panel in panels}


def write_folder(
    folder: str | Path,
    sections: Sequence[Section],
    drawings: Mapping[str, str],
    texts: Mapping[str, str],
) -> Path:
    """Write ``plots/`` with SVG and CSV of each plot, then texts by file name.

    Parameters
    ----------
    folder : str or Path
        Made where it does not exist.
    sections : sequence of Section
    drawings : mapping of str to str
        As `drawn` returns them.
    texts : mapping of str to str
        By path within the folder.

    Returns
    -------
    Path
        Of the folder.

    Raises
    ------
    BondGraphError
        Where the folder cannot be written.
    """
    folder = Path(folder)
    try:
        plots = folder / "plots"
        panels = panels_of(sections)
        (plots if panels else folder).mkdir(parents=True, exist_ok=True)
        for panel in panels:
            (plots / f"{panel.name}.svg").write_text(drawings[panel.name], encoding="utf-8")
            _write_csv(plots / f"{panel.name}.csv", panel)
        for name, text in texts.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise BondGraphError(
            f"cannot write the report into {folder}: {error.strerror or error}"
        ) from None
    return folder


def _write_csv(path: Path, panel: Panel) -> None:
    """Write the columns side by side; shorter ones end in empty cells."""
    columns = {
        name: column.tolist() if isinstance(column, numpy.ndarray) else list(column)
        for name, column in panel.columns().items()
    }
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in itertools.zip_longest(*columns.values()):
            writer.writerow([_cell(value) for value in row])


def _cell(value: object) -> str:
    if value is None or isinstance(value, str):
        return value or ""
    number = float(value)  # type: ignore[arg-type]
    return "" if math.isnan(number) else f"{number:.10g}"
