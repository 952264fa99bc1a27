"""Arithmetic on channels: `rcforc.left.force.normal + rcforc.right.force.normal`.

Operators + - * /, numbers, and the functions abs(x), norm(x, y, z), integral(x) and derivative(x)
in time. A channel name with other characters than letters, digits and dots is put in quotes:
`2 * 'rbdout.car-a.velocity.x'`. The word `time` is the sample time itself.

Consequence to test: derivative(integral(x)) gives x back to second order in the sample interval.
"""

import ast
import re
import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.units import Unit, same_dimension


class Series(NamedTuple):
    """One time history: sample times, values and the unit of the values."""

    time: np.ndarray
    values: np.ndarray
    unit: str


Lookup = Callable[[str], Series]

_LONGEST = 4000
# a whole number may have more digits than a float holds
_MOST = 1e300
_QUOTED_OR_NAME = re.compile(r"'[^']*'|\"[^\"]*\"|(?<![\w.])[A-Za-z_]\w*(?:\.\w+)+")


class _Term(NamedTuple):
    """A value while it is computed; unit None marks a bare number, which fits any unit."""

    values: np.ndarray | float
    unit: Unit | None


def evaluate(expression: str, lookup: Lookup) -> Series:
    """The series of an expression, channels coming from `lookup`; raises PostError."""
    return _Evaluation(expression, lookup).series()


class _Evaluation:
    def __init__(self, expression: str, lookup: Lookup) -> None:
        self.expression = expression
        self.lookup = lookup
        self.time: np.ndarray | None = None

    def series(self) -> Series:
        term = self.term(self.parse())
        if self.time is None:
            raise PostError(f"'{self.expression}' names no channel")
        values = np.broadcast_to(term.values, self.time.shape).astype(float)
        return Series(self.time, values, str(term.unit or ""))

    def parse(self) -> ast.expr:
        """The syntax tree, with every dotted name turned into a quoted one."""

        def quote(match: re.Match[str]) -> str:
            return match[0] if match[0][0] in "'\"" else f"'{match[0]}'"

        if len(self.expression) > _LONGEST:
            raise PostError(f"expression longer than {_LONGEST} characters")
        try:
            text = _QUOTED_OR_NAME.sub(quote, self.expression.strip())
            with warnings.catch_warnings(action="ignore"):
                return ast.parse(text, mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            raise PostError(f"cannot read the expression '{self.expression}'") from error

    def term(self, node: ast.expr) -> _Term:
        match node:
            case ast.Constant(value=str() as name):
                return self.channel(name)
            case ast.Constant(value=(int() | float()) as number) if not isinstance(number, bool):
                if abs(number) > _MOST:
                    raise PostError(f"a number in '{self.expression[:40]}' is too large")
                return _Term(float(number), None)
            case ast.Name(id="time"):
                return self.channel("time")
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                values, unit = self.term(operand)
                return _Term(-values, unit)
            case ast.BinOp(left=left, op=op, right=right):
                return self.binary(op, self.term(left), self.term(right))
            case ast.Call(func=ast.Name(id=function), args=arguments, keywords=[]):
                return self.call(function, arguments)
        part = ast.unparse(node)
        raise PostError(f"'{part}' is not a channel, number, operator + - * / or function")

    def channel(self, name: str) -> _Term:
        series = self.lookup(name)
        if self.time is not None and not np.array_equal(self.time, series.time):
            raise PostError(f"'{name}' is sampled at other times than the rest of the expression")
        self.time = series.time
        return _Term(series.values, Unit.parse(series.unit))

    def binary(self, op: ast.operator, a: _Term, b: _Term) -> _Term:
        match op:
            case ast.Add():
                return _Term(a.values + b.values, self.common_unit(a, b))
            case ast.Sub():
                return _Term(a.values - b.values, self.common_unit(a, b))
            case ast.Mult():
                return _Term(a.values * b.values, _product(a, b, 1))
            case ast.Div():
                with np.errstate(divide="ignore", invalid="ignore"):
                    quotient = np.divide(a.values, b.values)
                # who asks for such a moment is told (statistic.py)
                quotient = np.where(np.isfinite(quotient), quotient, np.nan)
                if not np.any(np.isfinite(quotient)):
                    raise PostError(f"division by zero in '{self.expression}'")
                return _Term(quotient, _product(a, b, -1))
        raise PostError(f"only + - * / are known in '{self.expression}'")

    def common_unit(self, *terms: _Term) -> Unit | None:
        units = [term.unit for term in terms if term.unit is not None]
        for unit in units[1:]:
            if not same_dimension(units[0], unit):
                raise PostError(
                    f"cannot add '{units[0]}' and '{unit}' in '{self.expression}': units differ"
                )
        return units[0] if units else None

    def call(self, function: str, arguments: list[ast.expr]) -> _Term:
        counts = {"abs": (1, 1), "norm": (1, 3), "integral": (1, 1), "derivative": (1, 1)}
        if function not in counts:
            raise unknown("function", function, counts)
        low, high = counts[function]
        if not low <= len(arguments) <= high:
            wanted = "one value" if low == high else f"{low} to {high} values"
            raise PostError(f"{function}() takes {wanted}")
        terms = [self.term(argument) for argument in arguments]
        if function == "abs":
            return _Term(np.abs(terms[0].values), terms[0].unit)
        if function == "norm":
            squares = sum(np.square(term.values) for term in terms)
            return _Term(np.sqrt(squares), self.common_unit(*terms))
        return self.calculus(function, terms[0])

    def calculus(self, function: str, term: _Term) -> _Term:
        if self.time is None:
            raise PostError(f"{function}() needs a channel in '{self.expression}'")
        values, second = np.broadcast_to(term.values, self.time.shape), Unit.parse("s")
        unit = term.unit or Unit()
        if function == "integral":
            return _Term(cumulative(self.time, values), unit.times(second))
        if len(self.time) < 2 or not np.all(np.diff(self.time) > 0):
            raise PostError("derivative() needs two or more samples at strictly increasing times")
        slope = np.gradient(values, self.time, edge_order=2 if len(self.time) > 2 else 1)
        return _Term(slope, unit.times(second, -1))


def _product(a: _Term, b: _Term, power: int) -> Unit | None:
    if a.unit is None and b.unit is None:
        return None
    return (a.unit or Unit()).times(b.unit or Unit(), power)


def cumulative(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Integral from the first sample to each sample by the trapezoidal rule."""
    areas = np.diff(time) * (values[1:] + values[:-1]) / 2
    return np.concatenate(([0.0], np.cumsum(areas)))
