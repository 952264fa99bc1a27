"""Blocks of points and cells of pictures, with their fields."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np


class CellType(NamedTuple):
    """A cell type of XDMF; `code` is its number in a mixed topology."""

    xdmf: str
    corners: int
    code: int
    # XDMF lets these have any number of corners, which must then be stated
    open_ended: bool = False


CELL_TYPES = {
    "vertex": CellType("Polyvertex", 1, 1, True),
    "line": CellType("Polyline", 2, 2, True),
    "triangle": CellType("Triangle", 3, 4),
    "quad": CellType("Quadrilateral", 4, 5),
    "tetra": CellType("Tetrahedron", 4, 6),
    "wedge": CellType("Wedge", 6, 8),
    "hexahedron": CellType("Hexahedron", 8, 9),
}
COMPONENTS = (1, 3, 6, 9)
# VTK hides cells whose vtkGhostType is 32: deleted elements
GHOST = "vtkGhostType"


def _refuse(name: str) -> None:
    """Raise ValueError for a name that would not survive as an HDF5 path or in XML."""
    if not name or set("/:.<>&\"'") & set(name):
        raise ValueError(f"unusable name '{name}'")


@dataclass(frozen=True)
class FieldSpec:
    """A field of a block; 1, 3, 6 or 9 components on its nodes or cells."""

    name: str
    unit: str
    n_components: int
    location: Literal["node", "cell"]

    def __post_init__(self) -> None:
        _refuse(self.name)
        if self.n_components not in COMPONENTS:
            raise ValueError(f"field '{self.name}': {self.n_components} components")

    @property
    def dtype(self) -> str:
        """Type on disk: single precision is ample for pictures."""
        return "<u1" if self.name == GHOST else "<f4"


DISPLACEMENT = FieldSpec("displacement", "m", 3, "node")
POINTS = FieldSpec("points", "m", 3, "node")


@dataclass(frozen=True)
class Block:
    """A mesh drawn as one thing: points (n, 3) and cells ((type, corners (m, k)), ...)."""

    name: str
    points: np.ndarray
    cells: tuple[tuple[str, np.ndarray], ...]
    fields: tuple[FieldSpec, ...] = ()
    # fields that never change, with their values
    fixed: tuple[tuple[FieldSpec, np.ndarray], ...] = ()
    # whether every state has points of its own; others carry a displacement instead
    is_placed: bool = False

    def __post_init__(self) -> None:
        _refuse(self.name)
        if self.points.ndim != 2 or self.points.shape[1] != 3:
            raise ValueError(f"block '{self.name}': points of shape {self.points.shape}")
        for kind, corners in self.cells:
            if corners.ndim != 2 or corners.shape[1] != CELL_TYPES[kind].corners:
                raise ValueError(f"block '{self.name}': {kind} cells of shape {corners.shape}")
            if corners.size and not 0 <= corners.min() <= corners.max() < len(self.points):
                raise ValueError(f"block '{self.name}': {kind} cells refer to missing points")
        # readers fail on empty blocks
        if not self.n_cells:
            raise ValueError(f"block '{self.name}' has no cells")
        for field, values in self.fixed:
            if values.shape != self.shape(field):
                raise ValueError(f"{self.name}, {field.name}: shape {values.shape}")

    @property
    def n_cells(self) -> int:
        """Number of cells of all types."""
        return sum(len(corners) for _, corners in self.cells)

    @property
    def all_fields(self) -> tuple[FieldSpec, ...]:
        """Fields of every state: points or displacement, then its own."""
        return (POINTS if self.is_placed else DISPLACEMENT, *self.fields)

    @property
    def fixed_fields(self) -> tuple[tuple[FieldSpec, np.ndarray], ...]:
        """Fields of mesh.h5, (points or cells, ...); blocks warp by their displacement."""
        still = ((DISPLACEMENT, np.zeros_like(self.points)),) if self.is_placed else ()
        return (*still, *self.fixed)

    def shape(self, field: FieldSpec) -> tuple[int, ...]:
        """Shape of a field's array."""
        count = len(self.points) if field.location == "node" else self.n_cells
        return (count,) if field.n_components == 1 else (count, field.n_components)

    def connectivity(self) -> np.ndarray:
        """Corners (m, k) of cells of one type; for several types the flat mixed list of XDMF."""
        if len(self.cells) == 1:
            return self.cells[0][1].astype("<i8")
        parts = []
        for kind, corners in self.cells:
            cell = CELL_TYPES[kind]
            head = [cell.code, cell.corners] if cell.open_ended else [cell.code]
            parts.append(np.hstack([np.tile(head, (len(corners), 1)), corners]).ravel())
        return np.concatenate(parts).astype("<i8")
