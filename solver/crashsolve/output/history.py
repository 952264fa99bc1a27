"""Writes history.h5: blocks of rows appended in place, whole at any moment.

The values of a block are written at once; a flush waits for the disk, and writes the times that
validate them. Appending costs time in proportion to the new rows. Rows are reserved as many as are
expected, within limits. When they are used up the file is copied to one of twice the size, which
takes its place by a rename, and on closing to one that fits: all copies together write less than
three times the final size.
"""

import os
import time as clock
from contextlib import suppress
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
# of the rows expected, reserved for others between them
FURTHER_SHARE = 1 / 8


class HistoryWriter:
    """Appends sample rows of all families; `extremes` holds the peaks of the rows appended.

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
        may_have_more: bool = False,
        flush_seconds: float = 5.0,
    ) -> None:
        """`may_have_more`: rows may come between those expected."""
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
        # rows that are valid; those whose values are written behind them, and their times
        self._rows, self._waiting, self._times = 0, 0, list[np.ndarray]()
        self._last_time = -np.inf
        self._flushed_at = clock.monotonic()
        doubles = sum(len(family.ids) * len(family.columns) for family in self.families)
        if resume_time is not None:
            self._read_kept_rows(resume_time)
        further = int(FURTHER_SHARE * expected_rows) if may_have_more else 0
        self._expected_rows = expected_rows + further
        max_rows = min(MAX_RESERVED_BYTES // (8 * doubles + 8), MAX_RESERVED_ROWS)
        expected = min(self._expected_rows or FIRST_CAPACITY, max_rows)
        self._rebuild(max(expected, 2 * self._rows))

    def append(
        self,
        times: np.ndarray,
        values: dict[str, np.ndarray],
        extremes: dict[str, np.ndarray] | None = None,
        is_last: bool = False,
    ) -> None:
        """Add rows: times (k,), and for each family an array (k, n_id, n_column).

        Flushes when it is time to. Of rows that are refused, those before are kept. `extremes`
        of these rows are known only where all numbers are finite (`Extremes.merge`). After the
        last rows no others are expected.
        """
        blocks = [values[family.name] for family in self.families]
        for family, block in zip(self.families, blocks, strict=True):
            if block.shape != (len(times), len(family.ids), len(family.columns)):
                raise ValueError(f"family '{family.name}': values of shape {block.shape}")
        valid, error = self._check_times(times)
        if extremes is None:
            valid, error = self._check_numbers(times, blocks, valid, error)
        if valid:
            columns = [block[:valid].transpose(2, 0, 1) for block in blocks]
            self._write_values(times[:valid], columns, is_last)
            for number, (family, own) in enumerate(zip(self.families, columns, strict=True)):
                if extremes is not None and error is None:
                    self.extremes.merge(number, times, extremes[family.name])
                else:
                    self.extremes.update(number, times[:valid], own)
        if error is not None:
            raise error
        if self.is_due():
            self.flush()

    def is_due(self) -> bool:
        """Whether rows should not wait any longer."""
        return clock.monotonic() - self._flushed_at >= self._flush_seconds

    def flush(self) -> None:
        """Wait until the disk has the values of all rows, then write the times that validate them.

        Raises OutputError.
        """
        if self._waiting:
            assert self._file is not None
            with reported(self.path):
                os.fdatasync(self._file.fileno())
                self._write_at(self._offsets["time"] + self._rows * 8, np.concatenate(self._times))
            self._rows, self._waiting, self._times = self._rows + self._waiting, 0, []
        self._flushed_at = clock.monotonic()

    def close(self) -> None:
        """Flush and give back the reserved rows; a second call does nothing."""
        if self._file is not None:
            self.flush()
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
            # rows that are whole are kept
            with suppress(OutputError):
                if self._file is not None:
                    self.flush()
            self._close_file()
        else:
            self.close()

    def _write_values(self, times: np.ndarray, blocks: list[np.ndarray], is_last: bool) -> None:
        """Write the values (n_column, k, n_id) of rows of each family, not valid yet."""
        self._make_room(self._rows + self._waiting + len(times), is_last)
        first = self._rows + self._waiting
        with reported(self.path):
            for family, block in zip(self.families, blocks, strict=True):
                row_bytes = 8 * len(family.ids)
                for column, values in zip(family.columns, block, strict=True):
                    offset = self._offsets[f"{family.name}/{column.path}"] + first * row_bytes
                    self._write_at(offset, values)
        self._times.append(times)
        self._waiting += len(times)
        self._last_time = float(times[-1])

    def _check_times(self, times: np.ndarray) -> tuple[int, OutputError | None]:
        """Number of rows whose times ascend, and the error of the next."""
        before = np.concatenate([[self._last_time], times[:-1]])
        wrong = np.flatnonzero(~((before < times) & (times < np.inf)))
        valid, error = len(times), None
        if len(wrong):
            valid = int(wrong[0])
            message = f"row at t = {times[valid]:.17g} s follows t = {before[valid]:.17g} s"
            error = OutputError(self.path, message)
        return valid, error

    def _check_numbers(
        self,
        times: np.ndarray,
        blocks: list[np.ndarray],
        valid: int,
        error: OutputError | None,
    ) -> tuple[int, OutputError | None]:
        """Number of rows before the first of these that is not finite, and the error of that."""
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
            # should there be no room for another file, this one has all of them
            self.flush()
            self._rebuild(rows if is_last else more)

    def _rebuild(self, capacity: int) -> None:
        """Replace the file by one of another capacity holding the valid rows."""
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

    def _write_at(self, offset: int, block: np.ndarray) -> None:
        """Write doubles at a byte offset."""
        assert self._file is not None
        layout.write_at(self._file, offset, np.ascontiguousarray(block, "<f8").data.cast("B"))

    def _close_file(self) -> None:
        """Close the handle for appending, if open."""
        if self._file is not None:
            self._file.close()
            self._file = None
