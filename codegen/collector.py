"""The garbage collector, held back while a stage builds what stays."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def held_back() -> Iterator[None]:
    """Build many values without the search for cycles among them.

    Python looks through everything alive again and again while the number of objects grows, which
    takes half the time of deriving a large graph and finds nothing: stages make trees. What is
    no longer used is freed as always. Serves as a decorator too.

    Examples
    --------
    >>> with held_back():
    ...     gc.isenabled()
    False
    >>> gc.isenabled()
    True
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:  # not by a stage within another, nor where the caller wants none
            gc.enable()
