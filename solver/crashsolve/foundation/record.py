"""Columns of a law's data, each with unit, size and meaning beside its name.

A law declares its columns by lifetime: PARAMETERS (Model), HISTORY (State), OUTPUT (channels).
"""

import re
from inspect import cleandoc
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

V = TypeVar("V", covariant=True)
_INTEGER_UNITS = ("index", "flag", "count")
_OF_NUMPY = frozenset(dir(np.void))


class Column(NamedTuple):
    """One column: `size` 1 is a scalar, 3 a vector; units "index", "flag", "count" are integers."""

    name: str
    unit: str
    size: int
    meaning: str

    @property
    def is_integer(self) -> bool:
        return self.unit in _INTEGER_UNITS

    @property
    def format(self) -> tuple[str, type] | tuple[str, type, tuple[int]]:
        kind = np.int64 if self.is_integer else np.float64
        return (self.name, kind) if self.size == 1 else (self.name, kind, (self.size,))


class Named(Protocol[V]):
    """A row or a dictionary of columns."""

    def __getitem__(self, name: str, /) -> V: ...


class Record:
    """Columns of a table in words: a line each of name, unit, size (of a vector), meaning.

        r         m     3  position of the mass centre
        mass_inv  1/kg     inverse mass; 0 for the ground

    Two or more spaces lie between them; a line with more indentation continues the meaning.
    Raises ValueError where a line is no such column, or a name is used twice.
    """

    def __init__(self, table: str = "", columns: tuple[Column, ...] = ()) -> None:
        lines = re.sub(r"\n +", " ", cleandoc(table)).splitlines()
        self.columns = (*map(_column, lines), *columns)
        names = [column.name for column in self.columns]
        if len(set(names)) < len(names):
            repeated = {name for name in names if names.count(name) > 1}
            raise ValueError(f"columns declared twice: {sorted(repeated)}")
        # numpy's own attributes of a record would hide the column from plain Python
        if taken := _OF_NUMPY.intersection(names):
            raise ValueError(f"names that numpy records have already: {sorted(taken)}")

    def __add__(self, other: "Record") -> "Record":
        """Both sets of columns; a name used twice is a programming error."""
        return Record(columns=self.columns + other.columns)

    def columns_of(self, values: "Named[V]") -> dict[str, V]:
        """The values of these columns out of a row that has them and others."""
        return {column.name: values[column.name] for column in self.columns}

    @property
    def dtype(self) -> np.dtype[np.void]:
        """numpy structured dtype; an empty record keeps one unused word."""
        if not self.columns:
            return np.dtype([("unused", np.int64)])
        return np.dtype([column.format for column in self.columns])


def _column(line: str) -> Column:
    """The column of a line. Raises ValueError."""
    name, *rest = re.split(r" {2,}", line)
    size = rest[1] if len(rest) == 3 else "1"
    if not (name.isidentifier() and len(rest) in (2, 3) and size.isdecimal() and int(size) > 0):
        raise ValueError(
            f"'{line}' is no column: give name, unit, size (of a vector) and meaning, with two or "
            "more spaces between them"
        )
    return Column(name, rest[0], int(size), rest[-1])


def rows_of(record: Record, first: int = 0) -> Any:
    """First row of each column among rows of lanes, counted from `first` on.

    Kernels read `ROWS.name`; SIZE is that of all columns, RECORD their meaning.
    """
    positions, at = {}, first
    for column in record.columns:
        positions[column.name] = at
        at += column.size
    return type("Rows", (), {**positions, "SIZE": at - first, "RECORD": record})
