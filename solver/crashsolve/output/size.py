"""Predicted size of the files of a run: bytes of the history and of the states.

Without headers, restart dumps and the log.
"""

import shutil
from collections.abc import Iterable
from math import prod
from pathlib import Path

import numpy as np

from crashsolve.output.blocks import Block
from crashsolve.output.channels import Family

# bytes of a number in the history
NUMBER = 8
UNITS = ((1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB"))


def history_size(families: Iterable[Family], samples: int) -> float:
    """Bytes of a history: the times, and every channel at every sample."""
    channels = sum(len(family.ids) * len(family.columns) for family in families)
    return float(NUMBER * (1 + channels)) * samples


def states_size(blocks: Iterable[Block], states: int) -> float:
    """Bytes of the states: points or displacements, and fields."""
    each = [
        prod(block.shape(field)) * np.dtype(field.dtype).itemsize
        for block in blocks
        for field in block.all_fields
    ]
    return float(sum(each)) * states


def in_words(size: float) -> str:
    """A size in bytes, as one reads it."""
    unit, name = next(((u, n) for u, n in UNITS if size >= u), (1.0, "bytes"))
    return f"{size / unit:.3g} {name}"


def free_space(folder: Path) -> int:
    """Bytes that are free where a folder is, or will be."""
    folder = folder.absolute()
    while not folder.exists():
        folder = folder.parent
    return shutil.disk_usage(folder).free
