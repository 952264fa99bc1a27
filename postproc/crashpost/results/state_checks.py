"""What states must hold before anything is drawn of them: shapes, kinds of numbers, references.

All raise Damaged, which the reader of a file turns into an error with the name of the file.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import h5py
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# a section's outline in a plane, and how many corners a cell may have
FLAT, CORNERS = 2, (1, 2, 3, 4, 6, 8)
# of values: products of three of them are still numbers
LARGEST = 1e100


class Damaged(ValueError):
    """A file of states is damaged."""


@dataclass(frozen=True)
class Block:
    """A mesh drawn as one thing; `rows` of each array of corners are its positions among all
    cells.
    """

    name: str
    points: np.ndarray
    cells: list[tuple[np.ndarray, np.ndarray]]  # rows, corners (m, k)
    fixed: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def n_cells(self) -> int:
        return sum(len(rows) for rows, _ in self.cells)


# what a group of a file of states holds
Item = h5py.Dataset | h5py.Group | h5py.Datatype


def numbers_of(item: Item) -> np.ndarray:
    """The finite numbers of a dataset."""
    if not isinstance(item, h5py.Dataset):
        raise Damaged(f"{item.name} is no dataset")
    name = item.name.lstrip("/")
    if item.external or item.is_virtual:
        raise Damaged(f"{name} lies in another file")
    if item.dtype.kind not in "fiu":
        raise Damaged(f"{name} holds no numbers")
    values: np.ndarray = item[...]
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise Damaged(f"{name} holds values that are no finite numbers")
    if values.dtype.kind == "f" and values.size and np.abs(values).max().item() > LARGEST:
        raise Damaged(f"{name} holds values beyond {LARGEST:g}, which cannot be drawn")
    return values


def points_of(item: Item) -> np.ndarray:
    """Points (n, 3)."""
    points = numbers_of(item)
    if points.ndim != 2 or points.shape[1] != 3:
        raise Damaged(f"{item.name} has the shape {points.shape}, not (n, 3)")
    return points


def corners_of(item: Item) -> np.ndarray:
    """Numbers of points of cells, (m, k) or a list of mixed cells."""
    cells = numbers_of(item)
    if cells.dtype.kind not in "iu" or cells.ndim not in (1, 2):
        raise Damaged(f"{item.name} holds no numbers of points")
    return cells.astype(np.int64)


def check_corners(cells: list[tuple[np.ndarray, np.ndarray]], count: int) -> None:
    """Cells must be made of points that are there."""
    for _, corners in cells:
        if corners.shape[1] not in CORNERS:
            raise Damaged(f"cells of {corners.shape[1]} corners are not known")
        if corners.size and not (corners.min() >= 0 and corners.max() < count):
            raise Damaged(f"cells name points that are not among the {count}")


def field_of(block: Block, name: str, item: Item) -> np.ndarray:
    """Values of a field at the points or cells of a block."""
    values = numbers_of(item)
    if values.ndim not in (1, 2) or len(values) not in (len(block.points), block.n_cells):
        raise Damaged(
            f"{item.name} has the shape {values.shape}; the block has {len(block.points)} points "
            f"and {block.n_cells} cells"
        )
    if name in VECTORS and values.shape != (len(block.points), 3):
        raise Damaged(f"{item.name} has the shape {values.shape}, not that of its points")
    if name in OF_CELLS and values.shape != (block.n_cells,):
        raise Damaged(f"{item.name} has the shape {values.shape}, not one for each cell")
    return values


# fields whose shape later code relies on
VECTORS = frozenset({"points", "displacement", "force", "rotation", "velocity"})
REQUIRED = {"beams": {"part", "section", "side"}, "links": {"body"}}
OF_CELLS = frozenset({"body", "part", "contact", "section", "vtkGhostType"})


def check_numbers(blocks: dict[str, Block], names: dict[str, list[str]], n_sections: int) -> None:
    """Bodies, parts, contacts and sections that blocks name by number must have a name."""
    counts = {"body": len(names["bodies"]), "part": len(names["parts"]), "section": n_sections}
    for block in blocks.values():
        for key, count in counts.items():
            values = block.fixed.get(key)
            if values is None or not len(values):
                continue
            if not (values.min() >= 0 and values.max() < max(count, 1)):
                raise Damaged(f"{block.name}/{key} names {key} {values.max():g} of {count}")
    for name, required in REQUIRED.items():
        if name in blocks and (missing := sorted(required - blocks[name].fixed.keys())):
            raise Damaged(f"{name} has no {missing[0]}")
    beams = blocks.get("beams")
    if beams is not None and beams.fixed["side"].shape != (beams.n_cells, 3):
        raise Damaged("beams/side has no direction for each beam")
    centres = blocks.get("mass_centres")
    if centres is not None and len(centres.points) != len(names["bodies"]) - 1:
        raise Damaged(f"{len(centres.points)} mass centres of {len(names['bodies'])} bodies")


def sections_of(entries: Iterable[ArrayLike]) -> list[np.ndarray]:
    """Outlines (n, 2) of sections."""
    numbers = [np.array(entry, float) for entry in entries]
    if any(
        one.ndim != FLAT or one.shape[1] != FLAT or not np.isfinite(one).all() for one in numbers
    ):
        raise Damaged("the outlines of sections are no points of a plane")
    return numbers


def vertical_of(entry: object) -> np.ndarray:
    """The direction upwards."""
    up = np.array(entry, float)
    if up.shape != (3,) or not np.isfinite(up).all() or not np.any(up):
        raise Damaged("up is no direction")
    return up
