"""Kinds of values in kernels, and values of these kinds.

    number, row, column, table, all tables of a scene, tuple, None

A value is the words of LLVM that hold it: one for a number, address and lengths for a table, those
of all items for a tuple. What Python knows before the run (modules, functions, global constants)
is a value without words.
"""

import struct
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Integral
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from crashsolve.compiler.table import Slot


class Untranslatable(Exception):
    """A construct that the language of kernels does not have."""


@dataclass(frozen=True)
class Kind:
    """A kind of value; `words` are the LLVM types of its parts."""

    @property
    def words(self) -> tuple[str, ...]:
        return ("ptr",)


@dataclass(frozen=True)
class Number(Kind):
    """A number; those of higher rank hold those of lower."""

    word: str
    rank: int

    @property
    def words(self) -> tuple[str, ...]:
        return (self.word,)


BOOL, INT, FLOAT = Number("i1", 0), Number("i64", 1), Number("double", 2)


@dataclass(frozen=True)
class Nothing(Kind):
    """None."""

    @property
    def words(self) -> tuple[str, ...]:
        return ()


NOTHING = Nothing()


@dataclass(frozen=True)
class Known(Kind):
    """A value known before the run: a module, a function, a class."""

    what: object

    @property
    def words(self) -> tuple[str, ...]:
        return ()


@dataclass(frozen=True)
class Row(Kind):
    """One record: the address of its first byte."""

    dtype: np.dtype


@dataclass(frozen=True)
class Column(Kind):
    """Several numbers one after the other: the address of the first, and how many.

    `count` is known for a column of a row; otherwise a second word holds it.
    """

    dtype: np.dtype
    count: int | None = None

    @property
    def words(self) -> tuple[str, ...]:
        return ("ptr",) if self.count is not None else ("ptr", "i64")


@dataclass(frozen=True)
class Table(Kind):
    """Rows of one layout, in one or two dimensions: address and lengths."""

    dtype: np.dtype
    ndim: int

    @property
    def words(self) -> tuple[str, ...]:
        return ("ptr", *["i64"] * self.ndim)


@dataclass(frozen=True, eq=False)
class Tables(Kind):
    """All tables of a scene, by name in their order: where addresses and lengths lie."""

    kinds: dict[str, Kind]


def tables_of(slots: dict[str, Slot]) -> Tables:
    """The kind of all tables of a scene."""
    kinds: dict[str, Kind] = {}
    for name, (dtype, ndim) in slots.items():
        kinds[name] = Table(dtype, ndim) if dtype.names else Column(dtype)
    return Tables(kinds)


@dataclass(frozen=True)
class Tuple(Kind):
    """Values of any kinds; with names those of a NamedTuple."""

    items: tuple[Kind, ...]
    names: tuple[str, ...] = ()

    @cached_property
    def _words(self) -> tuple[str, ...]:
        return tuple(word for item in self.items for word in item.words)

    @property
    def words(self) -> tuple[str, ...]:
        return self._words


@dataclass(frozen=True)
class Value:
    """A value of a kind; `constant` is its value where Python knows it before the run."""

    kind: Kind
    words: tuple[str, ...] = ()
    constant: Any = field(default=None, compare=False)

    @property
    def items(self) -> list["Value"]:
        """The values in a tuple. Raises Untranslatable."""
        if not isinstance(self.kind, Tuple):
            raise Untranslatable("this is no tuple")
        parts, at = [], 0
        constants = self.constant or [None] * len(self.kind.items)
        for kind, constant in zip(self.kind.items, constants, strict=True):
            count = len(kind.words)
            parts.append(Value(kind, self.words[at : at + count], constant))
            at += count
        return parts


def tuple_of(values: list[Value], names: tuple[str, ...] = ()) -> Value:
    """A tuple of values."""
    kind = Tuple(tuple(value.kind for value in values), names)
    constants = [value.constant for value in values]
    known = tuple(constants) if all(c is not None for c in constants) else None
    return Value(kind, tuple(word for value in values for word in value.words), known)


def known(thing: object) -> Value:
    """The value of a global name. Raises Untranslatable."""
    if thing is None:
        return Value(NOTHING)
    if isinstance(thing, (bool, np.bool_)):
        return Value(BOOL, ("true" if thing else "false",), bool(thing))
    if isinstance(thing, Integral):
        return whole(int(thing))
    if isinstance(thing, float):
        return Value(FLOAT, (float_word(thing),), float(thing))
    if isinstance(thing, tuple):
        return tuple_of([known(item) for item in thing], getattr(thing, "_fields", ()))
    if isinstance(thing, (ModuleType, FunctionType, type)) or callable(thing):
        return Value(Known(thing))
    raise Untranslatable(f"a kernel cannot use {thing!r}")


def whole(number: int) -> Value:
    """A constant integer. Raises Untranslatable beyond 64 bits."""
    if not -(2**63) <= number < 2**63:
        raise Untranslatable(f"{number} is beyond 64 bits")
    return Value(INT, (str(number),), number)


def float_word(number: float) -> str:
    """A number as LLVM reads it, to the last bit."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', number))[0]:016X}"


def unify(one: Kind, other: Kind) -> Kind | None:
    """The kind that can hold both, or None."""
    if one == other:
        return one
    if isinstance(one, Number) and isinstance(other, Number):
        return max(one, other, key=lambda kind: kind.rank)
    if isinstance(one, Column) and isinstance(other, Column) and one.dtype == other.dtype:
        return Column(one.dtype)
    if isinstance(one, Tuple) and isinstance(other, Tuple) and len(one.items) == len(other.items):
        items = [unify(a, b) for a, b in zip(one.items, other.items, strict=True)]
        if all(item is not None for item in items):
            return Tuple(tuple(item for item in items if item is not None), one.names)
    return None
