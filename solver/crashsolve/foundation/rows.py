"""Tables of rows whose columns are attributes, for kernels that run as plain Python.

What numpy.recarray does, in a quarter of the time: there every attribute is looked up by a function
of Python, here the class of a row has a property for each column.
"""

from __future__ import annotations

from functools import cache
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Protocol, SupportsIndex, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

Number = TypeVar("Number", int, float)


# rows of a record, by their columns `table["name"]`
Table = np.ndarray


class Row(Protocol):
    """A record of a table: its columns are attributes."""

    def __getattr__(self, name: str) -> Any: ...
    def __setattr__(self, name: str, value: object) -> None: ...


class Numbers(Protocol[Number]):
    """A column of several numbers, of one row."""

    def __getitem__(self, i: int) -> Number: ...
    def __setitem__(self, i: int, value: Number) -> None: ...


if TYPE_CHECKING:
    from collections.abc import Sequence

    class RowOfTable(np.void, Row):
        """A row of Rows: a numpy record whose columns are attributes too."""


class Rows(np.ndarray):
    """A structured array; `table[i].name` is a number of row i, `table.name` a column."""

    if TYPE_CHECKING:
        # numpy's own types say ndarray where it makes one of this class
        @overload
        def __getitem__(self, key: str) -> np.ndarray: ...  # type: ignore[override]
        @overload
        def __getitem__(self, key: SupportsIndex) -> RowOfTable: ...
        @overload
        def __getitem__(self, key: slice | Sequence[int] | np.ndarray) -> Rows: ...
        @overload
        def __getitem__(self, key: tuple[object, ...]) -> Any: ...

    def __getattr__(self, name: str) -> Any:
        if name not in (self.dtype.names or ()):
            raise AttributeError(f"no column '{name}'")
        column = self[name]
        return column if column.dtype.names else column.view(np.ndarray)

    def __setattr__(self, name: str, value: object) -> None:
        if name in (self.dtype.names or ()):
            self[name] = value
        else:
            super().__setattr__(name, value)


def copy_rows(source: np.ndarray, to: np.ndarray) -> None:
    """Copy one table into another of its layout: numpy copies column by column. Writes: to."""
    to.view(np.uint8)[:] = source.view(np.uint8)


def as_rows(table: np.ndarray) -> Any:
    """A view of a table as Rows; an array without columns as it is."""
    return table.view(_layout(table.dtype), Rows) if table.dtype.names else table


@cache
def _layout(layout: np.dtype) -> np.dtype:
    """The layout of a table with rows, and rows within them, of a class that has their columns."""
    if layout.subdtype is not None:
        inner, shape = layout.subdtype
        return np.dtype((_layout(inner), shape))
    if layout.fields is None or layout.names is None:
        return layout
    fields: Any = layout.fields
    parts = {name: fields[name] for name in layout.names}
    plain = {
        "names": list(parts),
        "formats": [_layout(part[0]) for part in parts.values()],
        "offsets": [part[1] for part in parts.values()],
        "itemsize": layout.itemsize,
    }
    # without a dictionary of its own a row takes no attribute that is no column
    row = type("Row", (np.void,), {"__slots__": (), **{name: _column(name) for name in parts}})
    return np.dtype((row, np.dtype(plain)))


def _column(name: str) -> property:
    def put(row: np.void, value: ArrayLike) -> None:
        row[name] = value

    return property(itemgetter(name), put)
