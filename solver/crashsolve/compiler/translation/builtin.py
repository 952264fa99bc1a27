"""Functions of Python that kernels may call."""

import math

from crashsolve.compiler.translation import arithmetic
from crashsolve.compiler.translation.expressions import BUILTINS, Builtin, Expressions
from crashsolve.compiler.translation.kinds import FLOAT, INT, Tuple, Untranslatable, Value

# LLVM's own, and those of the library of C
OWN = {
    math.sqrt: "sqrt",
    math.fabs: "fabs",
    math.exp: "exp",
    math.log: "log",
    math.sin: "sin",
    math.cos: "cos",
    math.copysign: "copysign",
}
OF_C = {
    math.tan: "tan",
    math.acos: "acos",
    math.asin: "asin",
    math.atan: "atan",
    math.atan2: "atan2",
    math.sinh: "sinh",
    math.cosh: "cosh",
    math.tanh: "tanh",
    math.expm1: "expm1",
    math.log1p: "log1p",
}
ROUNDING = {math.floor: "floor", math.ceil: "ceil"}
OF_TWO = ("copysign", "atan2")


def _count_of(name: str) -> int:
    return 2 if name in OF_TWO else 1


def declarations() -> list[str]:
    """Declarations of these functions in LLVM's language."""
    lines = [
        "declare double @llvm.pow.f64(double, double)",
        "declare i64 @llvm.fptosi.sat.i64.f64(double)",
    ]
    for name in (*OWN.values(), *ROUNDING.values()):
        given = ", ".join(["double"] * _count_of(name))
        lines.append(f"declare double @llvm.{name}.f64({given})")
    for name in OF_C.values():
        given = ", ".join(["double"] * _count_of(name))
        lines.append(f"declare double @{name}({given}) nounwind willreturn memory(none)")
    return lines


def _call(symbol: str, count: int) -> Builtin:
    def translate(of: Expressions, given: list[Value]) -> Value:
        if len(given) != count:
            name = symbol.removeprefix("llvm.").removesuffix(".f64")
            raise Untranslatable(f"{name} takes {count} argument{'s' * (count > 1)}")
        words = [arithmetic.convert(of.text, value, FLOAT).words[0] for value in given]
        listed = ", ".join(f"double {word}" for word in words)
        return Value(FLOAT, (of.text.value(f"call {of.text.flags} double @{symbol}({listed})"),))

    return translate


def _rounding(symbol: str) -> Builtin:
    whole = _call(symbol, 1)
    return lambda of, given: _to_integer(of, [whole(of, given)])


def _only(given: list[Value], name: str) -> Value:
    """The one argument. Raises Untranslatable."""
    if len(given) != 1:
        raise Untranslatable(f"{name} takes 1 argument")
    return given[0]


def _to_integer(of: Expressions, given: list[Value]) -> Value:
    return arithmetic.convert(of.text, _only(given, "int"), INT)


def _to_float(of: Expressions, given: list[Value]) -> Value:
    return arithmetic.convert(of.text, _only(given, "float"), FLOAT)


def _to_truth(of: Expressions, given: list[Value]) -> Value:
    return arithmetic.truth(of.text, _only(given, "bool"))


def _extreme(how: str) -> Builtin:
    """The first of the largest or smallest, as Python finds it."""

    def translate(of: Expressions, given: list[Value]) -> Value:
        is_tuple = len(given) == 1 and isinstance(given[0].kind, Tuple)
        values = given[0].items if is_tuple else given
        if len(values) < (1 if is_tuple else 2):
            raise Untranslatable("max and min take numbers, or a tuple of some")
        extreme = values[0]
        for value in values[1:]:
            a, b = arithmetic.common(of.text, extreme, value, INT)
            x, y, word = a.words[0], b.words[0], a.kind.words[0]
            order = f"fcmp {of.text.flags} o{how}" if a.kind == FLOAT else f"icmp s{how}"
            which = of.text.value(f"{order} {word} {y}, {x}")
            line = f"select i1 {which}, {word} {y}, {word} {x}"
            extreme = Value(a.kind, (of.text.value(line),))
        return extreme

    return translate


def _absolute(of: Expressions, given: list[Value]) -> Value:
    value = _only(given, "abs")
    if value.kind == FLOAT:
        return _call("llvm.fabs.f64", 1)(of, given)
    number = arithmetic.convert(of.text, value, INT)
    opposite = arithmetic.negative(of.text, number)
    word = number.words[0]
    below = of.text.value(f"icmp slt i64 {word}, 0")
    line = f"select i1 {below}, i64 {opposite.words[0]}, i64 {word}"
    return Value(INT, (of.text.value(line),))


BUILTINS.update({f: _call(f"llvm.{name}.f64", _count_of(name)) for f, name in OWN.items()})
BUILTINS.update({f: _call(name, _count_of(name)) for f, name in OF_C.items()})
BUILTINS.update({f: _rounding(f"llvm.{name}.f64") for f, name in ROUNDING.items()})
BUILTINS.update({int: _to_integer, float: _to_float, bool: _to_truth, abs: _absolute})
BUILTINS.update({max: _extreme("gt"), min: _extreme("lt")})
