"""Writing: from a discovery to a folder with a page, numbers, plots and the improved model."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy

from ...errors import BondGraphError
from ...files import save
from ...report import Section
from ...report.folder import drawn, write_folder
from ...report.page import Heading, render
from ...report.words import slug
from ..discovery import Course, Discovery, Verdict
from .as_json import to_json
from .courses import course_sections
from .evidence import alternative_section, done_section, told_sections
from .found import found_section, law_section
from .gaps import gap_section
from .model import graph_section, parameter_section
from .words import file_names, headline

IMPROVED = "improved.toml"


@dataclass(frozen=True)
class Written:
    """Where a report's files are.

    Attributes
    ----------
    page, data : Path
        HTML and JSON.
    improved : Path or None
        The improved model, where there is one and a model file can hold it.
    plots, courses : tuple of Path
        SVG of each plot, CSV of each recording beside the model.
    """

    page: Path
    data: Path
    improved: Path | None
    plots: tuple[Path, ...]
    courses: tuple[Path, ...]


def write_report(found: Discovery, folder: str | Path) -> Written:
    """Write ``<model>.html``, ``discovery.json``, ``improved.toml``, ``plots/`` and ``courses/``.

    The page needs neither network nor script, and can be moved alone.

    Parameters
    ----------
    found : Discovery
    folder : str or Path
        Made where it does not exist.

    Returns
    -------
    Written

    Raises
    ------
    BondGraphError
        Where the folder cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> import sympy
    >>> from bondgraph import C, One, R, assemble
    >>> from bondgraph.discrepancy import Measurement
    >>> from bondgraph.discrepancy.discovery import Discovery, Explanation, Verdict
    >>> from bondgraph.discrepancy.fitting import fit
    >>> tau = sympy.Symbol("tau", positive=True)
    >>> bonds = One("loop") >> (R("r", tau), C("c", 1, initial=2))
    >>> graph = assemble("decay", bonds, parameters={tau: 1})
    >>> done = fit(graph, Measurement([0, 1, 2], {"c.q": [2, 0.74, 0.27]}), ["tau"])
    >>> itself = Explanation((), graph, done, delta_bic=0.0, removed=0.0)
    >>> none = {"effects": (), "alternatives": (), "gap": {}, "improved": None, "laws": ()}
    >>> none |= {"parameters": {}, "nominal": {}, "train": (), "validation": ()}
    >>> words = ("Nothing is missing.",)
    >>> found = Discovery(graph, Verdict.NONE, ranked=(itself,), chosen=itself, words=words, **none)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     page = write_report(found, folder).page
    ...     page.name, "Nothing is missing." in page.read_text(encoding="utf-8")
    ('decay.html', True)
    """
    folder = Path(folder)
    improved, remark = _save_improved(found, folder)
    sections = _sections(found, remark)
    drawings = drawn(sections)
    page = f"{slug(found.graph.name)}.html"
    good = found.verdict in (Verdict.NAMED, Verdict.NONE)
    heading = Heading(found.graph.name, "Discovery report", headline(found), found.words, good)
    data = to_json(found, None if improved is None else improved.name)
    courses = dict(_courses(found))
    texts = {
        **courses,
        "discovery.json": json.dumps(data, indent=1, allow_nan=False) + "\n",
        page: render(heading, sections, drawings),
    }
    write_folder(folder, sections, drawings, texts)
    return Written(
        folder / page,
        folder / "discovery.json",
        improved,
        tuple(folder / "plots" / f"{name}.svg" for name in drawings),
        tuple(folder / name for name in courses),
    )


def _save_improved(found: Discovery, folder: Path) -> tuple[Path | None, str]:
    """Write the improved model; where a model file cannot hold it, say why."""
    path = folder / IMPROVED
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)  # one of an earlier report would be taken for this one's
    except OSError as error:
        raise BondGraphError(
            f"cannot write the report into {folder}: {error.strerror or error}"
        ) from None
    if found.improved is None:
        return None, ""
    try:
        return save(found.improved, path), ""
    except BondGraphError as error:
        return None, f"the improved model is not written as a model file: {error}"


def _sections(found: Discovery, remark: str) -> list[Section]:
    chapters: Iterable[Section | None] = [
        found_section(found),
        gap_section(found),
        *course_sections(found),
        law_section(found),
        graph_section(found),
        parameter_section(found),
        alternative_section(found),
        *told_sections(found, remark),
        done_section(found),
    ]
    return [chapter for chapter in chapters if chapter is not None]


def _courses(found: Discovery) -> Iterable[tuple[str, str]]:
    """Yield path and text of each course; a gap is an empty cell."""
    for kind, courses in (("train", found.train), ("validation", found.validation)):
        stems = file_names(f"{number} {course.name}" for number, course in enumerate(courses, 1))
        for stem, course in zip(stems.values(), courses, strict=True):
            yield f"courses/{kind}-{stem.removesuffix('-csv')}.csv", _course(course)


def _course(course: Course) -> str:
    head, columns = ["time [s]"], [numpy.asarray(course.t)]
    for signal, measured in course.measured.items():
        unit = course.units.get(signal) or "1"
        for label, values in (
            ("measured", measured),
            ("before", course.before.get(signal)),
            ("after", course.after.get(signal)),
        ):
            if values is not None:
                head.append(f"{signal} {label} [{unit}]")
                columns.append(numpy.asarray(values))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    for row in zip(*(column.tolist() for column in columns), strict=True):
        writer.writerow(["" if value != value else f"{value:.10g}" for value in row])
    return text.getvalue()
