"""What the compiler must know of words shared by threads; imported only where they are compiled."""

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, type_callable

from crashsolve.foundation.atomic import give_way, load_acquire, store_release
from crashsolve.foundation.table_types import WORD, Column, number_place

ALIGNED = 8


@type_callable(load_acquire)
def _type_load(context: Any) -> Any:
    def typer(words: Any, k: Any) -> Any:
        is_word = isinstance(words, Column) and words.number == types.int64
        return words.number if is_word and isinstance(k, types.Integer) else None

    return typer


@type_callable(store_release)
def _type_store(context: Any) -> Any:
    def typer(words: Any, k: Any, number: Any) -> Any:
        is_word = isinstance(words, Column) and words.number == types.int64
        is_sound = is_word and isinstance(number, types.Integer)
        return signature(types.none, words, k, types.int64) if is_sound else None

    return typer


@type_callable(give_way)
def _type_give_way(context: Any) -> Any:
    return lambda: types.none


@lower_builtin(load_acquire, Column, types.Integer)
def _load(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load_atomic(number_place(context, builder, sig, args), "acquire", ALIGNED)


@lower_builtin(store_release, Column, types.Integer, types.Any)
def _store(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    place = number_place(context, builder, sig, args)
    builder.store_atomic(args[2], place, "release", ALIGNED)
    return context.get_dummy_value()


@lower_builtin(give_way)
def _give_way(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    kind = ir.FunctionType(ir.IntType(32), [])
    name = "sched_yield"
    call = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
    builder.call(call, [])
    return context.get_dummy_value()


assert WORD.width == 8 * ALIGNED
