"""What the compiler must know of tables; imported only where something is compiled.

    table[i]  a row        row.name  a number, or a column of numbers        column[k]  a number

Numba's own arrays of records do the same with seven words, a reference count and a check for
negative indices each, which doubles the time to compile a scene. A kernel does not know the
difference: run as plain Python, or called by a test, it works on numpy's arrays.
"""

import hashlib
import operator
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AttributeTemplate, signature
from numba.extending import (
    infer_getattr,
    lower_builtin,
    lower_getattr_generic,
    lower_setattr_generic,
    models,
    register_model,
    type_callable,
)
from numba.np.numpy_support import from_dtype

from crashsolve.foundation.table import WORDS, Place

POINTER = ir.IntType(8).as_pointer()
WORD = ir.IntType(64)


class Row(types.Type):
    """One record: a pointer to its first byte."""

    def __init__(self, record: types.Record) -> None:
        self.record = record
        self.digest = hashlib.sha1(str(record).encode()).hexdigest()[:12]
        super().__init__(name=f"Row({self.digest})")

    def column(self, name: str) -> Any:
        """Type of a column, or None."""
        if name not in self.record.fields:
            return None
        kind = self.record.typeof(name)
        return Column(kind.dtype) if isinstance(kind, types.NestedArray) else kind


class Column(types.Type):
    """A column of several numbers: a pointer to the first."""

    def __init__(self, number: Any) -> None:
        self.number = number
        super().__init__(name=f"Column({number})")


class Table(types.Type):
    """Rows of one layout, in one or two dimensions."""

    def __init__(self, row: Row, ndim: int) -> None:
        self.row, self.ndim = row, ndim
        super().__init__(name=f"Table({row.digest}, {ndim})")


@register_model(Row)
@register_model(Column)
class _PointerModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, POINTER)


@register_model(Table)
class _TableModel(models.StructModel):
    def __init__(self, manager: Any, kind: Table) -> None:
        members = [("data", types.voidptr), ("shape", types.UniTuple(types.intp, kind.ndim))]
        super().__init__(manager, kind, members)


@infer_getattr
class _RowColumns(AttributeTemplate):
    key = Row

    def generic_resolve(self, value: Any, attr: Any) -> Any:  # type: ignore[override]
        return value.column(attr)


@infer_getattr
class _TableShape(AttributeTemplate):
    key = Table

    def resolve_shape(self, table: Table) -> Any:
        return types.UniTuple(types.intp, table.ndim)


def _at(builder: Any, pointer: Any, offset: Any, kind: Any = None) -> Any:
    """The address `offset` bytes on, as a pointer to `kind`."""
    address = builder.gep(pointer, [offset], inbounds=True)
    return address if kind is None else builder.bitcast(address, kind.as_pointer())


@lower_getattr_generic(Row)
def _read_column(context: Any, builder: Any, kind: Row, value: Any, name: str) -> Any:
    column, offset = kind.column(name), WORD(kind.record.offset(name))
    if isinstance(column, Column):
        return _at(builder, value, offset)
    return builder.load(_at(builder, value, offset, context.get_value_type(column)))


@lower_setattr_generic(Row)
def _write_column(context: Any, builder: Any, sig: Any, args: Any, name: str) -> Any:
    kind, given = sig.args
    column = kind.column(name)
    number = context.cast(builder, args[1], given, column)
    place = _at(builder, args[0], WORD(kind.record.offset(name)), context.get_value_type(column))
    builder.store(number, place)


@type_callable(operator.getitem)
def _type_getitem(context: Any) -> Any:
    def typer(target: Any, index: Any) -> Any:
        if isinstance(target, Column) and isinstance(index, types.Integer):
            return target.number
        if isinstance(target, Table):
            whole = target.ndim == 1 or isinstance(index, types.BaseTuple)
            return target.row if whole else Table(target.row, 1)
        return None

    return typer


@type_callable(operator.setitem)
def _type_setitem(context: Any) -> Any:
    def typer(target: Any, index: Any, value: Any) -> Any:
        if isinstance(target, Column) and isinstance(index, types.Integer):
            return signature(types.none, target, index, target.number)
        return None

    return typer


def number_place(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    kind = context.get_value_type(sig.args[0].number).as_pointer()
    index = context.cast(builder, args[1], sig.args[1], types.intp)
    return builder.gep(builder.bitcast(args[0], kind), [index], inbounds=True)


@lower_builtin(operator.getitem, Column, types.Integer)
def _read_number(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(number_place(context, builder, sig, args))


@lower_builtin(operator.setitem, Column, types.Integer, types.Any)
def _write_number(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    number = context.cast(builder, args[2], sig.args[2], sig.args[0].number)
    builder.store(number, number_place(context, builder, sig, args))


@lower_builtin(operator.getitem, Table, types.Integer)
def _read_row(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    """table[i], a row; of a table of two dimensions the i-th table."""
    kind = sig.args[0]
    table = cgutils.create_struct_proxy(kind)(context, builder, value=args[0])
    count = context.cast(builder, args[1], sig.args[1], types.intp)
    if kind.ndim == 1:
        return _row_at(builder, kind, table, count)
    part = cgutils.create_struct_proxy(sig.return_type)(context, builder)
    length = builder.extract_value(table.shape, 1)
    part.data = _row_at(builder, kind, table, builder.mul(count, length))
    part.shape = cgutils.pack_array(builder, [length])
    return part._getvalue()


@lower_builtin(operator.getitem, Table, types.BaseTuple)
def _read_row_of_part(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    """table[i, j]."""
    table = cgutils.create_struct_proxy(sig.args[0])(context, builder, value=args[0])
    i, j = (
        context.cast(builder, builder.extract_value(args[1], k), sig.args[1].types[k], types.intp)
        for k in range(2)
    )
    count = builder.add(builder.mul(i, builder.extract_value(table.shape, 1)), j)
    return _row_at(builder, sig.args[0], table, count)


def _row_at(builder: Any, kind: Table, table: Any, count: Any) -> Any:
    return _at(builder, table.data, builder.mul(count, WORD(kind.row.record.size)))


@lower_getattr_generic(Table)
def _read_shape(context: Any, builder: Any, kind: Table, value: Any, name: str) -> Any:
    return cgutils.create_struct_proxy(kind)(context, builder, value=value).shape


class TablesKind(types.Type):
    """Kinds of tables by their names: a pointer to where each begins and how long it is."""

    def __init__(self, layout: str, places: dict[str, Place]) -> None:
        self.kinds = {name: _kind_of(place) for name, place in places.items()}
        self.order = {name: k for k, name in enumerate(places)}
        super().__init__(name=f"Tables({layout})")


def _kind_of(place: Place) -> Any:
    dtype, ndim = place
    kind: Any = from_dtype(dtype)
    return Table(Row(kind), ndim) if dtype.names else Column(kind)


@register_model(TablesKind)
class _TablesModel(_PointerModel):
    pass


@infer_getattr
class _TablesByName(AttributeTemplate):
    key = TablesKind

    def generic_resolve(self, value: Any, attr: Any) -> Any:  # type: ignore[override]
        return value.kinds.get(attr)


@lower_getattr_generic(TablesKind)
def _read_table(context: Any, builder: Any, kind: TablesKind, value: Any, name: str) -> Any:
    words = builder.bitcast(value, WORD.as_pointer())
    first = kind.order[name] * WORDS
    data, *shape = (builder.load(builder.gep(words, [WORD(first + k)])) for k in range(WORDS))
    pointer = builder.inttoptr(data, POINTER)
    wanted = kind.kinds[name]
    if isinstance(wanted, Column):
        return pointer
    table = cgutils.create_struct_proxy(wanted)(context, builder)
    table.data = pointer
    table.shape = cgutils.pack_array(builder, shape[: wanted.ndim])
    return table._getvalue()
