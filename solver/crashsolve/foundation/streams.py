"""Text for a terminal that cannot be forged, and standard streams that may be closed or full."""

import os
import re
import sys
from contextlib import suppress
from typing import TextIO

# control characters, ends of lines, marks that turn the order of letters, halves of characters
_UNPRINTABLE = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)

# why standard output was given up before there was a log that could say so
lost: list[str] = []


def printable(text: str) -> str:
    """A text as one line: control characters are escaped."""
    return _UNPRINTABLE.sub(_escaped, text)


def _escaped(match: re.Match[str]) -> str:
    return repr(match[0])[1:-1] if ord(match[0]) < 0xA0 else f"\\u{ord(match[0]):04x}"


def open_standard_streams() -> None:
    """Give each closed standard stream the null device.

    Otherwise the next file to be opened, results perhaps, would be taken by the system libraries
    for standard output. What an encoding cannot write is spelt out.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    with suppress(AttributeError, ValueError):
        sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


def discard_output(stream: TextIO) -> None:
    """Redirect buffered and later output to the null device, against errors at exit."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def report_error(text: str) -> None:
    """Write to standard error, if anybody listens."""
    try:
        print(text, file=sys.stderr, flush=True)
    except OSError:
        discard_output(sys.stderr)


def print_line(text: str = "") -> None:
    """Write to standard output if it is open: for work that continues in any case."""
    try:
        # in one piece: several threads may report
        sys.stdout.write(f"{text}\n")
        sys.stdout.flush()
    except OSError as error:
        discard_output(sys.stdout)
        # a reader such as `head` has seen enough
        if not isinstance(error, BrokenPipeError):
            lost.append(error.strerror or str(error))
