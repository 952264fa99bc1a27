"""Where a node lies on the faces of a mesh: the nearest face, weights of its corners, height.

    x = sum N_i(xi, eta) x_i + c n

is solved for xi, eta and c, so that the node stays exactly where it is; n is the unit normal of the
diagonals of the face.
"""

from typing import NamedTuple

import numpy as np

# by how much of its half a node may lie beside a face, past a corner of the surface
BESIDE = 0.1
MAX_ITERATIONS = 20
# of xi and eta, when nothing changes any more
SAME = 1e-14
SIGNS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


class OnFace(NamedTuple):
    """A node on a face."""

    face: int
    weights: np.ndarray  # of the corners (4,), sum 1; of a triangle the last is 0
    height: float  # along the normal [m]
    distance: float  # from the face, not beyond its sides [m]


def nearest_face(x: np.ndarray, points: np.ndarray, quads: np.ndarray) -> OnFace | None:
    """The face that a position is nearest to; None where it lies beside all of them."""
    corners = points[quads]
    middle = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    away = np.linalg.norm(middle - x, axis=1)
    # no face farther than the nearest of the middles can be is nearer
    able = np.flatnonzero(away - radius <= (away + radius).min())
    faces = [one for k in able if (one := _on_face(int(k), x, corners[k], quads[k])) is not None]
    return min(faces, key=lambda one: one.distance, default=None)


def _on_face(face: int, x: np.ndarray, corners: np.ndarray, quad: np.ndarray) -> OnFace | None:
    """A position on one face; None where it lies beside it."""
    if quad[2] == quad[3]:
        return _on_triangle(face, x, corners)
    n = normal(corners)
    u, c = np.zeros(2), 0.0
    for _ in range(MAX_ITERATIONS):
        N, slopes = _bilinear(u)
        gap = x - N @ corners - c * n
        change = np.linalg.solve(np.column_stack([*(slopes.T @ corners), n]), gap)
        u, c = u + change[:2], c + change[2]
        if np.abs(u).max() > 2.0:
            return None
        if np.abs(change[:2]).max() < SAME:
            break
    if np.abs(u).max() > 1.0 + BESIDE:
        return None
    N, _ = _bilinear(u)
    inside, _ = _bilinear(np.clip(u, -1.0, 1.0))
    return OnFace(face, N, float(c), float(np.linalg.norm(x - inside @ corners)))


def _on_triangle(face: int, x: np.ndarray, corners: np.ndarray) -> OnFace | None:
    n = normal(corners)
    sides = corners[1:3] - corners[0]
    a, b, c = np.linalg.solve(np.column_stack([*sides, n]), x - corners[0])
    N = np.array([1.0 - a - b, a, b, 0.0])
    if N.min() < -0.5 * BESIDE:
        return None
    inside = np.maximum(N, 0.0) / np.maximum(N, 0.0).sum()
    return OnFace(face, N, float(c), float(np.linalg.norm(x - inside @ corners)))


def _bilinear(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights (4,) and their slopes (4, 2)."""
    factors = 1.0 + SIGNS * u
    slopes = 0.25 * SIGNS * factors[:, ::-1]
    return 0.25 * factors.prod(axis=1), slopes


def normal(corners: np.ndarray) -> np.ndarray:
    """Unit normal of the diagonals of a face (4, 3)."""
    n = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    unit: np.ndarray = n / np.linalg.norm(n)
    return unit


def normal_rate(corners: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Rate of the normal where the corners move with v (4, 3)."""
    d, e = corners[2] - corners[0], corners[3] - corners[1]
    n, size = normal(corners), np.linalg.norm(np.cross(d, e))
    rate = (np.cross(v[2] - v[0], e) + np.cross(d, v[3] - v[1])) / size
    across: np.ndarray = rate - (rate @ n) * n
    return across
