"""The folder of a sweep: begun, refused, or taken up again."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import SweepError
from ..simulation import CompiledModel
from .block import Block
from .identity import fingerprint
from .job import Job
from .points import Points
from .store import Chunks, Manifest, Store, check_cover, differences


@dataclass
class Folder:
    """A sweep's folder, locked.

    Attributes
    ----------
    path : Path
    store : Store
    model : str
        Its name.
    decides : dict
        What decides the results.
    chunks : tuple of (int, int) or None
        None until they are planned.
    """

    path: Path
    store: Store
    model: str
    decides: dict[str, Any]
    chunks: Chunks | None

    def plan(self, chunks: Chunks) -> None:
        """Write down which chunks there are going to be."""
        self.store.write_manifest(Manifest(self.model, self.decides, chunks))
        self.chunks = chunks

    def found(self) -> Iterator[tuple[int, Block]]:
        """Iterate over the chunks that are there and whole."""
        for index, (start, stop) in enumerate(self.chunks or ()):
            block = self.store.read_chunk(index, stop - start)
            if block is not None:
                yield index, block


def opened(
    stack: contextlib.ExitStack,
    out: str | Path | None,
    resume: bool,
    what: tuple[CompiledModel, Job, Points],
) -> Folder | None:
    """Open and lock a sweep's folder.

    Parameters
    ----------
    stack : ExitStack
        Unlocks it.
    out : path or None
    resume : bool
    what : (CompiledModel, Job, Points)

    Returns
    -------
    Folder or None

    Raises
    ------
    SweepError
        Where the folder holds another sweep, or this one without `resume`, or
        something else; where another process works in it.
    """
    if out is None:
        if resume:
            raise SweepError("resume needs out=, the folder of the sweep to take up")
        return None
    path = Path(out)
    _no_stranger(path)
    model, job, points = what
    store = Store(path)
    stack.callback(store.close)
    decides = fingerprint(model, job, points)
    manifest = store.read_manifest()
    if manifest is None:
        store.clear()
        return Folder(path, store, model.equations.name, decides, None)
    if not resume:
        raise SweepError(
            f"{path} holds a sweep of {manifest.model!r} already; take it up with resume, or take "
            f"another folder"
        )
    other = differences(decides, manifest.decides)
    if other:
        raise SweepError(
            f"{path} holds another sweep; what differs is {'; '.join(other)}. Ask for the same, or "
            f"take another folder"
        )
    check_cover(manifest.chunks, len(points))
    store.clear(chunks=False)
    return Folder(path, store, manifest.model, decides, manifest.chunks)


def _no_stranger(path: Path) -> None:
    """Refuse a folder that holds something else, before anything is written there."""
    try:
        names = {item.name for item in path.iterdir()}
    except FileNotFoundError:
        return
    except OSError as error:
        raise SweepError(f"{path}: cannot be used: {error.strerror or error}") from None
    strange = [name for name in names - {"lock", "chunks"} if not name.endswith(".part")]
    if "manifest.json" not in names and strange:
        raise SweepError(
            f"{path} holds files of something else, such as {min(strange)}; take another folder"
        )
