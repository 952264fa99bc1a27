"""Units that wait for their machine code, compiled by this process and by another one.

The other process begins while kernels are still being translated. Each takes the longest text
that waits, so both end at about the same time.
"""

import os
import pickle
from collections.abc import Callable
from pathlib import Path
from threading import Condition, Thread
from typing import BinaryIO, NamedTuple

from crashsolve.compiler.cache import read_sealed, write_sealed

# characters of text in which a process of its own is worth its start, some hundredths of a second
LONG = 200_000


class Unit(NamedTuple):
    """A text in LLVM's language, and the file for its code."""

    path: Path
    text: str


class Work:
    """Units that wait, and the code of those that are compiled."""

    def __init__(self, compile_text: Callable[[str], bytes]) -> None:
        self.compile_text = compile_text
        self.codes: dict[Path, bytes] = {}
        self._waiting: list[Unit] = []
        self._length = 0
        self._is_complete = False
        self._changed = Condition()
        self._helper: Thread | None = None

    def add(self, unit: Unit) -> None:
        """Have a unit compiled."""
        self._put(unit)
        self._length += len(unit.text)
        is_shared = len(self._waiting) > 1 and self._length > LONG
        if self._helper is None and is_shared and len(os.sched_getaffinity(0)) > 1:
            child = _started(self.compile_text)
            # it does not outlast an error of the translation
            self._helper = Thread(target=self._delegate, args=child, daemon=True)
            self._helper.start()

    def finish(self) -> None:
        """Compile what still waits. Raises CacheError."""
        with self._changed:
            self._is_complete = True
            self._changed.notify()
        self._compile_waiting()
        if self._helper is not None:
            self._helper.join()
            # what the other process could not make shows its error here
            self._compile_waiting()

    def _compile_waiting(self) -> None:
        while unit := self._taken():
            self.codes[unit.path] = _compiled(unit, self.compile_text)

    def _put(self, unit: Unit) -> None:
        with self._changed:
            self._waiting.append(unit)
            self._changed.notify()

    def _taken(self) -> Unit | None:
        """The longest unit that waits, which waits no more."""
        with self._changed:
            if not self._waiting:
                return None
            longest = max(self._waiting, key=lambda unit: len(unit.text))
            self._waiting.remove(longest)
            return longest

    def _delegate(self, child: int, units: BinaryIO, done: BinaryIO) -> None:
        """Give the other process one unit after another; one that it cannot compile waits again."""
        with units, done:
            while unit := self._awaited():
                code = _answer(unit, units, done)
                if code is None:
                    self._put(unit)
                    break
                self.codes[unit.path] = code
        os.waitpid(child, 0)

    def _awaited(self) -> Unit | None:
        """The next unit; None where no more will come."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._is_complete)
            return self._taken()


def _compiled(unit: Unit, compile_text: Callable[[str], bytes]) -> bytes:
    """Machine code of a unit, also written to its file."""
    code = compile_text(unit.text)
    # a damaged file is made anew: there is no need to wait for the disk
    write_sealed(unit.path, code, sync=False)
    return code


def _started(compile_text: Callable[[str], bytes]) -> tuple[int, BinaryIO, BinaryIO]:
    """Another process that compiles: its number, the file it reads, and the file it answers by."""
    (units, to_child), (from_child, done) = os.pipe(), os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(to_child)
            os.close(from_child)
            with open(units, "rb") as source, open(done, "wb") as answers:
                _serve(source, answers, compile_text)
        finally:
            os._exit(0)
    os.close(units)
    os.close(done)
    return child, open(to_child, "wb"), open(from_child, "rb")


def _serve(units: BinaryIO, done: BinaryIO, compile_text: Callable[[str], bytes]) -> None:
    """Compile units until no more come, and answer after each."""
    while True:
        try:
            unit = pickle.load(units)
        except EOFError:
            return
        _compiled(unit, compile_text)
        done.write(b".")
        done.flush()


def _answer(unit: Unit, units: BinaryIO, done: BinaryIO) -> bytes | None:
    """Code that the other process has made of a unit; None where it has failed."""
    try:
        pickle.dump(unit, units)
        units.flush()
    except OSError:
        return None
    return read_sealed(unit.path) if done.read(1) else None
