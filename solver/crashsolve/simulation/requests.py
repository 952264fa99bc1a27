"""Requests of a user to a run: by signals, and by words in control.txt of the results folder.

SIGTERM, SIGINT, SIGHUP, of a terminal that is closed, and SIGXCPU, of a limit of CPU time, dump and
stop, SIGUSR1 dumps and continues, SIGCONT is ignored (queues send it along). The words stop, dump
and states do the same. A run under nohup continues when its terminal closes.
"""

import signal
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from crashsolve.deck.diagnostics import shown
from crashsolve.output.files import read_plain, reported
from crashsolve.output.log import Log

# [s] between two looks at control.txt, which cost as much as a step of a small scene
POLL = 0.1
WORDS = {"stop", "dump", "states"}
# [bytes] of control.txt that are read
MAX_CONTROL = 4096
SIGNALS: dict[int, str] = {signal.SIGTERM: "stop", signal.SIGINT: "stop", signal.SIGUSR1: "dump"}
SIGNALS |= {signal.SIGHUP: "stop", signal.SIGXCPU: "stop"}


# signals that have asked a run to stop before it could dump anything
_interrupts: list[int] = []


def interrupt_as_keyboard() -> None:
    """Until there is a state to dump, signals stop the run as the keyboard does, without a dump."""
    _interrupts.clear()
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU):
        if not _is_ignored(number):
            signal.signal(number, _interrupt)
    signal.signal(signal.SIGUSR1, signal.SIG_IGN)


def _interrupt(number: int, _: object) -> None:
    _interrupts.append(number)
    raise KeyboardInterrupt


def _is_ignored(number: int) -> bool:
    """Whether the run was started to continue after a hangup, as by nohup."""
    return number == signal.SIGHUP and signal.getsignal(number) == signal.SIG_IGN


class Requests:
    """Requests that have not been met yet; `end` ends the process at once."""

    def __init__(self, folder: Path, log: Log, end: Callable[[], None]) -> None:
        self.words: set[str] = set()
        self._path, self._log, self._end = folder / "control.txt", log, end
        self._due = 0.0

    def catch(self) -> None:
        """Keep signals for the next pause; a second interrupt from the keyboard ends at once.

        Raises KeyboardInterrupt where one has come before and was lost: Python drops exceptions
        raised while it disposes of an object.
        """
        if _interrupts:
            raise KeyboardInterrupt
        interrupts = 0

        def keep(number: int, _: object) -> None:
            nonlocal interrupts
            self.words.add(SIGNALS[number])
            interrupts += number == signal.SIGINT
            if interrupts > 1:
                self._end()

        for number in SIGNALS:
            if not _is_ignored(number):
                signal.signal(number, keep)
        signal.signal(signal.SIGCONT, signal.SIG_IGN)

    def read(self) -> None:
        """Read the requests in control.txt and remove it; only a plain file is read.

        So is an empty one: its writer may only have opened it yet.
        """
        now = time.monotonic()
        if now < self._due:
            return
        self._due = now + POLL
        if not self._path.exists():
            return
        words: set[str] = set()
        # who has written it may take it back at any moment
        with reported(self._path), suppress(FileNotFoundError):
            text = read_plain(self._path, MAX_CONTROL)
            if text is None:
                self._log.warning("control.txt is not a plain file and is ignored")
                return
            if not text.strip():
                return
            words = set(text.split())
            self._path.unlink()
        self.words |= words & WORDS
        for word in sorted(words - WORDS):
            known = "dump, states, stop"
            self._log.warning(f"control.txt: unknown word {shown(word)} (words: {known})")
