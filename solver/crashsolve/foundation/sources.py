"""The source files of the package: the tree is the registry of families and of laws."""

import os
from collections.abc import Iterator
from functools import cache


@cache
def source_files(root: str) -> tuple[str, ...]:
    """Paths of all Python files below a folder, with it, sorted."""
    return tuple(sorted(_below(root)))


def _below(folder: str) -> Iterator[str]:
    # pathlib would take several times as long, as would the folders of Python's own cache
    for entry in os.scandir(folder):
        if entry.name.endswith(".py"):
            yield entry.path
        elif entry.name != "__pycache__" and entry.is_dir(follow_symlinks=False):
            yield from _below(entry.path)
