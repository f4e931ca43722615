"""Mode shapes: how the junctions move in the critical mode, and where the energy of each mode is."""

from __future__ import annotations

import numpy

from ..plot import energy_plot, mode_shape_plot, new_axes
from ..stability import Mode, StabilityResult
from .blocks import Figure, Panel, Section, Text

# Inches: as wide as all plots of a page, so that letters keep their size.
WIDTH = 5.0
# More junctions than a plot can name.
MOST = 40
# Of more modes, the least damped are shown by energy; more storages than this have no key.
MODES, KEYS = 12, 15
SEEN = 0.005  # a smaller share has no bar


def shape_section(result: StabilityResult) -> Section | None:
    """Show the critical mode as motion of junctions, and all modes by energy."""
    panels = [panel for panel in (_shape(result), _energies(result)) if panel is not None]
    if not panels:
        return None
    return Section(
        "Mode shapes",
        (
            Text(
                "A mode moves all parts at one rhythm, each by its own amount and with its own "
                "delay. A phase of 0° moves along with the largest, 180° against it, 90° ahead of "
                "it by a quarter of a period."
            ),
            Figure("Shapes and energies.", tuple(panels), " ".join(_words(panels))),
        ),
    )


WORDS = {
    "mode-shape": "Shape: the critical mode. A bar for each junction, flows (such as speeds) above "
    "and efforts (such as forces) below, each over the largest of its unit; hatched where it moves "
    "against it.",
    "mode-energies": "Energies: the share of each storage in the energy of each mode.",
}


def _words(panels: list[Panel]) -> list[str]:
    """Say of each plot that there is how to read it."""
    return [WORDS[panel.name] for panel in panels]


def _shape(result: StabilityResult) -> Panel | None:
    mode = result.critical
    if mode is None:
        return None
    index = next(k for k, item in enumerate(result.rows) if item is mode)
    shape = result.system.mode_shapes()[index]
    moving = shape.within_unit()
    if not moving or len(moving) > MOST:
        return None
    ax = new_axes((WIDTH, 1.1 + 0.3 * len(moving)))
    names = list(moving)
    numbers = {
        "element": numpy.array(names),
        "share of the largest of its unit [1]": numpy.array([abs(moving[name]) for name in names]),
        "phase [degrees]": numpy.array([shape.phase(name) for name in names]),
    }
    drawn = mode_shape_plot(shape, within_unit=True, ax=ax)
    return Panel(
        "mode-shape", drawn, "Bars: how far each junction moves in the critical mode", numbers
    )


def _energies(result: StabilityResult) -> Panel | None:
    modes = [mode for mode in result.rows if mode.eigenvalue.imag >= 0 and mode.energies]
    if len(modes) > MODES:
        least = sorted(modes, key=lambda mode: -mode.eigenvalue.real / abs(mode.eigenvalue or 1))
        modes = [mode for mode in modes if mode in least[:MODES]]
    shown = {name for mode in modes for name, share in mode.energies.items() if abs(share) >= SEEN}
    if not modes or len(shown) > KEYS:
        return None
    drawn = energy_plot(modes, ax=new_axes((WIDTH, 1.5 + 0.42 * len(modes))))
    return Panel(
        "mode-energies", drawn, "Bars: where the energy of each mode is", _energy_numbers(modes)
    )


def _energy_numbers(modes: list[Mode]) -> dict[str, numpy.ndarray]:
    names = dict.fromkeys(name for mode in modes for name in mode.energies)
    return {
        "growth rate [1/s]": numpy.array([mode.eigenvalue.real for mode in modes]),
        "frequency [Hz]": numpy.array([mode.frequency_hz for mode in modes]),
        **{
            f"{name} [1]": numpy.array([mode.energies.get(name, 0.0) for mode in modes])
            for name in names
        },
    }
