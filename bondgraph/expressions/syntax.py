"""From text to a syntax tree, and where in the text a part of it stands."""

from __future__ import annotations

import ast
import keyword
import re
import warnings
from collections.abc import Iterable, Iterator
from typing import NoReturn

from ..errors import LawError
from .language import ALLOWED, HINTS


class Source:
    """The text of one expression: gives its tree, and errors with their column."""

    def __init__(self, text: str, names: Iterable[str]) -> None:
        self.text = re.sub(r"\s", " ", text)
        self.margin = len(self.text) - len(self.text.lstrip())
        self.names = names

    def tree(self) -> ast.expr:
        """Return the syntax tree; nothing in it is checked yet."""
        unquoted = re.sub(r"'[^']*'|\"[^\"]*\"", lambda found: "q" * len(found[0]), self.text)
        if odd := re.search(r"[#\\;`]", unquoted):
            self.fail(odd.start(), f"{odd[0]!r} has no meaning here; {ALLOWED}")
        if not self.text.strip():
            self.fail(0, "the expression is empty; write a number or a formula")
        try:
            with warnings.catch_warnings():  # of numbers that run into words: refused or harmless
                warnings.simplefilter("ignore")
                return ast.parse(self.text.strip(), mode="eval").body
        except SyntaxError as error:
            column = min(self.margin + max((error.offset or 1) - 1, 0), len(self.text) - 1)
            self.fail(column, f"this is no formula ({error.msg}); {self._syntax_hint(unquoted)}")
        except ValueError:
            self.fail(0, "it holds a character that cannot be read; use plain letters")
        except (MemoryError, RecursionError):
            self.fail(0, "it is nested too deep or too long; split it")

    def _syntax_hint(self, unquoted: str) -> str:
        for word in re.findall(r"\w+", unquoted):
            names = [name for name in self.names if word in name.split(".")]
            if keyword.iskeyword(word) and names:
                return f"{word!r} is a word of the grammar: write {names[0]!r} with the quotes"
        return ALLOWED

    def _column(self, node: ast.AST) -> int:
        """Return where a node starts; the tree counts bytes of the stripped text."""
        ahead = self.text.strip().encode()[: getattr(node, "col_offset", 0)]
        return self.margin + len(ahead.decode())

    def fail(self, place: int | ast.AST, problem: str) -> NoReturn:
        """Raise, with the column and the text around it."""
        column = place if isinstance(place, int) else self._column(place)
        start = max(0, column - 40)
        shown = self.text[start : start + 80]
        shown = "..." * (start > 0) + shown + "..." * (start + 80 < len(self.text))
        raise LawError(f"column {column + 1} of {shown!r}: {problem}")

    def refuse(self, node: ast.AST, what: ast.AST) -> NoReturn:
        """Raise because the grammar has this and expressions do not."""
        kind = type(what).__name__
        shown = repr(what.value) if isinstance(what, ast.Constant) else kind
        self.fail(node, f"this ({shown}) is not allowed; {HINTS.get(kind, ALLOWED)}")


def flat(
    node: ast.expr, direct: type, inverse: type, minus: type | None
) -> Iterator[tuple[int, ast.expr]]:
    """Iterate over the terms of a sum, or the factors of a product, in the order written."""
    waiting = [(1, node)]
    while waiting:
        sign, part = waiting.pop()
        if isinstance(part, ast.BinOp) and isinstance(part.op, direct | inverse):
            waiting.append((sign if isinstance(part.op, direct) else -sign, part.right))
            waiting.append((sign, part.left))
        elif isinstance(part, ast.UnaryOp) and isinstance(part.op, ast.UAdd):
            waiting.append((sign, part.operand))
        elif minus and isinstance(part, ast.UnaryOp) and isinstance(part.op, minus):
            waiting.append((-sign, part.operand))
        else:
            yield sign, part
