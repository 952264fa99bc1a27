"""Data of every mesh: positions, corners of elements, and sets of nodes and of elements."""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Mesh:
    """Points (n, 3) [m], corners of elements (m, 4) counter-clockwise seen from outside.

    A triangle is a quadrilateral that names one of its corners twice. Of a mesh that parts share,
    each has all points and its own elements (model/shared_mesh.py).
    """

    points: np.ndarray
    quads: np.ndarray
    sets: dict[str, np.ndarray]
    element_sets: dict[str, np.ndarray] = field(default_factory=dict)
    own: slice | None = None  # of a shared mesh: points that this part moves
    origin: np.ndarray | None = None  # first point of a shared mesh, as it was written [m]


def net(nu: int, nv: int, closed: bool = False) -> tuple[np.ndarray, np.ndarray, dict]:
    """Parameters (n, 2) from 0 to 1, quadrilaterals and sides of a net of nu by nv elements.

    Points run along u first; a closed net has its last column in its first.
    """
    columns = nu if closed else nu + 1
    i, j = np.meshgrid(np.arange(columns), np.arange(nv + 1))
    numbers = np.arange(i.size).reshape(i.shape)
    parameters = np.column_stack([i.ravel() / nu, j.ravel() / nv])
    right = np.roll(numbers, -1, axis=1) if closed else numbers[:, 1:]
    left = numbers if closed else numbers[:, :-1]
    quads = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=-1).reshape(-1, 4)
    sides = {"v0": numbers[0], "v1": numbers[-1]}
    if not closed:
        sides |= {"u0": numbers[:, 0], "u1": numbers[:, -1]}
    return parameters, quads, sides


def welded(points: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 3) [m] without those that lie in one position, quads (m, 4), new number of
    each.
    """
    grain = 1e-9 * np.ptp(points, axis=0).max()
    _, first, number = np.unique(
        np.round(points / grain).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    number = number.ravel()
    return points[first], number[quads], number
