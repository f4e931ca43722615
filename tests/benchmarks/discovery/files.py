"""Cases as folders, and their truths as one sealed file beside them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from .make import Made, Record

SEALED = "sealed.json"


def write(cases: Iterable[Made], folder: Path) -> list[Path]:
    """Write ``cases/<id>/`` and the add to the sealed file of a folder; return the cases' folders.

    Parameters
    ----------
    cases : iterable of Made
    folder : Path
    """
    folder.mkdir(parents=True, exist_ok=True)
    sealed = unsealed(folder) if (folder / SEALED).exists() else []
    paths = []
    for case in cases:
        path = folder / "cases" / case.id
        path.mkdir(parents=True, exist_ok=True)
        (path / "case.json").write_text(json.dumps(case.open) + "\n", encoding="utf-8")
        for label, record in case.records.items():
            (path / f"{label}.csv").write_text(csv(record), encoding="utf-8")
        sealed.append(case.sealed)
        paths.append(path)
        # after each case, so that what was made stays when this is cut short
        (folder / SEALED).write_text(json.dumps(sealed, indent=1) + "\n", encoding="utf-8")
    return paths


def unsealed(folder: Path) -> list[dict[str, Any]]:
    """Read the truths of a folder."""
    found: list[dict[str, Any]] = json.loads((folder / SEALED).read_text(encoding="utf-8"))
    return found


def csv(record: Record) -> str:
    """Return a recording as text: a header with units, an empty cell for a gap."""
    lines = [",".join(["time [s]", *record.columns])]
    columns = [column.tolist() for column in record.columns.values()]
    for t, *row in zip(record.t.tolist(), *columns, strict=True):
        lines.append(",".join([f"{t:.9g}", *(_cell(value) for value in row)]))
    return "\n".join(lines) + "\n"


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.9g}"


def answers(path: Path) -> list[dict[str, Any]]:
    """Read answers, one JSON object a line, the last of each id."""
    if not path.exists():
        return []
    rows: Mapping[str, dict[str, Any]] = {
        row["id"]: row for row in map(json.loads, path.read_text(encoding="utf-8").splitlines())
    }
    return list(rows.values())
