"""Words of memory that threads share: translation of calls of atomic.py."""

from crashsolve.compiler.translation import arithmetic, memory
from crashsolve.compiler.translation.expressions import BUILTINS, Expressions
from crashsolve.compiler.translation.kinds import (
    BOOL,
    INT,
    NOTHING,
    Column,
    Untranslatable,
    Value,
)
from crashsolve.foundation.atomic import (
    add_release,
    load_acquire,
    offer_processor,
    replaced,
    sleep,
    store_release,
)

DECLARED = ("declare i32 @sched_yield()", "declare i32 @usleep(i32)")


def _position(of: Expressions, given: list[Value]) -> str:
    words = given[0]
    if not isinstance(words.kind, Column) or words.kind.dtype.str != "<i8":
        raise Untranslatable("threads share columns of whole words")
    return memory.slot_of_number(of.text, words, _whole(of, given[1]))


def _whole(of: Expressions, value: Value) -> Value:
    return arithmetic.convert(of.text, value, INT)


def _load(of: Expressions, given: list[Value]) -> Value:
    slot = _position(of, given)
    return Value(INT, (of.text.value(f"load atomic i64, ptr {slot} acquire, align 8"),))


def _store(of: Expressions, given: list[Value]) -> Value:
    slot, number = _position(of, given), _whole(of, given[2]).words[0]
    of.text.put(f"store atomic i64 {number}, ptr {slot} release, align 8")
    return Value(NOTHING)


def _add(of: Expressions, given: list[Value]) -> Value:
    slot, number = _position(of, given), _whole(of, given[2]).words[0]
    of.text.value(f"atomicrmw add ptr {slot}, i64 {number} release, align 8")
    return Value(NOTHING)


def _replace(of: Expressions, given: list[Value]) -> Value:
    slot = _position(of, given)
    old, new = (_whole(of, value).words[0] for value in given[2:])
    line = f"cmpxchg ptr {slot}, i64 {old}, i64 {new} acq_rel acquire, align 8"
    pair = of.text.value(line)
    return Value(BOOL, (of.text.value(f"extractvalue {{ i64, i1 }} {pair}, 1"),))


def _offer_processor(of: Expressions, given: list[Value]) -> Value:
    of.text.put("call i32 @sched_yield()")
    return Value(NOTHING)


def _sleep(of: Expressions, given: list[Value]) -> Value:
    time = of.text.value(f"trunc i64 {_whole(of, given[0]).words[0]} to i32")
    of.text.put(f"call i32 @usleep(i32 {time})")
    return Value(NOTHING)


BUILTINS.update({load_acquire: _load, store_release: _store, add_release: _add})
BUILTINS.update({replaced: _replace, offer_processor: _offer_processor, sleep: _sleep})
