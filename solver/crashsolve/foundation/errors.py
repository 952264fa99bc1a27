"""Errors a user may see, each with the exit code of the command that meets it."""

import re
from collections.abc import Iterable
from enum import IntEnum
from resource import RLIM_INFINITY, RLIMIT_AS, getrlimit

from crashsolve.foundation.streams import printable


class ExitCode(IntEnum):
    """Exit codes of the commands, for the shell and for queues."""

    NORMAL = 0
    INTERNAL = 1
    DECK = 2
    STOPPED = 3
    SOLVER = 4
    OUTPUT = 5


class CrashsolveError(Exception):
    """Any failure with a message for the user."""

    exit_code: int = ExitCode.INTERNAL


# errors of a deck that are shown at once
MAX_ERRORS = 200
# a word of more letters is cut: a number, or a name
_LONG = re.compile(r"[^\s'/]{101,}")


def _cut(match: re.Match[str]) -> str:
    return f"{match[0][:36]}... ({len(match[0])} letters)"


class DeckError(CrashsolveError):
    """One error in a deck: location, cause and advice."""

    exit_code = ExitCode.DECK

    def __init__(
        self,
        file: str,
        line: int | None,
        column: int | None,
        card: str,
        message: str,
        advice: str = "",
    ) -> None:
        self.file = file
        self.line = line
        self.column = column
        self.card = card
        self.message = message
        self.advice = advice
        super().__init__(file, line, column, card, message, advice)

    def __str__(self) -> str:
        # a value set from outside stands in the place of a file
        file = _LONG.sub(_cut, self.file) if self.file.startswith("--set ") else self.file
        location = ":".join(str(part) for part in (file, self.line, self.column) if part)
        card = f"{self.card}: " if self.card else ""
        # a list of what is known, in brackets, belongs to the message
        mark = " " if self.advice.startswith("(") else "; "
        advice = f"{mark}{self.advice}" if self.advice else ""
        return printable(f"{location}: error: {card}" + _LONG.sub(_cut, f"{self.message}{advice}"))


class DeckErrors(CrashsolveError):
    """All errors of a deck, in the order in which they stand in it."""

    exit_code = ExitCode.DECK

    def __init__(self, errors: Iterable[DeckError]) -> None:
        self.errors = list(errors)
        super().__init__(self.errors)

    def __str__(self) -> str:
        lines = [str(error) for error in self.errors[:MAX_ERRORS]]
        if len(self.errors) > MAX_ERRORS:
            lines.append(f"error: {len(self.errors) - MAX_ERRORS} more like these")
        return "\n".join(lines)


class SolverError(CrashsolveError):
    """A numerical stop: time, location, likely cause and advice."""

    exit_code = ExitCode.SOLVER

    def __init__(
        self, time: float, cycle: int, location: str, cause: str, advice: str = ""
    ) -> None:
        self.time = time
        self.cycle = cycle
        self.location = location
        self.cause = cause
        self.advice = advice
        super().__init__(time, cycle, location, cause, advice)

    def __str__(self) -> str:
        advice = f"; {self.advice}" if self.advice else ""
        message = (
            f"t = {self.time:.6g} s, cycle {self.cycle}, {self.location}: {self.cause}{advice}"
        )
        return printable(message)


class RunStopped(CrashsolveError):
    """The run was asked to stop and has left a restart dump."""

    exit_code = ExitCode.STOPPED


def cannot_load(error: OSError) -> str:
    """The message that a library cannot be loaded, with the limit of memory if there is one."""
    first = str(error).split(". ")[0]
    is_limited = getrlimit(RLIMIT_AS)[0] != RLIM_INFINITY
    return f"a library cannot be loaded: {first}" + f"; {out_of_memory()}" * is_limited


def out_of_memory() -> str:
    """The message that memory was refused, with the limit that refused it."""
    limit, _ = getrlimit(RLIMIT_AS)
    whose = "of this machine is used up"
    if limit != RLIM_INFINITY:
        whose = f"is limited to {limit / 1e9:.3g} GB for this process (ulimit -v, or the queue)"
    return f"out of memory: it {whose}; ask for more, or make the model smaller"
