"""Writing: from a stability result to a folder with a page, plots and numbers."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..equations import derive
from ..stability import StabilityResult
from . import contents, spectrum
from .blocks import Section
from .causality import causality_section
from .changing import changing_section
from .cycles import cycle_section
from .deciding import deciding_section
from .folder import drawn, write_folder
from .maps import Plane, map_section
from .outcomes import solver_section
from .page import Heading, render
from .shapes import shape_section
from .summary import headline

if TYPE_CHECKING:
    from ..attractors import Motions


def write_report(
    result: StabilityResult,
    folder: str | Path,
    sections: Iterable[Section] = (),
    description: str = "",
    maps: Sequence[Plane] = (),
    motions: Motions | None = None,
) -> Path:
    """Write a report: ``index.html``, ``stability.json``, and ``plots/`` with SVG and CSV.

    The page needs neither network nor script, and can be moved alone.

    Parameters
    ----------
    result : StabilityResult
    folder : str or Path
        Made where it does not exist.
    sections : iterable of Section
        The model's own, shown after the plots of eigenvalues.
    description : str
        What the model is, in paragraphs; the first stands below the title.
    maps : sequence of Plane
        As `bondgraph.report.plane` makes them.
    motions : Motions, optional
        What runs of the same model tell, see `bondgraph.attractors.motions`.

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
    heading = _heading(result, description, motions)
    chapters = _chapters(result, list(sections), description, maps, motions)
    drawings = drawn(chapters)
    numbers = result.to_json() | ({} if motions is None else motions.to_json())
    texts = {
        "stability.json": json.dumps(numbers, indent=1, allow_nan=False) + "\n",
        "index.html": render(heading, chapters, drawings),
    }
    return write_folder(folder, chapters, drawings, texts) / "index.html"


def _heading(result: StabilityResult, description: str, motions: Motions | None) -> Heading:
    attractors = None if motions is None else motions.attractors
    lede = " ".join(description.strip().partition("\n\n")[0].split())
    shown, kind = result.verdict.splitlines(), "Stability report"
    good = result.stable and not (attractors is not None and attractors.beside)
    return Heading(result.model, kind, headline(result, attractors), shown, good, lede)


def _chapters(
    result: StabilityResult,
    own: list[Section],
    description: str,
    maps: Sequence[Plane],
    motions: Motions | None,
) -> list[Section]:
    """Gather all sections in order: what a reader wants to know first stands first."""
    equations = derive(result.graph)
    figures = [figure for section in own for figure in section.figures]
    chapters: list[Section | None] = [
        deciding_section(result),
        changing_section(result),
        spectrum.eigenvalue_section(result),
        contents.point_section(result),
        contents.parameter_section(result),
        shape_section(result),
        spectrum.locus_section(result.loci),
        map_section(result, maps),
        cycle_section(motions),
        *own,
        None if own else spectrum.friction_section(result),
        contents.model_section(result, equations.causal, description),
        contents.equation_section(equations),
        causality_section(equations),
        contents.assumption_section(result),
        solver_section(result, figures, maps, motions),
    ]
    return [chapter for chapter in chapters if chapter is not None]
