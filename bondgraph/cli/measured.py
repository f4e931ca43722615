"""Words of the command line about measured data: which column is what, and its hold."""

from __future__ import annotations

import click


def read_map(words: tuple[str, ...]) -> dict[str, str]:
    """Read MODEL=COLUMN words of ``--map``.

    Parameters
    ----------
    words : tuple of str

    Returns
    -------
    dict of str to str
        As ``rename`` of `Measurement.read` takes it.

    Raises
    ------
    click.UsageError

    Examples
    --------
    >>> read_map(("v=speed", "F=force=left"))
    {'v': 'speed', 'F': 'force=left'}
    """
    return _pairs(words, "--map", "MODEL=COLUMN")


def read_holds(words: tuple[str, ...]) -> dict[str, str]:
    """Read NAME=HOLD words of ``--hold``.

    Parameters
    ----------
    words : tuple of str

    Returns
    -------
    dict of str to str
        As ``holds`` of `Measurement.read` takes it.

    Raises
    ------
    click.UsageError

    Examples
    --------
    >>> read_holds(("F=zero",))
    {'F': 'zero'}
    """
    from bondgraph.simulation.inputs import HOLDS

    holds = _pairs(words, "--hold", "NAME=HOLD")
    for name, hold in holds.items():
        if hold not in HOLDS:
            raise click.UsageError(
                f"--hold {name}: {hold!r} is not known; HOLD is one of {', '.join(HOLDS)}"
            )
    return holds


def _pairs(words: tuple[str, ...], option: str, form: str) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for word in words:
        name, _, value = (part.strip() for part in word.partition("="))
        if not name or not value:
            raise click.UsageError(f"{option} {word!r}: write {form}")
        if name in pairs:
            raise click.UsageError(f"{option} {name!r} is given twice")
        pairs[name] = value
    return pairs
