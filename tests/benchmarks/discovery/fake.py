"""Solvers that know nothing, for tests of the runner."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path
from typing import Any


def silent(folder: Path) -> dict[str, Any]:
    """Say that nothing is missing, and what was seen."""
    seen = sorted(path.name for path in folder.iterdir())
    model = json.loads((folder / "case.json").read_text(encoding="utf-8"))["model"]
    return {"verdict": "none", "effects": [], "gap": {}, "seen": seen, "model": model}


def broken(folder: Path) -> dict[str, Any]:
    """Raise."""
    raise ValueError(f"cannot read {folder.name}")


def dies(folder: Path) -> dict[str, Any]:
    """End the process."""
    os._exit(3)


def sleeps(folder: Path) -> dict[str, Any]:
    """Take too long."""
    time.sleep(600)
    return {}
