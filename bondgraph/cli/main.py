"""The click group: one clear line for every error, and the exit codes of the contract.

Exit 0: done. 1: the work failed, with a named reason. 2: bad usage or input.
"""

from __future__ import annotations

import logging
import os
import sys
from typing import Any

import click

DONE, FAILED, BAD_INPUT = 0, 1, 2


class OneLineGroup(click.Group):
    """A group whose every error is one line on stderr; ``--debug`` shows the traceback."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run a command and turn what it raises into one line and an exit code."""
        extra["standalone_mode"] = False
        debug = "--debug" in (extra.get("args") or (args[0] if args and args[0] else sys.argv[1:]))
        try:
            code = super().main(*args, **extra)
        except Exception as error:
            if debug:
                raise
            code = _report(error)
        sys.exit(code if isinstance(code, int) else DONE)


def _report(error: Exception) -> int:
    """Print one line and return the exit code."""
    if isinstance(error, click.Abort):
        click.echo("bondgraph: stopped", err=True)
        return 130
    if isinstance(error, BrokenPipeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    text, code = _describe(error)
    click.echo(f"bondgraph: {' '.join(text.split())}", err=True)
    return code


def _describe(error: Exception) -> tuple[str, int]:
    if isinstance(error, click.ClickException):
        context = getattr(error, "ctx", None)
        hint = f" (see {context.command_path} --help)" if context is not None else ""
        return error.format_message() + hint, BAD_INPUT
    from bondgraph import errors

    if isinstance(error, errors.BondGraphError):
        bad = (
            errors.ParameterError,
            errors.ModelError,
            errors.GraphError,
            errors.LawError,
            errors.SimulationError,
            errors.SweepError,
            errors.MeasurementError,
        )
        return str(error), BAD_INPUT if isinstance(error, bad) else FAILED
    if isinstance(error, OSError):
        return f"{error.filename or 'file'}: {error.strerror or error}", FAILED
    return (
        f"unexpected {type(error).__name__}: {error}; run again with --debug and report what it shows",
        FAILED,
    )


class _Notes(logging.Handler):
    """Shows the library's warnings as notes on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        click.echo(f"bondgraph: note: {record.getMessage()}", err=True)


@click.group(cls=OneLineGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--debug", is_flag=True, help="Show tracebacks.")
@click.version_option(package_name="halfarrow", prog_name="bondgraph")
def main(debug: bool) -> None:
    """Bond graphs: equations, simulation and stability of engineering systems.

    MODEL is a library name (see 'bondgraph models'), 'path/to/file.py:name', or
    a '.toml' model file.
    """
    log = logging.getLogger("bondgraph")
    log.setLevel(logging.DEBUG if debug else logging.WARNING)
    log.handlers = [_Notes()]
    log.propagate = False


def _register() -> None:
    from . import commands

    for command in commands.ALL:
        main.add_command(command)


_register()
