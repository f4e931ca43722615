"""From MODEL on the command line to a bond graph."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from bondgraph.errors import BondGraphError, ModelError, suggestion
from bondgraph.graph import BondGraph

from .options import read_number

if TYPE_CHECKING:
    from bondgraph.simulation import Samples
    from bondgraph.stability import Vary


class ReportParts(NamedTuple):
    """What a library model adds to its report.

    Attributes
    ----------
    description : str
    ranges : list of Vary
        What to follow the eigenvalues over unless told otherwise.
    maps : list of (Vary, Vary)
        What to map unless told otherwise.
    sections : callable
        Makes the model's own sections for settings of a report, which may take simulations.
    """

    description: str
    ranges: list[Vary]
    maps: list[tuple[Vary, Vary]]
    sections: Callable[[dict[str, Any]], list[Any]]


def report_parts(word: str) -> ReportParts:
    """Return what MODEL adds to its report; nothing where it is not of the library."""
    from bondgraph import models
    from bondgraph.stability import Vary

    if word not in models.LIBRARY:
        return ReportParts("", [], [], lambda _: [])
    module = getattr(models, word)
    figures = getattr(module, "figures", None)
    return ReportParts(
        module.__doc__ or "",
        [Vary(*item) for item in getattr(module, "VARY", ())],
        [(Vary(*across), Vary(*upwards)) for across, upwards in getattr(module, "MAPS", ())],
        lambda parameters: list(figures(parameters)) if figures else [],
    )


def load_model(word: str) -> BondGraph:
    """Return the graph that MODEL names.

    Parameters
    ----------
    word : str
        A library name, ``path/to/file.py:name``, or a ``.toml`` file.

    Returns
    -------
    BondGraph

    Raises
    ------
    ModelError
        When there is no such model, or its file fails.

    Examples
    --------
    >>> load_model("mass_on_belt").name
    'mass_on_belt'
    """
    if word.endswith(".toml"):
        from bondgraph.files import load

        return load(Path(word))
    path, colon, name = word.rpartition(":")
    if colon and path.endswith(".py"):
        return _from_python(Path(path), name)
    if word.endswith(".py"):
        raise ModelError(f"{word}: say which graph of the file, as {word}:name")
    return _from_library(word)


def read_inputs(graph: BondGraph, words: tuple[str, ...]) -> dict[str, float | Samples]:
    """Read NAME=FILE.csv and NAME=VALUE words of ``--input``.

    Parameters
    ----------
    graph : BondGraph
    words : tuple of str

    Returns
    -------
    dict of str to float or Samples

    Raises
    ------
    click.UsageError, ParameterError

    Examples
    --------
    >>> read_inputs(load_model("quarter_car"), ("v_road=0.5",))
    {'v_road': 0.5}
    """
    from bondgraph.parameters import unknown_name
    from bondgraph.simulation import Samples

    units = {symbol.name: unit for symbol, unit in graph.inputs.items()}
    inputs: dict[str, float | Samples] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not text:
            raise click.UsageError(
                f"--input {word!r}: write NAME=FILE.csv, NAME=FILE.csv:HOLD or NAME=VALUE"
            )
        if name not in units:
            raise unknown_name("input", name, units)
        path, hold = _path_and_hold(text)
        if path.endswith(".csv"):
            inputs[name] = Samples.read(path, name, units[name], hold)
        else:
            inputs[name] = read_number(text, f"--input {name}")
    return inputs


def _from_library(word: str) -> BondGraph:
    from bondgraph import models

    if word not in models.LIBRARY:
        hint = suggestion(word, models.LIBRARY, most=2) or f"it holds {', '.join(models.LIBRARY)};"
        raise ModelError(
            f"model {word!r} is not in the library; {hint} a file is given as file.py:name or file.toml"
        )
    graph = getattr(models, word).graph()
    assert isinstance(graph, BondGraph)
    return graph


def _from_python(path: Path, name: str) -> BondGraph:
    if not path.is_file():
        raise ModelError(f"{path}: no such file")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(path.parent.resolve()))
    try:
        spec.loader.exec_module(module)
        found = getattr(module, name, None)
        graph = _as_graph(found)
    except BondGraphError:
        raise
    except (Exception, SystemExit) as error:
        raise ModelError(f"{path}{_line(error, path)}: {type(error).__name__}: {error}") from error
    finally:
        sys.path.remove(str(path.parent.resolve()))
    if graph is None:
        what = (
            "has no such name"
            if found is None
            else f"holds {type(found).__name__}, not a BondGraph"
        )
        raise ModelError(
            f"{path}:{name}: the file {what}; name a BondGraph or a function that returns one"
        )
    return graph


def _as_graph(found: Any) -> BondGraph | None:
    if callable(found):
        found = found()
    return found if isinstance(found, BondGraph) else None


def _line(error: BaseException, path: Path) -> str:
    """Where in the user's own file it went wrong."""
    frames = [
        frame for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename) == path
    ]
    number = frames[-1].lineno if frames else getattr(error, "lineno", None)
    return f", line {number}" if number else ""


def _path_and_hold(text: str) -> tuple[str, str]:
    """Take a known word after the last colon for the hold; a path may hold colons of its own."""
    from bondgraph.simulation.inputs import HOLDS

    path, colon, hold = text.rpartition(":")
    if colon and path.endswith(".csv"):
        if hold not in HOLDS:
            raise click.UsageError(f"--input {text!r}: after the file comes {', '.join(HOLDS)}")
        return path, hold
    return text, "linear"
