"""Walks the syntax tree of an expression and builds it in sympy."""

from __future__ import annotations

import ast
import math
from collections.abc import Mapping
from typing import Any

import sympy

from ..errors import LawError, suggestion
from ..laws import exact
from .arithmetic import Arithmetic, Value
from .language import COMPARISONS, CONSTANTS, FUNCTIONS, HINTS, MAX_LENGTH, Function
from .names import dotted, normal
from .syntax import Source, flat
from .words import reason

MAX_DEPTH = 50  # functions, powers and parentheses within each other


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
    return _Reader(text, names, functions).read()


class _Reader:
    """Reads one expression. Sums and products are read flat, as sympy holds them."""

    def __init__(
        self, text: str, names: Mapping[str, Any], functions: Mapping[str, Function]
    ) -> None:
        self.names = names
        self.functions = functions
        self.source = Source(text, names)
        self.fail = self.source.fail
        self.arithmetic = Arithmetic(self.source)

    def read(self) -> sympy.Expr:
        try:
            return self._value(self.source.tree(), 0).expression
        except (TypeError, ValueError, ArithmeticError, RecursionError, MemoryError) as error:
            self.fail(0, f"it cannot be worked out ({reason(error)}); write it in simpler terms")

    def _value(self, node: ast.expr, depth: int) -> Value:
        if depth > MAX_DEPTH:
            self.fail(node, f"it is nested more than {MAX_DEPTH} deep; split it")
        if isinstance(node, ast.BinOp | ast.UnaryOp):
            return self._operation(node, depth + 1)
        if isinstance(node, ast.Call):
            return self._call(node, depth + 1)
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return self._literal(node)
        name = dotted(node)
        if name is None:
            self.source.refuse(node, node)
        return self._named(node, name)

    def _literal(self, node: ast.Constant) -> Value:
        value: Any = node.value
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            self.fail(node, "the number is too large for a double; write a finite one")
        return Value(exact(value), number)

    def _named(self, node: ast.AST, name: str) -> Value:
        found = self.names.get(name, CONSTANTS.get(name))
        if found is None:  # Python's grammar writes some letters in their normal form
            found = next((self.names[key] for key in self.names if normal(key) == name), None)
        if found is None:
            if name in self.functions or name == "where":
                hint = f"{name} is a function: write {name}(...)"
            elif near := suggestion(name, [*self.names, *CONSTANTS]):
                hint = near
            else:
                known = list(dict.fromkeys([*list(self.names)[:12], *CONSTANTS]))
                hint = f"known: {', '.join(known)}"
            self.fail(node, f"the name {name!r} is not known; {hint}")
        if isinstance(found, str):
            self.fail(node, found)
        return self.arithmetic.made(node, found)

    def _operation(self, node: ast.BinOp | ast.UnaryOp, depth: int) -> Value:
        if isinstance(node.op, ast.Add | ast.Sub):
            return self._sum(node, depth)
        if isinstance(node.op, ast.Mult | ast.Div | ast.USub | ast.UAdd):
            return self._product(node, depth)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            base, exponent = self._value(node.left, depth), self._value(node.right, depth)
            return self.arithmetic.power(node, base, exponent)
        self.source.refuse(node, node.op)

    def _sum(self, node: ast.expr, depth: int) -> Value:
        terms = [
            (sign, self._value(term, depth))
            for sign, term in flat(node, ast.Add, ast.Sub, ast.USub)
        ]
        expression = sympy.Add(*(sign * value.expression for sign, value in terms))
        numbers = [None if value.number is None else sign * value.number for sign, value in terms]
        return self.arithmetic.made(
            node, expression, self.arithmetic.folded(node, math.fsum, numbers)
        )

    def _product(self, node: ast.expr, depth: int) -> Value:
        factors = []
        for side, factor in flat(node, ast.Mult, ast.Div, None):
            if isinstance(factor, ast.UnaryOp) and isinstance(factor.op, ast.USub):
                factors.append(Value(sympy.S.NegativeOne, -1.0))
                factor = factor.operand
            value = self._value(factor, depth)
            if side < 0:
                value = self.arithmetic.power(factor, value, Value(sympy.S.NegativeOne, -1.0))
            factors.append(value)
        expression = sympy.Mul(*(value.expression for value in factors))
        number = self.arithmetic.folded(node, math.prod, [value.number for value in factors])
        if number == 0 and expression != 0:
            self.fail(node, "the result is too small for a double; change the numbers")
        return self.arithmetic.made(node, expression, number)

    def _call(self, node: ast.Call, depth: int) -> Value:
        name = dotted(node.func)
        if name is None or isinstance(node.func, ast.Constant):
            self.fail(node, "only a function can be called; multiplication is written *")
        function = self.functions.get(name)
        if function is None and name != "where":
            self.fail(node, f"there is no function {name!r}; {self._function_hint(name)}")
        if node.keywords or any(isinstance(item, ast.Starred) for item in node.args):
            self.fail(node, f"{name}: arguments are plain expressions, without names or stars")
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
        near = suggestion(name, [*self.functions, "where"])
        return near or f"there are {', '.join(self.functions)}, where"

    def _check_count(self, node: ast.Call, name: str, function: Function) -> None:
        count = len(node.args)
        if function.least <= count <= function.most:
            return
        takes = f"{function.least}"
        if function.most > function.least:
            takes += f" to {function.most}"
        plural = "" if takes == "1" else "s"
        self.fail(node, f"{name} takes {takes} argument{plural}, got {count}")

    def _applied(self, node: ast.Call, function: Function, values: list[Value]) -> Value:
        numbers = [value.number for value in values]
        number = self.arithmetic.folded(node, lambda known: function.number(*known), numbers)
        expressions = [value.expression for value in values]
        if function.build in (sympy.Min, sympy.Max):
            # Sympy compares all arguments with all, which is costly; nothing here needs it.
            if number is not None:
                return values[numbers.index(number)]
            return self.arithmetic.made(node, function.build(*expressions, evaluate=False))
        if function.build is sympy.exp:
            self.arithmetic.check_exponential(node, expressions[0], number)
        if function.build is sympy.sqrt:
            return self.arithmetic.power(node, values[0], Value(sympy.S.Half, 0.5))
        return self.arithmetic.made(node, function.build(*expressions), number)

    def _where(self, node: ast.Call, depth: int) -> Value:
        if len(node.args) < 3 or len(node.args) % 2 == 0:
            self.fail(node, "where takes a condition, a value and the value otherwise")
        pairs: list[tuple[Any, Any]] = [
            (self._value(value, depth).expression, self._condition(condition, depth))
            for condition, value in zip(node.args[:-1:2], node.args[1::2], strict=True)
        ]
        pairs.append((self._value(node.args[-1], depth).expression, sympy.true))
        return self.arithmetic.made(node, sympy.Piecewise(*pairs, evaluate=False))

    def _condition(self, node: ast.expr, depth: int) -> Any:
        if depth > MAX_DEPTH:
            self.fail(node, f"it is nested more than {MAX_DEPTH} deep; split it")
        if isinstance(node, ast.BoolOp):
            join = sympy.And if isinstance(node.op, ast.And) else sympy.Or
            return join(*(self._condition(part, depth + 1) for part in node.values))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return sympy.Not(self._condition(node.operand, depth + 1))
        if not isinstance(node, ast.Compare):
            self.fail(node, "expected a condition such as x > 0, with 'and', 'or', 'not'")
        sides = [self._value(side, depth + 1) for side in (node.left, *node.comparators)]
        steps = zip(node.ops, sides[:-1], sides[1:], strict=True)
        return sympy.And(*(self._comparison(node, *step) for step in steps))

    def _comparison(self, node: ast.AST, sign: ast.cmpop, left: Value, right: Value) -> Any:
        build = COMPARISONS.get(type(sign))
        if build is None:
            self.fail(node, "conditions compare with <, <=, >, >=, == or !=")
        if left.number is not None and right.number is not None:
            self.fail(node, "both sides are numbers; write the value that holds")
        return build(left.expression, right.expression, evaluate=False)
