"""A state file without its numbers: HDF5 lays it out once, and every state fills it in.

To HDF5 every dataset of every state is a new object, and costs as much as tens of steps of a small
scene. But the state files of a run differ in their numbers alone, and these lie in all of them
where HDF5 has put them in the first.
"""

import struct
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crashsolve.output.blocks import Block
from crashsolve.output.files import HDF5_OPTIONS, replacing
from crashsolve.output.layout import reserve

# stands for the time in the layout, where its bytes must be found once
MARK = 2.9979245812345678e-211
SIZE_OF_TIME = 8  # [bytes]


class Field(NamedTuple):
    """Numbers of a field of a block, as the file has them."""

    block: str
    name: str
    shape: tuple[int, ...]
    dtype: str


FieldSlot = tuple[int, int, Field | None]  # offset and size in bytes; None: the time


class Template:
    """The layout of the state files of some blocks."""

    def __init__(self, blocks: tuple[Block, ...]) -> None:
        image, self._positions = _laid_out(blocks)
        ends = [(0, 0), *((offset, offset + size) for offset, size, _ in self._positions)]
        # the bytes before each of the positions, and behind the last
        self._between = [image[a[1] : b[0]] for a, b in pairwise([*ends, (len(image), 0)])]

    def write(self, path: Path, time: float, values: dict[str, dict[str, np.ndarray]]) -> None:
        """Write a state: block name -> field name -> array. Raises OutputError."""
        with replacing(path) as partial, open(partial, "wb") as file:
            for before, (_, _, what) in zip(self._between, self._positions, strict=False):
                file.write(before)
                file.write(struct.pack("<d", time) if what is None else _bytes(what, values))
            file.write(self._between[-1])


def _bytes(field: Field, values: dict[str, dict[str, np.ndarray]]) -> memoryview:
    array = np.asarray(values[field.block][field.name])
    if array.shape != field.shape:
        raise ValueError(f"{field.block}, {field.name}: shape {array.shape}")
    return np.ascontiguousarray(array, field.dtype).data.cast("B")


def _laid_out(blocks: tuple[Block, ...]) -> tuple[bytes, list[FieldSlot]]:
    """A file with room for everything, made in memory, and where its numbers are, in order."""
    import h5py

    positions: list[FieldSlot] = []
    with h5py.File("state", "w", driver="core", backing_store=False, **HDF5_OPTIONS) as file:
        file.attrs["time"] = MARK
        for block in blocks:
            for field in block.all_fields:
                name, shape = f"{block.name}/{field.name}", block.shape(field)
                data = reserve(file, name, shape, field.dtype, fill_time="never")
                data.attrs["unit"] = field.unit
                what = Field(block.name, field.name, shape, field.dtype)
                positions.append((data.id.get_offset(), data.nbytes, what))
        file.flush()
        image = file.id.get_file_image()
    mark = struct.pack("<d", MARK)
    if image.count(mark) != 1:
        raise RuntimeError("the time of a state must stand once in the layout of its file")
    positions.append((image.index(mark), SIZE_OF_TIME, None))
    return image, sorted(positions, key=lambda position: position[0])
