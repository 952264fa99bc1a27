"""Formulas at many points at once, each with its first derivative.

    (u v)' = u' v + u v',   (u^p)' = u^p (p' log u + p u'/u),   f(u)' = f'(u) u'

Consequence to test: the derivative of every function is that of differences.
"""

import ast
from collections.abc import Callable
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crashsolve.deck.reading.expressions import CONSTANTS, Expression

Array = NDArray[np.float64]


class Jet(NamedTuple):
    """Values (n,) and first derivatives (n,)."""

    y: Array
    slope: Array


# values and derivatives of functions of one argument
_PLAIN: dict[str, tuple[Callable[[Array], Array], Callable[[Array], Array]]] = {
    "sin": (np.sin, np.cos),
    "cos": (np.cos, lambda u: -np.sin(u)),
    "tan": (np.tan, lambda u: 1.0 / np.cos(u) ** 2),
    "asin": (np.arcsin, lambda u: 1.0 / np.sqrt(1.0 - u * u)),
    "acos": (np.arccos, lambda u: -1.0 / np.sqrt(1.0 - u * u)),
    "atan": (np.arctan, lambda u: 1.0 / (1.0 + u * u)),
    "sqrt": (np.sqrt, lambda u: 0.5 / np.sqrt(u)),
    "exp": (np.exp, np.exp),
    "log": (np.log, lambda u: 1.0 / u),
    "abs": (np.abs, np.sign),
    "deg": (np.degrees, lambda u: np.full_like(u, 180.0 / pi)),
    "rad": (np.radians, lambda u: np.full_like(u, pi / 180.0)),
}


def with_derivative(formula: Expression, x: Array) -> Jet:
    """Values and slopes of a formula of x at positions (n,); raises ExpressionError.

    A slope is not finite where the formula has none.
    """
    with np.errstate(all="ignore"):
        jet = _jet(formula.root, x)
    for at in x[~np.isfinite(jet.y)][:1]:
        # the plain evaluation raises the error there
        formula.value({"x": float(at)})
    return jet


def _jet(node: ast.AST, x: Array) -> Jet:
    """Value and slope of one node of a formula that has been evaluated before, so that its words
    exist.
    """
    match node:
        case ast.Constant(value=int() | float() as number):
            return Jet(np.full_like(x, number), np.zeros_like(x))
        case ast.Name(id=name) if name in CONSTANTS:
            return Jet(np.full_like(x, CONSTANTS[name]), np.zeros_like(x))
        case ast.Name():
            return Jet(x, np.ones_like(x))
        case ast.UnaryOp(op=op, operand=operand):
            u = _jet(operand, x)
            return Jet(-u.y, -u.slope) if isinstance(op, ast.USub) else u
        case ast.BinOp(op=op, left=left, right=right):
            return _binary(op, _jet(left, x), _jet(right, x))
        case ast.Call(func=ast.Name(id=name), args=args):
            return _function(name, [_jet(arg, x) for arg in args])
    raise AssertionError(ast.dump(node))


def _binary(op: ast.operator, u: Jet, v: Jet) -> Jet:
    match op:
        case ast.Add():
            return Jet(u.y + v.y, u.slope + v.slope)
        case ast.Sub():
            return Jet(u.y - v.y, u.slope - v.slope)
        case ast.Mult():
            return Jet(u.y * v.y, u.slope * v.y + u.y * v.slope)
        case ast.Div():
            return Jet(u.y / v.y, (u.slope - u.y / v.y * v.slope) / v.y)
    y = np.power(u.y, v.y)
    slope = np.where(u.slope == 0.0, 0.0, v.y * np.power(u.y, v.y - 1.0) * u.slope)
    return Jet(y, slope + np.where(v.slope == 0.0, 0.0, y * np.log(u.y) * v.slope))


def _function(name: str, of: list[Jet]) -> Jet:
    if name in _PLAIN:
        value, derivative = _PLAIN[name]
        (u,) = of
        return Jet(value(u.y), np.where(u.slope == 0.0, 0.0, derivative(u.y) * u.slope))
    if name == "atan2":
        u, v = of
        return Jet(np.arctan2(u.y, v.y), (u.slope * v.y - u.y * v.slope) / (u.y * u.y + v.y * v.y))
    extreme = of[0]
    for other in of[1:]:
        takes = other.y < extreme.y if name == "min" else other.y > extreme.y
        extreme = Jet(*(np.where(takes, b, a) for a, b in zip(extreme, other, strict=True)))
    return extreme
