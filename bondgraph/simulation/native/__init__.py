"""Runs as compiled C.

`compiler` writes the source of a mode (CasADi's functions within ``kernel.c``) and of the integrator
(``driver.c``, and ``batch.c`` for many runs in one call); `builds` lets compilers work behind, and
`cache` keeps what they make on disk. `run` lays out the memory of one run and serves what the
driver asks for.
"""

from .builds import Build, CompileError
from .compiler import (
    NativeMode,
    Wanted,
    driver_wanted,
    find_compiler,
    load_driver,
    load_mode,
    load_shared,
    mode_wanted,
)

__all__ = [
    "Build",
    "CompileError",
    "NativeMode",
    "Wanted",
    "driver_wanted",
    "find_compiler",
    "load_driver",
    "load_mode",
    "load_shared",
    "mode_wanted",
]
