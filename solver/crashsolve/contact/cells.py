"""Faces near points, found by sorting the faces into cubes; all within the compiled step.

A face lies in the cube of its middle. Cubes are as wide as the largest distance at which a middle
counts as near, so partners lie in 27 cubes; cubes share buckets, whose faces are counted and
sorted: the cost is that of the points and faces, n. Consequence to test: the same pairs as
comparing all with all.
"""

from math import floor, sqrt
from typing import NamedTuple

import numpy as np

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, dot, put, scale, sub, vec

MAX_CUBE_INDEX = 1e9  # cubes
# that a probe may touch at once on one side of a surface: both of a crease below and both of one
# above, and of a corner one more each
WALLS = 6
CELL = Record("""
    middle  m      3  mean of the face's corners
    radius  m         its farthest corner from there
    cube    count  3  cube in which the middle lies
    bucket  index     of that cube
""")


@kernel
def corner_points(p, f, corners):
    """Points of the four corners of a face; a triangle has the third twice."""
    # triangles begin with a new block
    g = f if f < p.quads else f + p.empty
    at = p.first_corner + 4 * (g - g % LANES) + g % LANES
    return corners[at], corners[at + LANES], corners[at + 2 * LANES], corners[at + 3 * LANES]


@kernel
def cube_index(offset):
    """Number of a cube along an axis: neighbours stay neighbours, and the column can hold it."""
    return int(floor(min(max(offset, -MAX_CUBE_INDEX), MAX_CUBE_INDEX)))


@kernel
def cube_of(x, width):
    """Cube in which a position lies; very distant positions lie in the outermost ones."""
    return cube_index(x[0] / width), cube_index(x[1] / width), cube_index(x[2] / width)


@kernel
def bucket_of(i, j, k, count):
    """Bucket of a cube; `count` is a power of two."""
    return (i * 73856093 ^ j * 19349663 ^ k * 83492791) & (count - 1)


@kernel
def bound_faces(p, points, corners, cells):
    """Middle and radius of every face; returns the largest radius. Writes: cells."""
    largest = 0.0
    for f in range(p.face_count):
        at, square = corner_points(p, f, corners), 0.0
        middle = (0.0, 0.0, 0.0)
        for k in range(4):
            middle = add(middle, vec(points[at[k]].r))
        middle = scale(0.25, middle)
        for k in range(4):
            offset = sub(vec(points[at[k]].r), middle)
            square = max(square, dot(offset, offset))
        put(cells[f].middle, middle)
        cells[f].radius = sqrt(square)
        largest = max(largest, cells[f].radius)
    return largest


@kernel
def sort_faces(p, width, cells, starts, sorted_faces):
    """Faces by bucket; those of bucket b lie from starts[b] on. Writes: cells, starts, sorted."""
    count = p.bucket_count
    for b in range(count + 1):
        starts[b] = 0
    for f in range(p.face_count):
        cell = cells[f]
        cube = cube_of(vec(cell.middle), width)
        put(cell.cube, cube)
        cell.bucket = bucket_of(cube[0], cube[1], cube[2], count)
        starts[cell.bucket + 1] += 1
    for b in range(count):
        starts[b + 1] += starts[b]
    # backwards, so that the faces of a bucket are in ascending order, and starts point to the first
    for back in range(p.face_count):
        f = p.face_count - 1 - back
        b = cells[f].bucket + 1
        starts[b] -= 1
        sorted_faces[starts[b]] = f
    for b in range(count):
        starts[b] = starts[b + 1]
    starts[count] = p.face_count


class Near(NamedTuple):
    """Lists of the faces near each probe."""

    grid: tuple[np.ndarray, ...]  # cells, starts of buckets, faces sorted by them
    # first of each probe, faces near, displacement until each is due, that of the probe
    lists: tuple[np.ndarray, ...]
    excluded: tuple[np.ndarray, ...]  # first of each probe, faces that it never meets


@kernel
def list_near(i, x, p, offset, reach, width, near_faces, total):
    """List the faces whose bounding sphere comes within `reach` [m] of x, but those spared.

    Returns the length of all lists, which may be more than there is room for.
    Writes: near_faces.lists.
    """
    (cells, starts, sorted_faces), (_, near, wait, _), excluded = near_faces
    centre = cube_of(x, width)
    for n in range(27):
        a, b, c = centre[0] + n // 9 - 1, centre[1] + n // 3 % 3 - 1, centre[2] + n % 3 - 1
        bucket = bucket_of(a, b, c, p.bucket_count)
        for k in range(starts[bucket], starts[bucket + 1]):
            f = sorted_faces[k]
            cell = cells[f]
            if cell.cube[0] != a or cell.cube[1] != b or cell.cube[2] != c:
                continue
            between = sub(x, vec(cell.middle))
            far, square = reach + cell.radius, dot(between, between)
            if square >= far * far or is_excluded(i, f, excluded):
                continue
            if total < p.room:
                near[total] = f
                # not in contact before both have moved by the distance of their bounds, less the
                # gap
                wait[total] = offset + max(sqrt(square) - cell.radius - p.gap, 0.0)
            total += 1
    return total


@kernel
def is_excluded(i, f, excluded):
    """Whether a probe never meets a face: near it in the mesh."""
    first, faces = excluded
    at = first[i]
    while at < first[i + 1] and faces[at] != f:
        at += 1
    return at < first[i + 1]
