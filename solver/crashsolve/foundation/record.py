"""Columns of a law's data, each with unit, shape and meaning beside its name.

A law declares what it needs by lifetime: PARAMETERS (Model), HISTORY (State), OUTPUT (channels).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

_INTEGER_UNITS = ("index", "flag", "count")


@dataclass(frozen=True)
class Column:
    """One column: `size` 1 is a scalar, 3 a vector; units "index", "flag", "count" are integers."""

    name: str
    unit: str
    size: int
    meaning: str

    @property
    def format(self) -> tuple[Any, ...]:
        kind = np.int64 if self.unit in _INTEGER_UNITS else np.float64
        return (self.name, kind) if self.size == 1 else (self.name, kind, (self.size,))


class Record:
    """Columns given as name=(unit, meaning) or name=(unit, size, meaning).

    Raises ValueError for what is neither, and for names that numpy's records have.
    """

    def __init__(self, **columns: tuple[Any, ...]) -> None:
        for name, spec in columns.items():
            is_long = isinstance(spec, tuple) and len(spec) in (2, 3)
            if not is_long or not all(isinstance(x, str) and x for x in (spec[0], spec[-1])):
                raise ValueError(f"column {name} must be (unit, meaning) or (unit, size, meaning)")
            if len(spec) == 3 and not (isinstance(spec[1], int) and spec[1] > 0):
                raise ValueError(f"column {name}: size {spec[1]!r} must be a number of values")
        self.columns = tuple(
            Column(name, spec[0], spec[1] if len(spec) == 3 else 1, spec[-1])
            for name, spec in columns.items()
        )
        # numpy's own attributes of a record would hide the column from plain Python
        taken = [name for name in columns if hasattr(np.void, name)]
        if taken:
            raise ValueError(f"names that numpy records have already: {taken}")

    def __add__(self, other: "Record") -> "Record":
        """Both sets of columns; a name used twice is a programming error."""
        total = Record()
        total.columns = self.columns + other.columns
        names = [column.name for column in total.columns]
        repeated = {name for name in names if names.count(name) > 1}
        if repeated:
            raise ValueError(f"columns declared twice: {sorted(repeated)}")
        return total

    @property
    def dtype(self) -> np.dtype[Any]:
        """numpy structured dtype; an empty record keeps one unused word."""
        if not self.columns:
            return np.dtype([("unused", np.int64)])
        return np.dtype([column.format for column in self.columns])


def rows_of(record: Record, first: int = 0) -> Any:
    """Where each column begins among rows of lanes that lie one after the other from `first` on.

    Kernels read `ROWS.name`; SIZE is that of all columns, RECORD what they mean.
    """
    places, at = {}, first
    for column in record.columns:
        places[column.name] = at
        at += column.size
    return type("Rows", (), {**places, "SIZE": at - first, "RECORD": record})
