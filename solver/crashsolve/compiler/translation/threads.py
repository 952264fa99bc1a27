"""Words of memory that two threads share: what becomes of calls of atomic.py."""

from crashsolve.compiler.translation import arithmetic, memory
from crashsolve.compiler.translation.expressions import BUILTINS, Expressions
from crashsolve.compiler.translation.kinds import INT, NOTHING, Column, Untranslatable, Value
from crashsolve.foundation.atomic import give_way, load_acquire, store_release

DECLARED = ("declare i32 @sched_yield()",)


def _place(of: Expressions, given: list[Value]) -> str:
    words = given[0]
    if not isinstance(words.kind, Column) or words.kind.dtype.str != "<i8":
        raise Untranslatable("threads share columns of whole words")
    return memory.place_of_number(of.text, words, arithmetic.convert(of.text, given[1], INT))


def _load(of: Expressions, given: list[Value]) -> Value:
    place = _place(of, given)
    return Value(INT, (of.text.value(f"load atomic i64, ptr {place} acquire, align 8"),))


def _store(of: Expressions, given: list[Value]) -> Value:
    place = _place(of, given)
    number = arithmetic.convert(of.text, given[2], INT).words[0]
    of.text.put(f"store atomic i64 {number}, ptr {place} release, align 8")
    return Value(NOTHING)


def _give_way(of: Expressions, given: list[Value]) -> Value:
    of.text.put("call i32 @sched_yield()")
    return Value(NOTHING)


BUILTINS.update({load_acquire: _load, store_release: _store, give_way: _give_way})
