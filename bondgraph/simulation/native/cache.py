"""Shared objects on disk: one folder for each thing that was compiled, files that tell their content.

An entry's name is a hash of everything that decides the machine code; a file's name holds the hash
of its content. Files appear whole, and one whose content is not what its name says is thrown away:
any number of processes may read and write at once. Set ``HALFARROW_CACHE`` to move the folder, by
default ``halfarrow`` in ``$XDG_CACHE_HOME`` or ``~/.cache``.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import logging
import os
import platform
import struct
from collections.abc import Iterable
from pathlib import Path

log = logging.getLogger(__name__)

# A file that a compiler left under this ending is whole, but its content is not yet in its name.
FRESH = ".fresh"
LOOKS = 3  # into an entry whose files are being renamed


def cache_folder() -> Path:
    """Where entries are kept.

    Examples
    --------
    >>> cache_folder().is_absolute()
    True
    """
    if given := os.environ.get("HALFARROW_CACHE"):
        return Path(given).absolute()
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base).absolute() / "halfarrow"
    try:
        return Path.home() / ".cache" / "halfarrow"
    except RuntimeError:  # no home: whoever writes there finds it unusable and says so
        return Path(os.devnull) / "halfarrow"


def entry(compiler: str, parts: Iterable[str | bytes]) -> Path:
    """Folder of what a compiler makes on this processor from some parts.

    Parameters
    ----------
    compiler : str
        Path of its executable.
    parts : iterable of str or bytes
        Everything else that decides the machine code.

    Raises
    ------
    OSError
        Where the compiler is gone.
    """
    # A compiler's version is read from its file: `cc --version` would cost more than the loading.
    binary = os.path.realpath(compiler)
    stat = os.stat(binary)
    hashed = hashlib.blake2b(digest_size=16)
    identity = (binary, str(stat.st_size), str(stat.st_mtime_ns), _processor())
    for part in (*parts, *identity):
        data = part.encode() if isinstance(part, str) else part
        hashed.update(b"%d:" % len(data))
        hashed.update(data)
    return cache_folder() / hashed.hexdigest()


def load_kept(folder: Path) -> ctypes.CDLL | None:
    """The shared object of an entry, or None where there is no good one."""
    for _ in range(LOOKS):
        moved = False
        for file in _files(folder):
            try:
                return _load(file)
            except FileNotFoundError:  # another process gave it the name it is to have
                moved = True
            except OSError as failure:
                log.warning("%s cannot be used and is built again: %s", file, failure)
                remove(file)
        if not moved:
            break
    return None


def _load(file: Path) -> ctypes.CDLL:
    content = file.read_bytes()
    digest = hashlib.blake2b(content, digest_size=16).hexdigest()
    fresh = file.suffix == FRESH
    if not (_whole(content) if fresh else file.stem.rpartition("-")[2] == digest):
        raise OSError("it is damaged")
    if fresh:
        named = file.with_name(f"{file.name.partition('.')[0]}-{digest}.so")
        try:
            os.replace(file, named)
            file = named
        except PermissionError:  # a folder that others fill is read all the same
            pass
    return ctypes.CDLL(str(file))


def remove(file: Path) -> None:
    """Remove a file, where it is there and that is allowed."""
    try:
        file.unlink(missing_ok=True)
    except OSError as failure:
        log.debug("%s stays: %s", file, failure)


def _files(folder: Path) -> list[Path]:
    """Candidates in an entry, those with their content in their names first."""
    try:
        names = os.listdir(folder)
    except OSError:
        return []
    ordered = sorted(n for n in names if n.endswith(".so"))
    ordered += sorted(n for n in names if n.endswith(FRESH))
    return [folder / name for name in ordered]


def _whole(content: bytes) -> bool:
    """Whether a file reaches as far as its own header says, where that header is ELF's of 64 bits."""
    if content[:4] != b"\x7fELF":
        return content[:4] in (b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe")  # Mach-O, plain and fat
    if len(content) < 64 or content[4] != 2:
        return len(content) > 64
    order = "<" if content[5] == 1 else ">"
    (sections,) = struct.unpack_from(order + "Q", content, 40)
    size, count = struct.unpack_from(order + "HH", content, 58)
    return len(content) >= sections + size * count


@functools.cache
def _processor() -> str:
    """What -march=native looks at."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            first = file.read(8192).split("\n\n")[0].splitlines()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"
    wanted = ("model name", "flags", "Features", "CPU part", "isa")
    return platform.machine() + "".join(line for line in first if line.startswith(wanted))
