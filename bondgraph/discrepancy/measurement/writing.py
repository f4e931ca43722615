"""Recordings as CSV files that `Measurement.read` reads back to the bit."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

from ...errors import MeasurementError
from .value import Measurement


def write(measurement: Measurement, path: str | Path) -> Path:
    """Write a recording as CSV; see `Measurement.write`."""
    path, text = Path(path), io.StringIO()
    text.write(f"# {' '.join(measurement.name.split())}\n")
    header = ["time [s]", *(_label(measurement, name) for name in measurement.columns)]
    # quoted, a name may hold what could pass for a delimiter
    odd = any(set(',;\t"') & set(label) for label in header)
    quoting = csv.QUOTE_ALL if odd else csv.QUOTE_MINIMAL
    csv.writer(text, lineterminator="\n", quoting=quoting).writerow(header)
    rows = csv.writer(text, lineterminator="\n")
    columns = [column.tolist() for column in measurement.columns.values()]
    for t, *row in zip(measurement.t.tolist(), *columns, strict=True):
        rows.writerow([repr(t), *("" if math.isnan(value) else repr(value) for value in row)])
    try:
        path.write_text(text.getvalue(), encoding="utf-8", newline="")
    except OSError as error:
        raise MeasurementError(f"cannot write {path}: {error.strerror or error}") from None
    return path


def _label(measurement: Measurement, name: str) -> str:
    if set("[]\r\n\0") & set(name) or not name.strip() or name != name.strip() or name == "time":
        raise MeasurementError(
            f"{measurement.name}: column {name!r} cannot be written: a name has no brackets or line "
            "ends, no space at its ends, and is not 'time'"
        )
    return f"{name} [{measurement.units[name]}]" if name in measurement.units else name
