"""``bondgraph discover``: what a model lacks, as recordings tell it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import options as opt
from .measured import read_holds, read_map

if TYPE_CHECKING:
    from bondgraph.discrepancy import Measurement
    from bondgraph.graph import BondGraph

VALIDATE = "--validate"
DATA = click.Path(dir_okay=True, path_type=Path)


class _HeldOut(click.Command):
    """Takes every file after ``--validate`` for held out: one learned from by mistake tells nothing."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the option for each of several files behind it, where MODEL and DATA come first."""
        places = [i for i, word in enumerate(args) if _asks(word)]
        if places and self._complete(ctx, args[: places[0]]):
            args = list(_spread(args))
        return super().parse_args(ctx, args)

    def _complete(self, ctx: click.Context, args: list[str]) -> bool:
        """Whether words hold a model and data already."""
        try:
            found, *_ = self.make_parser(ctx).parse_args(list(args))
        except click.UsageError:
            return False
        model, data = found.get("model"), found.get("data")
        return isinstance(model, str) and isinstance(data, tuple | list) and len(data) > 0


def _asks(word: str) -> bool:
    return word == VALIDATE or word.startswith(f"{VALIDATE}=")


def _spread(args: list[str]) -> Iterator[str]:
    """Yield the words with the option before each of the files behind it."""
    behind = given = False
    for word in args:
        if word.startswith("-"):
            behind, given = _asks(word), "=" in word
        elif behind:
            if given:
                yield VALIDATE
            given = True
        yield word


@click.command(cls=_HeldOut)
@opt.model_argument
@click.argument("data", nargs=-1, required=True, type=DATA, metavar="DATA.csv...")
@click.option(
    VALIDATE,
    multiple=True,
    type=DATA,
    metavar="VAL.csv",
    help="Recording to test on, never learned from. Repeatable.",
)
@click.option(
    "--map",
    "renamed",
    multiple=True,
    metavar="MODEL=COLUMN",
    help="Column that an input or output is recorded in. Repeatable.",
)
@click.option(
    "--hold",
    "held",
    multiple=True,
    metavar="INPUT=HOLD",
    help="Between samples: zero, linear (default) or band. Repeatable.",
)
@click.option(
    "--initial",
    "start",
    multiple=True,
    metavar="NAME=VALUE",
    help="Initial state known for all recordings. Repeatable.",
)
@click.option(
    "--free",
    multiple=True,
    metavar="NAME",
    help="Parameter of the model to be fitted (default: all that may). Repeatable.",
)
@click.option(
    "--effects",
    "effects",
    multiple=True,
    metavar="NAME",
    help="Effect to be tried (default: all). Repeatable.",
)
@click.option("--time-budget", metavar="S", help="Wall-clock limit, s.")
@click.option(
    "--report", type=click.Path(file_okay=False, path_type=Path), help="Write an HTML report here."
)
@opt.set_option
@opt.json_option
@opt.debug_option
def discover(
    model: str,
    data: tuple[Path, ...],
    validate: tuple[Path, ...],
    renamed: tuple[str, ...],
    held: tuple[str, ...],
    start: tuple[str, ...],
    free: tuple[str, ...],
    effects: tuple[str, ...],
    time_budget: str | None,
    report: Path | None,
    settings: tuple[str, ...],
    as_json: bool,
) -> None:
    """Find what a model lacks: name it, grow it into the graph, test it on held-out data."""
    values, initial = opt.read_settings(settings), opt.read_settings(start, "--initial")
    names, holds = read_map(renamed), read_holds(held)
    budget = None if time_budget is None else opt.read_number(time_budget, "--time-budget")
    if budget is not None and budget <= 0:
        raise click.UsageError(f"--time-budget {time_budget}: give seconds above zero")
    _distinct(data, validate)
    from .load import load_model

    graph = load_model(model)
    _check(graph, values, free, effects)
    known = _in_si(initial)
    runs, tests = (_read(graph, paths, names, holds, known) for paths in (data, validate))
    from bondgraph.discrepancy import discovery

    if report is not None:
        report.mkdir(parents=True, exist_ok=True)  # told now, not after the work
    limits = {} if budget is None else {"time_budget": budget}
    with _progress() as said:
        found = discovery.discover(
            graph,
            runs,
            validation=tests,
            free=free or None,
            parameters=values,
            effects=effects or None,
            progress=said,
            **limits,
        )
    from bondgraph.discrepancy.report import to_json, write_report

    written = None if report is None else write_report(found, report)
    if as_json:
        improved = None if written is None or written.improved is None else str(written.improved)
        opt.print_json(to_json(found, improved))
        return
    from .discovered import print_discovery

    print_discovery(found, written)


def _distinct(data: tuple[Path, ...], validate: tuple[Path, ...]) -> None:
    """Refuse a file that is given twice: learned from and held out, it tests nothing."""
    seen: dict[Path, str] = {}
    for kind, paths in (("DATA", data), ("--validate", validate)):
        for path in paths:
            other = seen.setdefault(path.resolve(), kind)
            if other != kind:
                raise click.UsageError(
                    f"--validate {path}: is learned from already; give a recording that is not"
                )
    if len(seen) < len(data) + len(validate):
        raise click.UsageError("a recording is given twice; give each once")


def _check(
    graph: BondGraph, values: dict[str, Any], free: tuple[str, ...], effects: tuple[str, ...]
) -> None:
    """Find wrong names before any work is done."""
    from bondgraph.discrepancy.candidates import effects as chosen
    from bondgraph.parameters import unknown_name
    from bondgraph.resolver import resolve

    resolve(graph.parameters, values, partial=True)
    known = [symbol.name for symbol in graph.parameters]
    for name in free:
        if name not in known:
            raise unknown_name("parameter", name, known)
    if effects:
        chosen(*effects)


def _in_si(initial: dict[str, Any]) -> dict[str, float]:
    from bondgraph.units import to_si

    return {
        name: to_si(*value) if isinstance(value, tuple) else value
        for name, value in initial.items()
    }


def _read(
    graph: BondGraph,
    paths: tuple[Path, ...],
    names: dict[str, str],
    holds: dict[str, str],
    initial: dict[str, float],
) -> list[Measurement]:
    """Read recordings, and match them with the model so that what does not fit is told at once."""
    from bondgraph.discrepancy import matched, read_all

    if not paths:
        return []
    runs = [run.changed(initial=initial) for run in read_all(paths, rename=names, holds=holds)]
    for run in runs:
        matched(run, graph)
    return runs


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """Show what is being done on stderr: one line that changes on a terminal, else a line each."""
    if not sys.stderr.isatty():
        yield lambda words: click.echo(f"bondgraph: {words}", err=True)
        return
    from rich.console import Console
    from rich.markup import escape

    with Console(stderr=True).status("reading") as status:
        yield lambda words: status.update(escape(words))
