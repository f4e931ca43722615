"""The commands: each reads its options, calls the library, and shows the result."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from . import options as opt
from .discover import discover
from .stability import reports, stability
from .sweep import sweep
from .symbolic import symbolic

if TYPE_CHECKING:
    from bondgraph.simulation import Trajectory


@click.command()
@opt.json_option
@opt.debug_option
def models(as_json: bool) -> None:
    """List the model library."""
    from bondgraph.models import LIBRARY

    if as_json:
        rows = [{"name": name, "description": text} for name, text in LIBRARY.items()]
        opt.print_json({"schema": 1, "models": rows})
        return
    width = max(map(len, LIBRARY))
    for name, text in LIBRARY.items():
        click.echo(f"{name:<{width}}  {text}")


@click.command()
@opt.model_argument
@click.option(
    "--svg", type=click.Path(dir_okay=False, path_type=Path), help="Draw the graph into this file."
)
@click.option(
    "--causality",
    "report",
    is_flag=True,
    help="Instead: all that causality decided, why, and what was done about it.",
)
@opt.json_option
@opt.debug_option
def show(model: str, svg: Path | None, report: bool, as_json: bool) -> None:
    """Show a model: elements, bonds with their causality, parameters."""
    from bondgraph.causality import assign_causality

    from .load import load_model
    from .show import as_json_object, as_tables, print_causality

    causal = assign_causality(load_model(model))
    if svg is not None:
        from bondgraph.draw import to_svg

        svg.write_text(to_svg(causal), encoding="utf-8")
    if report:
        print_causality(causal, as_json)
    elif as_json:
        opt.print_json(as_json_object(causal))
    else:
        as_tables(causal)
    if svg is not None and not as_json:
        click.echo(f"drawing: {svg}")


@click.command()
@opt.model_argument
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "latex", "json"]),
    default="text",
    help="What to print.",
)
@opt.set_option
@click.option("--json", "as_json", is_flag=True, help="The same as --format json.")
@opt.debug_option
def equations(model: str, form: str, settings: tuple[str, ...], as_json: bool) -> None:
    """Derive and print a model's equations."""
    from bondgraph import text
    from bondgraph.equations import derive
    from bondgraph.resolver import resolve

    from .load import load_model

    graph = load_model(model)
    values = resolve(graph.parameters, opt.read_settings(settings), partial=True)
    derived = derive(graph)
    if as_json or form == "json":
        opt.print_json(text.to_json(derived, values))
    else:
        click.echo(text.to_latex(derived) if form == "latex" else text.to_text(derived))


@click.command()
@opt.model_argument
@click.option("--until", required=True, metavar="T", help="End of the run, s.")
@opt.set_option
@opt.run_options
@click.option(
    "--points",
    type=click.IntRange(2, 10_000_000),
    help="Report this many even times (default: steps).",
)
@click.option(
    "--smooth", metavar="WIDTH", help="For comparison: tanh friction of this slip width, m/s."
)
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write signals to FILE.csv or FILE.nc.",
)
@click.option(
    "--plot",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Plot the outputs to FILE.svg or .png.",
)
@opt.json_option
@opt.debug_option
def simulate(
    model: str,
    until: str,
    rtol: str,
    settings: tuple[str, ...],
    start: tuple[str, ...],
    files: tuple[str, ...],
    points: int | None,
    smooth: str | None,
    backend: Literal["auto", "native", "vm"],
    solver: Literal["auto", "dopri5", "cvodes", "idas", "rosenbrock"],
    out: Path | None,
    plot: Path | None,
    as_json: bool,
) -> int:
    """Simulate a model from time zero."""
    end = opt.read_number(until, "--until")
    tolerance = opt.read_number(rtol, "--rtol")
    if end <= 0:
        raise click.UsageError(f"--until {until}: the run must end after zero")
    values, initial = opt.read_settings(settings), opt.read_settings(start, "--initial")
    if out is not None and out.suffix not in (".csv", ".nc"):
        raise click.UsageError(f"--out {out}: use the ending .csv or .nc")
    from bondgraph.modes import smoothed
    from bondgraph.simulation import simulate as run

    from .load import load_model, read_inputs

    graph = load_model(model)
    if smooth is not None:
        graph = smoothed(graph, opt.read_number(smooth, "--smooth"))
    grid = None if points is None else [end * index / (points - 1) for index in range(points)]
    trajectory = run(
        graph,
        (0.0, end),
        values,
        initial,
        read_inputs(graph, files),
        t_eval=grid,
        rtol=tolerance,
        backend=backend,
        solver=solver,
    )
    if out is not None:
        trajectory.save(out)
    if plot is not None:
        _plot(trajectory, plot)
    return _report_run(trajectory, as_json, [path for path in (out, plot) if path is not None])


def _plot(trajectory: Trajectory, path: Path) -> None:
    from bondgraph.plot import overview, save

    save(overview(trajectory), path)


def _report_run(trajectory: Trajectory, as_json: bool, written: list[Path]) -> int:
    from .show import run_json, run_tables

    if as_json:
        opt.print_json(run_json(trajectory))
    else:
        run_tables(trajectory)
        for path in written:
            click.echo(f"written: {path}")
    if not trajectory.outcome.ok:
        click.echo(
            f"bondgraph: the run stopped at {trajectory.t_end:.9g} s: {trajectory.outcome.value}; "
            f"{trajectory.advice}",
            err=True,
        )
        return 1
    if trajectory.undefined:
        click.echo(f"bondgraph: {trajectory.undefined_words()}", err=True)
        return 1
    return 0


ALL = (models, show, equations, symbolic, simulate, stability, reports, sweep, discover)
