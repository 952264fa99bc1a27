"""Files that are either whole or absent: temporary name, fsync, rename."""

import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import FileIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crashsolve.output.errors import OutputError

# a table of a JSON file
Json = dict[str, Any]

if TYPE_CHECKING:
    import h5py

HDF5_OPTIONS: dict[str, Any] = {
    # ParaView 5.11 is built on HDF5 1.10
    "libver": ("earliest", "v110"),
    # an aligned double never straddles a page, so that no write of it is ever torn
    "alignment_threshold": 1,
    "alignment_interval": 8,
}


@contextmanager
def reported(path: Path) -> Iterator[None]:
    """Turn a failure of the operating system or of HDF5 into an OutputError naming the file."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        number = getattr(error, "errno", None)
        raise OutputError(path, os.strerror(number) if number else error) from error


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path; the file is renamed to `path` at the end, in one operation."""
    partial = path.with_name(path.name + ".partial")
    with reported(path):
        try:
            yield partial
            _sync(partial)
            os.replace(partial, path)
            _sync(path.parent)
        except BaseException:
            partial.unlink(missing_ok=True)
            raise


@contextmanager
def replacing_hdf5(path: Path) -> Iterator["h5py.File"]:
    """Yield a new HDF5 file that takes the name `path` once it is whole."""
    with replacing(path) as partial, new_hdf5(partial) as file:
        yield file


@contextmanager
def new_hdf5(path: Path) -> Iterator["h5py.File"]:
    """Yield a new HDF5 file. Raises OSError once it is closed where it could not be written."""
    import h5py

    with _UnfailingFile(path, "w+") as raw:
        with h5py.File(raw, "w", **HDF5_OPTIONS) as file:
            yield file
        if raw.failure:
            raise raw.failure


class _UnfailingFile(FileIO):
    """A file that keeps its first failure to itself, for the caller to raise after closing.

    HDF5 cannot close a file once a write has failed: it holds on to it and complains at exit.
    """

    failure: OSError | None = None

    def write(self, data: Any) -> int:
        """Write all of the data, or note why not."""
        rest = memoryview(data).cast("B")
        size = len(rest)
        try:
            while rest and not self.failure:
                rest = rest[super().write(rest) :]
        except OSError as error:
            self.failure = error
        return size

    def truncate(self, size: int | None = None) -> int:
        """Set the size, or note why not."""
        try:
            return super().truncate(size)
        except OSError as error:
            self.failure = self.failure or error
            return size or 0


def replace_text(path: Path, text: str) -> None:
    """Write a whole text file so that no reader ever sees half of it."""
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8")


def read_plain(path: Path, most: int) -> str | None:
    """First `most` bytes of a plain file; None for a folder, pipe or device. Raises OSError."""
    if not stat.S_ISREG(os.stat(path).st_mode):
        return None
    with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as file:
        return file.read(most).decode(errors="replace")


def write_metadata(file: "h5py.File", file_format: str, version: int, metadata: Json) -> None:
    """Write root attributes: text and numbers as they are, everything else as JSON text."""
    file.attrs["format"] = file_format
    file.attrs["format_version"] = version
    for name, value in metadata.items():
        plain = isinstance(value, str | int | float)
        file.attrs[name] = value if plain else json.dumps(value, ensure_ascii=False)


def _sync(path: Path) -> None:
    """Wait until a file or folder has reached the disk, so that a rename survives a power cut."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
