"""Writes history.h5: blocks of rows gathered in memory, appended in place, whole at any moment.

Appending costs time in proportion to the new rows. Rows are reserved as many as are expected,
within limits. When they are used up the file is copied to one of twice the size, which takes its
place by a rename, and on closing to one that fits: all copies together write less than three times
the final size.
"""

import os
import time as clock
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from crashsolve.output import layout
from crashsolve.output.channels import Family
from crashsolve.output.errors import OutputError
from crashsolve.output.files import Json, new_hdf5, replacing, reported, write_metadata
from crashsolve.output.peaks import Extremes

FIRST_CAPACITY = 1024
# reserved at most for the expected samples: a run may have an endless end time, and be stopped;
# times are written in advance
MAX_RESERVED_BYTES, MAX_RESERVED_ROWS = 1 << 28, 1 << 20
MAX_BUFFERED_ROWS = 1024


class HistoryWriter:
    """Appends sample rows of all families; `extremes` holds the peaks of the flushed rows.

    Raises OutputError when the file cannot be written, when a row is not finite, and when a
    history to be resumed is missing or belongs to another model.
    """

    def __init__(
        self,
        path: Path | str,
        families: tuple[Family, ...],
        metadata: Json,
        resume_time: float | None = None,
        *,
        expected_rows: int = 0,
        flush_seconds: float = 5.0,
        buffer_bytes: int = 1 << 24,
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
        # where datasets begin in the file; not known yet of one that is resumed
        self._offsets: layout.Offsets = {}
        self._rows = 0
        self._last_time = -np.inf
        self._flushed_at = clock.monotonic()
        doubles = sum(len(family.ids) * len(family.columns) for family in self.families)
        most = min(max(1, buffer_bytes // (8 * doubles)), MAX_BUFFERED_ROWS)
        # rows in waiting: their number, times, and values (n_column, k, n_id) of every family
        self._count, self._times = 0, np.empty(most)
        self._values = [np.empty((len(f.columns), most, len(f.ids))) for f in self.families]
        if resume_time is not None:
            self._read_kept_rows(resume_time)
        self._expected_rows = expected_rows
        max_rows = min(MAX_RESERVED_BYTES // (8 * doubles + 8), MAX_RESERVED_ROWS)
        expected = min(expected_rows or FIRST_CAPACITY, max_rows)
        self._rebuild(max(expected, 2 * self._rows))

    def append(self, times: np.ndarray, values: dict[str, np.ndarray]) -> None:
        """Add rows: times (k,), and for each family an array (k, n_id, n_column).

        Flushes when it is time to. Of rows that are refused, those before are kept.
        """
        blocks = [values[family.name] for family in self.families]
        for family, block in zip(self.families, blocks, strict=True):
            if block.shape != (len(times), len(family.ids), len(family.columns)):
                raise ValueError(f"family '{family.name}': values of shape {block.shape}")
        valid, error = self._check_rows(times, blocks)
        taken = 0
        while taken < valid:
            taken += self._take(times[taken:valid], [block[taken:valid] for block in blocks])
            if self._count == len(self._times):
                self.flush()
        if error is not None:
            raise error
        if self.is_due():
            self.flush()

    def is_due(self) -> bool:
        """Whether rows should not wait any longer."""
        return clock.monotonic() - self._flushed_at >= self._flush_seconds

    def flush(self, is_last: bool = False) -> None:
        """Write the gathered rows: values, wait for the disk, then the times that validate them.

        After the last rows no others are expected.
        """
        if self._count:
            count = self._count
            self._make_room(self._rows + count, is_last)
            times, blocks = self._times[:count], [values[:, :count] for values in self._values]
            with reported(self.path):
                self._write_rows(times, blocks)
            for number, block in enumerate(blocks):
                self.extremes.update(number, times, block)
            self._rows += count
            self._count = 0
        self._flushed_at = clock.monotonic()

    def close(self) -> None:
        """Flush and give back the reserved rows; a second call does nothing."""
        if self._file is not None:
            self.flush(is_last=True)
            if self._rows < self._capacity:
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

    def _take(self, times: np.ndarray, blocks: list[np.ndarray]) -> int:
        """Gather rows, as many as there is room for; returns their number."""
        first, last = self._count, min(self._count + len(times), len(self._times))
        count = last - first
        self._times[first:last] = times[:count]
        for values, block in zip(self._values, blocks, strict=True):
            values[:, first:last] = block[:count].transpose(2, 0, 1)
        self._count, self._last_time = last, float(times[count - 1])
        return count

    def _check_rows(
        self, times: np.ndarray, blocks: list[np.ndarray]
    ) -> tuple[int, OutputError | None]:
        """Number of valid rows, and the error of the next: its time, or a number."""
        before = np.concatenate([[self._last_time], times[:-1]])
        wrong = np.flatnonzero(~((before < times) & (times < np.inf)))
        valid, error = len(times), None
        if len(wrong):
            valid = int(wrong[0])
            message = f"row at t = {times[valid]:.17g} s follows t = {before[valid]:.17g} s"
            error = OutputError(self.path, message)
        for family, block in zip(self.families, blocks, strict=True):
            if not np.isfinite(block[:valid]).all():
                row, entity, column = np.argwhere(~np.isfinite(block[:valid]))[0]
                name, valid = family.channel(entity, column), int(row)
                message = f"{name} is {block[row, entity, column]} at t = {times[row]:.9g} s"
                advice = "look for numbers of the deck that are far too large or too small"
                error = OutputError(self.path, f"{message}; {advice}")
        return valid, error

    def _read_kept_rows(self, resume_time: float) -> None:
        """Count the rows to keep and recall their extremes."""
        with reported(self.path):
            self._rows = layout.rows_until(self.path, self.families, resume_time)
            for number, times, values in layout.read_blocks(self.path, self.families, self._rows):
                self.extremes.update(number, times, values)
                self._last_time = times[-1]

    def _make_room(self, rows: int, is_last: bool) -> None:
        """Reserve twice the rows, or those expected where these are no more: none remains."""
        if rows > self._capacity:
            is_near = rows <= self._expected_rows <= 2 * rows
            more = self._expected_rows if is_near else 2 * rows
            self._rebuild(rows if is_last else more)

    def _rebuild(self, capacity: int) -> None:
        """Replace the file by one of another capacity holding the rows written so far."""
        self._close_file()
        with replacing(self.path) as partial:
            with new_hdf5(partial) as file:
                write_metadata(file, layout.FORMAT, layout.FORMAT_VERSION, self._metadata)
                offsets = layout.create(file, self.families, capacity)
            if self._rows:
                before = self._offsets or layout.offsets_of(self.path, self.families)
                layout.copy_rows(self.path, before, partial, offsets, self.families, self._rows)
        self._offsets = offsets
        with reported(self.path):
            self._file = FileIO(self.path, "r+")
        self._capacity = capacity

    def _write_rows(self, times: np.ndarray, blocks: list[np.ndarray]) -> None:
        """Append rows to every dataset: times, and values (n_column, k, n_id) of each family."""
        for family, block in zip(self.families, blocks, strict=True):
            row_bytes = 8 * len(family.ids)
            for column, values in zip(family.columns, block, strict=True):
                offset = self._offsets[f"{family.name}/{column.path}"] + self._rows * row_bytes
                self._write_at(offset, values)
        assert self._file is not None
        os.fdatasync(self._file.fileno())
        self._write_at(self._offsets["time"] + self._rows * 8, times)

    def _write_at(self, offset: int, block: np.ndarray) -> None:
        """Write doubles at a byte offset."""
        assert self._file is not None
        layout.write_at(self._file, offset, block.astype("<f8", copy=False).data.cast("B"))

    def _close_file(self) -> None:
        """Close the handle for appending, if open."""
        if self._file is not None:
            self._file.close()
            self._file = None
