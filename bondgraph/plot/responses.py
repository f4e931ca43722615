"""Plots of linear responses: Bode diagrams, steps and impulses."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError
from .gaps import key_above
from .style import INK, PALETTE, STYLES, dressed, figure_of, new_axes, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..linear import FrequencyResponse, LinearSystem, TimeResponse

WIDEST = 70  # letters of a key's row
Names = str | Iterable[str] | None


def bode_plot(
    found: FrequencyResponse | LinearSystem,
    outputs: Names = None,
    inputs: Names = None,
    *,
    ax: Axes | tuple[Axes, Axes] | None = None,
) -> tuple[Axes, Axes]:
    """Plot magnitude and phase over frequency.

    Parameters
    ----------
    found : FrequencyResponse or LinearSystem
    outputs, inputs : str or iterable of str, optional
        Channels to show; all unless given.
    ax : Axes or (Axes, Axes), optional
        For magnitude and phase; one alone is divided in two.

    Returns
    -------
    (Axes, Axes)
        Of magnitude and phase.

    Examples
    --------
    >>> from bondgraph import linearize
    >>> from bondgraph.models import quarter_car
    >>> above, below = bode_plot(linearize(quarter_car.graph()), "v_body")
    >>> above.get_ylabel(), below.get_ylabel(), below.get_xlabel()
    ('magnitude [1]', 'phase [°]', 'frequency [Hz]')
    """
    response = found.frequency_response() if hasattr(found, "frequency_response") else found
    above, below = _stacked(ax)
    hertz = response.frequency_hz
    units = []
    for place, (output, source) in enumerate(_channels(response, outputs, inputs)):
        style = _curve(place)
        units.append(response.unit(output, source))
        label = f"{output} over {source}"
        size, phase = response.magnitude(output, source), response.phase(output, source)
        shown = numpy.where(numpy.isfinite(size) & (size > 0), size, numpy.nan)
        above.plot(hertz, shown, label=label, **style)
        below.plot(hertz, phase, label=label, **style)
    above.set_yscale("log")
    for part in (above, below):
        part.set_xscale("log")
        part.margins(x=0)
    _degrees(below)
    above.set_ylabel(f"magnitude [{_common(units)}]")
    below.set_ylabel("phase [°]")
    below.set_xlabel("frequency [Hz]")
    above.tick_params(labelbottom=False)
    _key(above)
    return above, below


def step_plot(
    found: TimeResponse | LinearSystem,
    outputs: Names = None,
    inputs: Names = None,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Plot how outputs answer a step, or an impulse where that is given.

    Parameters
    ----------
    found : TimeResponse or LinearSystem
        Of a system, the step response.
    outputs, inputs : str or iterable of str, optional
        Channels to show; all unless given. Outputs of one unit share an axis.
    ax : Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    BondGraphError
        For outputs of different units.

    Examples
    --------
    >>> from bondgraph import linearize
    >>> from bondgraph.models import quarter_car
    >>> ax = step_plot(linearize(quarter_car.graph()), ["suspension", "tyre"])
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('time [s]', 'suspension, tyre [m]')
    """
    response = found.step_response() if hasattr(found, "step_response") else found
    channels = _channels(response, outputs, inputs)
    units = {response.unit(output, source) for output, source in channels}
    if len(units) > 1:
        several = ", ".join(dict.fromkeys(output for output, _ in channels))
        raise BondGraphError(
            f"outputs of one unit share an axis, got {several} in {', '.join(sorted(units))}; "
            f"choose some, as outputs={channels[0][0]!r}"
        )
    ax = dressed(ax)
    ax.axhline(0, color=INK, lw=0.6)
    factor, unit = (1e3, "ms") if response.time[-1] < 1 else (1.0, "s")
    for place, (output, source) in enumerate(channels):
        label = f"{output}, {response.kind} of {source}"
        ax.plot(response.time * factor, response[output, source], label=label, **_curve(place))
    ax.set_xlabel(f"time [{unit}]")
    names = ", ".join(dict.fromkeys(output for output, _ in channels))
    ax.set_ylabel(f"{names} [{_common(list(units))}]")
    ax.margins(x=0.01)
    _key(ax)
    return ax


def _channels(response: Any, outputs: Names, inputs: Names) -> list[tuple[str, str]]:
    rows, columns = (
        list(known) if names is None else [names] if isinstance(names, str) else list(names)
        for names, known in ((outputs, response.outputs), (inputs, response.inputs))
    )
    if not rows or not columns:
        raise BondGraphError("there is nothing to plot: name at least one output and one input")
    return [(output, source) for output in rows for source in columns]


def _curve(place: int) -> dict[str, Any]:
    """Return colour and line style: a pair of them comes again only after many curves."""
    return {
        "color": PALETTE[place % len(PALETTE)],
        "ls": STYLES[(place + place // len(PALETTE)) % len(STYLES)],
        "lw": 1.6,
    }


def _key(ax: Axes) -> None:
    """Put the key above the axes, in as many columns as its words leave room for."""
    handles, labels = ax.get_legend_handles_labels()
    key_above(ax)
    longest = max(map(len, labels), default=0)
    legend = ax.get_legend()
    if legend is not None and len(labels) * (longest + 6) > WIDEST:
        ax.legend(
            handles,
            labels,
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=max(WIDEST // (longest + 6), 1),
            frameon=False,
            fontsize=8,
            labelcolor=INK,
        )


def _common(units: list[str]) -> str:
    return pretty(units[0] or "1") if len(set(units)) == 1 else "SI"


def _degrees(ax: Axes) -> None:
    """Give a phase axis ticks at parts of a turn."""
    from matplotlib.ticker import MultipleLocator

    low, high = ax.get_ylim()
    step = next((s for s in (15, 30, 45, 90, 180) if (high - low) / s <= 7), 360)
    ax.yaxis.set_major_locator(MultipleLocator(step))


def _stacked(ax: Axes | tuple[Axes, Axes] | None) -> tuple[Axes, Axes]:
    """Return two axes, one above the other."""
    if ax is None:
        ax = new_axes((5.0, 4.6))
    if isinstance(ax, tuple):
        above, below = ax
    else:
        above, figure, place = ax, figure_of(ax), ax.get_subplotspec()
        if place is not None:
            rows = place.subgridspec(2, 1, height_ratios=(3, 2), hspace=0.08)
            above.set_subplotspec(rows[0])
            below = figure.add_subplot(rows[1], sharex=above)
        else:
            x0, y0, width, height = ax.get_position().bounds
            above.set_position((x0, y0 + 0.45 * height, width, 0.55 * height))
            below = figure.add_axes((x0, y0, width, 0.38 * height), sharex=above)
    return dressed(above), dressed(below)
