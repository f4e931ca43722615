"""What --map and --hold say."""

import click
import pytest

from bondgraph.cli.measured import read_holds, read_map


def test_pairs():
    assert read_map(("F=force", " v = speed [km/h]")) == {"F": "force", "v": "speed [km/h]"}
    assert read_holds(("F=zero", "v=band")) == {"F": "zero", "v": "band"}
    assert read_map(()) == {}


@pytest.mark.parametrize(
    ("read", "words", "message"),
    [
        (read_map, ("F",), "--map 'F': write MODEL=COLUMN"),
        (read_map, ("=force",), "write MODEL=COLUMN"),
        (read_map, ("F=",), "write MODEL=COLUMN"),
        (read_map, ("F=a", "F=b"), "--map 'F' is given twice"),
        (read_holds, ("F",), "--hold 'F': write NAME=HOLD"),
        (read_holds, ("F=cubic",), "'cubic' is not known; HOLD is one of zero, linear, band"),
    ],
)
def test_what_cannot_be_read(read, words, message):
    with pytest.raises(click.UsageError, match=message):
        read(words)
