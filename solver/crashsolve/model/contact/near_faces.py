"""Neighbours of the faces of a shell, and the faces that its own nodes never meet."""

from itertools import permutations

import numpy as np

from crashsolve.foundation.distinct import distinct
from crashsolve.foundation.orientation import crosses
from crashsolve.foundation.record import Record

FACE_AT_START = Record("""
    normal  1  3  of the face
    middle  m  3  mean of its corners
""")
# distances from some points to all, that are known at a time
TABLE = 4_000_000


def grouped(keys: np.ndarray, values: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Values by key, each once and ascending: where those of a key begin (count + 1,), all (n,)."""
    most = int(values.max(initial=0)) + 1
    # meshes have numbers of 32 bits, whose products need 64
    keys, values = np.divmod(distinct(keys.astype(np.int64) * most + values), most)
    return np.searchsorted(keys, np.arange(count + 1)).astype(np.int64), values.astype(np.int64)


def faces_around(quads: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Faces that each of `count` points belongs to."""
    return grouped(quads.ravel(), np.repeat(np.arange(len(quads)), 4), count)


def faces_at_start(corners: np.ndarray) -> np.ndarray:
    """Rows of FACE_AT_START of faces with corners (n, 4, 3) [m]; a triangle has the third twice."""
    first, second, third, fourth = np.moveaxis(corners, 1, 0)
    normals = crosses(third - first, fourth - second)
    faces = np.zeros(len(corners), FACE_AT_START.dtype)
    faces["normal"] = normals / np.linalg.norm(normals, axis=1)[:, None]
    faces["middle"] = corners.mean(axis=1)
    return faces


def adjacent_faces(quads: np.ndarray) -> np.ndarray:
    """The face across each side of each face (4 m,), -1 at a free border."""
    ends = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = ends.min(axis=1), ends.max(axis=1)
    order = np.lexsort((high, low))
    adjacent = np.full(len(ends), -1, np.int64)
    # over the side of no length of a triangle lies the triangle itself
    none = np.flatnonzero(low == high)
    adjacent[none] = none // 4
    has_length = (low < high)[order[1:]]
    is_same = (low[order[1:]] == low[order[:-1]]) & (high[order[1:]] == high[order[:-1]])
    same = np.flatnonzero(is_same & has_length)
    one, other = order[same], order[same + 1]
    adjacent[one], adjacent[other] = other // 4, one // 4
    return adjacent


# values by key: the first of each key (keys + 1,), and all values (n,)
Grouped = tuple[np.ndarray, np.ndarray]


def excluded_faces(quads: np.ndarray, around: Grouped, ring: int) -> tuple[np.ndarray, np.ndarray]:
    """Faces that each point never meets: its own, and those within `ring` of them."""
    first, faces = around
    count = len(first) - 1
    for _ in range(ring):
        owners = np.repeat(np.arange(count), np.diff(first))
        corners = quads[faces].ravel()
        begin, own = faces_around(quads, count)
        # from the faces of a point to their corners, and on to the faces of these
        sizes = np.diff(begin)[corners]
        at = np.repeat(begin[corners] - np.r_[0, np.cumsum(sizes)[:-1]], sizes)
        reached = own[at + np.arange(sizes.sum())]
        first, faces = grouped(np.repeat(np.repeat(owners, 4), sizes), reached, count)
    return first, faces


def faces_within_reach(
    points: np.ndarray, quads: np.ndarray, around: Grouped, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Faces with a corner within `reach` [m] of each point, along sides and diagonals of faces."""
    count = len(points)
    owners, reached = points_along(points, quads, reach)
    first, faces = around
    sizes = np.diff(first)[reached]
    at = np.repeat(first[reached] - np.r_[0, np.cumsum(sizes)[:-1]], sizes)
    return grouped(np.repeat(owners, sizes), faces[at + np.arange(sizes.sum())], count)


def points_along(
    points: np.ndarray, quads: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of points within `reach` [m] of each other along sides and diagonals of faces.

    Shortest paths, edge by edge; each point is a pair with itself. Some points at a time, so that
    their distances to all others fit into memory; the cost is that of the pairs.
    """
    count = len(points)
    ends = np.concatenate([quads[:, pair] for pair in permutations(range(4), 2)])
    first, others = grouped(ends[:, 0], ends[:, 1], count)
    starts = np.repeat(np.arange(count), np.diff(first))
    lengths = np.linalg.norm(points[others] - points[starts], axis=1)
    at_once = max(TABLE // count, 1)
    shortest, reached_pairs = np.full(at_once * count, np.inf), []
    for begin in range(0, count, at_once):
        owners = np.arange(begin, min(begin + at_once, count))
        # pairs as one number each, by rows of the table of distances
        pairs = _reached(
            (owners - begin) * count + owners, (first, others, lengths), shortest, reach
        )
        shortest[pairs] = np.inf
        reached_pairs.append(pairs + begin * count)
    owners, reached = np.divmod(np.concatenate(reached_pairs), count)
    return owners, reached


def _reached(
    front: np.ndarray, edges: tuple[np.ndarray, ...], shortest: np.ndarray, reach: float
) -> np.ndarray:
    """Pairs that are reached from a front, ascending. Writes: shortest."""
    first, others, lengths = edges
    count = len(first) - 1
    shortest[front] = 0.0
    reached = [front]
    while len(front):
        owner, via = np.divmod(front, count)
        sizes = np.diff(first)[via]
        at = np.repeat(first[via] - np.r_[0, np.cumsum(sizes)[:-1]], sizes)
        at += np.arange(sizes.sum())
        longer = np.repeat(shortest[front], sizes) + lengths[at]
        pair = np.repeat(owner * count, sizes) + others[at]
        is_better = (longer < reach) & (longer < shortest[pair])
        pair, longer = pair[is_better], longer[is_better]
        reached.append(distinct(pair[np.isinf(shortest[pair])]))
        np.minimum.at(shortest, pair, longer)
        front = distinct(pair)
    return np.sort(np.concatenate(reached))


def merged(one: Grouped, other: Grouped) -> tuple[np.ndarray, np.ndarray]:
    """Values by key of two tables together, as `grouped` gives them (keys + 1,), (n,)."""
    count = len(one[0]) - 1
    keys = np.r_[*(np.repeat(np.arange(count), np.diff(first)) for first, _ in (one, other))]
    return grouped(keys, np.r_[one[1], other[1]], count)


def chosen(
    first: np.ndarray, values: np.ndarray, keys: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Some keys of a table by `grouped`, in this order, with their values below `count`."""
    rows = [values[first[key] : first[key + 1]] for key in keys]
    rows = [row[row < count] for row in rows]
    ends = np.cumsum([0, *map(len, rows)])
    return ends.astype(np.int64), np.concatenate([*rows, np.zeros(1, np.int64)])


def nothing(count: int) -> tuple[np.ndarray, np.ndarray]:
    """No face is excluded."""
    return np.zeros(count + 1, np.int64), np.zeros(1, np.int64)
