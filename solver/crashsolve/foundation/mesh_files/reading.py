"""Meshes read from files: points, elements of four or three corners, and sets by name.

meshio reads them. What it loses of Abaqus and Nastran files is read beside it, from their lines
(abaqus.py, nastran.py), and compared with its result: identifiers of nodes and elements, and
sets. What cannot be understood is refused with its line. Consequence to test: a set holds the same
elements however they are spread over blocks.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import meshio
    from numpy.typing import ArrayLike

SIDES = {"quad": 4, "triangle": 3}
# lines that gmsh writes along the outline of an area
OUTLINES = ("vertex", "line")
GROUPS = "gmsh:physical"


class MeshFileError(ValueError):
    """A mesh file that cannot be read; the text states location and cause."""


@dataclass
class MeshFile:
    """Points (n, 3) as they stand in the file; elements (m, 4) by points, and their kinds.

    A triangle names its last corner twice; elements of other kinds are rows of -1. `firsts` has
    the line where each kind occurs first, `passed_over` the parts of the file that were not read.
    """

    points: np.ndarray
    corners: np.ndarray
    kinds: np.ndarray
    element_sets: dict[str, np.ndarray]
    node_sets: dict[str, np.ndarray]
    firsts: dict[str, str] = field(default_factory=dict)
    passed_over: list[str] = field(default_factory=list)
    has_outlines: bool = False


@dataclass
class Lines:
    """Content of the lines of a file: a text that meshio reads in full, and the data that meshio
    would lose.

    Elements by identifier: their kind and, of quadrilaterals and triangles, their nodes. Sets hold
    identifiers.
    """

    name: str
    text: str = ""
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, tuple[int, ...]]] = field(default_factory=dict)
    element_sets: dict[str, Iterable[int]] = field(default_factory=dict)
    node_sets: dict[str, Iterable[int]] = field(default_factory=dict)
    firsts: dict[str, str] = field(default_factory=dict)
    passed_over: dict[str, int] = field(default_factory=dict)

    def fail(self, line: int, message: str) -> MeshFileError:
        """The exception for a line that cannot be read: `raise lines.fail(...)`."""
        return MeshFileError(f"{self.name}, line {line}: {message}")

    def skip_card(self, line: int, word: str) -> None:
        """Remember a card that is neither node, element nor set."""
        self.passed_over.setdefault(word, line)

    def add_node(self, line: int, number: int, position: tuple[float, float, float]) -> None:
        if number in self.nodes:
            raise self.fail(line, f"node {number} is given twice")
        self.nodes[number] = position

    def add_element(self, line: int, number: int, kind: str, nodes: tuple[int, ...]) -> None:
        if number in self.elements:
            raise self.fail(line, f"element {number} is given twice")
        missing = [node for node in nodes if node not in self.nodes]
        if missing:
            raise self.fail(line, f"element {number} names node {missing[0]}, which is not there")
        self.elements[number] = kind, nodes
        self.firsts.setdefault(kind, f"{self.name}, line {line}")


def read_mesh_file(path: Path) -> MeshFile:
    """The mesh in a file. Raises MeshFileError; ImportError without meshio."""
    import meshio

    readers = {".inp": "abaqus", ".bdf": "nastran", ".fem": "nastran", ".nas": "nastran"}
    reader = readers.get(path.suffix.lower())
    try:
        if reader:
            lines = import_module(f"{__package__}.{reader}").read_lines(path)
            if not lines.nodes:
                raise MeshFileError(f"{path.name} holds no nodes")
            return _of_lines(lines, meshio.read(io.StringIO(lines.text), reader))
        return _of_meshio(meshio.read(path), path)
    except MeshFileError:
        raise
    except SystemExit:
        raise MeshFileError(f"meshio does not know files like {path.name}") from None
    except Exception as error:
        # every reader of meshio has its own exceptions
        raise MeshFileError(f"meshio cannot read {path.name}: {error}") from None


def _of_lines(lines: Lines, mesh: meshio.Mesh) -> MeshFile:
    """The mesh read by meshio, with the identifiers and sets of the lines."""
    shells = [number for number, (kind, _) in lines.elements.items() if kind in SIDES]
    corners, kinds = _elements(mesh)
    points = _points(mesh)
    position = {number: i for i, number in enumerate(lines.nodes)}
    wanted = [[position[n] for n in lines.elements[number][1]] for number in shells]
    own = np.array([(*row, row[-1])[:4] for row in wanted], int).reshape(-1, 4)
    positions = np.array(list(lines.nodes.values()))
    if not np.array_equal(positions, points) or not np.array_equal(own, corners):
        raise MeshFileError(f"meshio and crashsolve read {lines.name} differently; write it as vtu")
    at = {number: i for i, number in enumerate(lines.elements)}
    all_corners = np.full((len(at), 4), -1)
    all_corners[[at[number] for number in shells]] = corners
    return MeshFile(
        points,
        all_corners,
        np.array([kind for kind, _ in lines.elements.values()], object),
        {name: _numbers(at, some) for name, some in lines.element_sets.items()},
        {name: _numbers(position, some) for name, some in lines.node_sets.items()},
        lines.firsts,
        [f"{word} (line {line})" for word, line in lines.passed_over.items()],
    )


def _numbers(position: dict[int, int], some: Iterable[int]) -> np.ndarray:
    """Indices of these identifiers, each once and in order."""
    return np.unique(np.array([position[number] for number in some], int))


def _points(mesh: meshio.Mesh) -> np.ndarray:
    """Points (n, 3); those of a plane lie at z = 0."""
    points = np.asarray(mesh.points, float)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise MeshFileError(f"its points have the shape {points.shape}, not (n, 3)")
    if points.shape[1] == 2:
        points = np.hstack([points, np.zeros((len(points), 1))])
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise MeshFileError(f"point {wrong[0]} (counted from 0) is at no finite position")
    return points


def _elements(mesh: meshio.Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Corners (m, 4), rows of -1 for cells with neither four nor three corners, and kinds of all
    blocks.
    """
    corners, kinds = [np.zeros((0, 4), int)], [np.zeros(0, object)]
    for block in mesh.cells:
        cells = np.asarray(block.data)
        rows = np.full((len(cells), 4), -1)
        if len(cells) and block.type in SIDES:
            rows = cells[:, [0, 1, 2, 3][: SIDES[block.type]] + [2] * (4 - SIDES[block.type])]
        corners.append(rows.astype(int))
        kinds.append(np.full(len(cells), block.type, object))
    return np.concatenate(corners), np.concatenate(kinds)


def _of_meshio(mesh: meshio.Mesh, path: Path) -> MeshFile:
    """A file of which meshio loses nothing, but for groups of gmsh that have no name."""
    corners, kinds = _elements(mesh)
    points = _points(mesh)
    is_shell = np.isin(kinds, list(SIDES))
    bad = np.flatnonzero(is_shell & ((corners < 0) | (corners >= len(points))).any(axis=1))
    if len(bad):
        wrong = next(n for n in corners[bad[0]] if not 0 <= n < len(points))
        message = f"element {bad[0]} names point {wrong}; there are points 0 to {len(points) - 1}"
        raise MeshFileError(f"{path.name}: {message}")
    sets = {
        name: _of_blocks(mesh, own)
        for name, own in mesh.cell_sets.items()
        if not name.startswith("gmsh:")
    }
    nodes = {name: np.unique(np.asarray(own, int)) for name, own in mesh.point_sets.items()}
    for name, own in nodes.items():
        if len(own) and not (own[0] >= 0 and own[-1] < len(points)):
            raise MeshFileError(f"{path.name}: set '{name}' names a point that is not there")
    groups = _groups(mesh, path)
    # of a group that has a name in the file, meshio reads all elements
    groups = {name: own for name, own in groups.items() if name not in sets} | sets
    for name, own in groups.items():
        nodes.setdefault(name, _nodes_of(mesh, own))
    of_areas = {name: own[~np.isin(kinds[own], OUTLINES)] for name, own in groups.items()}
    element_sets = {name: own for name, own in of_areas.items() if len(own)}
    outlines = GROUPS in mesh.cell_data
    return MeshFile(points, corners, kinds, element_sets, nodes, has_outlines=outlines)


def _of_blocks(mesh: meshio.Mesh, own: Iterable[ArrayLike | None]) -> np.ndarray:
    """Elements of a set, counted over all blocks, from their numbers in each; None is none."""
    some, start = [np.zeros(0, int)], 0
    for block, numbers in zip(mesh.cells, own, strict=True):
        inner = np.asarray([] if numbers is None else numbers, int).ravel()
        if len(inner) and not (inner.min() >= 0 and inner.max() < len(block.data)):
            raise MeshFileError("a set names an element that is not there")
        some.append(start + inner)
        start += len(block.data)
    # an element named twice is one
    return np.unique(np.concatenate(some))


def _nodes_of(mesh: meshio.Mesh, elements: np.ndarray) -> np.ndarray:
    """Points of these elements, of any kind."""
    some, start = [np.zeros(0, int)], 0
    for block in mesh.cells:
        own = elements[(elements >= start) & (elements < start + len(block.data))] - start
        some.append(np.asarray(block.data, int)[own].ravel())
        start += len(block.data)
    return np.unique(np.concatenate(some))


def _groups(mesh: meshio.Mesh, path: Path) -> dict[str, np.ndarray]:
    """Elements of the physical groups of gmsh, by name, or by number where they have none.

    Numbers count in each dimension for themselves: one used for lines and for areas is left out.
    """
    if GROUPS not in mesh.cell_data:
        return {}
    number = np.concatenate([np.asarray(own, int) for own in mesh.cell_data[GROUPS]])
    dimension = np.concatenate([np.full(len(block.data), block.dim) for block in mesh.cells])
    groups = {}
    for name, (tag, dim) in mesh.field_data.items():
        groups[name] = np.flatnonzero((number == tag) & (dimension == dim))
    if _lists_all_groups(path):
        for tag in np.unique(number[number > 0]):
            own = np.flatnonzero(number == tag)
            if len(np.unique(dimension[own])) == 1:
                groups.setdefault(str(tag), own)
    return groups


def _lists_all_groups(path: Path) -> bool:
    """Whether meshio reads all groups of the file: of several of an element it keeps the first."""
    with path.open("rb") as file:
        head = file.read(64).split()[:3]
    if len(head) < 3 or head[0] != b"$MeshFormat" or head[1].startswith(b"2"):
        return True
    if head[2] != b"0":
        return False  # binary: no text to check
    text = path.read_text("utf-8", errors="replace")
    entities = re.search(r"\$Entities\s+(.*?)\$EndEntities", text, re.DOTALL)
    if entities is None:
        return True
    head_row, *rows = (row.split() for row in entities[1].splitlines())
    # after those of points: tag, box of six, number of groups, groups
    return all(int(row[7]) < 2 for row in rows[int(head_row[0]) :] if row)
