"""TOML itself: text to tables, and values to text."""

from __future__ import annotations

import json
import re
import tomllib
from typing import Any

from ..errors import ModelError


def tables(text: str) -> dict[str, Any]:
    """Return what a TOML text holds."""
    # tomllib's time grows with the square of a key's parts.
    unquoted = re.sub(r'"(?:[^"\\\n]|\\.)*+"?|\'[^\'\n]*+\'?', "q", text)
    if re.search(r"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+){50}", unquoted):
        raise ModelError("a key has more than 50 parts; put names with dots in quotes")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ModelError(f"no valid TOML: {error}; correct it there") from None
    except RecursionError:
        raise ModelError("its TOML is nested too deep; model files have two levels") from None


def toml(value: Any) -> str:
    """Return a value on one line."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return (
            f"{{ {', '.join(f'{toml_key(key)} = {toml(item)}' for key, item in value.items())} }}"
        )
    if isinstance(value, list):
        return f"[{', '.join(map(toml, value))}]"
    return repr(value)


def toml_key(name: str) -> str:
    """Return a key, in quotes where it needs them."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else toml(name)
