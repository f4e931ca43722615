"""A sweep on disk: a manifest, one file a chunk, and a lock; each file appears whole or not.

``manifest.json`` says what decides the results and which points each chunk holds. A chunk's file
begins with the checksum of the rest. ``journal.jsonl`` has one line for each chunk computed.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import SweepError
from .block import Block, from_bytes, to_bytes
from .identity import digest

FORMAT = 1
_HEAD = b"halfarrow sweep chunk 1\n"

Chunks = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Manifest:
    """What a folder's sweep is.

    Attributes
    ----------
    model : str
    decides : mapping
        Everything that decides the results; see `fingerprint`.
    chunks : tuple of (int, int)
        First point and the one after the last, of each chunk.
    """

    model: str
    decides: Mapping[str, Any]
    chunks: Chunks


class Store:
    """A folder that this process alone writes to.

    Parameters
    ----------
    folder : Path
        Made where it does not exist.

    Raises
    ------
    SweepError
        When it cannot be made, or another process works in it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            (folder / "chunks").mkdir(parents=True, exist_ok=True)
            self._lock = _locked(folder / "lock")
        except OSError as error:
            raise SweepError(f"{folder}: cannot be used: {error.strerror or error}") from None

    def close(self) -> None:
        """Let other processes in."""
        os.close(self._lock)

    def read_manifest(self) -> Manifest | None:
        """Return the manifest; None where the folder has none yet."""
        path = self.folder / "manifest.json"
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise SweepError(f"{path}: cannot be read: {error}; take another folder") from None
        if not isinstance(found, dict) or found.get("format") != FORMAT:
            raise SweepError(f"{path}: is no manifest of format {FORMAT}; take another folder")
        chunks = tuple((int(start), int(stop)) for start, stop in found["chunks"])
        return Manifest(found["model"], found["decides"], chunks)

    def write_manifest(self, manifest: Manifest) -> None:
        """Write the manifest, before all chunks."""
        text = json.dumps(
            {
                "format": FORMAT,
                "model": manifest.model,
                "points": manifest.chunks[-1][1],
                "decides": manifest.decides,
                "chunks": manifest.chunks,
            },
            indent=1,
        )
        written(self.folder / "manifest.json", text.encode())

    def read_chunk(self, index: int, count: int) -> Block | None:
        """Return a chunk; None where its file is missing, cut short or altered."""
        try:
            data = self._path(index).read_bytes()
        except OSError:
            return None
        head, _, rest = data.partition(b"\n\n")
        if head + b"\n" != _HEAD + digest(rest).encode() + b"\n":
            return None
        try:
            block = from_bytes(rest)
        except ValueError:
            return None
        return block if len(block) == count else None

    def write_chunk(self, index: int, block: Block) -> None:
        """Write a chunk, then a line of the journal."""
        data = to_bytes(block)
        written(self._path(index), _HEAD + digest(data).encode() + b"\n\n" + data)
        line = {"chunk": index, "points": len(block), "seconds": float(block.seconds.sum())}
        with (self.folder / "journal.jsonl").open("a", encoding="utf-8") as journal:
            journal.write(json.dumps(line) + "\n")

    def _path(self, index: int) -> Path:
        return self.folder / "chunks" / f"{index:06d}.chunk"

    def clear(self, *, chunks: bool = True) -> None:
        """Remove files that a killed process left half written, and chunks without a manifest."""
        for folder in (self.folder, self.folder / "chunks"):
            for part in folder.glob(".*.part"):
                part.unlink(missing_ok=True)
        if chunks:
            for path in (self.folder / "chunks").glob("*.chunk"):
                path.unlink(missing_ok=True)


def written(path: Path, data: bytes) -> None:
    """Write a file so that it is there whole or not at all, also when the machine stops.

    Raises
    ------
    SweepError
        When it cannot be written.
    """
    make(path, lambda part: part.write_bytes(data))


def make(path: Path, fill: Callable[[Path], Any]) -> None:
    """Let a function fill a new file beside a path, then put it in the path's place."""
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-", suffix=".part")
        part = Path(name)
        try:
            os.close(handle)
            fill(part)
            with part.open("rb+") as file:
                os.fsync(file.fileno())
            os.replace(part, path)
        except BaseException:
            part.unlink(missing_ok=True)
            raise
        _sync_folder(path.parent)
    except OSError as error:
        raise SweepError(f"{path}: cannot be written: {error.strerror or error}") from None


def differences(mine: Mapping[str, Any], theirs: Mapping[str, Any]) -> list[str]:
    """Name what differs between two fingerprints.

    Examples
    --------
    >>> differences({"model": "a", "options": {"rtol": "1"}}, {"model": "a", "options": {"rtol": "2"}})
    ['options: rtol']
    """
    found = []
    for name in dict.fromkeys((*mine, *theirs)):
        one, other = mine.get(name), theirs.get(name)
        if one == other:
            continue
        if isinstance(one, Mapping) and isinstance(other, Mapping):
            inside = [
                key for key in dict.fromkeys((*one, *other)) if one.get(key) != other.get(key)
            ]
            found.append(f"{name}: {', '.join(inside)}")
        else:
            found.append(name)
    return found


def pieces(count: int, size: int, start: int = 0) -> Chunks:
    """Cut points from `start` on into chunks of one size.

    Examples
    --------
    >>> pieces(7, 3)
    ((0, 3), (3, 6), (6, 7))
    """
    return tuple((i, min(i + size, count)) for i in range(start, count, size))


def check_cover(chunks: Sequence[tuple[int, int]], count: int) -> None:
    """Raise SweepError unless chunks hold each of so many points once."""
    edges = [0, *(stop for _, stop in chunks)]
    starts = [start for start, _ in chunks]
    if starts != edges[:-1] or edges[-1] != count or any(a >= b for a, b in chunks):
        raise SweepError(f"the manifest's chunks do not hold each of {count} points once")


def _sync_folder(folder: Path) -> None:
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:  # not every system opens folders
        return
    try:
        os.fsync(handle)
    except OSError:
        pass
    finally:
        os.close(handle)


def _locked(path: Path) -> int:
    """Open and lock a file. The system lets go of it when the process ends, however it ends."""
    handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        _take(handle)
    except OSError:
        owner = os.read(handle, 100).decode(errors="replace").strip()
        os.close(handle)
        raise SweepError(
            f"{path.parent}: process {owner or 'unknown'} works in this folder; wait for it, or "
            f"take another"
        ) from None
    os.ftruncate(handle, 0)
    os.write(handle, str(os.getpid()).encode())
    return handle


def _take(handle: int) -> None:
    try:
        import fcntl
    except ImportError:  # Windows
        import msvcrt

        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
    else:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
