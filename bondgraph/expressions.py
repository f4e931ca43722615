"""Expressions as text: a whitelist walker from text to sympy, and the way back.

Text is read by Python's grammar and nothing else of Python: each node of the
syntax tree is either in the tables below or refused with its column. No text
is ever evaluated, and a constant is bounded in doubles before sympy sees it,
so that ``9**9**9**9`` is refused at once.
"""

from __future__ import annotations

import ast
import difflib
import keyword
import math
import re
import unicodedata
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NoReturn

import sympy
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.str import StrPrinter

from .errors import LawError
from .laws import exact

TIME = sympy.Symbol("t", real=True)  # the same symbol as graph.TIME, which lies above
MAX_LENGTH = 10_000  # characters
MAX_DEPTH = 50  # functions, powers and parentheses within each other
MAX_POWER = 100  # magnitude of a numeric exponent
MAX_BITS = 1200  # of a number's numerator or denominator; every double fits
DOUBLE_BITS = 1023  # of a whole number that is surely below the largest double
MAX_GROWTH = 100_000  # bits that sympy may write out in between
MAX_ROOT_BITS = 256  # under a fractional power, where sympy looks for factors
MAX_CHOICES = 16  # arguments of min and max: sympy compares each with each


@dataclass(frozen=True)
class Function:
    """A function that expressions may call.

    Attributes
    ----------
    build : callable
        Sympy's function; a class if `to_text` shall write it.
    number : callable
        The same in doubles, for constants: raises OverflowError or ValueError
        where there is no finite real result.
    least, most : int
        How many arguments it takes.

    Examples
    --------
    >>> FUNCTIONS["atan2"].most
    2
    """

    build: Callable[..., Any]
    number: Callable[..., float]
    least: int = 1
    most: int = 1


def _sign(x: float) -> float:
    return float((x > 0) - (x < 0))


def _heaviside(x: float, at_zero: float = 0.5) -> float:
    return at_zero if x == 0 else float(x > 0)


FUNCTIONS: Mapping[str, Function] = MappingProxyType(
    {
        "exp": Function(sympy.exp, math.exp),
        "log": Function(sympy.log, math.log),
        "sqrt": Function(sympy.sqrt, math.sqrt),
        "sin": Function(sympy.sin, math.sin),
        "cos": Function(sympy.cos, math.cos),
        "tan": Function(sympy.tan, math.tan),
        "asin": Function(sympy.asin, math.asin),
        "acos": Function(sympy.acos, math.acos),
        "atan": Function(sympy.atan, math.atan),
        "atan2": Function(sympy.atan2, math.atan2, 2, 2),
        "sinh": Function(sympy.sinh, math.sinh),
        "cosh": Function(sympy.cosh, math.cosh),
        "tanh": Function(sympy.tanh, math.tanh),
        "asinh": Function(sympy.asinh, math.asinh),
        "acosh": Function(sympy.acosh, math.acosh),
        "atanh": Function(sympy.atanh, math.atanh),
        "abs": Function(sympy.Abs, abs),
        "sign": Function(sympy.sign, _sign),
        "floor": Function(sympy.floor, math.floor),
        "ceil": Function(sympy.ceiling, math.ceil),
        "erf": Function(sympy.erf, math.erf),
        "heaviside": Function(sympy.Heaviside, _heaviside, 1, 2),
        "min": Function(sympy.Min, min, 1, MAX_CHOICES),
        "max": Function(sympy.Max, max, 1, MAX_CHOICES),
    }
)
CONSTANTS: Mapping[str, sympy.Expr] = MappingProxyType({"pi": sympy.pi, "t": TIME})
COMPARISONS: Mapping[type, type] = MappingProxyType(
    {
        ast.Lt: sympy.StrictLessThan,
        ast.LtE: sympy.LessThan,
        ast.Gt: sympy.StrictGreaterThan,
        ast.GtE: sympy.GreaterThan,
        ast.Eq: sympy.Equality,
        ast.NotEq: sympy.Unequality,
    }
)

# What people write in other languages, and what it is called here.
HINTS: Mapping[str, str] = MappingProxyType(
    {
        "ln": "write log",
        "pow": "write a**b",
        "Abs": "write abs",
        "Max": "write max",
        "Min": "write min",
        "Piecewise": "write where(condition, value, otherwise)",
        "arctan2": "write atan2",
        ast.BitXor.__name__: "a power is written **",
        ast.FloorDiv.__name__: "write floor(a / b)",
        ast.Mod.__name__: "write a - b*floor(a / b)",
        ast.BitAnd.__name__: "in a condition write: and",
        ast.BitOr.__name__: "in a condition write: or",
        ast.IfExp.__name__: "write where(condition, value, otherwise)",
        ast.Compare.__name__: "a comparison stands as the condition of where(...) only",
        ast.BoolOp.__name__: "'and', 'or' stand in the condition of where(...) only",
        ast.Not.__name__: "'not' stands in the condition of where(...) only",
        ast.Attribute.__name__: "a dotted name starts with a name, such as spring.q",
    }
)
ALLOWED = "allowed are numbers, names, + - * / **, parentheses and functions"


def parse(
    text: str, names: Mapping[str, Any], functions: Mapping[str, Function] = FUNCTIONS
) -> sympy.Expr:
    """Read an expression; nothing is evaluated as code.

    Parameters
    ----------
    text : str
        Such as ``"N*(mu + 0.2*exp(-speed/v_s))"``. Numbers are exact: 0.2 is
        1/5. ``where(condition, value, otherwise)`` chooses, also among
        several: ``where(x < 0, 0, x < 1, x, 1)``. A name that is no plain
        word stands in quotes: ``'coulomb friction.e'``.
    names : mapping of str to Expr
        What the names mean, plain or dotted (``rear.mass.f``). They go before
        the constants ``pi`` and ``t`` (time). A name whose value is a str is
        refused with these words.
    functions : mapping of str to Function
        What may be called.

    Returns
    -------
    Expr
        Real, without floats.

    Raises
    ------
    LawError
        In one line: the column, what is wrong, and the remedy.

    Examples
    --------
    >>> k, q = sympy.symbols("k q", real=True)
    >>> parse("0.2*k*spring.q", {"k": k, "spring.q": q})
    k*q/5
    >>> parse("__import__('os')", {})
    Traceback (most recent call last):
    ...
    bondgraph.errors.LawError: column 1 of "__import__('os')": there is no function '__import__'; ...
    """
    if not isinstance(text, str):
        raise LawError(f"expected an expression as text, got {text!r}; write it in quotes")
    if len(text) > MAX_LENGTH:
        raise LawError(
            f"the expression has {len(text)} characters; {MAX_LENGTH} is the limit: split it"
        )
    return _Walker(text, names, functions).read()


def to_text(
    expression: Any, names: Mapping[str, Any], functions: Mapping[str, Function] = FUNCTIONS
) -> str:
    """Write an expression so that `parse` reads it back.

    Parameters
    ----------
    expression : Expr or number
    names : mapping of str to Symbol
        As for `parse`. Where a symbol has several names the first is written.
    functions : mapping of str to Function

    Returns
    -------
    str
        ``parse(to_text(e, names), names) == e``. What sympy evaluates by
        itself when it is built again, such as a factored ``2*(x + y)``, comes
        back in that form.

    Raises
    ------
    LawError
        For functions and symbols that have no name.

    Examples
    --------
    >>> p, c = sympy.symbols("p c", real=True)
    >>> to_text(sympy.Max(p / 3, sympy.sqrt(c)), {"mass.p": p, "c": c})
    'max(sqrt(c), mass.p/3)'
    """
    expression = exact(expression)
    text = str(_Writer(names, functions).doprint(expression))
    if len(text) > MAX_LENGTH:
        raise LawError(f"the expression is too long to write: {len(text)} characters; split it")
    return text


@dataclass(frozen=True)
class _Value:
    """A part that was read; ``number`` is its value in doubles if it is constant."""

    expression: sympy.Expr
    number: float | None


class _Walker:
    """Walks one syntax tree. Sums and products are read flat, as sympy holds them."""

    def __init__(
        self, text: str, names: Mapping[str, Any], functions: Mapping[str, Function]
    ) -> None:
        self.text = re.sub(r"\s", " ", text)
        self.margin = len(self.text) - len(self.text.lstrip())
        self.names = names
        self.functions = functions

    def read(self) -> sympy.Expr:
        try:
            return self._value(self._tree(), 0).expression
        except (TypeError, ValueError, ArithmeticError, RecursionError, MemoryError) as error:
            reason = " ".join(f"{type(error).__name__} {error}".split())[:80]
            self._fail(0, f"it cannot be worked out ({reason}); write it in simpler terms")

    def _tree(self) -> ast.expr:
        unquoted = re.sub(r"'[^']*'|\"[^\"]*\"", lambda found: "q" * len(found[0]), self.text)
        if odd := re.search(r"[#\\;`]", unquoted):
            self._fail(odd.start(), f"{odd[0]!r} has no meaning here; {ALLOWED}")
        if not self.text.strip():
            self._fail(0, "the expression is empty; write a number or a formula")
        try:
            with warnings.catch_warnings():  # of numbers that run into words: refused or harmless
                warnings.simplefilter("ignore")
                return ast.parse(self.text.strip(), mode="eval").body
        except SyntaxError as error:
            column = min(self.margin + max((error.offset or 1) - 1, 0), len(self.text) - 1)
            self._fail(column, f"this is no formula ({error.msg}); {self._syntax_hint(unquoted)}")
        except ValueError:
            self._fail(0, "it holds a character that cannot be read; use plain letters")
        except (MemoryError, RecursionError):
            self._fail(0, "it is nested too deep or too long; split it")

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

    def _fail(self, place: int | ast.AST, problem: str) -> NoReturn:
        column = place if isinstance(place, int) else self._column(place)
        start = max(0, column - 40)
        shown = self.text[start : start + 80]
        shown = "..." * (start > 0) + shown + "..." * (start + 80 < len(self.text))
        raise LawError(f"column {column + 1} of {shown!r}: {problem}")

    def _value(self, node: ast.expr, depth: int) -> _Value:
        if depth > MAX_DEPTH:
            self._fail(node, f"it is nested more than {MAX_DEPTH} deep; split it")
        if isinstance(node, ast.BinOp | ast.UnaryOp):
            return self._operation(node, depth + 1)
        if isinstance(node, ast.Call):
            return self._call(node, depth + 1)
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return self._literal(node)
        name = _dotted(node)
        if name is None:
            self._refuse(node, node)
        return self._named(node, name)

    def _refuse(self, node: ast.AST, what: ast.AST) -> NoReturn:
        kind = type(what).__name__
        shown = repr(what.value) if isinstance(what, ast.Constant) else kind
        self._fail(node, f"this ({shown}) is not allowed; {HINTS.get(kind, ALLOWED)}")

    def _literal(self, node: ast.Constant) -> _Value:
        value: Any = node.value
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            self._fail(node, "the number is too large for a double; write a finite one")
        return _Value(exact(value), number)

    def _named(self, node: ast.AST, name: str) -> _Value:
        found = self.names.get(name, CONSTANTS.get(name))
        if found is None:  # Python's grammar writes some letters in their normal form
            found = next((self.names[key] for key in self.names if _normal(key) == name), None)
        if found is None:
            near = difflib.get_close_matches(name, [*self.names, *CONSTANTS], n=3)
            if name in self.functions or name == "where":
                hint = f"{name} is a function: write {name}(...)"
            elif near:
                hint = f"did you mean {' or '.join(near)}?"
            else:
                known = list(dict.fromkeys([*list(self.names)[:12], *CONSTANTS]))
                hint = f"known: {', '.join(known)}"
            self._fail(node, f"the name {name!r} is not known; {hint}")
        if isinstance(found, str):
            self._fail(node, found)
        return self._made(node, found)

    def _made(self, node: ast.AST, expression: sympy.Expr, number: float | None = None) -> _Value:
        """Check what sympy made of a part."""
        if expression.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
            self._fail(node, "this is not finite (a division by zero?); change the numbers")
        if expression.has(sympy.I):
            self._fail(node, "this is not real; change the numbers")
        for part in (*expression.as_coeff_Mul()[:1], *expression.as_coeff_Add()[:1]):
            if _bits(part) > MAX_BITS:
                self._fail(node, "the exact number is too long; write its value as a decimal")
        if number is None and not expression.free_symbols:
            number = self._bounded(node, lambda: float(expression.evalf(17)))
        if number is None:
            for power in expression.atoms(sympy.Pow):
                if _growth(power.base, power.exp) > MAX_GROWTH:
                    self._fail(node, "a number is raised to too high a power; use exp(...)")
        return _Value(expression, number)

    def _bounded(self, node: ast.AST, work: Callable[[], float]) -> float:
        """Evaluate a constant in doubles."""
        try:
            number = float(work())
        except OverflowError:
            number = math.inf
        except (ValueError, ZeroDivisionError, TypeError):
            self._fail(node, "this has no real value; change the numbers")
        if not math.isfinite(number):
            self._fail(node, "the result is too large for a double; change the numbers")
        return number

    def _operation(self, node: ast.BinOp | ast.UnaryOp, depth: int) -> _Value:
        if isinstance(node.op, ast.Add | ast.Sub):
            return self._sum(node, depth)
        if isinstance(node.op, ast.Mult | ast.Div | ast.USub | ast.UAdd):
            return self._product(node, depth)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            base, exponent = self._value(node.left, depth), self._value(node.right, depth)
            return self._power(node, base, exponent)
        self._refuse(node, node.op)

    def _sum(self, node: ast.expr, depth: int) -> _Value:
        terms = [
            (sign, self._value(term, depth))
            for sign, term in _flat(node, ast.Add, ast.Sub, ast.USub)
        ]
        expression = sympy.Add(*(sign * value.expression for sign, value in terms))
        numbers = [None if value.number is None else sign * value.number for sign, value in terms]
        return self._made(node, expression, self._folded(node, math.fsum, numbers))

    def _product(self, node: ast.expr, depth: int) -> _Value:
        factors = []
        for side, factor in _flat(node, ast.Mult, ast.Div, None):
            if isinstance(factor, ast.UnaryOp) and isinstance(factor.op, ast.USub):
                factors.append(_Value(sympy.S.NegativeOne, -1.0))
                factor = factor.operand
            value = self._value(factor, depth)
            if side < 0:
                value = self._power(factor, value, _Value(sympy.S.NegativeOne, -1.0))
            factors.append(value)
        expression = sympy.Mul(*(value.expression for value in factors))
        number = self._folded(node, math.prod, [value.number for value in factors])
        if number == 0 and expression != 0:
            self._fail(node, "the result is too small for a double; change the numbers")
        return self._made(node, expression, number)

    def _folded(
        self, node: ast.AST, fold: Callable[[list[float]], float], numbers: list[float | None]
    ) -> float | None:
        known = [number for number in numbers if number is not None]
        return self._bounded(node, lambda: fold(known)) if len(known) == len(numbers) else None

    def _power(self, node: ast.AST, base: _Value, exponent: _Value) -> _Value:
        if exponent.number is not None and abs(exponent.number) > MAX_POWER:
            self._fail(
                node, f"the exponent {exponent.number:g} is beyond {MAX_POWER}; use exp(...)"
            )
        if base.number == 0 and exponent.number is not None and exponent.number < 0:
            self._fail(node, "this divides by zero; change the numbers")
        number = None
        if base.number is not None and exponent.number is not None:
            below, above = base.number, exponent.number
            number = self._bounded(node, lambda: math.pow(below, above))
            if number == 0 and below != 0:
                self._fail(node, "the result is too small for a double; change the numbers")
        if exponent.expression != -1:
            self._check_growth(node, base.expression, exponent.expression)
        return self._made(node, base.expression**exponent.expression, number)

    def _check_growth(self, node: ast.AST, base: sympy.Expr, exponent: sympy.Expr) -> None:
        """Refuse powers that sympy would write out as long numbers, or search for factors."""
        for factor in sympy.Mul.make_args(base):
            below, above = factor.as_base_exp()
            if below.is_number and _growth(below, above, exponent) > MAX_GROWTH:
                self._fail(node, "a number is raised to too high a power; use exp(...)")
            plain = not below.is_number and above.is_number and exponent.is_number
            if plain and abs(above * exponent) > MAX_POWER:
                self._fail(node, f"the exponents multiply to more than {MAX_POWER}; use exp(...)")
        if not exponent.is_Integer and _bits(base.as_coeff_Mul()[0]) > MAX_ROOT_BITS:
            self._fail(node, "a root of such a number is costly; write its value as a decimal")

    def _call(self, node: ast.Call, depth: int) -> _Value:
        name = _dotted(node.func)
        if name is None or isinstance(node.func, ast.Constant):
            self._fail(node, "only a function can be called; multiplication is written *")
        function = self.functions.get(name)
        if function is None and name != "where":
            self._fail(node, f"there is no function {name!r}; {self._function_hint(name)}")
        if node.keywords or any(isinstance(item, ast.Starred) for item in node.args):
            self._fail(node, f"{name}: arguments are plain expressions, without names or stars")
        if function is None:
            return self._where(node, depth)
        self._check_count(node, name, function)
        values = [self._value(item, depth) for item in node.args]
        return self._applied(node, function, values)

    def _function_hint(self, name: str) -> str:
        last = name.rpartition(".")[2]
        if last in HINTS:
            return HINTS[last]
        if last in self.functions:
            return f"write {last}"
        if name in self.names:
            return "multiplication is written *"
        near = difflib.get_close_matches(name, [*self.functions, "where"], n=3)
        if near:
            return f"did you mean {' or '.join(near)}?"
        return f"there are {', '.join(self.functions)}, where"

    def _check_count(self, node: ast.Call, name: str, function: Function) -> None:
        count = len(node.args)
        if function.least <= count <= function.most:
            return
        takes = f"{function.least}"
        if function.most > function.least:
            takes += f" to {function.most}"
        plural = "" if takes == "1" else "s"
        self._fail(node, f"{name} takes {takes} argument{plural}, got {count}")

    def _applied(self, node: ast.Call, function: Function, values: list[_Value]) -> _Value:
        numbers = [value.number for value in values]
        known = [number for number in numbers if number is not None]
        number = None
        if len(known) == len(numbers):
            number = self._bounded(node, lambda: function.number(*known))
        expressions = [value.expression for value in values]
        if function.build in (sympy.Min, sympy.Max):
            # Sympy compares all arguments with all, which is costly; nothing here needs it.
            if number is not None:
                return values[known.index(number)]
            return self._made(node, function.build(*expressions, evaluate=False))
        if function.build is sympy.exp:
            self._check_exponential(node, expressions[0], number)
        if function.build is sympy.sqrt:
            return self._power(node, values[0], _Value(sympy.S.Half, 0.5))
        return self._made(node, function.build(*expressions), number)

    def _check_exponential(self, node: ast.AST, argument: sympy.Expr, number: float | None) -> None:
        """Refuse what sympy would turn into a long number: exp(x + a log(b)) is b**a exp(x)."""
        terms = sympy.Add.make_args(argument)
        constant = sympy.Add(*(term for term in terms if not term.free_symbols))
        value = self._bounded(node, lambda: math.exp(float(constant.evalf(17))))
        if value == 0 or number == 0:
            self._fail(node, "the result is too small for a double; change the numbers")

    def _where(self, node: ast.Call, depth: int) -> _Value:
        if len(node.args) < 3 or len(node.args) % 2 == 0:
            self._fail(node, "where takes a condition, a value and the value otherwise")
        pairs: list[tuple[Any, Any]] = [
            (self._value(value, depth).expression, self._condition(condition, depth))
            for condition, value in zip(node.args[:-1:2], node.args[1::2], strict=True)
        ]
        pairs.append((self._value(node.args[-1], depth).expression, sympy.true))
        return self._made(node, sympy.Piecewise(*pairs, evaluate=False))

    def _condition(self, node: ast.expr, depth: int) -> Any:
        if depth > MAX_DEPTH:
            self._fail(node, f"it is nested more than {MAX_DEPTH} deep; split it")
        if isinstance(node, ast.BoolOp):
            join = sympy.And if isinstance(node.op, ast.And) else sympy.Or
            return join(*(self._condition(part, depth + 1) for part in node.values))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return sympy.Not(self._condition(node.operand, depth + 1))
        if not isinstance(node, ast.Compare):
            self._fail(node, "expected a condition such as x > 0, with 'and', 'or', 'not'")
        sides = [self._value(side, depth + 1) for side in (node.left, *node.comparators)]
        steps = zip(node.ops, sides[:-1], sides[1:], strict=True)
        return sympy.And(*(self._comparison(node, *step) for step in steps))

    def _comparison(self, node: ast.AST, sign: ast.cmpop, left: _Value, right: _Value) -> Any:
        build = COMPARISONS.get(type(sign))
        if build is None:
            self._fail(node, "conditions compare with <, <=, >, >=, == or !=")
        if left.number is not None and right.number is not None:
            self._fail(node, "both sides are numbers; write the value that holds")
        return build(left.expression, right.expression, evaluate=False)


def _flat(
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


def _dotted(node: ast.expr) -> str | None:
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


def _normal(name: str) -> str:
    return unicodedata.normalize("NFKC", name)


def _bits(number: sympy.Expr) -> int:
    if not isinstance(number, sympy.Rational):
        return 0
    return max(int(number.p).bit_length(), int(number.q).bit_length())


def _growth(base: sympy.Expr, *exponents: sympy.Expr) -> float:
    """Bound the bits of a number raised to the product of exponents; 0 where none comes out."""
    if not base.is_number or (base is sympy.E and not any(e.has(sympy.log) for e in exponents)):
        return 0
    bits = float(max(2, *map(_bits, base.atoms(sympy.Rational) | {sympy.S.One})))
    for exponent in exponents:
        sizes = [abs(float(number)) for number in exponent.atoms(sympy.Rational)]
        bits *= max(1.0, *sizes, 1.0)
    return bits


class _Writer(StrPrinter):
    """Writes with sympy's rules for precedence and order, in our names."""

    def __init__(self, names: Mapping[str, Any], functions: Mapping[str, Function]) -> None:
        super().__init__()
        self._constants = names
        self._spelled: dict[Any, str] = {TIME: "t"} if "t" not in names else {}
        for name, symbol in names.items():
            if isinstance(symbol, sympy.Symbol):
                self._spelled.setdefault(symbol, name)
        self._functions = {
            function.build: name
            for name, function in functions.items()
            if isinstance(function.build, type)
        }

    def doprint(self, expr: sympy.Expr) -> str:
        for part in sympy.preorder_traversal(expr):
            if not (isinstance(part, WRITABLE) or part.func in self._functions):
                raise LawError(
                    f"{part.func.__name__} in {_short(expr)} cannot be written in a file; "
                    f"there are {', '.join(self._functions.values())}, sqrt and where"
                )
        return str(super().doprint(expr))

    def _print_Symbol(self, expr: sympy.Symbol) -> str:
        if expr not in self._spelled:
            raise LawError(f"{expr.name!r} has no name here; make it a parameter or an input")
        return _quoted(self._spelled[expr])

    _print_Dummy = _print_Symbol

    def _print_Integer(self, expr: sympy.Integer) -> str:
        return _decimal(expr) or self._fraction(expr)

    def _print_Rational(self, expr: sympy.Rational) -> str:
        return _decimal(expr) or self._fraction(expr)

    def _fraction(self, expr: sympy.Rational) -> str:
        if _bits(expr) > DOUBLE_BITS:
            raise LawError(f"the exact number near {expr.evalf(6)} is too long to write; round it")
        return f"{expr.p}/{expr.q}" if expr.q != 1 else str(expr.p)

    def _print_Mul(self, expr: sympy.Mul) -> str:
        number, rest = expr.as_coeff_Mul()
        decimal = _decimal(number)
        if decimal is None:
            return str(super()._print_Mul(expr))
        text = self.parenthesize(rest, PRECEDENCE["Mul"], strict=True)
        return decimal + text[1:] if text.startswith("1/") else f"{decimal}*{text}"

    def _print_Pi(self, expr: sympy.Expr) -> str:
        return "pi" if self._constants.get("pi", sympy.pi) is sympy.pi else "acos(-1)"

    def _print_Exp1(self, expr: sympy.Expr) -> str:
        return "exp(1)"

    def _print_Function(self, expr: sympy.Expr) -> str:
        arguments = expr.args
        if isinstance(expr, sympy.Heaviside) and arguments[1:] == (sympy.S.Half,):
            arguments = arguments[:1]
        return f"{self._functions[expr.func]}({', '.join(map(self._print, arguments))})"

    _print_LatticeOp = _print_Heaviside = _print_Function

    def _print_Piecewise(self, expr: sympy.Piecewise) -> str:
        *pairs, last = expr.args
        if last.cond != sympy.true:
            raise LawError(f"{_short(expr)} has no value otherwise; end it with (value, True)")
        parts = [item for pair in pairs for item in (pair.cond, pair.expr)]
        return f"where({', '.join(map(self._print, [*parts, last.expr]))})"

    def _print_Relational(self, expr: sympy.Expr) -> str:
        sign = {"Eq": "==", "Ne": "!="}.get(expr.rel_op, expr.rel_op)
        return f"{self._print(expr.lhs)} {sign} {self._print(expr.rhs)}"

    def _print_And(self, expr: sympy.And) -> str:
        return self._joined(expr, " and ")

    def _print_Or(self, expr: sympy.Or) -> str:
        return self._joined(expr, " or ")

    def _print_Not(self, expr: sympy.Not) -> str:
        return f"not ({self._print(expr.args[0])})"

    def _joined(self, expr: Any, word: str) -> str:
        ordered = sorted(expr.args, key=sympy.default_sort_key)
        return word.join(f"({self._print(part)})" for part in ordered)


WRITABLE = (
    sympy.Symbol,
    sympy.Rational,
    type(sympy.pi),
    type(sympy.E),
    sympy.Add,
    sympy.Mul,
    sympy.Pow,
    sympy.Piecewise,
    sympy.functions.elementary.piecewise.ExprCondPair,
    *COMPARISONS.values(),
    sympy.And,
    sympy.Or,
    sympy.Not,
    type(sympy.true),
)


def _short(expression: Any) -> str:
    text = str(expression)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _decimal(number: sympy.Expr) -> str | None:
    """Return the decimal form of a number that reads better so than as a fraction."""
    if not isinstance(number, sympy.Rational) or (number.q <= 12 and abs(number.p) < 10**16):
        return None
    try:
        value = float(number)
    except OverflowError:
        return None
    return repr(value) if math.isfinite(value) and exact(value) == number else None


def _quoted(name: str) -> str:
    """Return a name as the expression language writes it."""
    plain = all(part.isidentifier() and not keyword.iskeyword(part) for part in name.split("."))
    if plain and _normal(name) == name:
        return name
    mark = '"' if "'" in name else "'"
    if mark in name or "\\" in name or re.search(r"[^\S ]", name) or name != name.strip():
        raise LawError(
            f"the name {name!r} cannot be written in an expression; give it a plainer one"
        )
    return f"{mark}{name}{mark}"
