"""Signs of life: at least every ten seconds a run reports its activity.

Between samples the run itself does so, whenever the compiled loop pauses. What lasts long beside
that (reading a large deck, compiling, one long step, estimates of errors) is reported by a thread
that only looks at the clock.
"""

import threading
from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from typing import Self

# [s] after which the run reports at its next pause, and after which the thread does
AT_PAUSE, AT_LATEST = 8.0, 9.0
# [s] after the start that the first sign may take
FIRST = 0.9
POLL = 0.2


class Heartbeat:
    """Reports the activity of a run, by `print_line(text)`, while nothing else is reported."""

    def __init__(self, doing: str, print_line: Callable[[str], None]) -> None:
        self.print_line = print_line
        self._doing, self._since = doing, monotonic()
        self._reported, self._has_reported = self._since, False
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def does(self, doing: str) -> None:
        """Set the activity of the run from now on."""
        self._doing, self._since = doing, monotonic()

    def reported(self) -> None:
        """Note that a line has just been written."""
        self._reported, self._has_reported = monotonic(), True

    def is_due(self) -> bool:
        """Whether the run should say something at this pause."""
        return monotonic() - self._reported > AT_PAUSE

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._ended.wait(POLL):
            now = monotonic()
            if now - self._reported > (AT_LATEST if self._has_reported else FIRST):
                # a file that cannot be written stops the run where it writes itself
                with suppress(Exception):
                    self.print_line(f"{self._doing}: {now - self._since:.0f} s")
                self.reported()
