"""Memory pages of a library that are no longer used: returned to the system until needed again."""

import ctypes
import mmap
import re
from collections.abc import Iterator
from contextlib import suppress

# a mapping in /proc/self/smaps: begin, end, rights, file
MAPPING = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) (\S{4}) \S+ \S+ \S+ *(.*)$")


def release_pages(library: str) -> None:
    """Drop the unchanged pages of a library from memory; the system reads them from its file again.

    Where the system has no list of pages, nothing happens.
    """
    with suppress(AttributeError, OSError):
        advise = ctypes.CDLL(None).madvise
        advise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
        for begin, end in list(_unchanged(library)):
            advise(begin, end - begin, mmap.MADV_DONTNEED)


def _unchanged(library: str) -> Iterator[tuple[int, int]]:
    """Address ranges of a library's pages that have not been written to."""
    begin = end = changed = 0
    with open("/proc/self/smaps", encoding="utf-8") as file:
        for line in file:
            if fields := MAPPING.match(line):
                begin, end = int(fields[1], 16), int(fields[2], 16)
                changed = "w" in fields[3] or library not in fields[4]
            elif line.startswith(("Anonymous:", "Swap:")):
                changed += int(line.split()[1])
            elif line.startswith("VmFlags:") and not changed:
                yield begin, end
