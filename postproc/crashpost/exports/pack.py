"""Merges the states of a run into one VTKHDF file, which ParaView 5.12 and later and pyvista play.

All blocks are one unstructured grid, in place at each time; `block` distinguishes them. What a
block does not have is not a number there. Geometry that never changes is written once. The format
is that of the VTK file formats, VTKHDF 2.0, with steps; states are read one by one.
"""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

from crashpost.errors import PostError
from crashpost.results.states import GHOST, Block, States

# cell types of VTK by corners; four corners in a plane are a quadrilateral
VTK_TYPES = {1: 1, 2: 3, 3: 5, 4: 9, 6: 13, 8: 12}
SKIPPED = ("points", "displacement")
# numbers of a piece of a dataset on disk
PIECE = 1 << 16
# [bytes] of corners and types of a cell, at most eight corners; of headers of the file
CELL, HEADERS = 80, 1 << 18


def pack(states: States, path: Path, progress: Callable[[int, int], None]) -> str:
    """Write the file and report its content; raises PostError."""
    partial = path.with_name(f".{path.name}.partial")
    packing = _Packing(states)
    try:
        # a file that cannot be written to its end ends HDF5 itself
        free = shutil.disk_usage(path.parent).free
        if packing.size > free:
            message = f"needs {packing.size / 1e6:.3g} MB, and {free / 1e6:.3g} MB are free"
            raise PostError(f"{path}: {message}")
        with h5py.File(partial, "w") as file:
            packing.write(file, progress)
        partial.replace(path)
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else error
        raise PostError(f"{path}: {reason}") from error
    finally:
        partial.unlink(missing_ok=True)
    names = ", ".join(f"{k} {name}" for k, name in enumerate(states.blocks))
    return f"{path}: {len(states.times)} states, {len(packing.fields)} fields, blocks {names}"


class _Packing:
    def __init__(self, states: States) -> None:
        self.states = states
        self.blocks = list(states.blocks.values())
        self.n_points = sum(len(block.points) for block in self.blocks)
        self.n_cells = sum(block.n_cells for block in self.blocks)
        self.fields = self._fields()

    @property
    def size(self) -> int:
        """Size of the file [bytes], rather high than low."""
        per_state = 24 * self.n_points + 8 * (len(self.fields) + 8)
        for (_, association), width in self.fields.items():
            per_state += 4 * width * self._count(association)
        return len(self.states.times) * per_state + CELL * self.n_cells + HEADERS

    def _count(self, association: str) -> int:
        """Number of points, or of cells."""
        return self.n_points if association == "PointData" else self.n_cells

    def write(self, file: h5py.File, progress: Callable[[int, int], None]) -> None:
        """All states."""
        self.root = file.create_group("VTKHDF")
        self.root.attrs["Version"] = (2, 0)
        kind = b"UnstructuredGrid"
        self.root.attrs.create("Type", kind, dtype=h5py.string_dtype("ascii", len(kind)))
        count, fields = len(self.states.times), self.fields
        self._topology(count)
        for (name, association), width in fields.items():
            size = self._count(association)
            shape = (size * count,) if width == 1 else (size * count, width)
            kind = "u1" if name == GHOST else "f4"
            self.root.create_dataset(f"{association}/{name}", shape, kind, chunks=_chunk(shape))
        shape = (self.n_points * count, 3)
        points = self.root.create_dataset("Points", shape, "f8", chunks=_chunk(shape))
        for k in range(count):
            points[k * self.n_points : (k + 1) * self.n_points] = np.concatenate(
                [self.states.positions(k, block.name) for block in self.blocks]
            )
            for (name, association), width in fields.items():
                values = self._values(k, name, association, width)
                self.root[f"{association}/{name}"][k * len(values) : (k + 1) * len(values)] = values
            progress(k + 1, count)
        self._steps(count, list(fields))

    def _fields(self) -> dict[tuple[str, str], int]:
        """Name and location of every field of any block, and its components."""
        sizes: dict[tuple[str, str], int] = {}
        for block in self.blocks:
            for name in self.states.fields(block.name):
                if name not in SKIPPED:
                    values = self.states.read_one(0, block.name, name)
                    sizes[name, _position(block, name, values)] = 1 if values.ndim == 1 else 3
        sizes["displacement", "PointData"] = 3
        sizes["block", "CellData"] = 1
        return sizes

    def _values(self, k: int, name: str, association: str, width: int) -> np.ndarray:
        """A field of all blocks at a state."""
        parts = []
        for number, block in enumerate(self.blocks):
            size = len(block.points) if association == "PointData" else block.n_cells
            shape = (size,) if width == 1 else (size, width)
            field = self.states.read(k, block.name, name).get(name)
            if name == "block":
                parts.append(np.full(shape, float(number)))
            elif (
                field is not None
                and field.shape == shape
                and _position(block, name, field) == association
            ):
                parts.append(field)
            else:
                parts.append(np.full(shape, 0.0 if name in (GHOST, "displacement") else np.nan))
        return np.concatenate(parts)

    def _topology(self, count: int) -> None:
        """Cells, the same at all times."""
        corners, sizes, types, first = [], [], [], 0
        for block in self.blocks:
            rows = np.concatenate([rows for rows, _ in block.cells])
            order = np.argsort(rows)
            cells = [row for _, table in block.cells for row in table + first]
            corners += [cells[k] for k in order]
            first += len(block.points)
        sizes = [len(cell) for cell in corners]
        types = [VTK_TYPES[size] for size in sizes]
        self.root["Connectivity"] = np.concatenate(corners).astype("i8")
        self.root["Offsets"] = np.concatenate([[0], np.cumsum(sizes)]).astype("i8")
        self.root["Types"] = np.array(types, "u1")
        totals = {
            "NumberOfPoints": self.n_points,
            "NumberOfCells": self.n_cells,
            "NumberOfConnectivityIds": sum(sizes),
        }
        for name, number in totals.items():
            self.root[name] = np.full(count, number, "i8")

    def _steps(self, count: int, fields: list[tuple[str, str]]) -> None:
        """Write the offsets of the numbers of each time."""
        steps = self.root.create_group("Steps")
        steps.attrs["NSteps"] = count
        steps["Values"] = self.states.times
        zero, k = np.zeros(count, "i8"), np.arange(count, dtype="i8")
        steps["PartOffsets"], steps["NumberOfParts"] = zero, np.ones(count, "i8")
        steps["PointOffsets"] = k * self.n_points
        steps["CellOffsets"] = zero[:, None]
        steps["ConnectivityIdOffsets"] = zero[:, None]
        for name, association in fields:
            size = self._count(association)
            steps[f"{association}Offsets/{name}"] = k * size


def _position(block: Block, name: str, values: np.ndarray) -> str:
    """Whether a field is one of points or of cells; vectors in space are those of points."""
    if name == GHOST or (values.ndim == 1 and len(values) == block.n_cells) or name == "side":
        return "CellData"
    return "PointData"


def _chunk(shape: tuple[int, ...]) -> tuple[int, ...]:
    return (max(1, min(shape[0], PIECE)), *shape[1:])
