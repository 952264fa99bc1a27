"""Tables as they were at the samples of a block.

Channels are made of many samples at once, since a call of numpy costs as much for one of them as
for a hundred. At a sample itself the tables they are made of are only copied, in bytes.
"""

from collections.abc import Callable

import numpy as np

Source = np.ndarray | Callable[[], np.ndarray]

# [bytes] of a block, and samples in it: more would wait in memory for longer, and gain nothing
MOST_BYTES, MOST_SAMPLES = 1 << 22, 256


class Kept:
    """Copies of tables, each of which stays where it is; others are asked for at every sample."""

    def __init__(self, sources: list[Source]) -> None:
        self._asked = [(i, s) for i, s in enumerate(sources) if callable(s)]
        tables = [source() if callable(source) else source for source in sources]
        size = sum(table.nbytes for table in tables)
        self.most = min(max(MOST_BYTES // max(size, 1), 1), MOST_SAMPLES)
        self._tables = [np.empty((self.most, *table.shape), table.dtype) for table in tables]
        # numpy would copy columns one by one
        self._bytes = [
            (_bytes(source), copies.view(np.uint8).reshape(self.most, -1))
            for source, copies in zip(sources, self._tables, strict=True)
            if not callable(source) and source.nbytes
        ]
        self.count = 0

    def take(self) -> None:
        """Keep the tables of the present sample."""
        k = self.count
        for table, copies in self._bytes:
            copies[k] = table
        for i, source in self._asked:
            self._tables[i][k] = source()
        self.count = k + 1

    @property
    def is_full(self) -> bool:
        return self.count == self.most

    def tables(self) -> list[np.ndarray]:
        """The tables (samples, ...) kept since the last call; the next sample overwrites them."""
        count, self.count = self.count, 0
        return [copies[:count] for copies in self._tables]


def _bytes(table: np.ndarray) -> np.ndarray:
    if not table.flags.c_contiguous:
        raise ValueError("a table must lie in one piece")
    return table.reshape(-1).view(np.uint8)
