"""Arithmetic on channels: `rcforc.left.force.normal + rcforc.right.force.normal`.

Operators + - * /, numbers, and the functions of the folder `functions`. A channel name with other
characters than letters, digits and dots is put in quotes: `2 * 'rbdout.car-a.velocity.x'`; so is a
number with a unit: `rbdout.a.velocity.x - '54 km/h'`. The word `time` is the sample time itself.

A file of `functions` holds `apply(time, x, ...)`, from sample times (n,) and Terms to a Term, and
SAMPLED = True where samples at other times enter the value at a moment, IS_SAMPLE_TIME = True where
values are times of samples.
"""

import ast
import inspect
import re
import warnings
from collections.abc import Callable
from functools import lru_cache
from typing import ParamSpec, TypeVar

import numpy as np

from crashsolve.channels.display import Product
from crashsolve.channels.errors import ChannelError, unknown
from crashsolve.channels.folder import FUNCTIONS, module_of, words_in
from crashsolve.channels.series import Series
from crashsolve.channels.term import Term, common_unit
from crashsolve.channels.units import describe, parse_unit, split_quantity

Lookup = Callable[[str], Series]
# arguments and result of a step of the evaluation
P = ParamSpec("P")
R = TypeVar("R")

LONGEST = 4000
# letters of an expression that a message repeats
SHOWN = 60
# a whole number may have more digits than a float holds
LARGEST = 1e300
_QUOTED_OR_NAME = re.compile(r"'[^']*'|\"[^\"]*\"|(?<![\w.])[A-Za-z_]\w*(?:\.\w+)+")
_QUANTITY = re.compile(r"\s*[-+]?\.?[0-9]")
_OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div)


def evaluate(expression: str, lookup: Lookup) -> Series:
    """The series of an expression, channels coming from `lookup`; raises ChannelError.

    Values are NaN where it divides by zero.
    """
    try:
        return _Evaluation(expression, lookup).series()
    except RecursionError:
        raise ChannelError(f"'{expression[:40]}...' is nested too deeply") from None


def channels_in(expression: str) -> list[str]:
    """The channels an expression names, each once; raises ChannelError.

    An expression that is itself a channel's name is for the caller to know.
    """
    try:
        names = dict.fromkeys(_names(_tree(expression)))
    except RecursionError:
        raise ChannelError(f"'{expression[:40]}...' is nested too deeply") from None
    if not names:
        raise ChannelError(f"'{expression}' names no channel")
    return [name for name in names if name != "time"]


def is_sampled(expression: str) -> bool:
    """Whether samples at other times enter the value of a moment, as by an integral."""
    return _calls_any(expression, "SAMPLED")


def gives_sample_times(expression: str) -> bool:
    """Whether values are times of samples, known to an interval and no better."""
    return _calls_any(expression, "IS_SAMPLE_TIME")


def _calls_any(expression: str, flag: str) -> bool:
    called = re.findall(r"([A-Za-z_]\w*)\s*\(", expression)
    known = [word for word in called if word in words_in(FUNCTIONS)]
    return any(getattr(module_of(FUNCTIONS, word), flag, False) for word in known)


@lru_cache(maxsize=1024)
def _tree(expression: str) -> ast.expr:
    """The syntax tree, with every dotted name turned into a quoted one."""

    def quote(match: re.Match[str]) -> str:
        return match[0] if match[0][0] in "'\"" else f"'{match[0]}'"

    if len(expression) > LONGEST:
        raise ChannelError(f"expression longer than {LONGEST} characters")
    try:
        text = _QUOTED_OR_NAME.sub(quote, expression.strip())
        with warnings.catch_warnings(action="ignore"):
            return ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        message = f"cannot read the expression '{expression}'{_advice(expression.strip())}"
        raise ChannelError(message) from error


def _advice(expression: str) -> str:
    """What to write for a channel that a statistic follows, as logs have it."""
    channel, _, last = expression.rpartition(" ")
    if not channel or last.partition(":")[0] not in words_in("statistics"):
        return ""
    return f"; a statistic is a field of its own: {{channel: {channel}, statistic: {last}}}"


def _names(node: ast.expr) -> list[str]:
    """The channels of a tree, `time` among them; raises ChannelError for any other node."""
    match node:
        case ast.Constant(value=str() as name):
            return [] if _QUANTITY.match(name) else [name]
        case ast.Name(id="time"):
            return ["time"]
        case ast.Constant(value=(int() | float()) as number) if not isinstance(number, bool):
            if abs(number) > LARGEST:
                raise ChannelError("a number is too large")
            return []
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _names(operand)
        case ast.BinOp(left=left, op=op, right=right):
            if not isinstance(op, _OPERATORS):
                raise ChannelError(f"'{ast.unparse(node)}' is not known: only + - * / are known")
            return _names(left) + _names(right)
        case ast.Call(func=ast.Name(id=function), args=parts, keywords=[]):
            _check_call(function, len(parts))
            return [name for part in parts for name in _names(part)]
    part = ast.unparse(node)
    raise ChannelError(f"'{part}' is not a channel, number, operator + - * / or function")


def _check_call(function: str, count: int) -> None:
    """Raises ChannelError for a function that is unknown, or given too much or too little."""
    if function not in words_in(FUNCTIONS):
        raise unknown("function", function, words_in(FUNCTIONS))
    taken = list(inspect.signature(module_of(FUNCTIONS, function).apply).parameters.values())[1:]
    least = sum(parameter.default is inspect.Parameter.empty for parameter in taken)
    if not least <= count <= len(taken):
        wanted = "one value" if len(taken) == 1 else f"{least} to {len(taken)} values"
        names = ", ".join(parameter.name for parameter in taken)
        raise ChannelError(f"{function}({names}) takes {wanted}, not {count}")


class _Evaluation:
    def __init__(self, expression: str, lookup: Lookup) -> None:
        self.expression = expression
        self.lookup = lookup
        self.known: dict[str, Term] = {}
        self.time = np.empty(0)

    def series(self) -> Series:
        tree = _tree(self.expression)
        names = _names(tree)
        if not names:
            raise ChannelError(f"'{self.expression}' names no channel, and needs a channel")
        self.time = self.lookup(names[0]).time
        with np.errstate(all="ignore"):
            term = self.term(tree)
        values = np.array(term.over(self.time))
        # a statistic of a moment without a value is refused where it is asked for (statistic.py)
        values[~np.isfinite(values)] = np.nan
        return Series(self.time, values, str(term.product))

    def term(self, node: ast.expr) -> Term:
        """The value of a tree whose words are known to be right."""
        match node:
            case ast.Constant(value=str() as name):
                return _quantity(name) if _QUANTITY.match(name) else self.channel(name)
            case ast.Name():
                return self.channel("time")
            case ast.UnaryOp(operand=operand):
                term = self.term(operand)
                return Term(-term.values, term.unit)
            case ast.BinOp(left=left, op=op, right=right):
                return self.binary(op, self.term(left), self.term(right))
            case ast.Call(func=ast.Name(id=function), args=arguments):
                return self.call(function, [self.term(argument) for argument in arguments])
        assert isinstance(node, ast.Constant)
        return Term(float(node.value), None)  # type: ignore[arg-type]

    def channel(self, name: str) -> Term:
        if name not in self.known:
            series = self.lookup(name)
            if not np.array_equal(self.time, series.time):
                raise ChannelError(f"'{name}' is sampled at other times than the rest")
            self.known[name] = Term(series.values, Product.parse(series.unit))
        return self.known[name]

    def binary(self, op: ast.operator, a: Term, b: Term) -> Term:
        if isinstance(op, ast.Add | ast.Sub):
            values = a.values + b.values if isinstance(op, ast.Add) else a.values - b.values
            return Term(values, self.reported(common_unit, a, b))
        if isinstance(op, ast.Mult):
            return Term(a.values * b.values, _product(a, b, 1))
        quotient = np.divide(a.values, b.values)
        quotient = np.where(np.isfinite(quotient), quotient, np.nan)
        if not np.any(np.isfinite(quotient)) and np.size(quotient):
            raise ChannelError(f"division by zero in '{self.expression}'")
        return Term(quotient, _product(a, b, -1))

    def call(self, function: str, terms: list[Term]) -> Term:
        result: Term = self.reported(module_of(FUNCTIONS, function).apply, self.time, *terms)
        return result

    def reported(self, act: Callable[P, R], *arguments: P.args, **words: P.kwargs) -> R:
        """The result of a step; raises its ChannelError with the expression in it."""
        try:
            return act(*arguments, **words)
        except ChannelError as error:
            location = f" in '{self.expression}'" if len(self.expression) <= SHOWN else ""
            raise type(error)(f"{error}{location}") from None


def _product(a: Term, b: Term, power: int) -> Product | None:
    if a.unit is None and b.unit is None:
        return None
    return a.product.times(b.product, power)


def _quantity(text: str) -> Term:
    """A number with a unit, in SI; raises ChannelError."""
    value, name = split_quantity(text)
    if not name:
        return Term(value, None)
    unit = parse_unit(name)
    return Term(value * unit.factor, Product.parse(describe(unit)))
