"""Model files on disk."""

from __future__ import annotations

from pathlib import Path

from ..errors import ModelError
from ..graph import BondGraph
from .entries import at
from .read import loads
from .write import dumps

MAX_BYTES = 5_000_000


def load(path: str | Path) -> BondGraph:
    """Read a bond graph from a model file.

    Parameters
    ----------
    path : str or Path
        A TOML file of at most 5 MB.

    Returns
    -------
    BondGraph

    Raises
    ------
    BondGraphError
        `ModelError`, `GraphError`, `ParameterError` or `LawError`: in one line
        the file, the table and key at fault, and the remedy.

    Examples
    --------
    >>> load("missing.toml")
    Traceback (most recent call last):
    ...
    bondgraph.errors.ModelError: missing.toml: there is no such file; check the path
    """
    return loads(_read(Path(path)), str(path))


def save(graph: BondGraph, path: str | Path) -> Path:
    """Write a bond graph to a model file that `load` reads again.

    Parameters
    ----------
    graph : BondGraph
    path : str or Path
        Overwritten if it exists.

    Returns
    -------
    Path

    Raises
    ------
    BondGraphError
        If a law cannot be written, or the file not be made.

    Examples
    --------
    >>> import tempfile
    >>> from bondgraph.models import mass_on_belt
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     load(save(mass_on_belt.graph(), Path(folder) / "belt.toml"))
    BondGraph('mass_on_belt', 7 elements, 6 bonds)
    """
    path = Path(path)
    text = dumps(graph)
    with at(f"model {graph.name!r} would not load again"):
        loads(text, "as written")
    try:
        path.write_text(text, encoding="utf-8", newline="\n")
    except UnicodeError:
        raise ModelError(
            f"model {graph.name!r} holds characters that are no text; rename"
        ) from None
    except OSError as error:
        raise ModelError(f"{path}: cannot be written ({error.strerror}); check the path") from None
    return path


def _read(path: Path) -> str:
    try:
        if not path.exists():
            raise ModelError(f"{path}: there is no such file; check the path")
        if not path.is_file():
            raise ModelError(f"{path}: this is no file; give a .toml model file")
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ModelError(f"{path}: cannot be read ({reason}); check the path") from None
    if len(data) > MAX_BYTES:
        raise ModelError(f"{path}: larger than {MAX_BYTES // 10**6} MB; this is no model file")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError(f"{path}: byte {error.start} is not UTF-8; save it as UTF-8") from None
