"""Bounds of a formula and of its slope over intervals of x, by interval arithmetic.

    f in F,   f' in F',   |f - chord| <= min(width(F), h width(F') / 4)   over an interval h long

Every rule bounds its function over all of its arguments, so no value lies outside: what cannot be
seen at any number of points, such as a short pulse on top of a slow sine, is within the bounds, and
bisection finds it. Bounds are wider than the values, by the square of h for the chord.
Consequence to test: every value and every slope lies within.

Reference: Moore, Kearfott and Cloud (2009), Introduction to Interval Analysis, chapters 5 and 6.
"""

import ast
from collections.abc import Callable
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crashsolve.curves._piecewise import Array
from crashsolve.deck.reading.expressions import CONSTANTS, Expression

Mask = NDArray[np.bool_]


class Interval(NamedTuple):
    """Bounds of numbers (n,)."""

    low: Array
    high: Array


class Bounds(NamedTuple):
    """Bounds of the values and of the slopes of a formula."""

    y: Interval
    slope: Interval


def deviation(formula: Expression, left: Array, right: Array) -> Array:
    """Bounds (n,) of the distance of a formula from its chord over intervals."""
    with np.errstate(all="ignore"):
        y, slope = bounds(formula, left, right)
        by_slope = 0.25 * (right - left) * (slope.high - slope.low)
        bound: Array = np.fmin(y.high - y.low, by_slope)
    return np.where(np.isnan(bound), np.inf, bound)


def bounds(formula: Expression, left: Array, right: Array) -> Bounds:
    """Bounds of a formula of x and of its slope over intervals; infinite where none are known."""
    with np.errstate(all="ignore"):
        return Bounds(*(_known(part) for part in _bounds(formula.root, Interval(left, right))))


def _known(u: Interval) -> Interval:
    low = np.where(np.isnan(u.low), -np.inf, u.low)
    return Interval(low, np.where(np.isnan(u.high), np.inf, u.high))


def _bounds(node: ast.AST, x: Interval) -> Bounds:
    match node:
        case ast.Constant(value=int() | float() as number):
            return Bounds(_constant(number, x), _constant(0.0, x))
        case ast.Name(id=name) if name in CONSTANTS:
            return Bounds(_constant(CONSTANTS[name], x), _constant(0.0, x))
        case ast.Name():
            return Bounds(x, _constant(1.0, x))
        case ast.UnaryOp(op=op, operand=operand):
            u = _bounds(operand, x)
            return Bounds(_minus(u.y), _minus(u.slope)) if isinstance(op, ast.USub) else u
        case ast.BinOp(op=op, left=left, right=right):
            return _binary(op, _bounds(left, x), _bounds(right, x))
        case ast.Call(func=ast.Name(id=name), args=args):
            return _function(name, [_bounds(arg, x) for arg in args])
    raise AssertionError(ast.dump(node))


def _binary(op: ast.operator, u: Bounds, v: Bounds) -> Bounds:
    match op:
        case ast.Add():
            return Bounds(_plus(u.y, v.y), _plus(u.slope, v.slope))
        case ast.Sub():
            return Bounds(_plus(u.y, _minus(v.y)), _plus(u.slope, _minus(v.slope)))
        case ast.Mult():
            return _product(u, v)
        case ast.Div():
            inverse = _reciprocal(v.y)
            return _product(u, Bounds(inverse, _times(_minus(_square(inverse)), v.slope)))
    y, below = _power(u.y, v.y), _power(u.y, _plus(v.y, _constant(-1.0, v.y)))
    by_exponent = _times(_times(y, _increasing(np.log, _positive(u.y))), v.slope)
    return Bounds(y, _plus(_times(_times(v.y, below), u.slope), by_exponent))


def _function(name: str, of: list[Bounds]) -> Bounds:
    u = of[0]
    if name in _PLAIN:
        value, derivative = _PLAIN[name]
        return Bounds(value(u.y), _times(derivative(u.y), u.slope))
    if name == "atan2":
        v = of[1]
        slope = _plus(_times(u.slope, v.y), _minus(_times(u.y, v.slope)))
        inverse = _reciprocal(_plus(_square(u.y), _square(v.y)))
        return Bounds(_angle(u.y, v.y), _times(slope, inverse))
    for v in of[1:]:
        u = _least(u, v) if name == "min" else _greatest(u, v)
    return u


def _constant(number: float, like: Interval) -> Interval:
    return Interval(np.full_like(like.low, number), np.full_like(like.low, number))


def _minus(u: Interval) -> Interval:
    return Interval(-u.high, -u.low)


def _plus(u: Interval, v: Interval) -> Interval:
    return Interval(u.low + v.low, u.high + v.high)


def _times(u: Interval, v: Interval) -> Interval:
    parts = np.array([u.low * v.low, u.low * v.high, u.high * v.low, u.high * v.high])
    # 0 times a bound that is not known: the number within it is finite
    parts[np.isnan(parts)] = 0.0
    return Interval(parts.min(axis=0), parts.max(axis=0))


def _product(u: Bounds, v: Bounds) -> Bounds:
    return Bounds(_times(u.y, v.y), _plus(_times(u.slope, v.y), _times(u.y, v.slope)))


def _reciprocal(u: Interval) -> Interval:
    has_zero = (u.low <= 0.0) & (u.high >= 0.0)
    # a bound at 0 keeps its sign
    is_positive, is_negative = (u.low == 0.0) & (u.high > 0.0), (u.high == 0.0) & (u.low < 0.0)
    low = np.where(has_zero & ~is_positive, -np.inf, 1.0 / u.high)
    return Interval(low, np.where(has_zero & ~is_negative, np.inf, 1.0 / u.low))


def _square(u: Interval) -> Interval:
    high = np.maximum(u.low * u.low, u.high * u.high)
    low = np.where((u.low < 0.0) & (u.high > 0.0), 0.0, np.minimum(u.low**2, u.high**2))
    return Interval(low, high)


def _power(u: Interval, v: Interval) -> Interval:
    """u^v: of whole exponents for any u, of others for u >= 0."""
    exponent = float(v.low[0])
    if (v.low == v.high).all() and (v.low == exponent).all() and exponent.is_integer():
        if exponent < 0.0:
            return _reciprocal(_power(u, _minus(v)))
        if exponent % 2.0 == 1.0:
            return Interval(u.low**exponent, u.high**exponent)
        size = _size(u)
        return Interval(size.low**exponent, size.high**exponent)
    return _increasing(np.exp, _times(v, _increasing(np.log, _positive(u))))


def _increasing(function: Callable[[Array], Array], u: Interval) -> Interval:
    return Interval(function(u.low), function(u.high))


def _positive(u: Interval) -> Interval:
    return Interval(np.maximum(u.low, 0.0), np.maximum(u.high, 0.0))


def _size(u: Interval) -> Interval:
    low, high = np.abs(u.low), np.abs(u.high)
    has_zero = (u.low < 0.0) & (u.high > 0.0)
    return Interval(np.where(has_zero, 0.0, np.minimum(low, high)), np.maximum(low, high))


def _sign(u: Interval) -> Interval:
    return Interval(np.where(u.low > 0.0, 1.0, -1.0), np.where(u.high < 0.0, -1.0, 1.0))


def _sine(u: Interval) -> Interval:
    ends = np.sin(u.low), np.sin(u.high)

    def has(angle: float) -> Mask:
        periods: Array = np.floor((u.high - angle) / (2.0 * pi))
        return periods >= (u.low - angle) / (2.0 * pi)

    low = np.where(has(-0.5 * pi), -1.0, np.minimum(*ends))
    return Interval(low, np.where(has(0.5 * pi), 1.0, np.maximum(*ends)))


def _cosine(u: Interval) -> Interval:
    return _sine(Interval(u.low + 0.5 * pi, u.high + 0.5 * pi))


def _tangent(u: Interval) -> Interval:
    has_pole = np.floor(u.low / pi + 0.5) != np.floor(u.high / pi + 0.5)
    low, high = np.tan(u.low), np.tan(u.high)
    return Interval(np.where(has_pole, -np.inf, low), np.where(has_pole, np.inf, high))


def _within_one(u: Interval) -> Interval:
    return Interval(np.clip(u.low, -1.0, 1.0), np.clip(u.high, -1.0, 1.0))


def _one_plus(u: Interval) -> Interval:
    return Interval(1.0 + u.low, 1.0 + u.high)


def _slope_of_asin(u: Interval) -> Interval:
    inside = _positive(_one_plus(_minus(_square(_within_one(u)))))
    return _reciprocal(_increasing(np.sqrt, inside))


def _slope_of_sqrt(u: Interval) -> Interval:
    root = _reciprocal(_increasing(np.sqrt, _positive(u)))
    return Interval(0.5 * root.low, 0.5 * root.high)


def _angle(u: Interval, v: Interval) -> Interval:
    """Bounds of atan2(u, v): of the corners, but for those that go round the origin."""
    corners = np.array([np.arctan2(a, b) for a in u for b in v])
    is_round = (u.low <= 0.0) & (u.high >= 0.0) & (v.low <= 0.0)
    low, high = corners.min(axis=0), corners.max(axis=0)
    return Interval(np.where(is_round, -pi, low), np.where(is_round, pi, high))


def _least(u: Bounds, v: Bounds) -> Bounds:
    y = Interval(np.minimum(u.y.low, v.y.low), np.minimum(u.y.high, v.y.high))
    return Bounds(y, _either(u.slope, v.slope, u.y.high < v.y.low, v.y.high < u.y.low))


def _greatest(u: Bounds, v: Bounds) -> Bounds:
    y = Interval(np.maximum(u.y.low, v.y.low), np.maximum(u.y.high, v.y.high))
    return Bounds(y, _either(u.slope, v.slope, u.y.low > v.y.high, v.y.low > u.y.high))


def _either(u: Interval, v: Interval, is_u: Mask, is_v: Mask) -> Interval:
    low = np.where(is_u, u.low, np.where(is_v, v.low, np.minimum(u.low, v.low)))
    high = np.where(is_u, u.high, np.where(is_v, v.high, np.maximum(u.high, v.high)))
    return Interval(low, high)


Rule = Callable[[Interval], Interval]
# bounds of functions of one argument, and of their derivatives
_PLAIN: dict[str, tuple[Rule, Rule]] = {
    "sin": (_sine, _cosine),
    "cos": (_cosine, lambda u: _minus(_sine(u))),
    "tan": (_tangent, lambda u: _one_plus(_square(_tangent(u)))),
    "asin": (lambda u: _increasing(np.arcsin, _within_one(u)), _slope_of_asin),
    "acos": (
        lambda u: _plus(_constant(0.5 * pi, u), _minus(_increasing(np.arcsin, _within_one(u)))),
        lambda u: _minus(_slope_of_asin(u)),
    ),
    "atan": (
        lambda u: _increasing(np.arctan, u),
        lambda u: _reciprocal(_one_plus(_square(u))),
    ),
    "sqrt": (lambda u: _increasing(np.sqrt, _positive(u)), _slope_of_sqrt),
    "exp": (lambda u: _increasing(np.exp, u), lambda u: _increasing(np.exp, u)),
    "log": (lambda u: _increasing(np.log, _positive(u)), lambda u: _reciprocal(_positive(u))),
    "abs": (_size, _sign),
    "deg": (lambda u: _increasing(np.degrees, u), lambda u: _constant(180.0 / pi, u)),
    "rad": (lambda u: _increasing(np.radians, u), lambda u: _constant(pi / 180.0, u)),
}
