"""Expressions as text: a whitelist walker from text to sympy, and the way back.

Text is read by Python's grammar and nothing else of Python: each node of the
syntax tree is either in the tables of `language` or refused with its column.
No text is ever evaluated, and a constant is bounded in doubles before sympy
sees it, so that ``9**9**9**9`` is refused at once.

A new function is a row in `language`, beside the constants, comparisons and
hints; how a name is spelled is in `names`. `syntax` turns text into a tree and
places errors in it, `read` walks the tree, `arithmetic` keeps numbers within
their limits, `write` goes back to text, `words` holds what error messages
share.
"""

from .language import CONSTANTS, FUNCTIONS, TIME, Function
from .numbers import as_double
from .read import parse
from .write import to_text

__all__ = ["CONSTANTS", "FUNCTIONS", "TIME", "Function", "as_double", "parse", "to_text"]
