"""Options that commands share, and how their text is read."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from typing import Any

import click

_VALUE = re.compile(r"^\s*([^\[\]]+?)\s*(?:\[(.*)\])?\s*$")


def model_argument(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the MODEL argument."""
    return click.argument("model")(function)


def set_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add ``--set NAME=VALUE``."""
    text = "Parameter in SI, or with a unit: k_f=350[N/mm]. Repeatable."
    return click.option("--set", "settings", multiple=True, metavar="NAME=VALUE", help=text)(
        function
    )


def run_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add what decides a run beside its parameters: tolerance, start, inputs, solver, backend."""
    for option in reversed(_RUN):
        function = option(function)
    return function


_RUN = (
    click.option("--rtol", default="1e-6", metavar="R", help="Relative tolerance (default 1e-6)."),
    click.option(
        "--initial", "start", multiple=True, metavar="NAME=VALUE", help="Initial state. Repeatable."
    ),
    click.option(
        "--input",
        "files",
        multiple=True,
        metavar="NAME=FILE.csv",
        help="Input over time, held between samples as FILE.csv:zero, :linear (default) or :band "
        "say; or NAME=VALUE.",
    ),
    click.option(
        "--solver",
        type=click.Choice(["auto", "dopri5", "cvodes", "idas", "rosenbrock"]),
        default="auto",
        help="Integrator; auto looks at the model and says why.",
    ),
    click.option(
        "--backend",
        type=click.Choice(["auto", "native", "vm"]),
        default="auto",
        help="Compiled C or not.",
    ),
)


def json_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add ``--json``."""
    return click.option(
        "--json", "as_json", is_flag=True, help="Print one JSON object and nothing else."
    )(function)


def debug_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add ``--debug`` to a command, so that it may stand at the end."""
    return click.option("--debug", is_flag=True, expose_value=False, help="Show tracebacks.")(
        function
    )


def read_settings(settings: tuple[str, ...], what: str = "--set") -> dict[str, Any]:
    """Read NAME=VALUE or NAME=VALUE[unit] words.

    Parameters
    ----------
    settings : tuple of str
    what : str
        The option's name, for messages.

    Returns
    -------
    dict of str to float or (float, str)

    Raises
    ------
    click.UsageError

    Examples
    --------
    >>> read_settings(("k_f=350[N/mm]", "tau=0.02"))
    {'k_f': (350.0, 'N/mm'), 'tau': 0.02}
    """
    values: dict[str, Any] = {}
    for word in settings:
        name, equals, text = word.partition("=")
        match = _VALUE.match(text)
        if not equals or not name.strip() or match is None:
            raise click.UsageError(f"{what} {word!r}: write NAME=VALUE or NAME=VALUE[unit]")
        name = name.strip()
        if name in values:
            raise click.UsageError(f"{what} {name!r} is given twice")
        number = read_number(match[1], f"{what} {name}")
        values[name] = number if match[2] is None else (number, match[2].strip())
    return values


def read_modes(words: tuple[str, ...]) -> dict[str, str]:
    """Read NAME=MODE words.

    Raises
    ------
    click.UsageError

    Examples
    --------
    >>> read_modes(("pads.contact=slip+",))
    {'pads.contact': 'slip+'}
    """
    modes = {}
    for word in words:
        name, equals, mode = word.rpartition("=")
        if not equals:
            raise click.UsageError(f"--mode {word!r}: write NAME=stick, NAME=slip+ or NAME=slip-")
        modes[name] = mode
    return modes


def read_number(text: str, what: str) -> float:
    """Read a finite number, or raise a usage error that says where.

    Examples
    --------
    >>> read_number("1e3", "--until")
    1000.0
    """
    try:
        value = float(text)
    except ValueError:
        raise click.UsageError(f"{what}: {text.strip()!r} is no number") from None
    if not math.isfinite(value):
        raise click.UsageError(f"{what}: {text.strip()} is not a finite number")
    return value


def print_json(value: dict[str, Any]) -> None:
    """Print one JSON object, refusing what JSON cannot hold."""
    click.echo(json.dumps(value, allow_nan=False))
