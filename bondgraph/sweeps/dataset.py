"""The result of a sweep as an xarray Dataset, and on disk as netCDF."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import SweepError
from ..simulation import CompiledModel
from .block import CODES, FINISHED, OUTCOMES, QUANTITY_FAILED, Block
from .job import Job, unit_at
from .points import Points
from .quantities import Quantity
from .store import make

if TYPE_CHECKING:
    import xarray

Array = numpy.ndarray


def needed() -> Any:
    """Return xarray, or raise by name where it is missing."""
    try:
        return importlib.import_module("xarray")
    except ImportError:
        raise SweepError(
            "sweeps give xarray Datasets, and xarray is not installed; pip install 'halfarrow[data]'"
        ) from None


def to_dataset(
    model: CompiledModel, job: Job, points: Points, blocks: Sequence[Block]
) -> xarray.Dataset:
    """Put the blocks of all points together.

    Parameters
    ----------
    model : CompiledModel
    job : Job
    points : Points
    blocks : sequence of Block
        In the order of the points.

    Returns
    -------
    xarray.Dataset
        Without what differs from run to run; see `timed`.
    """
    outcome = numpy.concatenate([block.outcome for block in blocks])
    messages = numpy.array([text for block in blocks for text in block.messages], dtype=object)
    values = _values(blocks, outcome, messages, _scalar_names(job))
    dims, shape = points.dims, points.shape
    variables: dict[str, Any] = {
        name: (
            (*dims, *_inner(name, column)),
            column.reshape(*shape, *column.shape[1:]),
            _attributes(model, job, name),
        )
        for name, column in values.items()
    }
    flags = {
        "flag_values": numpy.arange(len(OUTCOMES), dtype=numpy.int8),
        "flag_meanings": " ".join(_word(name) for name in OUTCOMES),
        "long_name": "how the run ended",
    }
    t_end = numpy.concatenate([block.t_end for block in blocks])
    variables["outcome"] = (dims, outcome.reshape(shape), flags)
    variables["t_end"] = (
        dims,
        t_end.reshape(shape),
        {"units": "s", "long_name": "last good time"},
    )
    variables["message"] = (dims, messages.reshape(shape), {"long_name": "why there are no values"})
    return needed().Dataset(variables, _coordinates(model, points), _about(model, job))


def timed(dataset: xarray.Dataset, points: Points, blocks: Sequence[Block]) -> xarray.Dataset:
    """Return the dataset with the seconds that each point took."""
    seconds = numpy.concatenate([block.seconds for block in blocks]).reshape(points.shape)
    attributes = {"units": "s", "long_name": "wall seconds of the point"}
    return dataset.assign(seconds=(points.dims, seconds, attributes))


def outcomes(dataset: xarray.Dataset) -> Array:
    """Return the outcome of each point as text, in the shape of the sweep.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of `sweep`, or read again from its file.

    Returns
    -------
    array of str

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> from bondgraph.sweeps import grid, sweep
    >>> found = sweep(mass_on_belt.graph(), grid(m=[1, -1]), "final:v", t_span=0.1)
    >>> outcomes(found).tolist()
    ['finished', 'refused']
    """
    names = numpy.array([word.replace("_", " ") for word in dataset.outcome.flag_meanings.split()])
    codes = numpy.asarray(dataset.outcome.values, dtype=int)
    return names[codes]


def save(dataset: xarray.Dataset, path: Path) -> None:
    """Write a dataset as netCDF; the file is there whole or not at all.

    Raises
    ------
    SweepError
        Where it cannot be written.
    """
    try:
        make(path, dataset.to_netcdf)
    except (ValueError, ImportError) as error:  # no library for netCDF
        raise SweepError(f"{path}: {error}; pip install 'halfarrow[data]'") from None


def _word(outcome: str) -> str:
    return outcome.replace(" ", "_")


def _scalar_names(job: Job) -> list[str]:
    """Return the names that are there even where no point has a value."""
    return [item.name for item in job.quantities if isinstance(item.what, Quantity)]


def _values(
    blocks: Sequence[Block], outcome: Array, messages: Array, scalars: Sequence[str]
) -> dict[str, Array]:
    """Return a full array of each name, NaN where a point has none.

    A name has the shape it has at the first point; a point that differs has failed.
    """
    total = len(outcome)
    found: dict[str, list[tuple[Array, Array]]] = {name: [] for name in scalars}
    start = 0
    for block in blocks:
        for piece in block.pieces:
            found.setdefault(piece.name, []).append((piece.rows + start, piece.values))
        start += len(block)
    shapes = {name: _first_shape(parts) for name, parts in found.items()}
    for name, parts in found.items():
        for rows, values in parts:
            if values.shape[1:] != shapes[name]:
                outcome[rows] = CODES[QUANTITY_FAILED]
                messages[rows] = (
                    f"{name} has shape {values.shape[1:]} here and {shapes[name]} at the first point"
                )
    full = {name: numpy.full((total, *shape), numpy.nan) for name, shape in shapes.items()}
    for name, parts in found.items():
        for rows, values in parts:
            good = outcome[rows] == FINISHED
            if values.shape[1:] == shapes[name]:
                full[name][rows[good]] = values[good]
    return full


def _first_shape(parts: Sequence[tuple[Array, Array]]) -> tuple[int, ...]:
    with_rows = [(int(rows.min()), values.shape[1:]) for rows, values in parts if len(rows)]
    return min(with_rows, default=(0, ()))[1]


def _inner(name: str, column: Array) -> list[str]:
    return [f"{name} axis {i}" for i in range(column.ndim - 1)]


def _attributes(model: CompiledModel, job: Job, name: str) -> dict[str, str]:
    for item in job.quantities:
        if item.name == name and isinstance(item.what, Quantity):
            return {"units": item.what.unit(model), "long_name": item.what.label}
    return {"long_name": name}


def _coordinates(model: CompiledModel, points: Points) -> Mapping[str, Any]:
    given = points.axes or points.columns
    table = {symbol.name: row for symbol, row in model.equations.graph.parameters.items()}
    found = {}
    for name, column in given.items():
        meaning = table[name].meaning if name in table else ""
        attributes = {"units": unit_at(model, points, name), "long_name": meaning or name}
        found[name] = (name if points.axes else "point", column, attributes)
    return found


def _about(model: CompiledModel, job: Job) -> dict[str, Any]:
    from .. import __version__

    return {
        "model": model.equations.name,
        "t_start": job.t_span[0],
        "t_stop": job.t_span[1],
        "rtol": job.options["rtol"],
        "halfarrow": __version__,
    }
