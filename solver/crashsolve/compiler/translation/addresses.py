"""Memory by its address: translation of calls of foundation/addresses.py."""

from crashsolve.compiler.translation import arithmetic
from crashsolve.compiler.translation.expressions import BUILTINS, Expressions
from crashsolve.compiler.translation.kinds import BOOL, FLOAT, INT, NOTHING, Number, Value
from crashsolve.foundation.addresses import call_step, copy_bytes, number_at, ticks

DECLARED = (
    "declare i64 @llvm.readcyclecounter()",
    "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)",
)


def _word(of: Expressions, value: Value, kind: Number) -> str:
    return arithmetic.convert(of.text, value, kind).words[0]


def _pointer(of: Expressions, value: Value) -> str:
    return of.text.value(f"inttoptr i64 {_word(of, value, INT)} to ptr")


def _call_step(of: Expressions, given: list[Value]) -> Value:
    step, tables = _pointer(of, given[0]), _pointer(of, given[3])
    number, flag = _word(of, given[1], FLOAT), _word(of, given[2], BOOL)
    of.text.put(f"call void {step}(double {number}, i1 zeroext {flag}, ptr {tables})")
    return Value(NOTHING)


def _copy_bytes(of: Expressions, given: list[Value]) -> Value:
    target, source = _pointer(of, given[0]), _pointer(of, given[1])
    count = _word(of, given[2], INT)
    of.text.put(
        f"call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {count}, i1 false)"
    )
    return Value(NOTHING)


def _number_at(of: Expressions, given: list[Value]) -> Value:
    return Value(FLOAT, (of.text.load("double", _pointer(of, given[0])),))


def _ticks(of: Expressions, given: list[Value]) -> Value:
    return Value(INT, (of.text.value("call i64 @llvm.readcyclecounter()"),))


BUILTINS.update({call_step: _call_step, copy_bytes: _copy_bytes})
BUILTINS.update({number_at: _number_at, ticks: _ticks})
