"""Views of runs: how they ended, their energy audit, last values and curves."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy

from ..plot.envelope import envelope
from ..plot.style import dressed, legend, line, pretty
from ..simulation import Trajectory
from .markup import block, number, paragraph, table

MOST_AXES, MOST_CURVES = 4, 6
_SETTINGS: Any = {"svg.fonttype": "none", "svg.hashsalt": "halfarrow"}
_NOTHING = dict.fromkeys(("Date", "Creator", "Format", "Type"))


def svg(run: Trajectory) -> str:
    """Return a small plot of the outputs over time, or of the states where there are none.

    Parameters
    ----------
    run : Trajectory

    Returns
    -------
    str
        One row for each unit. Long runs are drawn as envelopes, of many signals the first.
    """
    import matplotlib
    from matplotlib.figure import Figure

    rows: dict[str, list[str]] = {}
    for name in run.model.equations.outputs or run.states:
        rows.setdefault(run.unit(name), []).append(name)
    shown = list(rows.items())[:MOST_AXES]
    figure = Figure(figsize=(6.4, 0.5 + 1.5 * max(len(shown), 1)), layout="constrained")
    grid = figure.subplots(max(len(shown), 1), 1, sharex=True, squeeze=False)[:, 0]
    for ax, (unit, names) in zip(grid, shown, strict=False):
        _curves(dressed(ax), run, names[:MOST_CURVES], unit)
    dressed(grid[-1]).set_xlabel("time [s]")
    buffer = io.StringIO()
    with matplotlib.rc_context(_SETTINGS):
        figure.savefig(buffer, format="svg", metadata=_NOTHING, facecolor="white")
    return buffer.getvalue()


def html(run: Trajectory) -> str:
    """Return outcome, energy audit, last values and curves.

    Parameters
    ----------
    run : Trajectory

    Returns
    -------
    str
    """
    audit = run.energy
    rows = [
        ("ended", f"{run.outcome.value} at {number(run.t_end, 's', 9)}"),
        ("solver", f"{run.solver}, {run.steps} steps, {len(run.t)} rows kept"),
        ("events", str(len(run.events))),
        ("energy supplied", number(audit.supplied, "J")),
        ("energy stored", number(audit.stored, "J")),
        ("energy dissipated", number(audit.dissipated, "J")),
        ("left over, relative", number(audit.relative_residual, "", 2)),
    ]
    last = [(name, number(value, run.unit(name))) for name, value in run.final.items()]
    picture = base64.b64encode(svg(run).encode()).decode()
    return block(
        f"Run of {run.model.equations.name}",
        paragraph("" if run.outcome.ok else run.advice),
        paragraph(run.undefined_words()),
        # as an image of its own: the ids of several drawings on a page do not meet
        f'<img alt="signals over time" src="data:image/svg+xml;base64,{picture}"/>',
        table(("", ""), rows),
        table(("signal", "last value"), last),
    )


def _curves(ax: Any, run: Trajectory, names: list[str], unit: str) -> None:
    for place, name in enumerate(names):
        values = numpy.where(numpy.isfinite(run[name]), run[name], numpy.nan)
        found, style = envelope(run.t, values), line(place)
        ax.plot(found.t, found.low, label=name, **style)
        if not found.whole:
            ax.fill_between(found.t, found.low, found.high, color=style["color"], alpha=0.4, lw=0)
    ax.set_ylabel(f"{', '.join(names)} [{pretty(unit or '1')}]", fontsize=8)
    ax.margins(x=0.01)
    legend(ax)
