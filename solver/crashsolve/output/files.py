"""Files that are either whole or absent: temporary name, fsync, rename."""

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crashsolve.output.errors import OutputError

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
        raise OutputError(path, error) from error


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path; what is written there takes the name `path` in one instant."""
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


def replace_text(path: Path, text: str) -> None:
    """Write a whole text file so that no reader ever sees half of it."""
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8")


def write_metadata(
    file: "h5py.File", file_format: str, version: int, metadata: dict[str, Any]
) -> None:
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
