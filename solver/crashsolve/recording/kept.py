"""Tables as they were at the samples of a block.

Channels are made of many samples at once, since a call of numpy costs as much for one of them as
for a hundred. At a sample itself the tables they are made of are only copied, in bytes.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Columns:
    """The columns of a table that values need: to copy these alone takes less time."""

    table: np.ndarray
    names: frozenset[str]


Source = np.ndarray | Columns | Callable[[], np.ndarray]

# [bytes] of a block, and samples in it: larger ones are no faster
MAX_BYTES, MAX_SAMPLES = 1 << 22, 256


class SampledTables:
    """Copies of tables at fixed addresses; other sources are called at every sample."""

    def __init__(self, sources: list[Source]) -> None:
        self._requested = [(i, s) for i, s in enumerate(sources) if callable(s)]
        tables = [_layout(source) for source in sources]
        size = sum(dtype.itemsize * int(np.prod(shape)) for shape, dtype in tables)
        self.capacity = min(max(MAX_BYTES // max(size, 1), 1), MAX_SAMPLES)
        self._tables = [np.empty((self.capacity, *shape), dtype) for shape, dtype in tables]
        # from and to, the latter (samples, ...): numpy would copy columns one by one
        self.pieces = [
            piece
            for source, copies in zip(sources, self._tables, strict=True)
            if not callable(source) and copies.size
            for piece in _pieces(source, copies)
        ]
        self.count = 0

    def take(self) -> None:
        """Keep the tables of the present sample."""
        k = self.count
        for piece, copies in self.pieces:
            copies[k] = piece
        for i, source in self._requested:
            self._tables[i][k] = source()
        self.count = k + 1

    @property
    def is_full(self) -> bool:
        return self.count == self.capacity

    @property
    def room(self) -> int:
        """Samples that may still be kept."""
        return self.capacity - self.count

    @property
    def is_copied(self) -> bool:
        """Whether copies alone are needed at a sample."""
        return not self._requested

    def tables(self) -> list[np.ndarray]:
        """The tables (samples, ...) kept since the last call; the next sample overwrites them."""
        count, self.count = self.count, 0
        return [copies[:count] for copies in self._tables]


def merged(sources: Iterable[Source]) -> dict[int, Source]:
    """Sources by the identity of their tables, each with all columns that are needed of it."""
    found: dict[int, Source] = {}
    for source in sources:
        known = found.get(identity(source))
        if isinstance(source, Columns) and isinstance(known, Columns):
            source = Columns(source.table, source.names | known.names)
        found[identity(source)] = source
    return found


def identity(source: Source) -> int:
    """Key that distinguishes two sources."""
    return id(source.table if isinstance(source, Columns) else source)


def _layout(source: Source) -> tuple[tuple[int, ...], np.dtype]:
    """Shape and type of the copies of a source."""
    if isinstance(source, Columns):
        names = [name for name in source.table.dtype.names or () if name in source.names]
        return source.table.shape, np.dtype([(n, source.table.dtype[n]) for n in names])
    table = source() if callable(source) else source
    return table.shape, table.dtype


def _pieces(
    source: np.ndarray | Columns, copies: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Columns that are side by side in a table and in its copies, each in words of both."""
    table = source.table if isinstance(source, Columns) else source
    if not table.flags.c_contiguous:
        raise ValueError("a table must lie in one piece")
    if not isinstance(source, Columns):
        return [(_bytes(table), copies.view(np.uint8).reshape(len(copies), -1))]
    old: Any = table.dtype.fields
    new: Any = copies.dtype.fields
    # a record is of numbers of eight bytes
    words, kept = _words(table), _words(copies).reshape(len(copies), table.size, -1)
    found = []
    for _, run in groupby(new, lambda name: old[name][1] - new[name][1]):
        names = list(run)
        size = sum(new[name][0].itemsize for name in names) // 8
        i, j = old[names[0]][1] // 8, new[names[0]][1] // 8
        found.append((words[:, i : i + size], kept[:, :, j : j + size]))
    return found


def _words(table: np.ndarray) -> np.ndarray:
    return table.reshape(-1).view(np.int64).reshape(table.size, -1)


def _bytes(table: np.ndarray) -> np.ndarray:
    return table.reshape(-1).view(np.uint8)
