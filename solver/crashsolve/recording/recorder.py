"""Takes samples of an engine, and writes their channels to a history in blocks."""

import numpy as np

from crashsolve.output.history import HistoryWriter
from crashsolve.recording.histories import Histories


class Recorder:
    """Stores samples, and computes their values when a block is full or the history is due."""

    def __init__(self, histories: Histories, history: HistoryWriter) -> None:
        self.histories, self.history = histories, history
        self._times: list[float] = []

    def take(self, time: float, is_stored: bool = False) -> None:
        """Take the present sample, unless it has been stored already. Raises OutputError."""
        if not is_stored:
            self.histories.take()
        self.add_stored([time])

    def add_stored(self, times: list[float]) -> None:
        """Add samples at times [s] that have been stored already. Raises OutputError."""
        self._times += times
        if self.histories.kept.is_full or self.history.is_due():
            self._write_block()

    def flush(self) -> None:
        """Write all samples taken, after which no others are expected. Raises OutputError."""
        self._write_block(is_last=True)
        self.history.flush()

    def close(self) -> None:
        """Write all samples taken, and close the history."""
        try:
            self._write_block(is_last=True)
        finally:
            self.history.close()

    def _write_block(self, is_last: bool = False) -> None:
        if self._times:
            times, self._times = np.array(self._times), []
            values = self.histories.values()
            self.history.append(times, values, self.histories.extremes(len(times)), is_last)
