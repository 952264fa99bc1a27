"""The states of a run, read one at a time: blocks of points and cells, and their fields.

A result of any size needs the memory of its geometry and of one state (FILE_FORMAT.md, States).
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from crashpost.errors import PostError
from crashpost.results.state_checks import (
    Block,
    Damaged,
    check_corners,
    check_numbers,
    corners_of,
    field_of,
    points_of,
    sections_of,
    vertical_of,
)
from crashpost.results.text import printable

FORMAT = "crashsolve states"
FORMAT_VERSIONS = (2, 3)
# numbers of XDMF in a list of mixed cells: corners; a line says how many follow
LINE = 2
MIXED = {1: 1, LINE: 2, 4: 3, 5: 4, 6: 4, 8: 6, 9: 8}
# value of vtkGhostType for cells that are not drawn
GHOST, HIDDEN = "vtkGhostType", 32
__all__ = ["Block", "States"]
NOT_FIELDS = ("points", "cells")


class States:
    """States of a results folder, for pictures; raises PostError when it cannot be read."""

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        mesh = self.folder / "mesh.h5"
        self.files = sorted((self.folder / "states").glob("[0-9]*.h5"))
        if not mesh.is_file() or not self.files:
            raise PostError(f"{self.folder}: no states to draw (mesh.h5 and states/)")
        self.units: dict[str, str] = {}
        self._fields: dict[str, list[str]] = {}
        with _open(mesh) as file:
            self._check(mesh, file.attrs)
            names = json.loads(file.attrs.get("names", "{}"))
            self.names: dict[str, list[str]] = {
                kind: [printable(str(name)) for name in names.get(kind, [])]
                for kind in ("bodies", "parts", "contacts")
            }
            self.sections = sections_of(json.loads(file.attrs.get("sections", "[]")))
            self.up = vertical_of(json.loads(file.attrs.get("up", "[0, 0, 1]")))
            self.blocks = {name: self._block(name, file[name]) for name in file}
            self._name_blocks()
            check_numbers(self.blocks, self.names, len(self.sections))
        self.times = np.array([self._time(path) for path in self.files])

    def nearest(self, time: float) -> int:
        """Number of the state nearest to a time."""
        return int(np.argmin(np.abs(self.times - time)))

    def fields(self, block: str) -> list[str]:
        """Names of the fields of a block, points and displacement among them."""
        if block not in self._fields:
            with _open(self.files[0]) as file:
                group = file.get(block)
                changing = list(group) if isinstance(group, h5py.Group) else []
            self._fields[block] = [*changing, *self.blocks[block].fixed]
        return self._fields[block]

    def read(self, number: int, block: str, *names: str) -> dict[str, np.ndarray]:
        """Fields of a block at a state; those that it does not have are left out."""
        fields = {}
        with _open(self.files[number]) as file:
            for name in names:
                path = f"{block}/{name}"
                if path in file:
                    fields[name] = field_of(self.blocks[block], name, file[path])
                    self.units[name] = printable(str(file[path].attrs.get("unit", "")))
                elif name in self.blocks[block].fixed:
                    fields[name] = self.blocks[block].fixed[name]
        return fields

    def read_one(self, number: int, block: str, name: str) -> np.ndarray:
        """A field that every state of a block has; raises PostError without it."""
        values = self.read(number, block, name).get(name)
        if values is None:
            raise PostError(f"{self.files[number]}: damaged: {block} has no field '{name}'")
        return values

    def positions(self, number: int, block: str) -> np.ndarray:
        """Points (n, 3) of a block at a state."""
        fields = self.read(number, block, "points", "displacement")
        if "points" in fields:
            return fields["points"].astype(float)
        return self.blocks[block].points + fields.get("displacement", 0.0)

    def visible(self, number: int, block: str) -> np.ndarray:
        """Mask of the cells (m,) that are drawn: not deleted elements, nor contacts that are
        apart.
        """
        ghost = self.read(number, block, GHOST).get(GHOST)
        count = self.blocks[block].n_cells
        return np.ones(count, bool) if ghost is None else (ghost.astype(int) & HIDDEN) == 0

    def _name_blocks(self) -> None:
        """Version 2 knows no names: bodies are numbers there, parts those of the blocks."""
        centres, names = self.blocks.get("mass_centres"), self.names
        if centres is not None and not names["bodies"]:
            numbers = range(1, len(centres.points) + 1)
            names["bodies"] = ["ground", *(f"body {k}" for k in numbers)]
        if not names["parts"]:
            blocks = (name for name in self.blocks if name.startswith("part_"))
            names["parts"] = [name.removeprefix("part_") for name in blocks]

    def _check(self, path: Path, attributes: h5py.AttributeManager) -> None:
        version = attributes.get("format_version")
        if attributes.get("format") != FORMAT or version not in FORMAT_VERSIONS:
            raise PostError(
                f"{path}: not a {FORMAT} file of versions "
                f"{FORMAT_VERSIONS[0]} to {FORMAT_VERSIONS[-1]} (version {version})"
            )

    def _block(self, name: str, group: h5py.Group) -> Block:
        points, cells = points_of(group["points"]), corners_of(group["cells"])
        kinds = [(np.arange(len(cells)), cells)] if cells.ndim == 2 else _by_kind(cells)
        check_corners(kinds, len(points))
        bare = Block(name, points, kinds)
        fixed = {key: field_of(bare, key, group[key]) for key in group if key not in NOT_FIELDS}
        for key in fixed:
            self.units[key] = printable(str(group[key].attrs.get("unit", "")))
        return Block(name, points, kinds, fixed)

    def _time(self, path: Path) -> float:
        with _open(path) as file:
            time = float(file.attrs["time"])
            if not np.isfinite(time):
                raise Damaged("its time is no number")
            return time


def _by_kind(flat: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Cells of one kind each, from the list in which each begins with its number."""
    runs: list[tuple[int, list[int], list[int]]] = []
    index = row = 0
    while index < len(flat):
        code = int(flat[index])
        # points and lines are followed by how many corners they have
        first, corners = index + (2 if code <= LINE else 1), MIXED[code]
        if not runs or runs[-1][0] != corners:
            runs.append((corners, [], []))
        runs[-1][1].append(row)
        runs[-1][2].append(first)
        index, row = first + corners, row + 1
    return [
        (np.array(rows), flat[np.array(firsts)[:, None] + np.arange(corners)])
        for corners, rows, firsts in runs
    ]


@contextmanager
def _open(path: Path) -> Iterator[h5py.File]:
    try:
        with h5py.File(path, "r") as file:
            yield file
    except PostError:
        raise
    except Damaged as damage:
        raise PostError(f"{path}: {damage}") from damage
    except Exception as error:
        raise PostError(f"{path}: not readable ({error})") from error
