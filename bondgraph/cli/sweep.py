"""``bondgraph sweep``: many runs of a model, kept on disk while they are made."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import options as opt

if TYPE_CHECKING:
    import xarray

    from bondgraph.graph import BondGraph
    from bondgraph.sweeps import Points, Progress

DESIGNS = ("grid", "uniform", "latin", "sobol")
EXECUTORS = ("auto", "serial", "threads", "processes")


@click.command()
@opt.model_argument
@click.option(
    "--vary",
    multiple=True,
    required=True,
    metavar="NAME=LO:HI:N",
    help="Values of a parameter, initial state or input. Repeatable.",
)
@click.option("--until", required=True, metavar="T", help="End of each run, s.")
@click.option(
    "--quantity",
    "quantities",
    multiple=True,
    metavar="KIND:WHAT",
    help="What to keep: final:V_c, peak:x_c@0.1, count:friction:stick, ... (default: the last "
    "value of each output, and how often contacts stick). Repeatable.",
)
@click.option(
    "--design",
    type=click.Choice(DESIGNS),
    default="grid",
    help="All combinations, or --count points drawn from the ranges.",
)
@click.option("--count", type=click.IntRange(1), help="Number of points of a drawn design.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Of a drawn design (default 0).")
@opt.set_option
@opt.run_options
@click.option(
    "--executor", type=click.Choice(EXECUTORS), default="auto", help="Where runs are done."
)
@click.option("--workers", type=click.IntRange(1), help="How many (default: all processors).")
@click.option(
    "--chunk", type=click.IntRange(1), help="Points at a time (default: half a second's)."
)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    help="Keep what is done in this folder; dataset.nc at the end.",
)
@click.option("--resume", is_flag=True, help="Take up what --out holds.")
@click.option(
    "--plot",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Plot the first quantity to FILE.svg or .png.",
)
@click.option("--progress/--no-progress", default=None, help="On stderr (default: on a terminal).")
@opt.json_option
@opt.debug_option
def sweep(
    model: str,
    vary: tuple[str, ...],
    until: str,
    quantities: tuple[str, ...],
    design: str,
    count: int | None,
    seed: int,
    rtol: str,
    settings: tuple[str, ...],
    start: tuple[str, ...],
    files: tuple[str, ...],
    solver: str,
    backend: str,
    executor: str,
    workers: int | None,
    chunk: int | None,
    out: Path | None,
    resume: bool,
    plot: Path | None,
    progress: bool | None,
    as_json: bool,
) -> int:
    """Run a model at many points; go on after a kill with --resume."""
    end, tolerance = opt.read_number(until, "--until"), opt.read_number(rtol, "--rtol")
    if end <= 0:
        raise click.UsageError(f"--until {until}: the run must end after zero")
    if resume and out is None:
        raise click.UsageError("--resume needs --out, the folder to take up")
    if (count is None) != (design == "grid"):
        raise click.UsageError("--count is for a --design other than grid, which needs it")
    values, initial = opt.read_settings(settings), opt.read_settings(start, "--initial")
    from bondgraph import sweeps

    from .load import load_model, read_inputs

    points = _points(vary, design, count, seed)
    graph = load_model(model)
    shown = sys.stderr.isatty() if progress is None else progress
    with _Shown() if shown else _Silent() as listener:
        found = sweeps.sweep(
            graph,
            points,
            list(quantities) or _usual(graph),
            t_span=(0.0, end),
            parameters=values,
            initial=initial,
            inputs=read_inputs(graph, files),
            rtol=tolerance,
            solver=solver,
            backend=backend,
            executor=None if executor == "auto" else executor,
            workers=workers,
            chunk=chunk,
            out=out,
            resume=resume,
            progress=listener,
        )
    if plot is not None:
        from bondgraph.plot import save, sweep_map

        save(sweep_map(found), plot)
    return _report(found, listener.last, out, plot, as_json)


def _usual(graph: BondGraph) -> list[str]:
    """What is kept where nothing is asked for."""
    from bondgraph.elements import DryFriction

    sticks = [f"count:{name}:stick" for name, item in graph.of(DryFriction) if item.switches]
    return [*(f"final:{name}" for name in graph.outputs), *sticks, "energy"]


def _points(vary: tuple[str, ...], design: str, count: int | None, seed: int) -> Points:
    from bondgraph import sweeps
    from bondgraph.stability import Vary

    ranges = [Vary.parse(word) for word in vary]
    names = [item.name for item in ranges]
    for name in names:
        if names.count(name) > 1:
            raise click.UsageError(f"--vary {name!r} is given twice")
    if count is None:
        import numpy

        axes = {r.name: (numpy.linspace(r.lo, r.hi, r.n), r.unit) for r in ranges}
        return sweeps.grid(axes)
    draw = {"uniform": sweeps.uniform, "latin": sweeps.latin_hypercube, "sobol": sweeps.sobol}
    box = {r.name: (min(r.lo, r.hi), max(r.lo, r.hi), r.unit) for r in ranges}
    return draw[design](box, count, seed=seed)


# ---------------------------------------------------------------------- progress


class _Silent:
    """Keeps the last word of the progress."""

    last: Progress | None = None

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def __call__(self, now: Progress) -> None:
        self.last = now


class _Shown(_Silent):
    """A bar on a terminal; elsewhere a line a second."""

    def __enter__(self) -> Any:
        self._said = 0.0
        self._bar: Any = None
        if sys.stderr.isatty():
            self._bar, self._task = _bar()
        return self

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, now: Progress) -> None:
        self.last = now
        words = f"{now.rate:.3g} points/s" + (f", {now.failed} failed" if now.failed else "")
        if self._bar is not None:
            self._bar.update(self._task, completed=now.done, total=now.total, words=words)
        elif now.done == now.total or time.monotonic() - self._said > 1:
            self._said = time.monotonic()
            left = "" if now.left is None else f", {now.left:.0f} s left"
            click.echo(f"bondgraph: {now.done} of {now.total}, {words}{left}", err=True)


def _bar() -> tuple[Any, Any]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[words]}"),
        TimeRemainingColumn(),
    )
    bar = Bar(*columns, console=Console(stderr=True))
    bar.start()
    return bar, bar.add_task("", total=None, words="deriving")


# ---------------------------------------------------------------------- what was found


def _report(
    found: xarray.Dataset, last: Progress | None, out: Path | None, plot: Path | None, as_json: bool
) -> int:
    from collections import Counter

    from bondgraph.sweeps import outcomes

    ended = Counter(outcomes(found).ravel().tolist())
    written = [path for path in (out and out / "dataset.nc", plot) if path is not None]
    (opt.print_json if as_json else _print)(_told(found, ended, last, written))
    if not ended.get("finished"):
        texts = [text for text in found.message.values.ravel().tolist() if text]
        click.echo(f"bondgraph: no point has values; the first: {texts[0]}", err=True)
        return 1
    return 0


def _told(
    found: xarray.Dataset, ended: Any, last: Progress | None, written: list[Path]
) -> dict[str, Any]:
    """Return what `bondgraph sweep --json` prints."""
    own = ("outcome", "t_end", "message", "seconds")
    return {
        "schema": 1,
        "model": found.attrs["model"],
        "points": int(found.outcome.size),
        "axes": {
            str(name): {"unit": axis.attrs["units"], "values": int(axis.size)}
            for name, axis in found.coords.items()
        },
        "outcomes": dict(ended),
        "quantities": {
            str(name): {"unit": column.attrs["units"], **_range(column)}
            for name, column in found.data_vars.items()
            if name not in own
        },
        "resumed": last.resumed if last else 0,
        "seconds": last.seconds if last else 0.0,
        "executor": found.attrs["executor"],
        "written": [str(path) for path in written],
    }


def _range(column: Any) -> dict[str, float | None]:
    import numpy

    numbers = column.values[numpy.isfinite(column.values)]
    ends: tuple[Callable[[Any], Any], ...] = (numpy.min, numpy.max)
    low, high = (float(end(numbers)) if numbers.size else None for end in ends)
    return {"min": low, "max": high}


def _print(told: dict[str, Any]) -> None:
    """Print what was found for reading."""
    from rich.table import Table

    from .show import new_console

    screen = new_console()
    ended = ", ".join(f"{number} {name}" for name, number in told["outcomes"].items())
    screen.print(f"[bold]{told['model']}[/bold]: {told['points']} points, {ended}")
    screen.print(f"{told['seconds']:.1f} s, {told['resumed']} resumed, {told['executor']}\n")
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("quantity", "least", "largest", "unit"):
        table.add_column(heading)
    for name, row in told["quantities"].items():
        ends = ("none" if row[end] is None else f"{row[end]:.9g}" for end in ("min", "max"))
        table.add_row(name, *ends, row["unit"])
    screen.print(table)
    for path in told["written"]:
        click.echo(f"written: {path}")
