"""Arithmetic in decks: `${speed/3.6}` evaluated without running any code of the deck."""

import ast
import keyword
import math
import operator
import re
import warnings
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TypeVar

from crashsolve.channels.units import PURE, SI, Unit
from crashsolve.deck.words import choices

MAX_LENGTH = 500
# of the exponent of a unit, as in N/m^1.5
MAX_ROOT = 12
# functions whose value is an angle in radians, in any units of the file
ANGLES = ("asin", "acos", "atan", "atan2")
# functions whose value has the unit that all their arguments share
OF_ONE_UNIT = ("abs", "min", "max", "within")
U = TypeVar("U")


def within(value: float, low: float, high: float) -> float:
    """The value itself. Raises ValueError unless low <= value <= high."""
    if not low <= value <= high:
        raise ValueError(f"{value:g} is not within {low:g} and {high:g}")
    return value


FUNCTIONS: dict[str, Callable[..., float]] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "atan2": math.atan2,
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "abs": abs,
    "min": min,
    "max": max,
    "within": within,
    "deg": math.degrees,
    "rad": math.radians,
}
CONSTANTS = {"pi": math.pi}
OPERATORS: dict[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}


# stands behind a parameter's name that Python keeps for itself: lambda, yield, in
OWN = "\u02b9"
# as in 2 pi or 65 deg
_TWO_TERMS = r"[\d.]\s+[A-Za-z]"
_RESERVED = rf"(?<![\w.])({'|'.join(keyword.kwlist)})(?!\w)"


class ExpressionError(Exception):
    """An expression that cannot be evaluated."""

    def __init__(self, message: str, advice: str = "") -> None:
        self.message = message
        self.advice = advice
        super().__init__(message, advice)


class _NoUnit(Exception):
    """Terms of a sum have different units."""


class Expression:
    """A parsed expression; `names` are the parameters that it needs."""

    def __init__(self, text: str) -> None:
        self.text = text.strip()
        if len(self.text) > MAX_LENGTH:
            raise ExpressionError(f"the expression is longer than {MAX_LENGTH} letters")
        try:
            with warnings.catch_warnings(action="ignore"):
                self.written = re.sub(_RESERVED, rf"\1{OWN}", self.text)
                self.root = ast.parse(self.written, mode="eval").body
        except (SyntaxError, ValueError, MemoryError, RecursionError):
            advice = "; products have a *, and a number with a unit is a parameter of its own"
            advice *= bool(re.search(_TWO_TERMS, self.text))
            raise ExpressionError(f"cannot read the expression '{self.text}'{advice}") from None
        nodes = list(ast.walk(self.root))
        for node in nodes:
            if isinstance(node, ast.Name):
                # as they were written
                node.id = node.id.removesuffix(OWN)
        functions = [node.func for node in nodes if isinstance(node, ast.Call)]
        called = set(map(id, functions))
        self.has_angles = any(isinstance(f, ast.Name) and f.id in ANGLES for f in functions)
        names = {n.id for n in nodes if isinstance(n, ast.Name) and id(n) not in called}
        self.names = sorted(names - CONSTANTS.keys())

    def value(self, names: Mapping[str, float]) -> float:
        """The value of the expression; raises ExpressionError."""
        try:
            result = float(self._evaluate(self.root, names))
        except ZeroDivisionError:
            raise ExpressionError(f"'{self.text}' divides by zero") from None
        except (OverflowError, RecursionError):
            raise ExpressionError(f"'{self.text}' is too large") from None
        except (ValueError, TypeError) as error:
            raise ExpressionError(f"'{self.text}': {error}") from None
        if not math.isfinite(result):
            raise ExpressionError(f"'{self.text}' is too large")
        return result

    def unit(self, units: Mapping[str, U | None]) -> U | None:
        """The unit of a lone name, or of sums of names; None of others, which may have any.

        The numbers of a product or a power may have units that are not written in the deck.
        """
        return self._unit(self.root, units)

    def derived_unit(self, units: Mapping[str, Unit]) -> Unit | None:
        """The unit where bare numbers and names without one are pure; None without any.

        So it is where terms of a sum have different units, and where a power is no fraction.
        """
        try:
            return self._derived(self.root, units)
        except (_NoUnit, ExpressionError, ArithmeticError, ValueError):
            return None

    def _derived(self, node: ast.AST, units: Mapping[str, Unit]) -> Unit:
        match node:
            case ast.Name(id=name):
                return units.get(name, PURE)
            case ast.UnaryOp(operand=operand):
                return self._derived(operand, units)
            case ast.BinOp(op=ast.Mult(), left=left, right=right):
                return self._derived(left, units) * self._derived(right, units)
            case ast.BinOp(op=ast.Div(), left=left, right=right):
                return self._derived(left, units) * self._derived(right, units) ** Fraction(-1)
            case ast.BinOp(op=ast.Pow(), left=left, right=right):
                base = self._derived(left, units)
                if base.exponents == PURE.exponents:
                    return PURE
                return base ** Fraction(self._evaluate(right, {})).limit_denominator(MAX_ROOT)
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
                return self._derived(argument, units) ** Fraction(1, 2)
            case ast.Call(func=ast.Name(id=name)) if name in ANGLES:
                return SI["angle"]
            case ast.BinOp(left=left, right=right):
                return self._common([left, right], units)
            case ast.Call(func=ast.Name(id=name), args=parts) if name in OF_ONE_UNIT:
                return self._common(parts, units)
        return PURE

    def _common(self, parts: list[ast.expr], units: Mapping[str, Unit]) -> Unit:
        """The unit of all terms. Raises _NoUnit where they differ."""
        derived = [self._derived(part, units) for part in parts]
        if any(unit.exponents != derived[0].exponents for unit in derived):
            raise _NoUnit
        return derived[0]

    def _unit(self, node: ast.AST, units: Mapping[str, U | None]) -> U | None:
        match node:
            case ast.Name(id=name):
                return units.get(name)
            case ast.UnaryOp(operand=operand):
                return self._unit(operand, units)
            case ast.BinOp(op=ast.Add() | ast.Sub(), left=left, right=right):
                parts = [left, right]
            case ast.Call(func=ast.Name(id=name), args=parts) if name in OF_ONE_UNIT:
                pass
            case _:
                return None
        units_of_parts = [unit for part in parts if (unit := self._unit(part, units)) is not None]
        # the same for all of them
        return (
            units_of_parts[0]
            if units_of_parts and all(unit == units_of_parts[0] for unit in units_of_parts)
            else None
        )

    def _evaluate(self, node: ast.AST, names: Mapping[str, float]) -> float:
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return float(number)
            case ast.Name(id=name) if name in CONSTANTS:
                return CONSTANTS[name]
            case ast.Name(id=name) if name in names:
                return names[name]
            case ast.Name(id=name):
                raise ExpressionError(
                    f"unknown parameter '{name}'", choices(name, names, "parameters")
                )
            case ast.BinOp(op=op, left=left, right=right) if type(op) in OPERATORS:
                a, b = self._evaluate(left, names), self._evaluate(right, names)
                return OPERATORS[type(op)](a, b)
            case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
                return OPERATORS[type(op)](self._evaluate(operand, names))
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                return self._function(name)(*(self._evaluate(arg, names) for arg in args))
        part = ast.get_source_segment(self.written, node) if hasattr(node, "lineno") else None
        advice = "an expression has numbers, parameters, + - * / ** and functions"
        message = (part or self.text).replace(OWN, "")
        raise ExpressionError(f"'{message}' cannot stand in an expression", advice)

    def _function(self, name: str) -> Callable[..., float]:
        if name not in FUNCTIONS:
            advice = choices(name, FUNCTIONS, "functions")
            raise ExpressionError(f"unknown function '{name}'", advice)
        return FUNCTIONS[name]
