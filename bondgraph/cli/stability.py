"""`stability` and `reports`: verdicts on the terminal, and as pages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import options as opt

if TYPE_CHECKING:
    from bondgraph.attractors import Motions
    from bondgraph.graph import BondGraph
    from bondgraph.stability import Vary

# Points along an axis of a map whose range does not say how many.
POINTS = 60


@click.command()
@opt.model_argument
@opt.set_option
@click.option(
    "--input", "files", multiple=True, metavar="NAME=VALUE", help="Constant input. Repeatable."
)
@click.option(
    "--mode",
    "fixed",
    multiple=True,
    metavar="NAME=MODE",
    help="Hold a contact in stick, slip+ or slip-.",
)
@click.option(
    "--vary",
    multiple=True,
    metavar="NAME=LO:HI:N",
    help="Follow the eigenvalues along a parameter. Repeatable.",
)
@click.option(
    "--map",
    "planes",
    multiple=True,
    metavar="X,Y",
    help="Map stability over two of the varied, at 60 points each unless N says other. Repeatable; "
    "a report maps the first two varied unless told.",
)
@click.option(
    "--cycles/--no-cycles",
    "cycles",
    default=None,
    help="Run the model from several starts for limit cycles beside the verdict (a report does "
    "unless told not to).",
)
@click.option(
    "--report", type=click.Path(file_okay=False, path_type=Path), help="Write an HTML report here."
)
@opt.json_option
@opt.debug_option
def stability(
    model: str,
    settings: tuple[str, ...],
    files: tuple[str, ...],
    fixed: tuple[str, ...],
    vary: tuple[str, ...],
    planes: tuple[str, ...],
    cycles: bool | None,
    report: Path | None,
    as_json: bool,
) -> None:
    """Find the steady state, its eigenvalues, what decides them and what would change them."""
    values, modes = opt.read_settings(settings), opt.read_modes(fixed)
    from bondgraph.report import stability_planes, write_report
    from bondgraph.stability import Vary, assess

    from .load import load_model, report_parts
    from .verdict import map_json, stability_tables

    ranges = [Vary.parse(word) for word in vary]
    pairs = read_planes(planes, dict(zip(vary, ranges, strict=True)))
    graph = load_model(model)
    parts = None if report is None else report_parts(model)
    if parts is not None and not pairs:
        pairs = _usual(parts.maps, dict(zip(vary, ranges, strict=True)))
    inputs = opt.read_settings(files, "--input")
    if cycles and modes:
        raise click.UsageError("--cycles: runs find their modes themselves; leave out --mode")
    result = assess(
        graph,
        values,
        inputs=inputs,
        modes=modes,
        vary=ranges or (parts.ranges if parts else []),
        planes=_varied(pairs, ranges),
    )
    maps = stability_planes(result, pairs, modes)
    wanted = cycles if cycles is not None else report is not None and not modes
    along = ranges or (parts.ranges if parts else [])
    found = _motions(graph, values, inputs, along, required=bool(cycles)) if wanted else None
    page = None
    if report is not None and parts is not None:
        own = parts.sections(values)
        page = write_report(result, report, own, parts.description, maps, found)
    if as_json:
        told: dict[str, Any] = {"maps": [map_json(item) for item in maps]} if maps else {}
        if found is not None:
            told |= found.to_json()
        opt.print_json({**result.to_json(), **told})
        return
    stability_tables(result, maps, found)
    if page is not None:
        click.echo(f"report: {page}")


def _motions(
    graph: BondGraph,
    values: dict[str, Any],
    inputs: dict[str, Any],
    along: Sequence[Vary],
    required: bool,
) -> Motions | None:
    """Return what runs tell; None where the model cannot be run, unless that was asked for."""
    from bondgraph.attractors import motions
    from bondgraph.errors import BondGraphError

    try:
        return motions(graph, values, inputs, along)
    except BondGraphError as error:
        if required:
            raise
        click.echo(f"bondgraph: note: no search for limit cycles: {error}", err=True)
        return None


def read_planes(words: Sequence[str], ranges: dict[str, Vary]) -> list[tuple[Vary, Vary]]:
    """Read X,Y words of ``--map``.

    Parameters
    ----------
    words : sequence of str
    ranges : dict of str to Vary
        What is varied, by its own word.

    Returns
    -------
    list of (Vary, Vary)

    Raises
    ------
    click.UsageError

    Examples
    --------
    >>> from bondgraph.stability import Vary
    >>> words = {word: Vary.parse(word) for word in ("a=0:1", "b=0:2:30")}
    >>> [(x.name, x.n, y.name, y.n) for x, y in read_planes(["a,b"], words)]
    [('a', 60, 'b', 30)]
    """
    known = {item.name: _axis(word, item) for word, item in ranges.items()}
    pairs = []
    for word in words:
        names = [name.strip() for name in word.split(",")]
        if len(names) != 2 or names[0] == names[1]:
            raise click.UsageError(f"--map {word!r}: write two different names, as X,Y")
        for name in names:
            if name not in known:
                raise click.UsageError(
                    f"--map {word!r}: {name!r} is not varied; add --vary {name}=LO:HI"
                )
        pairs.append((known[names[0]], known[names[1]]))
    return pairs


def _usual(own: list[tuple[Vary, Vary]], ranges: dict[str, Vary]) -> list[tuple[Vary, Vary]]:
    """Return what a report maps unless told: the first two varied, or the model's own pairs."""
    axes = [_axis(word, item) for word, item in ranges.items()]
    return [(axes[0], axes[1])] if len({item.name for item in axes[:2]}) == 2 else own


def _varied(pairs: list[tuple[Vary, Vary]], ranges: list[Vary]) -> list[tuple[str, str]]:
    """Return the names of pairs that are both varied: their edges are followed by the assessment."""
    names = {item.name for item in ranges}
    return [(x.name, y.name) for x, y in pairs if {x.name, y.name} <= names]


def _axis(word: str, item: Vary) -> Vary:
    """Return a range with the points of a map, where its word does not count them itself."""
    return item if word.partition("=")[2].count(":") == 2 else replace(item, n=POINTS)


@click.command()
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--model", "names", multiple=True, metavar="NAME", help="Only this one. Repeatable.")
@opt.json_option
@opt.debug_option
def reports(folder: Path, names: tuple[str, ...], as_json: bool) -> int:
    """Write a stability report for every model of the library into FOLDER, with an index."""
    from bondgraph.models import LIBRARY

    from .library import library_reports

    for name in names:
        if name not in LIBRARY:
            raise click.UsageError(f"--model {name}: the library holds {', '.join(LIBRARY)}")
    found = library_reports(folder, names or None)
    index = str(folder / "index.html")
    if as_json:
        rows = [
            {"model": item.model, "page": item.page or None, "headline": item.headline}
            for item in found
        ]
        opt.print_json({"schema": 1, "index": index, "reports": rows})
    else:
        for item in found:
            click.echo(f"{item.model}: {item.headline}")
        click.echo(f"report: {index}")
    failed = [item for item in found if not item.page]
    for item in failed:
        click.echo(f"bondgraph: no report for {item.model}: {item.sentences[0]}", err=True)
    return 1 if failed else 0
