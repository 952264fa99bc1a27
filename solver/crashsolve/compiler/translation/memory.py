"""Numbers to and from tables, rows and columns."""

import math
from typing import Any

import numpy as np

from crashsolve.compiler.table import WORDS
from crashsolve.compiler.translation.arithmetic import convert
from crashsolve.compiler.translation.kinds import (
    BOOL,
    FLOAT,
    INT,
    Column,
    Number,
    Row,
    Table,
    Tables,
    Untranslatable,
    Value,
)
from crashsolve.compiler.translation.text import Text


def kind_in(dtype: np.dtype) -> tuple[Number, str]:
    """The kind that a kernel sees, and LLVM's type in memory. Raises Untranslatable."""
    if dtype.kind == "f" and dtype.itemsize == 8:
        return FLOAT, "double"
    if dtype.kind == "b":
        return BOOL, "i8"
    if dtype.kind == "i":
        return INT, f"i{8 * dtype.itemsize}"
    raise Untranslatable(f"kernels know no numbers of type {dtype}")


def read_number(text: Text, slot: str, dtype: np.dtype) -> Value:
    """The number that lies there."""
    kind, stored = kind_in(dtype)
    word = text.load(stored, slot)
    if kind == BOOL:
        word = text.value(f"trunc i8 {word} to i1")
    elif kind == INT and stored != "i64":
        word = text.value(f"sext {stored} {word} to i64")
    return Value(kind, (word,))


def write_number(text: Text, slot: str, dtype: np.dtype, value: Value) -> None:
    """Put a number there."""
    kind, stored = kind_in(dtype)
    known = value.constant
    if kind == INT and isinstance(known, int):
        limit = 2 ** (8 * dtype.itemsize - 1)
        if not -limit <= known < limit:
            raise Untranslatable(f"a column of {8 * dtype.itemsize} bits cannot hold {known}")
    (word,) = convert(text, value, kind).words
    if kind == BOOL:
        word = text.value(f"zext i1 {word} to i8")
    elif kind == INT and stored != "i64":
        number = word
        word = text.value(f"trunc i64 {number} to {stored}")
        if text.site is not None:
            back = text.value(f"sext {stored} {word} to i64")
            same = text.value(f"icmp eq i64 {back}, {number}")
            text.test(same, number, str(2 ** (8 * dtype.itemsize - 1)))
    text.store(stored, word, slot)


def slot_of_column(text: Text, row: Value, name: str) -> tuple[str, np.dtype, int]:
    """Address of a column of a row, type of its numbers, and their count; 0 for a single one."""
    assert isinstance(row.kind, Row)
    fields: Any = row.kind.dtype.fields or {}
    if name not in fields:
        known = ", ".join(fields) or "none"
        raise Untranslatable(f"these rows have no column `{name}`, but {known}")
    dtype, offset = fields[name][:2]
    slot = text.at("i8", row.words[0], str(offset))
    return slot, dtype.base, math.prod(dtype.shape) if dtype.shape else 0


def read_column(text: Text, row: Value, name: str) -> Value:
    """row.name: a number, a column of numbers, or a row within the row."""
    slot, dtype, several = slot_of_column(text, row, name)
    if dtype.names:
        return Value(Row(dtype), (slot,))
    if not several:
        return read_number(text, slot, dtype)
    return Value(Column(dtype, several), (slot,))


def slot_of_number(text: Text, column: Value, index: Value) -> str:
    """Address of column[index]. Raises Untranslatable for a constant that it does not have."""
    kind = column.kind
    assert isinstance(kind, Column)
    at = index.constant
    if at is not None and (at < 0 or (kind.count is not None and at >= kind.count)):
        held = "" if kind.count is None else f" of {kind.count} numbers"
        raise Untranslatable(f"a column{held} has no item {at}: kernels count from 0")
    slot = text.at(kind_in(kind.dtype)[1], column.words[0], index.words[0])
    if at is not None and kind.count is not None:
        return slot
    count = column.words[1] if kind.count is None else str(kind.count)
    return text.checked(slot, index.words[0], count)


def row_of(text: Text, table: Value, indices: list[Value]) -> Value:
    """table[i] or table[i, j]; of a table of two dimensions table[i] is one of rows."""
    kind, data = table.kind, table.words[0]
    assert isinstance(kind, Table)
    for index in indices:
        if index.constant is not None and index.constant < 0:
            raise Untranslatable(f"a table has no row {index.constant}: kernels count from 0")
    count = indices[0].words[0]
    if kind.ndim == 2:
        count = text.value(f"mul i64 {count}, {table.words[2]}")
    if len(indices) == 2:
        count = text.value(f"add i64 {count}, {indices[1].words[0]}")
    offset = text.value(f"mul i64 {count}, {kind.dtype.itemsize}")
    slot = text.at("i8", data, offset)
    for index, limit in zip(indices, table.words[1:], strict=False):
        slot = text.checked(slot, index.words[0], limit)
    if len(indices) == kind.ndim:
        return Value(Row(kind.dtype), (slot,))
    if len(indices) > kind.ndim:
        raise Untranslatable("this table has one dimension")
    return Value(Table(kind.dtype, 1), (slot, table.words[2]))


def table_of(text: Text, tables: Value, name: str) -> Value:
    """tables.name."""
    assert isinstance(tables.kind, Tables)
    if name not in tables.kind.kinds:
        raise Untranslatable(f"the scene has no table `{name}`")
    kind, first = tables.kind.kinds[name], WORDS * list(tables.kind.kinds).index(name)
    words = []
    for k, word in enumerate(kind.words):
        slot = text.at("i64", tables.words[0], str(first + k))
        words.append(text.load(word, slot))
    return Value(kind, tuple(words))
