"""Quiet: what SUNDIALS says on the standard error stream is collected, not printed.

CasADi hands these messages to ``sys.stderr`` of Python, whatever its options say.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TextIO


class _Ear:
    """A stream that keeps what listening threads write, and passes on what others do."""

    def __init__(self, behind: TextIO) -> None:
        self._behind = behind
        self.heard: dict[int, list[str]] = {}

    def write(self, text: str) -> int:
        kept = self.heard.get(threading.get_ident())
        if kept is None:
            return self._behind.write(text)
        kept.append(text)
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._behind, name)


_lock = threading.Lock()


@contextmanager
def quiet() -> Iterator[list[str]]:
    """Collect what this thread writes to the standard error stream.

    Other threads print as before. The stream is put back when the last thread
    stops listening.

    Yields
    ------
    list of str

    Examples
    --------
    >>> with quiet() as heard:
    ...     print("mxstep steps taken", file=sys.stderr)
    >>> heard[0]
    'mxstep steps taken'
    """
    me = threading.get_ident()
    with _lock:
        ear = sys.stderr if isinstance(sys.stderr, _Ear) else _Ear(sys.stderr)
        heard = ear.heard.setdefault(me, [])
        sys.stderr = ear
    try:
        yield heard
    finally:
        with _lock:
            ear.heard.pop(me, None)
            if not ear.heard and sys.stderr is ear:
                sys.stderr = ear._behind
