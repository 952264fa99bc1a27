"""Displacements and velocities of the points of all bodies that are drawn as one block."""

from dataclasses import dataclass

import numpy as np

from crashsolve.simulation.body_shapes import Piece

# points that are moved together: temporary arrays of more are new memory from the system each time,
# which costs several times as much as their numbers
TOGETHER = 4096


@dataclass(frozen=True)
class Bodies:
    """Pieces of a skin that are moved together: its points from `first` to `last`."""

    nodes: list[int]
    # of each piece, its last point
    ends: list[int]
    first: int
    last: int
    # node of every point
    owners: np.ndarray
    # points in body axes, and at the start in world axes (3, n): numpy adds what lies side by side
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

    def fields(self, nodes: np.ndarray) -> dict[str, np.ndarray]:
        """Displacement and velocity of every point, in the single precision of states.

        The next call overwrites them.
        """
        rotations = nodes["A"].reshape(-1, 3, 3)
        vectors = [np.ascontiguousarray(nodes[name].T) for name in "rvw"]
        for group in self._groups:
            moved = self._moved[group.first : group.last]
            velocity = self._velocity[group.first : group.last]
            x = _rotated(group, rotations)
            r, v, w = (np.take(vector, group.owners, axis=1) for vector in vectors)
            np.subtract(r + x, group.start, out=moved.T, casting="same_kind")
            for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
                spin = w[j] * x[k] - w[k] * x[j]
                np.add(v[i], spin, out=velocity[:, i], casting="same_kind")
        return {"displacement": self._moved, "velocity": self._velocity}

    def _add_group(self, pieces: list[Piece]) -> None:
        first = self._groups[-1].last if self._groups else 0
        lengths = [len(points) for _, points, _ in pieces]
        nodes, ends = [node for node, _, _ in pieces], np.cumsum(lengths).tolist()
        own = np.concatenate([points for _, points, _ in pieces]).T
        last = first + ends[-1]
        start, owners = self.points[first:last].T, np.repeat(nodes, lengths)
        both = (np.ascontiguousarray(points) for points in (own, start))
        self._groups.append(Bodies(nodes, ends, first, last, owners, *both))


def _rotated(group: Bodies, rotations: np.ndarray) -> np.ndarray:
    """Points (3, n) from the mass centres of their bodies, world axes."""
    rotated, first = np.empty(group.own.shape), 0
    for node, last in zip(group.nodes, group.ends, strict=True):
        np.matmul(rotations[node], group.own[:, first:last], out=rotated[:, first:last])
        first = last
    return rotated


def _cells(pieces: list[Piece]) -> tuple[tuple[str, np.ndarray], ...]:
    """Triangles, or lines, of all pieces, their points counted through."""
    first, cells = 0, []
    for _, points, triangles in pieces:
        cells.append(np.asarray(triangles) + first)
        first += len(points)
    corners = np.concatenate(cells)
    return (("line" if corners.shape[1] == 2 else "triangle", corners),)
