"""Writes history.h5: rows gathered in memory, appended in place, whole whatever happens.

Appending costs time in proportion to the new rows. When the reserved rows are used up the file is
copied to one of twice the size, which takes its place by a rename, and on closing to one that fits:
all copies together write less than three times the final size.
"""

import os
import time as clock
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from crashsolve.output import layout
from crashsolve.output.channels import Family
from crashsolve.output.errors import OutputError
from crashsolve.output.files import replacing_hdf5, reported, write_metadata
from crashsolve.output.peaks import Extremes

FIRST_CAPACITY = 1024
MOST_BUFFERED_ROWS = 1024


class HistoryWriter:
    """Appends sample rows of all families; `extremes` holds the peaks of the flushed rows.

    Raises OutputError when the file cannot be written, when a row is not finite, and when a
    history to be resumed is missing or belongs to another model.
    """

    def __init__(
        self,
        path: Path | str,
        families: tuple[Family, ...],
        metadata: dict[str, Any],
        resume_time: float | None = None,
        *,
        flush_seconds: float = 5.0,
        buffer_bytes: int = 1 << 22,
    ) -> None:
        self.path = Path(path)
        # a family without entities leaves no trace
        self.families = tuple(family for family in families if family.ids and family.columns)
        if not self.families:
            raise ValueError("a history needs at least one channel")
        self.extremes = Extremes(self.families)
        self._metadata = metadata
        self._flush_seconds = flush_seconds
        self._file: FileIO | None = None
        self._rows = 0
        self._waiting = 0
        self._last_time = -np.inf
        self._flushed_at = clock.monotonic()
        self._make_buffers(buffer_bytes)
        if resume_time is not None:
            self._read_kept_rows(resume_time)
        self._rebuild(max(FIRST_CAPACITY, 2 * self._rows))

    def append(self, time: float, values: dict[str, np.ndarray]) -> None:
        """Add one row: for each family an array (n_id, n_column); flushes when it is time to."""
        blocks = [self._checked(time, family, values[family.name]) for family in self.families]
        if not self._last_time < time < np.inf:
            raise OutputError(self.path, f"row at t = {time!r} s follows t = {self._last_time!r} s")
        for buffer, block in zip(self._buffers, blocks, strict=True):
            buffer[:, self._waiting] = block.T
        self._times[self._waiting] = self._last_time = time
        self._waiting += 1
        waited = clock.monotonic() - self._flushed_at
        if self._waiting == len(self._times) or waited >= self._flush_seconds:
            self.flush()

    def flush(self) -> None:
        """Write the gathered rows: values, wait for the disk, then the times that validate them."""
        if self._waiting:
            if self._rows + self._waiting > self._capacity:
                self._rebuild(2 * (self._rows + self._waiting))
            with reported(self.path):
                self._write_rows()
            for number, buffer in enumerate(self._buffers):
                fresh = slice(0, self._waiting)
                self.extremes.update(number, self._times[fresh], buffer[:, fresh])
            self._rows += self._waiting
            self._waiting = 0
        self._flushed_at = clock.monotonic()

    def close(self) -> None:
        """Flush and give back the reserved rows; a second call does nothing."""
        if self._file is not None:
            self.flush()
            self._rebuild(self._rows)
            self._close_file()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if isinstance(error, OutputError):
            self._close_file()
        else:
            self.close()

    def _make_buffers(self, buffer_bytes: int) -> None:
        """Reserve memory for rows in waiting, (n_column, rows, n_id) for each family."""
        doubles = sum(len(family.ids) * len(family.columns) for family in self.families)
        rows = min(max(1, buffer_bytes // (8 * doubles)), MOST_BUFFERED_ROWS)
        self._times = np.empty(rows)
        self._buffers = [
            np.empty((len(family.columns), rows, len(family.ids))) for family in self.families
        ]

    def _checked(self, time: float, family: Family, block: np.ndarray) -> np.ndarray:
        """Return a block that has the right shape and only finite values."""
        if block.shape != (len(family.ids), len(family.columns)):
            raise ValueError(f"family '{family.name}': values of shape {block.shape}")
        if not np.isfinite(block).all():
            entity, column = np.argwhere(~np.isfinite(block))[0]
            name = family.channel(entity, column)
            told = f"{name} is {block[entity, column]} at t = {time:.9g} s"
            advice = "look for numbers of the deck that are far too large or too small"
            raise OutputError(self.path, f"{told}; {advice}")
        return block

    def _read_kept_rows(self, resume_time: float) -> None:
        """Count the rows to keep and recall their extremes."""
        with reported(self.path):
            self._rows = layout.rows_until(self.path, self.families, resume_time)
            for number, times, values in layout.read_blocks(self.path, self.families, self._rows):
                self.extremes.update(number, times, values)
                self._last_time = times[-1]

    def _rebuild(self, capacity: int) -> None:
        """Replace the file by one of another capacity holding the rows written so far."""
        self._close_file()
        with replacing_hdf5(self.path) as file:
            write_metadata(file, layout.FORMAT, layout.FORMAT_VERSION, self._metadata)
            self._offsets = layout.create(file, self.families, capacity)
            if self._rows:
                layout.copy_rows(self.path, file, self.families, self._rows)
        with reported(self.path):
            self._file = FileIO(self.path, "r+")
        self._capacity = capacity

    def _write_rows(self) -> None:
        """Append the waiting rows to every dataset."""
        for family, buffer in zip(self.families, self._buffers, strict=True):
            row_bytes = 8 * len(family.ids)
            for column, block in zip(family.columns, buffer, strict=True):
                offset = self._offsets[f"{family.name}/{column.path}"] + self._rows * row_bytes
                self._write_at(offset, block[: self._waiting])
        assert self._file is not None
        os.fdatasync(self._file.fileno())
        self._write_at(self._offsets["time"] + self._rows * 8, self._times[: self._waiting])

    def _write_at(self, offset: int, block: np.ndarray) -> None:
        """Write doubles at a byte offset; the system may take a long block in several bites."""
        assert self._file is not None
        rest = block.astype("<f8", copy=False).data.cast("B")
        while rest:
            written = os.pwrite(self._file.fileno(), rest, offset)
            rest, offset = rest[written:], offset + written

    def _close_file(self) -> None:
        """Close the handle for appending, if open."""
        if self._file is not None:
            self._file.close()
            self._file = None
