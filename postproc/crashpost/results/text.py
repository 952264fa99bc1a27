"""Text of files that anybody may have written: read without waiting, shown without obeying it."""

import os
import re
import stat
from pathlib import Path

# bytes of a text file that are read
MAX_BYTES = 1 << 28
# control characters, ends of lines, marks that turn the order of letters, halves of characters
_UNPRINTABLE = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def plain_text(path: Path) -> str | None:
    """Text of a plain file; None without one, also for a folder, or a pipe that would wait."""
    try:
        about = os.stat(path)
        if not stat.S_ISREG(about.st_mode):
            return None
        with path.open("rb") as file:
            # a file takes the memory that is asked for before it is read
            return file.read(min(about.st_size, MAX_BYTES)).decode("utf-8", errors="replace")
    except (OSError, ValueError):
        return None


def printable(text: str) -> str:
    """A text as one line: control characters are escaped."""
    return _UNPRINTABLE.sub(_escaped, text)


def _escaped(match: re.Match[str]) -> str:
    return repr(match[0])[1:-1] if ord(match[0]) < 0xA0 else f"\\u{ord(match[0]):04x}"


def printable_lines(text: str) -> str:
    """Several lines of a text, each made printable."""
    return "\n".join(map(printable, text.split("\n")))
