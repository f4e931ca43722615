"""Equality of datasets, to the bit."""

from __future__ import annotations

import numpy as np


def contents(dataset):
    """All that a sweep found, as bytes: values and coordinates, with their names and shapes."""
    return {
        name: (column.dims, column.shape, _bytes(column.values), str(column.attrs.get("units")))
        for name, column in {**dataset.data_vars, **dataset.coords}.items()
        if name != "seconds"
    }


def _bytes(values):
    if values.dtype.kind in "OUT":
        return [str(value) for value in values.ravel()]
    return values.dtype.str, np.ascontiguousarray(values).tobytes()


def assert_same(one, other):
    a, b = contents(one), contents(other)
    assert list(a) == list(b)
    for name in a:
        assert a[name] == b[name], name
