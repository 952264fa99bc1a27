"""Which faces of a shell lie beside each other, and which its own nodes never meet."""

from itertools import permutations
from typing import Any

import numpy as np


def grouped(keys: np.ndarray, values: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Values by key, each once and ascending: where those of a key begin (count + 1,), all (n,)."""
    pairs = np.unique(np.column_stack([keys, values]), axis=0)
    first = np.searchsorted(pairs[:, 0], np.arange(count + 1))
    return first.astype(np.int64), np.ascontiguousarray(pairs[:, 1])


def faces_around(quads: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Faces that each of `count` points belongs to."""
    return grouped(quads.ravel(), np.repeat(np.arange(len(quads)), 4), count)


def faces_beside(quads: np.ndarray) -> np.ndarray:
    """The face across each side of each face (4 m,), -1 at a free border."""
    ends = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = ends.min(axis=1), ends.max(axis=1)
    order = np.lexsort((high, low))
    beside = np.full(len(ends), -1, np.int64)
    # over the side of no length of a triangle lies the triangle itself
    none = np.flatnonzero(low == high)
    beside[none] = none // 4
    has_length = (low < high)[order[1:]]
    alike = (low[order[1:]] == low[order[:-1]]) & (high[order[1:]] == high[order[:-1]])
    same = np.flatnonzero(alike & has_length)
    one, other = order[same], order[same + 1]
    beside[one], beside[other] = other // 4, one // 4
    return beside


def spare(quads: np.ndarray, around: Any, ring: int) -> tuple[np.ndarray, np.ndarray]:
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


def spare_along(
    points: np.ndarray, quads: np.ndarray, around: Any, reach: float
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

    Shortest ways, all points at once, edge by edge; each point is a pair with itself.
    """
    count = len(points)
    ends = np.concatenate([quads[:, pair] for pair in permutations(range(4), 2)])
    first, others = grouped(ends[:, 0], ends[:, 1], count)
    starts = np.repeat(np.arange(count), np.diff(first))
    lengths = np.linalg.norm(points[others] - points[starts], axis=1)
    # pairs as one number each, ascending, with the shortest way so far
    known = front = np.arange(count) * (count + 1)
    distances = distance = np.zeros(count)
    while len(front):
        owner, via = np.divmod(front, count)
        sizes = np.diff(first)[via]
        at = np.repeat(first[via] - np.r_[0, np.cumsum(sizes)[:-1]], sizes)
        at += np.arange(sizes.sum())
        longer = np.repeat(distance, sizes) + lengths[at]
        pair, is_near = np.repeat(owner, sizes) * count + others[at], longer < reach
        pair, longer = pair[is_near], longer[is_near]
        pairs, values = np.r_[known, pair], np.r_[distances, longer]
        is_new = np.r_[np.zeros(len(known), bool), np.ones(len(pair), bool)]
        # of equal ways the known one
        order = np.lexsort((is_new, values, pairs))
        pairs, values, is_new = pairs[order], values[order], is_new[order]
        best = np.r_[True, pairs[1:] != pairs[:-1]]
        known, distances, is_new = pairs[best], values[best], is_new[best]
        front, distance = known[is_new], distances[is_new]
    return known // count, known % count


def merged(one: Any, other: Any) -> tuple[np.ndarray, np.ndarray]:
    """Values by key of two tables together, as `grouped` gives them (keys + 1,), (n,)."""
    count = len(one[0]) - 1
    keys = np.r_[*(np.repeat(np.arange(count), np.diff(first)) for first, _ in (one, other))]
    return grouped(keys, np.r_[one[1], other[1]], count)


def chosen(
    first: np.ndarray, values: np.ndarray, keys: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Of a table as `grouped` gives it some keys, in this order, and their values below `count`."""
    rows = [values[first[key] : first[key + 1]] for key in keys]
    rows = [row[row < count] for row in rows]
    ends = np.cumsum([0, *map(len, rows)])
    return ends.astype(np.int64), np.concatenate([*rows, np.zeros(1, np.int64)])


def nothing(count: int) -> tuple[np.ndarray, np.ndarray]:
    """No face is spared."""
    return np.zeros(count + 1, np.int64), np.zeros(1, np.int64)
