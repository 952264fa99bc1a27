"""Memory pages of a library that are no longer used: returned to the system until needed again."""

import ctypes
import mmap
import re
from collections.abc import Iterator
from contextlib import suppress
from functools import cache

# a mapping in /proc/self/smaps: begin, end, rights, file, and the lines about it
MAPPING = re.compile(rb"([0-9a-f]+)-([0-9a-f]+) (\S{4}) .*\n((?:[A-Z].*\n)*)")
# [kB] of its pages that are no longer those of the file
CHANGED = re.compile(rb"^(?:Anonymous|Swap): +(\d+)", re.MULTILINE)


def release_pages(library: str) -> None:
    """Drop the unchanged pages of a library from memory; the system reads them from its file again.

    Where the system has no list of pages, nothing happens.
    """
    with suppress(AttributeError, OSError):
        advise = ctypes.CDLL(None).madvise
        advise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
        for begin, end in _unchanged(library):
            advise(begin, end - begin, mmap.MADV_DONTNEED)


@cache
def _unchanged(library: str) -> tuple[tuple[int, int], ...]:
    """Address ranges of a library's pages that have not been written to, and cannot be."""
    return tuple(_ranges(library))


def _ranges(library: str) -> Iterator[tuple[int, int]]:
    with open("/proc/self/smaps", "rb") as file:
        text = file.read()
    # a process has hundreds of mappings: only those of the library are read
    at = text.find(library.encode())
    while at >= 0:
        fields = MAPPING.match(text, text.rfind(b"\n", 0, at) + 1)
        if fields and b"w" not in fields[3] and not any(map(int, CHANGED.findall(fields[4]))):
            yield int(fields[1], 16), int(fields[2], 16)
        at = text.find(library.encode(), fields.end() if fields else at + 1)
