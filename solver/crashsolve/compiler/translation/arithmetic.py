"""Operators on numbers, as in Python; division by zero gives infinity.

Numbers of different kinds are brought to the one that holds both. Integers are those of the
machine: 64 bits. See COMPILER.md.
"""

import ast
import math

from crashsolve.compiler.translation.kinds import (
    BOOL,
    FLOAT,
    INT,
    Column,
    Kind,
    Number,
    Tuple,
    Untranslatable,
    Value,
    float_word,
    tuple_of,
    unify,
    whole,
)
from crashsolve.compiler.translation.text import Text

FLOATS: dict[type[ast.operator], str] = {
    ast.Add: "fadd",
    ast.Sub: "fsub",
    ast.Mult: "fmul",
    ast.Div: "fdiv",
}
INTEGERS: dict[type[ast.operator], str] = {
    ast.Add: "add",
    ast.Sub: "sub",
    ast.Mult: "mul",
    ast.BitAnd: "and",
    ast.BitOr: "or",
    ast.BitXor: "xor",
    ast.LShift: "shl",
    ast.RShift: "ashr",
}
LOGIC = (ast.BitAnd, ast.BitOr, ast.BitXor)
# of integers, and of floating point numbers: all but `ne` are false with NaN
ORDERS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Eq: ("eq", "oeq"),
    ast.NotEq: ("ne", "une"),
    ast.Lt: ("slt", "olt"),
    ast.LtE: ("sle", "ole"),
    ast.Gt: ("sgt", "ogt"),
    ast.GtE: ("sge", "oge"),
}


def convert(text: Text, value: Value, kind: Kind) -> Value:
    """A value as one of a kind that can hold it, or a number as one of a column's kind."""
    if value.kind == kind:
        return value
    if isinstance(kind, Tuple):
        pairs = zip(value.items, kind.items, strict=True)
        return tuple_of([convert(text, item, wanted) for item, wanted in pairs], kind.names)
    if isinstance(kind, Column) and isinstance(value.kind, Column) and kind.count is None:
        return Value(kind, (value.words[0], str(value.kind.count)))
    if not isinstance(kind, Number) or not isinstance(value.kind, Number):
        raise Untranslatable(f"{value.kind} where {kind} is wanted")
    return _convert_number(text, value, kind)


def _convert_number(text: Text, value: Value, kind: Number) -> Value:
    known = value.constant
    if kind == FLOAT:
        if known is not None:
            return Value(FLOAT, (float_word(float(known)),), float(known))
        how = "uitofp i1" if value.kind == BOOL else "sitofp i64"
        return Value(FLOAT, (text.value(f"{how} {value.words[0]} to double"),))
    if kind == INT:
        if known is not None:
            if not math.isfinite(known):
                raise Untranslatable(f"{known} is no integer")
            return whole(int(known))
        if value.kind == BOOL:
            return Value(INT, (text.value(f"zext i1 {value.words[0]} to i64"),))
        return Value(INT, (_whole_of(text, value.words[0]),))
    return truth(text, value)


def _whole_of(text: Text, word: str) -> str:
    """The integer of a floating point number: 0 of NaN, the nearest one beyond 64 bits."""
    whole = text.value(f"call i64 @llvm.fptosi.sat.i64.f64(double {word})")
    if text.site is not None:
        size = text.value(f"call double @llvm.fabs.f64(double {word})")
        held = text.value(f"fcmp olt double {size}, {float_word(2.0**63)}")
        text.test(held, whole, str(2**63 - 1))
    return whole


def truth(text: Text, value: Value) -> Value:
    """Whether a number is not zero."""
    if value.kind == BOOL:
        return value
    if value.constant is not None:
        return Value(BOOL, ("true" if value.constant else "false",), bool(value.constant))
    if value.kind == INT:
        return Value(BOOL, (text.value(f"icmp ne i64 {value.words[0]}, 0"),))
    if value.kind == FLOAT:
        zero = float_word(0.0)
        return Value(BOOL, (text.value(f"fcmp {text.flags} une double {value.words[0]}, {zero}"),))
    raise Untranslatable("only a number can be a condition")


def common(text: Text, one: Value, other: Value, at_least: Number = BOOL) -> tuple[Value, Value]:
    """Two numbers as of one kind."""
    kind = unify(one.kind, other.kind)
    if not isinstance(kind, Number):
        raise Untranslatable("this is for numbers only")
    kind = max(kind, at_least, key=lambda kind: kind.rank)
    return convert(text, one, kind), convert(text, other, kind)


def compare(text: Text, how: ast.cmpop, one: Value, other: Value) -> Value:
    """one < other, and so on."""
    if type(how) not in ORDERS:
        raise Untranslatable(f"kernels do not compare with {type(how).__name__}")
    a, b = common(text, one, other, INT)
    integer, real = ORDERS[type(how)]
    words = f"{a.words[0]}, {b.words[0]}"
    if a.kind == FLOAT:
        return Value(BOOL, (text.value(f"fcmp {text.flags} {real} double {words}"),))
    return Value(BOOL, (text.value(f"icmp {integer} i64 {words}"),))


def operate(text: Text, how: ast.operator, one: Value, other: Value) -> Value:
    """one + other, and so on."""
    if isinstance(how, ast.Pow):
        return power(text, one, other)
    if isinstance(how, LOGIC) and one.kind == other.kind == BOOL:
        words = f"{one.words[0]}, {other.words[0]}"
        return Value(BOOL, (text.value(f"{INTEGERS[type(how)]} i1 {words}"),))
    a, b = common(text, one, other, FLOAT if isinstance(how, ast.Div) else INT)
    if isinstance(how, (ast.FloorDiv, ast.Mod)):
        return _divide(text, how, a, b)
    if a.kind == INT and isinstance(how, (ast.LShift, ast.RShift)):
        return _shift(text, how, a, b)
    words = f"{a.words[0]}, {b.words[0]}"
    if a.kind == FLOAT and type(how) in FLOATS:
        return Value(FLOAT, (text.value(f"{FLOATS[type(how)]} {text.flags} double {words}"),))
    if a.kind == INT and type(how) in INTEGERS:
        return Value(INT, (text.value(f"{INTEGERS[type(how)]} i64 {words}"),))
    raise Untranslatable(f"kernels have no {type(how).__name__} of such numbers")


def _shift(text: Text, how: ast.operator, a: Value, b: Value) -> Value:
    """Bits to the left or right by any count; those beyond 64 are lost. Constants: 0 to 63."""
    count, known = b.words[0], b.constant
    if known is not None and not 0 <= known < 64:
        raise Untranslatable(f"integers have 64 bits: no shift by {known}")
    word = INTEGERS[type(how)]
    if known is not None:
        return Value(INT, (text.value(f"{word} i64 {a.words[0]}, {count}"),))
    fits = text.value(f"icmp ult i64 {count}, 64")
    text.test(fits, count, "64")
    few = text.value(f"select i1 {fits}, i64 {count}, i64 63")
    shifted = text.value(f"{word} i64 {a.words[0]}, {few}")
    if isinstance(how, ast.RShift):
        return Value(INT, (shifted,))
    return Value(INT, (text.value(f"select i1 {fits}, i64 {shifted}, i64 0"),))


def _divide(text: Text, how: ast.operator, a: Value, b: Value) -> Value:
    """Quotient rounded down, or the remainder with the sign of the divisor; by zero both are 0."""
    if a.kind != INT:
        raise Untranslatable("// and % are for integers")
    x, y = a.words[0], b.words[0]
    if b.constant == 0:
        raise Untranslatable("division of an integer by zero")
    if b.constant is None:
        by_zero = text.value(f"icmp eq i64 {y}, 0")
        if text.site is not None:
            text.test(text.value(f"icmp ne i64 {y}, 0"), x, y)
        y = text.value(f"select i1 {by_zero}, i64 1, i64 {y}")
        x = text.value(f"select i1 {by_zero}, i64 0, i64 {x}")
    if b.constant in (None, -1):
        # the machine stops at -2**63 // -1
        is_minus = text.value(f"icmp eq i64 {y}, -1")
        turned = text.value(f"sub i64 0, {x}")
        x = text.value(f"select i1 {is_minus}, i64 {turned}, i64 {x}")
        y = text.value(f"select i1 {is_minus}, i64 1, i64 {y}")
    rest = text.value(f"srem i64 {x}, {y}")
    uneven = text.value(f"icmp ne i64 {rest}, 0")
    signs = text.value(f"xor i64 {rest}, {y}")
    opposed = text.value(f"icmp slt i64 {signs}, 0")
    below = text.value(f"and i1 {uneven}, {opposed}")
    if isinstance(how, ast.Mod):
        more = text.value(f"add i64 {rest}, {y}")
        return Value(INT, (text.value(f"select i1 {below}, i64 {more}, i64 {rest}"),))
    quotient = text.value(f"sdiv i64 {x}, {y}")
    less = text.value(f"sub i64 {quotient}, 1")
    return Value(INT, (text.value(f"select i1 {below}, i64 {less}, i64 {quotient}"),))


def power(text: Text, base: Value, exponent: Value) -> Value:
    """base ** exponent; by multiplication where the exponent is a whole number written there."""
    n = exponent.constant
    if not isinstance(n, int) or n < 0:
        a, b = convert(text, base, FLOAT), convert(text, exponent, FLOAT)
        words = f"double {a.words[0]}, double {b.words[0]}"
        return Value(FLOAT, (text.value(f"call {text.flags} double @llvm.pow.f64({words})"),))
    result, square = Value(INT, ("1",), 1), base
    while n:
        if n & 1:
            result = square if result.constant == 1 else operate(text, ast.Mult(), result, square)
        n >>= 1
        if n:
            square = operate(text, ast.Mult(), square, square)
    return result


def negative(text: Text, value: Value) -> Value:
    """-value."""
    if value.kind == FLOAT:
        if value.constant is not None:
            return Value(FLOAT, (float_word(-value.constant),), -value.constant)
        return Value(FLOAT, (text.value(f"fneg {text.flags} double {value.words[0]}"),))
    number = convert(text, value, INT)
    if number.constant is not None:
        return whole(-number.constant)
    return Value(INT, (text.value(f"sub i64 0, {number.words[0]}"),))


def opposite(text: Text, value: Value) -> Value:
    """not value."""
    whether = truth(text, value)
    if whether.constant is not None:
        return Value(BOOL, ("false" if whether.constant else "true",), not whether.constant)
    return Value(BOOL, (text.value(f"xor i1 {whether.words[0]}, true"),))
