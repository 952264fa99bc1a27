"""Displacements and velocities of the points of all bodies that are drawn as one block."""

from typing import NamedTuple

import numpy as np

from crashsolve.simulation.body_shapes import Piece

# points that are moved together: temporary arrays of more are new memory from the system each time,
# which costs several times as much as their numbers
TOGETHER = 4096


class Bodies(NamedTuple):
    """Pieces of a skin that are moved together: its points from `first` to `last`."""

    nodes: list[int]
    # of each node, behind its last point
    ends: list[int]
    first: int
    last: int
    # points (x, y, z, 1) in body axes (4, n), and at the start in world axes (3, n): numpy adds
    # what lies side by side
    own: np.ndarray
    start: np.ndarray


class Skin:
    """Points and cells of some pieces of bodies."""

    def __init__(self, pieces: list[Piece], nodes: np.ndarray) -> None:
        self.points = np.concatenate(
            [nodes["r"][n] + points @ nodes["A"][n].reshape(3, 3).T for n, points, _ in pieces]
        )
        self.cells = _cells(pieces)
        self.bodies = np.concatenate([np.full(len(c), float(node)) for node, _, c in pieces])
        self._groups: list[Bodies] = []
        some: list[Piece] = []
        for piece in pieces:
            if some and sum(len(points) for _, points, _ in (*some, piece)) > TOGETHER:
                self._add_group(some)
                some = []
            some.append(piece)
        self._add_group(some)
        self._moved, self._velocity = (np.empty(self.points.shape, np.float32) for _ in range(2))
        # of one group after the other
        most = max(group.last - group.first for group in self._groups)
        self._room = np.empty((6, most))

    def fields(self, matrices: np.ndarray) -> dict[str, np.ndarray]:
        """Displacement and velocity of every point, in the single precision of states, by
        motion_of the nodes. The next call overwrites them.
        """
        for group in self._groups:
            moved = self._moved[group.first : group.last]
            velocity = self._velocity[group.first : group.last]
            both = self._room[:, : group.last - group.first]
            _multiply(matrices, group, both)
            np.subtract(both[:3], group.start, out=moved.T, casting="same_kind")
            np.copyto(velocity.T, both[3:], casting="same_kind")
        return {"displacement": self._moved, "velocity": self._velocity}

    def _add_group(self, pieces: list[Piece]) -> None:
        first = self._groups[-1].last if self._groups else 0
        lengths = [len(points) for _, points, _ in pieces]
        all_nodes, all_ends = [node for node, _, _ in pieces], np.cumsum(lengths).tolist()
        # pieces of one body that follow each other are moved as one
        lasts = [i for i, node in enumerate(all_nodes) if all_nodes[i + 1 : i + 2] != [node]]
        nodes, ends = [all_nodes[i] for i in lasts], [all_ends[i] for i in lasts]
        last = first + ends[-1]
        own = np.ones((4, last - first))
        own[:3] = np.concatenate([points for _, points, _ in pieces]).T
        start = np.ascontiguousarray(self.points[first:last].T)
        self._groups.append(Bodies(nodes, ends, first, last, own, start))


def motion_of(nodes: np.ndarray) -> np.ndarray:
    """Of every node (6, 4): position and velocity of a point (x, y, z, 1) in its axes."""
    rotations, w = nodes["A"].reshape(-1, 3, 3), nodes["w"]
    spin = np.zeros(rotations.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        spin[:, i, j], spin[:, j, i] = -w[:, k], w[:, k]
    matrices = np.empty((len(nodes), 6, 4))
    matrices[:, :3, :3], matrices[:, 3:, :3] = rotations, spin @ rotations
    matrices[:, :3, 3], matrices[:, 3:, 3] = nodes["r"], nodes["v"]
    return matrices


def _multiply(matrices: np.ndarray, group: Bodies, motion: np.ndarray) -> None:
    """Positions and velocities of points (6, n), world axes. Writes: motion."""
    first = 0
    for node, last in zip(group.nodes, group.ends, strict=True):
        np.matmul(matrices[node], group.own[:, first:last], out=motion[:, first:last])
        first = last


def _cells(pieces: list[Piece]) -> tuple[tuple[str, np.ndarray], ...]:
    """Triangles, or lines, of all pieces, their points counted through."""
    first, cells = 0, []
    for _, points, triangles in pieces:
        cells.append(np.asarray(triangles) + first)
        first += len(points)
    corners = np.concatenate(cells)
    return (("line" if corners.shape[1] == 2 else "triangle", corners),)
