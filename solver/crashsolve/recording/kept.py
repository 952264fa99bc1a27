"""Columns of numbers at the samples of a block.

Channels are made of many samples at once, since a call of numpy costs as much for one of them as
for a hundred. At a sample itself numbers are only copied (gather.py), each to where it lies in the
history.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from crashsolve.compiler.table import Tables
from crashsolve.recording import gather

# [bytes] of a block, and samples in it: larger ones are no faster
MAX_BYTES, MAX_SAMPLES = 1 << 23, 1024


class Source(NamedTuple):
    """Where columns lie in a table of the run: numbers (n,) or (n, width) of its entities.

    Of a history, `half` are the bytes from its first half to the second. Of chosen rows of the
    table, `rows` are their indices.
    """

    numbers: np.ndarray
    half: int = 0
    rows: Sequence[int] | None = None

    @property
    def width(self) -> int:
        return 1 if self.numbers.ndim == 1 else self.numbers.shape[1]

    @property
    def is_integer(self) -> bool:
        return self.numbers.dtype.kind in "iu"

    def chosen(self, columns: Sequence[int], rows: Sequence[int]) -> "list[Source | Later]":
        """Some of the columns and of the entities, both ascending, as sources side by side."""
        numbers, own = self.numbers, self.rows
        if len(rows) < (len(numbers) if own is None else len(own)):
            own = list(rows) if own is None else [own[k] for k in rows]
        if numbers.ndim == 1:
            return [Source(numbers, self.half, own)]
        return [Source(numbers[:, k], self.half, own) for k in columns]


class Later(NamedTuple):
    """Columns that are computed when the block is complete."""

    width: int


@dataclass(eq=False)
class Columns:
    """Columns of one length, from one to the next; `request` computes them in place of copies."""

    size: int
    sources: list[Source | Later] = field(default_factory=list)
    request: Callable[[], np.ndarray] | None = None

    @property
    def width(self) -> int:
        return sum(source.width for source in self.sources)

    @property
    def are_copies(self) -> bool:
        """Whether all of them are copied, and none is computed."""
        are_sources = all(isinstance(source, Source) for source in self.sources)
        return self.request is None and are_sources

    def chosen(self, columns: Sequence[int], rows: Sequence[int]) -> "Columns":
        """Some of these columns, of some entities; all are copies."""
        sources, first = list[Source | Later](), 0
        for source in self.sources:
            own = [k - first for k in columns if first <= k < first + source.width]
            if own and isinstance(source, Source):
                is_whole = len(own) == source.width and len(rows) == self.size
                sources += [source] if is_whole else source.chosen(own, rows)
            first += source.width
        return Columns(len(rows), sources)


class Block:
    """Columns of a run at up to `capacity` samples; `joints`, `origins`: tables of gather.py."""

    def __init__(
        self,
        every: list[Columns],
        tables: dict[str, np.ndarray],
        joints: np.ndarray,
        origins: np.ndarray,
        bounded: int = 0,
    ) -> None:
        """`tables`: nodes, rows and clock of the run. Extremes are those of the first `bounded`."""
        size = 8 * sum(columns.size * columns.width for columns in every)
        # odd: columns a power of two apart share few lines of a processor's cache
        self.capacity = min(max(MAX_BYTES // max(size, 1), 1), MAX_SAMPLES) - 1 | 1
        # values (n_column, capacity, n) of each
        self._values = [np.empty((own.width, self.capacity, own.size)) for own in every]
        self._every, self._block = every, np.zeros(1, gather.BLOCK.dtype)
        both = zip(every, self._values, strict=True)
        pieces = [piece for own, values in both for piece in _pieces(own.sources, values)]
        own = {"joints": joints, "origins": origins, "block": self._block}
        self._bounded = every[:bounded]
        bounds, self._extremes = self._bounds()
        # of gather.add_sample and gather.find_extremes
        self.tables = tables | own | {"pieces": np.array(pieces, gather.PIECE.dtype)}
        self.tables |= {"bounds": bounds, "extremes": self._extremes}
        self._add = self._add_in_python
        self._bound: Callable[[], None] | None = None

    def use(self, add: Callable[[], None], bound: Callable[[], None] | None) -> None:
        """Take samples by gather.add_sample, and seek extremes by gather.find_extremes, compiled
        for tables that include these.
        """
        self._add, self._bound = add, bound

    def take(self) -> None:
        """Add the present sample."""
        count = self.count
        self._add()
        for own, values in zip(self._every, self._values, strict=True):
            if own.request is not None:
                values[:, count] = own.request().T

    def _add_in_python(self) -> None:
        gather.add_sample(Tables(self.tables))

    @property
    def count(self) -> int:
        """Samples taken."""
        return int(self._block["count"][0])

    @property
    def is_full(self) -> bool:
        return self.count == self.capacity

    @property
    def room(self) -> int:
        """Samples that may still be taken."""
        return self.capacity - self.count

    @property
    def is_copied(self) -> bool:
        """Whether copies alone are needed at a sample."""
        return all(own.request is None for own in self._every)

    def extremes(self, count: int) -> list[np.ndarray] | None:
        """Extremes (n_column, n) of the last `count` values, as they have been completed.

        None where a number is not finite, or no compiled code seeks them.
        """
        if self._bound is None:
            return None
        self._block["rows"] = count
        self._bound()
        if not self._block["is_sound"][0]:
            return None
        ends = np.cumsum([own.width * own.size for own in self._bounded])
        parts = np.split(self._extremes, ends[:-1])
        shapes = [(own.width, own.size) for own in self._bounded]
        return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]

    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows of BOUND of all columns, and room for their extremes."""
        rows, first = [], 0
        for own, values in zip(self._bounded, self._values, strict=False):
            if values.size:
                column, advance, _ = values.strides
                rows.append((_address(values), column, advance, own.width, own.size, first))
            first += own.width * own.size
        return np.array(rows, gather.BOUND.dtype), np.zeros(first, gather.EXTREME.dtype)

    def values(self) -> list[np.ndarray]:
        """Values (n_column, samples, n) taken since the last call; later samples overwrite them."""
        count = self.count
        self._block["count"] = 0
        blocks = [values[:, :count] for values in self._values]
        for own, values in zip(self._every, blocks, strict=True):
            _convert(own.sources, values)
        return blocks


def sources_of(table: np.ndarray, names: Iterable[str]) -> list[Source | Later]:
    """Columns of a table."""
    return [Source(table[name]) for name in names]


def _pieces(sources: list[Source | Later], values: np.ndarray) -> list[tuple[int, ...]]:
    """Rows of PIECE that fill values (n_column, capacity, n) from their sources."""
    copies, at = [], 0
    column, advance, _ = values.strides
    for source in sources:
        if isinstance(source, Source) and values.size:
            numbers = source.numbers
            if numbers.itemsize != 8 or numbers.ndim == 2 and numbers.strides[1] != 8:
                raise ValueError("a column must be of numbers of eight bytes, side by side")
            target, first, stride = _address(values[at]), _address(numbers), numbers.strides[0]
            to = (column, advance)
            shape = (stride, source.half, source.width)
            if source.rows is None:
                copies.append((target, *to, first, *shape, len(numbers)))
            else:
                copies += [
                    (target + 8 * j, *to, first + row * stride, *shape, 1)
                    for j, row in enumerate(source.rows)
                ]
        at += source.width
    return copies


def _address(array: np.ndarray) -> int:
    address: int = array.__array_interface__["data"][0]
    return address


def _convert(sources: list[Source | Later], values: np.ndarray) -> None:
    """Whole numbers were copied as such. Writes: values."""
    at = 0
    for source in sources:
        own = values[at : at + source.width]
        if isinstance(source, Source) and source.is_integer:
            own[...] = own.view(np.int64)
        at += source.width
