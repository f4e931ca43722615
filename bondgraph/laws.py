"""Constitutive laws as plain functions on sympy expressions.

A law takes and gives expressions; it knows no element and no graph. What
changes the physics is a required keyword: nothing here has a hidden default.
"""

from __future__ import annotations

from typing import Any

import sympy

from .errors import LawError


def exact(value: Any) -> sympy.Expr:
    """Turn a number or expression into sympy without binary float dust.

    A Python float becomes the rational number it is written as, so that 0.2 is
    1/5 and elimination leaves no 1e-17 terms.

    Parameters
    ----------
    value : number, numpy scalar or sympy expression
        Anything sympy can represent as one real expression; text is refused.

    Returns
    -------
    sympy.Expr

    Raises
    ------
    LawError
        For text, NaN, infinities, complex numbers and things that are no scalar expression.

    Examples
    --------
    >>> exact(0.2)
    1/5
    """
    if isinstance(value, bool | str):
        raise LawError(
            f"expected a number or a sympy expression, got {value!r}; make a symbol with sympy.Symbol"
        )
    try:
        if hasattr(value, "item") and not isinstance(value, sympy.Basic):
            value = value.item()
        expression = sympy.sympify(value, strict=True)
    except (sympy.SympifyError, TypeError, ValueError):
        raise LawError(f"expected a number or a sympy expression, got {value!r}") from None
    if not isinstance(expression, sympy.Expr):
        raise LawError(f"expected a scalar expression, got {value!r}")
    if expression.is_Rational or expression.is_Symbol:
        return expression
    if expression.has(sympy.nan, sympy.zoo, sympy.oo, sympy.S.NegativeInfinity):
        raise LawError(f"{value!r} is not a finite number; give a finite value")
    if expression.has(sympy.I):
        raise LawError(f"{value!r} is not real; efforts, flows and parameters are real")
    floats = expression.atoms(sympy.Float)
    return expression.xreplace({number: sympy.Rational(repr(float(number))) for number in floats})


def stribeck(slip: Any, *, normal: Any, mu_s: Any, mu_k: Any, v_s: Any) -> sympy.Expr:
    """Friction force that falls from static to kinetic as slip grows.

    ``normal (mu_k + (mu_s - mu_k) exp(-slip / v_s))``: the magnitude, for a
    slip speed of at least zero.

    Parameters
    ----------
    slip : Expr
        Slip speed, m/s, not negative.
    normal : Expr
        Normal force, N.
    mu_s, mu_k : Expr
        Static and kinetic coefficients of friction.
    v_s : Expr
        Slip sensitivity: speed over which the force falls by a factor e, m/s.

    Returns
    -------
    Expr
        Force, N.

    References
    ----------
    Bike braking vibration modelling and measurement, Procedia Engineering 72
    (2014) 471-476, Fig. 4.

    Examples
    --------
    >>> stribeck(0, normal=10, mu_s=0.4, mu_k=0.25, v_s=0.1)
    4
    """
    slip, normal, mu_s, mu_k, v_s = map(exact, (slip, normal, mu_s, mu_k, v_s))
    return normal * (mu_k + (mu_s - mu_k) * sympy.exp(-slip / v_s))


def regularised(kinetic: sympy.Expr, speed: sympy.Symbol, slip: Any, width: Any) -> sympy.Expr:
    """Replace the jump of dry friction at zero slip by ``tanh(slip / width)``.

    Kept for comparison: it is wrong in time traces (a stuck contact creeps),
    with an error linear in the width.

    Parameters
    ----------
    kinetic : Expr
        Magnitude of the force as a function of ``speed``.
    speed : Symbol
        The symbol that stands for the slip speed in ``kinetic``.
    slip : Expr
        Signed slip, m/s.
    width : Expr
        Width of the transition, m/s, positive.

    Returns
    -------
    Expr
        Signed force.

    Examples
    --------
    >>> import sympy
    >>> v, s = sympy.symbols("v s", real=True)
    >>> regularised(8 + 0 * s, s, v, 0.001)
    8*tanh(1000*v)
    """
    slip = exact(slip)
    return kinetic.xreplace({speed: sympy.Abs(slip)}) * sympy.tanh(slip / exact(width))


def affine_inverse(
    law: sympy.Expr | None, argument: sympy.Symbol, value: sympy.Symbol
) -> sympy.Expr | None:
    """Invert a law that is affine in its argument; None where it is not.

    Parameters
    ----------
    law : Expr or None
    argument : Symbol
        What the law is a function of.
    value : Symbol
        What the law gives.

    Returns
    -------
    Expr or None

    Examples
    --------
    >>> f, e = sympy.symbols("f e")
    >>> affine_inverse(2 * f + 1, f, e)
    e/2 - 1/2
    """
    if law is None:
        return None
    slope = sympy.diff(law, argument)
    if slope == 0 or argument in slope.free_symbols:
        return None
    return (value - law.xreplace({argument: sympy.S.Zero})) / slope


def inverse(
    law: sympy.Expr | None, argument: sympy.Symbol, value: sympy.Symbol
) -> sympy.Expr | None:
    """Invert a law that is affine or an odd power; None where it is neither.

    Parameters
    ----------
    law : Expr or None
    argument : Symbol
        What the law is a function of.
    value : Symbol
        What the law gives.

    Returns
    -------
    Expr or None

    Examples
    --------
    >>> f, e = sympy.symbols("f e", real=True)
    >>> inverse(2 * f, f, e), inverse(f**3, f, e), inverse(f + f**3, f, e)
    (e/2, Abs(e)**(1/3)*sign(e), None)
    """
    affine = affine_inverse(law, argument, value)
    return power_inverse(law, argument, value) if affine is None else affine


def power_inverse(
    law: sympy.Expr | None, argument: sympy.Symbol, value: sympy.Symbol
) -> sympy.Expr | None:
    """Invert an odd power law, such as an orifice's ``e = c f |f|``; None where it is none.

    Parameters
    ----------
    law : Expr or None
        ``c f**n`` with n odd, ``c f |f|**m`` or ``c sign(f) |f|**m``, m positive.
    argument : Symbol
        What the law is a function of; real.
    value : Symbol
        What the law gives.

    Returns
    -------
    Expr or None

    Examples
    --------
    >>> f, e = sympy.symbols("f e", real=True)
    >>> power_inverse(4 * f * abs(f), f, e)
    sqrt(Abs(e))*sign(e)/2
    """
    if law is None or not argument.is_real:
        return None
    factor, rest = law.as_independent(argument, as_Add=False)
    if factor == 0 or argument in factor.free_symbols:
        return None
    degree = _odd_degree(rest, argument)
    if degree is None:
        return None
    part = value / factor
    return sympy.sign(part) * sympy.Abs(part) ** (1 / degree)


def _odd_degree(power: sympy.Expr, argument: sympy.Symbol) -> sympy.Rational | None:
    """Return n where an expression is ``sign(x) |x|**n``; None where it is not."""
    degree, odd = sympy.S.Zero, False
    for part in sympy.Mul.make_args(power):
        base, exponent = part.as_base_exp()
        if not (exponent.is_Rational and exponent > 0):
            return None
        if base == argument and exponent.is_Integer:
            degree, odd = degree + exponent, odd != bool(exponent % 2)
        elif base == sympy.Abs(argument):
            degree += exponent
        elif base == sympy.sign(argument) and exponent.is_Integer:
            odd = odd != bool(exponent % 2)
        else:
            return None
    return degree if odd and degree > 0 else None
