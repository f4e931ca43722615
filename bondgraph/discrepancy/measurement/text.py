"""Files as rows of cells: encoding, comments, the delimiter; what is unclear is refused by name."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy

from ...errors import MeasurementError

DELIMITERS = {",": "commas", ";": "semicolons", "\t": "tabs"}
_BINARY = {b"PK\x03\x04": "a spreadsheet or archive", b"\x89HDF": "HDF5", b"CDF": "netCDF"}


@dataclass(frozen=True, eq=False)
class Rows:
    """Cells of a file.

    Attributes
    ----------
    path : Path
    header : tuple of str
    lines : list of int
        Where each row stands in the file, counted from one.
    cells : list of list of str
        As text, one list a row, all as long as the header; none where there is a table.
    table : (nt, columns) array or None
        The same where all cells are plain numbers or empty; NaN marks the empty ones.
    """

    path: Path
    header: tuple[str, ...]
    lines: list[int]
    cells: list[list[str]]
    table: numpy.ndarray | None = None


def rows_of(path: str | Path, as_text: bool = False) -> Rows:
    """Split a file into a header and rows.

    Parameters
    ----------
    path : str or Path
        UTF-8, with or without a byte order mark; any line endings. ``#`` begins a comment line.
        What separates cells (``,``, ``;`` or tab) is read off the header.
    as_text : bool
        Leave cells text, even where all are numbers.

    Returns
    -------
    Rows

    Raises
    ------
    MeasurementError
        For what is no readable text, an unclear delimiter, ragged rows; with the line.
    """
    path = Path(path)
    text = _text(path).replace("\r\n", "\n").replace("\r", "\n")
    numbered = [
        (number, line)
        for number, line in enumerate(text.split("\n"), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not numbered:
        what = "is empty" if not text.strip() else "holds comments only"
        raise MeasurementError(f"{path}: the file {what}; it needs {_EXAMPLE}")
    (place, first), body = numbered[0], numbered[1:]
    delimiter = _delimiter(path, place, first)
    header = tuple(cell.strip() for cell in _cells(path, place, first, delimiter))
    if all(_is_number(cell) for cell in header if cell):
        raise MeasurementError(
            f"{path}, line {place}: the file begins with numbers where a header is wanted; it needs {_EXAMPLE}"
        )
    if not body:
        raise MeasurementError(f"{path}: no rows below the header")
    lines = [number for number, _ in body]
    plain = [line for _, line in body]
    table = None if as_text else _table(plain, delimiter, len(header))
    if table is not None:
        return Rows(path, header, lines, [], table)
    if '"' in text:
        cells = [_cells(path, number, line, delimiter) for number, line in body]
    else:
        cells = [line.split(delimiter) for _, line in body]
    for number, row in zip(lines, cells, strict=True):
        if len(row) != len(header):
            raise MeasurementError(_ragged(path, number, row, len(header), delimiter))
    return Rows(path, header, lines, cells)


_EXAMPLE = "a header such as 'time [s],x [m],v [m/s]' and rows of numbers"


def _text(path: Path) -> str:
    try:
        raw = path.read_bytes()
    except IsADirectoryError:
        raise MeasurementError(
            f"{path}: is a folder; read_all reads the recordings of one"
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise MeasurementError(f"{path}: cannot be read: {reason}") from None
    for magic, kind in _BINARY.items():
        if raw.startswith(magic):
            raise MeasurementError(f"{path}: is {kind}, not text; export it as CSV")
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise MeasurementError(f"{path}: is UTF-16; save it as UTF-8")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise MeasurementError(
            f"{path}, line {line}: byte 0x{raw[error.start]:02x} is not UTF-8; save the file as UTF-8"
        ) from None
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise MeasurementError(f"{path}, line {line}: a zero byte; the file is not text")
    return text


def _table(lines: list[str], delimiter: str, wide: int) -> numpy.ndarray | None:
    """Read rows that hold plain numbers and gaps only, in one go; None for any other."""
    text = "\n".join(lines)
    if text.encode().translate(None, b"0123456789+-.eE\n " + delimiter.encode()):
        return None
    for _ in range(2):  # every other one of a row of gaps, then the rest
        text = text.replace(delimiter * 2, f"{delimiter}nan{delimiter}")
    text = f"\n{text}\n".replace(f"\n{delimiter}", f"\nnan{delimiter}")
    text = text.replace(f"{delimiter}\n", f"{delimiter}nan\n")
    try:
        found = numpy.loadtxt(
            text[1:-1].split("\n"), delimiter=delimiter, ndmin=2, comments=None, dtype=float
        )
    except ValueError:
        return None
    good = found.shape == (len(lines), wide) and not numpy.isinf(found).any()
    return found if good else None


def _delimiter(path: Path, number: int, header: str) -> str:
    """Return the only delimiter outside quotes and units; a comma for a lone column."""
    bare = re.sub(r'"[^"]*"|\[[^\]]*\]', "", header)
    found = [mark for mark in DELIMITERS if mark in bare]
    if len(found) > 1:
        kinds = " and ".join(DELIMITERS[mark] for mark in found)
        raise MeasurementError(
            f"{path}, line {number}: the header holds {kinds}; which of them separates columns is "
            "not clear: put names that hold one in double quotes"
        )
    return found[0] if found else ","


def _cells(path: Path, number: int, line: str, delimiter: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=delimiter, strict=True, skipinitialspace=True))
    except csv.Error as error:
        raise MeasurementError(f"{path}, line {number}: {error}; mend the quotes") from None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _ragged(path: Path, number: int, row: list[str], wide: int, delimiter: str) -> str:
    found = f"{len(row)} cell{'s' * (len(row) != 1)} where the header has {wide}"
    others = [mark for mark in DELIMITERS if mark != delimiter and mark in row[0]]
    if others:
        found += f"; the header is separated by {DELIMITERS[delimiter]}, the row by {DELIMITERS[others[0]]}"
    elif delimiter == "," and len(row) > wide:
        found += "; a comma is no decimal point here: write 1.5"
    else:
        found += "; a gap is an empty cell"
    return f"{path}, line {number}: {found}"
