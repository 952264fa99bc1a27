"""Triangles of meshes in a tree of boxes, as flat arrays for kernels."""

from collections.abc import Iterable

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.foundation.record import Record

# triangles, or edges, in the smallest boxes
LEAF = 4

BOX = Record("""
    low    m      3  lower corner
    high   m      3  upper corner
    skip   index     next box when this one is too far
    first  index     first of what it holds
    count  count     how much it holds; 0 for a box of boxes
""")
TRIANGLE = Record("""
    i        m      3  first corner, shape axes
    j        m      3  second corner
    l        m      3  third corner
    n        1      3  outward unit normal
    edge_n   1     18  outward directions at the three edges and the three corners
    is_open  flag   6  whether those belong to an open edge
""")


def data(elements_a: object, elements_b: Iterable[Columns]) -> tuple[np.ndarray, np.ndarray]:
    """Tables BOX and TRIANGLE of all meshes on side b, (boxes,) and (triangles,).

    Writes: root of each element.
    """
    boxes, triangles = [], []
    first_box = first_triangle = 0
    for element in elements_b:
        table = _triangles(element)
        corners = np.stack([table[name] for name in "ijl"], axis=1)
        tree, order = grow(corners.min(axis=1), corners.max(axis=1))
        tree["skip"] += first_box
        tree["first"] += first_triangle
        element["root"] = first_box
        boxes.append(tree)
        triangles.append(table[order])
        first_box += len(tree)
        first_triangle += len(table)
    return np.concatenate(boxes), np.concatenate(triangles)


def _triangles(element: Columns) -> np.ndarray:
    """Table of triangles with the normals of faces, edges and corners."""
    points, faces, edges = element["points"], element["faces"], element["edges"]
    table = np.zeros(len(faces), TRIANGLE.dtype)
    corner = points[faces]
    for c, name in enumerate("ijl"):
        table[name] = corner[:, c]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 1])
    table["n"] = normal = normal / np.linalg.norm(normal, axis=1)[:, None]
    # an edge: both normals; a corner: all normals there, each with the angle of its triangle
    owner, edge, beyond = edges.T
    out = table["edge_n"].reshape(-1, 6, 3)
    out[owner, edge] = normal[owner] + np.where(beyond[:, None] >= 0, normal[beyond], 0.0)
    at_point = np.zeros_like(points)
    for c in range(3):
        u, v = (corner[:, (c + s) % 3] - corner[:, c] for s in (1, 2))
        cosine = np.einsum("ij,ij->i", u, v) / np.linalg.norm(u, axis=1) / np.linalg.norm(v, axis=1)
        np.add.at(at_point, faces[:, c], np.arccos(np.clip(cosine, -1, 1))[:, None] * normal)
    out[:, 3:] = at_point[faces]
    _mark_open(table, faces, edges)
    return table


def _mark_open(table: np.ndarray, faces: np.ndarray, edges: np.ndarray) -> None:
    """Flags of edges without a triangle beyond, and of the corners they join. Writes: table."""
    owner, edge, beyond = edges[edges[:, 2] < 0].T
    table["is_open"][owner, edge] = 1
    rim = np.concatenate([faces[owner, edge], faces[owner, (edge + 1) % 3]])
    table["is_open"][:, 3:] = np.isin(faces, rim)


def grow(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Boxes in the order in which they are traversed, and the order of their contents.

    `low`, `high` (n, 3): corners of their contents.
    """
    boxes: list[list[object]] = []
    order: list[int] = []

    def split(part: np.ndarray) -> None:
        box = [low[part].min(axis=0), high[part].max(axis=0), 0, len(order), 0]
        boxes.append(box)
        if len(part) <= LEAF:
            box[4] = len(part)
            order.extend(part.tolist())
        else:
            middle = 0.5 * (low[part] + high[part])
            axis = int(np.ptp(middle, axis=0).argmax())
            half = np.argsort(middle[:, axis], kind="stable")
            split(part[half[: len(part) // 2]])
            split(part[half[len(part) // 2 :]])
        box[2] = len(boxes)

    split(np.arange(len(low)))
    return np.array([tuple(box) for box in boxes], BOX.dtype), np.array(order)
