"""Which engines and browsers are installed; a missing one skips the test by name, or fails where required."""

from __future__ import annotations

import importlib.util
import os
import shutil
from collections.abc import Callable
from typing import NamedTuple

import pytest

REQUIRE = "HALFARROW_REQUIRE_ENGINES"


class Engine(NamedTuple):
    """How to see whether an engine is installed, and how to install it."""

    found: Callable[[], object]
    remedy: str


# Under whichever of these names a system has its Chromium.
BROWSERS = ("chromium", "chromium-browser", "google-chrome")

ENGINES = {
    "ngspice": Engine(lambda: shutil.which("ngspice"), "apt-get install ngspice"),
    "mujoco": Engine(lambda: importlib.util.find_spec("mujoco"), "pip install mujoco"),
    "playwright": Engine(lambda: importlib.util.find_spec("playwright"), "pip install playwright"),
    "chromium": Engine(
        lambda: next(filter(None, map(shutil.which, BROWSERS)), None), "apt-get install chromium"
    ),
}


def need(name: str) -> None:
    """Go on where the engine is installed; otherwise skip the test, or fail it where required."""
    if ENGINES[name].found():
        return
    message = f"{name} is not installed: {ENGINES[name].remedy}"
    if os.environ.get(REQUIRE) == "1":
        pytest.fail(f"{message} ({REQUIRE}=1 allows no skip)", pytrace=False)
    pytest.skip(message)
