"""Writing: from a stability result to a folder with a page, plots and numbers."""

from __future__ import annotations

import csv
import itertools
import json
from collections.abc import Iterable
from pathlib import Path

from ..equations import derive
from ..errors import BondGraphError
from ..stability import StabilityResult
from . import contents, spectrum
from .blocks import Panel, Section
from .causality import causality_section
from .page import render
from .svg import standalone
from .words import slug


def write_report(
    result: StabilityResult,
    folder: str | Path,
    sections: Iterable[Section] = (),
    description: str = "",
) -> Path:
    """Write a report: ``index.html``, ``stability.json``, and ``plots/`` with SVG and CSV.

    The page needs neither network nor script, and can be moved alone.

    Parameters
    ----------
    result : StabilityResult
    folder : str or Path
        Made where it does not exist.
    sections : iterable of Section
        The model's own, shown after the eigenvalues.
    description : str
        What the model is, in paragraphs.

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
    >>> from bondgraph.models import quarter_car
    >>> from bondgraph.stability import assess
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     page = write_report(assess(quarter_car.graph()), folder)
    ...     sorted(path.name for path in page.parent.iterdir())
    ['index.html', 'plots', 'stability.json']
    """
    chapters = _chapters(result, list(sections), description)
    panels = [
        panel for chapter in chapters for figure in chapter.figures for panel in figure.panels
    ]
    _check_names(panels)
    drawings = {panel.name: standalone(panel.ax) for panel in panels}
    page = render(
        result.model,
        "Stable" if result.stable else _unstable(result),
        result.verdict.splitlines(),
        result.stable,
        chapters,
        drawings,
    )
    data = json.dumps(result.to_json(), indent=1, allow_nan=False)
    folder = Path(folder)
    try:
        (folder / "plots").mkdir(parents=True, exist_ok=True)
        for panel in panels:
            plots = folder / "plots"
            (plots / f"{panel.name}.svg").write_text(drawings[panel.name], encoding="utf-8")
            _write_csv(plots / f"{panel.name}.csv", panel)
        (folder / "stability.json").write_text(data + "\n", encoding="utf-8")
        (folder / "index.html").write_text(page, encoding="utf-8")
    except OSError as error:
        raise BondGraphError(
            f"cannot write the report into {folder}: {error.strerror or error}"
        ) from None
    return folder / "index.html"


def _unstable(result: StabilityResult) -> str:
    worst = max((mode.growth for mode in result.rows), default=0)
    return "Unstable" if worst > 0 else "Neither stable nor unstable"


def _chapters(result: StabilityResult, own: list[Section], description: str) -> list[Section]:
    """Gather all sections in order."""
    equations = derive(result.graph)
    figures = [figure for section in own for figure in section.figures]
    chapters: list[Section | None] = [
        contents.model_section(result, equations.causal, description),
        contents.parameter_section(result),
        contents.point_section(result),
        spectrum.eigenvalue_section(result),
        spectrum.locus_section(result.loci),
        *own,
        None if own else spectrum.friction_section(result),
        contents.equation_section(equations),
        causality_section(equations),
        contents.assumption_section(result),
        contents.solver_section(result, figures),
    ]
    return [chapter for chapter in chapters if chapter is not None]


def _check_names(panels: list[Panel]) -> None:
    names = [panel.name for panel in panels]
    for name in names:
        if slug(name) != name or names.count(name) > 1:
            raise BondGraphError(
                f"plot {name!r}: its name is that of files; use letters, digits, '-' and '_', once"
            )


def _write_csv(path: Path, panel: Panel) -> None:
    """Write the columns side by side; shorter ones end in empty cells."""
    columns = panel.columns()
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in itertools.zip_longest(*columns.values()):
            writer.writerow(["" if value is None else f"{float(value):.10g}" for value in row])
