"""Arithmetic of channels on samples in memory, as crashpost does it on those of a file.

Operators + - * /, numbers, abs(x), norm(x, y, z), integral(x), derivative(x) and the word `time`; a
channel with other characters than letters, digits and dots stands in quotes. Units are left to
crashpost, which judges them.

Consequence to test: crashpost finds the same numbers in the results.
"""

import ast
import re
import warnings
from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

MOST = 1e300
# letters of an expression, as crashpost has it
LONGEST = 4000
_QUOTED_OR_NAME = re.compile(r"'[^']*'|\"[^\"]*\"|(?<![\w.])[A-Za-z_]\w*(?:\.\w+)+")
_FUNCTIONS = {"abs": (1, 1), "norm": (1, 3), "integral": (1, 1), "derivative": (1, 1)}
_OPERATORS = {ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide}


def channels_in(expression: str) -> list[str]:
    """The channels an expression names, each once. Raises ValueError for one that cannot be read.

    An expression that is itself a channel's name is for the caller to know.
    """
    try:
        names = dict.fromkeys(_names(_tree(expression)))
    except RecursionError:
        raise ValueError(f"'{expression[:40]}...' is nested too deeply") from None
    if not names:
        raise ValueError(f"'{expression}' names no channel")
    return [name for name in names if name != "time"]


def evaluate(expression: str, time: np.ndarray, values: Mapping[str, np.ndarray]) -> np.ndarray:
    """Values (n,) of an expression at the sample times (n,); NaN where it divides by zero.

    Raises ValueError.
    """
    if expression.strip() in values:
        return values[expression.strip()]
    known = {**values, "time": time}
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.broadcast_to(_value(_tree(expression), time, known), time.shape)
    return np.where(np.isfinite(found), found, np.nan)


def is_sampled(expression: str) -> bool:
    """Whether samples, by an integral or a derivative, enter the value of a single moment."""
    return "integral(" in expression or "derivative(" in expression


def cumulative(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Integral from the first sample to each sample by the trapezoidal rule."""
    areas = np.diff(time) * (values[1:] + values[:-1]) / 2
    return np.concatenate(([0.0], np.cumsum(areas)))


@lru_cache(maxsize=1024)
def _tree(expression: str) -> ast.expr:
    """The syntax tree, with every dotted name turned into a quoted one."""

    def quote(match: re.Match[str]) -> str:
        return match[0] if match[0][0] in "'\"" else f"'{match[0]}'"

    if len(expression) > LONGEST:
        raise ValueError(f"an expression of more than {LONGEST} letters")
    text = _QUOTED_OR_NAME.sub(quote, expression.strip())
    try:
        with warnings.catch_warnings(action="ignore"):
            return ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ValueError(f"cannot read the expression '{expression}'") from error


def _names(node: ast.expr) -> list[str]:
    match node:
        case ast.Constant(value=str() as name):
            return [name]
        case ast.Name(id="time"):
            return ["time"]
        case ast.Constant(value=(int() | float()) as number):
            # a whole number may have more digits than a float holds
            if abs(number) > MOST:
                raise ValueError("a number is too large")
            return []
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _names(operand)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _names(left) + _names(right)
        case ast.Call(func=ast.Name(id=function), args=parts, keywords=[]):
            _check_call(function, parts)
            return [name for part in parts for name in _names(part)]
    part = ast.unparse(node)
    raise ValueError(f"'{part}' is not a channel, number, operator + - * / or function")


def _check_call(function: str, arguments: Sequence[ast.expr]) -> None:
    if function not in _FUNCTIONS:
        raise ValueError(f"unknown function '{function}' (functions: {', '.join(_FUNCTIONS)})")
    low, high = _FUNCTIONS[function]
    if not low <= len(arguments) <= high:
        wanted = "one value" if low == high else f"{low} to {high} values"
        raise ValueError(f"{function}() takes {wanted}")


def _value(node: ast.expr, time: np.ndarray, known: Mapping[str, np.ndarray]) -> np.ndarray:
    """The value of a tree whose words are known to be right."""
    match node:
        case ast.Constant(value=str() as name):
            return known[name]
        case ast.Name():
            return time
        case ast.Constant(value=(int() | float()) as number):
            return np.array(float(number))
        case ast.UnaryOp(operand=operand):
            return -_value(operand, time, known)
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATORS[type(op)](_value(left, time, known), _value(right, time, known))
        case ast.Call(func=ast.Name(id=function), args=parts):
            return _call(function, [_value(part, time, known) for part in parts], time)
    raise ValueError(f"'{ast.unparse(node)}' is not understood")


def _call(function: str, values: list[np.ndarray], time: np.ndarray) -> np.ndarray:
    match function:
        case "abs":
            return np.abs(values[0])
        case "norm":
            return np.sqrt(sum(np.square(value) for value in values))
        case "integral":
            return cumulative(time, np.broadcast_to(values[0], time.shape))
    if len(time) < 2:
        raise ValueError("derivative() needs two or more samples")
    course = np.broadcast_to(values[0], time.shape)
    return np.gradient(course, time, edge_order=2 if len(time) > 2 else 1)
