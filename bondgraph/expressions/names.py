"""How names are spelled: plain, dotted, or in quotes."""

from __future__ import annotations

import ast
import keyword
import re
import unicodedata

from ..errors import LawError


def dotted(node: ast.expr) -> str | None:
    """Return a name such as ``rear.mass.f``; quoted text is a name too."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if isinstance(node, ast.Name):
        parts.append(node.id)
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        parts.append(node.value)
    else:
        return None
    return ".".join(reversed(parts))


def normal(name: str) -> str:
    """Return a name in the normal form that Python's grammar gives it."""
    return unicodedata.normalize("NFKC", name)


def quoted(name: str) -> str:
    """Return a name as the expression language writes it."""
    plain = all(part.isidentifier() and not keyword.iskeyword(part) for part in name.split("."))
    if plain and normal(name) == name:
        return name
    mark = '"' if "'" in name else "'"
    if mark in name or "\\" in name or re.search(r"[^\S ]", name) or name != name.strip():
        raise LawError(
            f"the name {name!r} cannot be written in an expression; give it a plainer one"
        )
    return f"{mark}{name}{mark}"
