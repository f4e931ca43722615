"""Writing: from a stability result to a folder with a page, plots and numbers."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

from ..equations import derive
from ..stability import StabilityResult
from . import contents, spectrum
from .blocks import Section
from .causality import causality_section
from .folder import drawn, write_folder
from .page import Heading, render


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
    drawings = drawn(chapters)
    heading = Heading(
        result.model,
        "Stability report",
        "Stable" if result.stable else _unstable(result),
        result.verdict.splitlines(),
        result.stable,
    )
    texts = {
        "stability.json": json.dumps(result.to_json(), indent=1, allow_nan=False) + "\n",
        "index.html": render(heading, chapters, drawings),
    }
    return write_folder(folder, chapters, drawings, texts) / "index.html"


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
