"""Takes the reserved rows from the datasets of a history in place, without a copy of the others.

The header of a dataset states its shape, and where its numbers are and how many bytes. Both are
changed where HDF5 has written them; the room of the rows taken stays in the file, unused. A header
is valid after each of its numbers has been changed, and until the last one every dataset has at
least the rows that stay: whatever moment the process is killed, these are whole.

Reference: HDF5 File Format Specification, version 3.0, IV.A.1.a (object header, version 1),
IV.A.2.b (dataspace message, version 1) and IV.A.2.i (data layout message, version 3).
"""

import os
import struct
from collections.abc import Iterable
from io import FileIO

from crashsolve.output.layout import write_at

# an object header of version 1: bytes before its messages, and those read, which reach the layout
VERSION, PREFIX, READ = 1, 16, 512
# type and size of a message, which follows
MESSAGE = struct.Struct("<HHxxxx")
DATASPACE, LAYOUT = 1, 8
# of a dataspace: version, dimensions, whether their limits follow; of a layout: version, class
SPACE, SHAPE_AT, HAS_LIMITS = struct.Struct("<BBB"), 8, 1
CLASS, CONTIGUOUS, SIZE_AT = struct.Struct("<BB"), (3, 1), 10
NUMBER = struct.Struct("<Q")


class UnknownHeader(Exception):
    """A header is not as HDF5 writes those of contiguous datasets of so many rows."""


def trim(file: FileIO, headers: Iterable[int], capacity: int, rows: int) -> None:
    """Shorten contiguous datasets from `capacity` rows; `headers`: where theirs begin in the file.

    Raises UnknownHeader before anything is changed, OSError.
    """
    trimmed = [(at, _trimmed(os.pread(file.fileno(), READ, at), capacity, rows)) for at in headers]
    for at, header in trimmed:
        write_at(file, at, memoryview(header))


def _trimmed(header: bytes, capacity: int, rows: int) -> bytes:
    """A header with other rows, up to the end of its layout message."""
    new, at, kind = bytearray(header), PREFIX, 0
    try:
        if header[0] != VERSION:
            raise UnknownHeader
        while kind != LAYOUT:
            kind, size = MESSAGE.unpack_from(header, at)
            at += MESSAGE.size
            if kind == DATASPACE:
                _replace_rows(new, at, capacity, rows)
            elif kind == LAYOUT:
                _replace_size(new, at, capacity, rows)
            at += size
    except (IndexError, struct.error) as error:
        raise UnknownHeader from error
    return bytes(new[:at])


def _replace_rows(header: bytearray, at: int, capacity: int, rows: int) -> None:
    """Replace the rows in a dataspace message, and their limit, which is the same."""
    version, dimensions, flags = SPACE.unpack_from(header, at)
    limits_at = SHAPE_AT + NUMBER.size * dimensions
    for offset in (SHAPE_AT, limits_at) if flags & HAS_LIMITS else (SHAPE_AT,):
        if version != 1 or NUMBER.unpack_from(header, at + offset) != (capacity,):
            raise UnknownHeader
        NUMBER.pack_into(header, at + offset, rows)


def _replace_size(header: bytearray, at: int, capacity: int, rows: int) -> None:
    """Replace the bytes of all rows in a layout message."""
    (size,) = NUMBER.unpack_from(header, at + SIZE_AT)
    if CLASS.unpack_from(header, at) != CONTIGUOUS or size % capacity:
        raise UnknownHeader
    NUMBER.pack_into(header, at + SIZE_AT, size // capacity * rows)
