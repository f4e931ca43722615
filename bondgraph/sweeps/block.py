"""The results of a run of consecutive points, and how they are written as bytes."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy

from ..simulation import Outcome

Array = numpy.ndarray

# How a point may end beside the outcomes of a run.
REFUSED, QUANTITY_FAILED = "refused", "quantity failed"
WORKER_DIED, ERROR = "worker died", "error"
OUTCOMES = (
    *(outcome.value for outcome in Outcome),
    REFUSED,
    QUANTITY_FAILED,
    WORKER_DIED,
    ERROR,
)
CODES = {name: code for code, name in enumerate(OUTCOMES)}
FINISHED = CODES[Outcome.FINISHED.value]


@dataclass(frozen=True, eq=False)
class Piece:
    """Values of one name that have one shape, and the points they belong to.

    Attributes
    ----------
    name : str
    rows : (k,) array of int
        Counted from the block's first point.
    values : (k, ...) array
    """

    name: str
    rows: Array
    values: Array


@dataclass(frozen=True, eq=False)
class Block:
    """Results of consecutive points.

    Attributes
    ----------
    outcome : (n,) array of int8
        Codes; see `OUTCOMES`.
    t_end : (n,) array, s
        Last good time; NaN where the run did not begin.
    messages : tuple of str
        Why a point has no values; empty where it has.
    pieces : tuple of Piece
    seconds : (n,) array
        What the points took; of a batch, its mean.
    """

    outcome: Array
    t_end: Array
    messages: tuple[str, ...]
    pieces: tuple[Piece, ...]
    seconds: Array

    def __len__(self) -> int:
        return len(self.outcome)

    @property
    def failed(self) -> int:
        """How many points have no values."""
        return int((self.outcome != FINISHED).sum())


def failed(outcome: str, message: str, count: int = 1) -> Block:
    """Return the block of points of which nothing is known but why.

    Examples
    --------
    >>> failed(WORKER_DIED, "at this point").failed
    1
    """
    nothing = numpy.full(count, numpy.nan)
    codes = numpy.full(count, CODES[outcome], dtype=numpy.int8)
    return Block(codes, nothing, (message,) * count, (), numpy.zeros(count))


def joined(blocks: Sequence[Block]) -> Block:
    """Return one block of several that follow each other.

    Examples
    --------
    >>> len(joined([failed(ERROR, "a"), failed(ERROR, "b", 2)]))
    3
    """
    starts = numpy.cumsum([0, *(len(block) for block in blocks)])
    found: dict[tuple[str, tuple[int, ...]], list[tuple[Array, Array]]] = {}
    for start, block in zip(starts, blocks, strict=False):
        for piece in block.pieces:
            key = piece.name, piece.values.shape[1:]
            found.setdefault(key, []).append((piece.rows + start, piece.values))
    return Block(
        numpy.concatenate([block.outcome for block in blocks]),
        numpy.concatenate([block.t_end for block in blocks]),
        tuple(message for block in blocks for message in block.messages),
        tuple(_one_piece(name, parts) for (name, _), parts in found.items()),
        numpy.concatenate([block.seconds for block in blocks]),
    )


def _one_piece(name: str, parts: list[tuple[Array, Array]]) -> Piece:
    rows, values = zip(*parts, strict=True)
    return Piece(name, numpy.concatenate(rows), numpy.concatenate(values))


def to_bytes(block: Block) -> bytes:
    """Write a block; the same block gives the same bytes.

    Examples
    --------
    >>> from_bytes(to_bytes(failed(REFUSED, "no mass"))).messages
    ('no mass',)
    """
    told = {"messages": block.messages, "names": [piece.name for piece in block.pieces]}
    text = numpy.frombuffer(json.dumps(told).encode(), dtype=numpy.uint8)
    arrays: dict[str, Any] = {f"rows{i}": piece.rows for i, piece in enumerate(block.pieces)}
    arrays |= {f"values{i}": piece.values for i, piece in enumerate(block.pieces)}
    buffer = io.BytesIO()
    numpy.savez(
        buffer,
        outcome=block.outcome,
        t_end=block.t_end,
        seconds=block.seconds,
        text=text,
        **arrays,
    )
    return buffer.getvalue()


def from_bytes(data: bytes) -> Block:
    """Read a block; ValueError where the bytes are none."""
    try:
        with numpy.load(io.BytesIO(data), allow_pickle=False) as arrays:
            told = json.loads(arrays["text"].tobytes())
            return Block(
                arrays["outcome"],
                arrays["t_end"],
                tuple(told["messages"]),
                tuple(_pieces(told["names"], arrays)),
                arrays["seconds"],
            )
    except (KeyError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise ValueError(f"no block: {error}") from None


def _pieces(names: Sequence[str], arrays: Any) -> Iterator[Piece]:
    for i, name in enumerate(names):
        yield Piece(name, arrays[f"rows{i}"], arrays[f"values{i}"])
