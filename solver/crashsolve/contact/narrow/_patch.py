"""Area of contact of two flat faces: a polygon about the centre of pressure.

Each body presses with the part of its face, cap or lateral surface that is symmetric about the
centre of pressure x: half sizes h_k - |x_k|, not below the rounding of its edges. The patch is what
these parts have in common, a convex polygon with x in its middle: as large as the smaller face
where two lie flat, a line on an edge, a point on a corner. A corner of it carries a share of the
force in proportion to the two sides that meet there, and acts at 1/sqrt(3) of its distance from x,
where the tilting moment is that of evenly pressed rectangles. Friction resists a spin about the
normal with the mean distance from x of an even pressure,

    r = int |y| dA / A        2/3 of the radius of a disc, 1/4 of the length of a line

Consequence to test: r of discs, squares and lines; shares add up to 1, their moments about x to 0.
"""

from math import log, sqrt

from crashsolve.contact.narrow._ascent import axis_of, tangents
from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, cross, dot, norm, scale, sub, vec

PATCH_POINT = Record("""
    u      m     corner of the patch from its middle, along the first tangent
    v      m     along the second
    point  m  3  where the force acts, world axes
    share  1     of the force
""")
# rows of a polygon, and of three: of both sides, and one to work on
CORNERS = 24
ROWS = 3 * CORNERS
# lever of the forces of the corners, in shares of their distance
PRESSURE_LEVER = sqrt(1.0 / 3.0)
# an octagon whose area is as far from its middle, on the mean, as that of a disc of radius 1
OCTAGON = 1.0530118888486155
DIAGONAL = sqrt(0.5)


@kernel
def patch(a, b, nodes, data, n, x):
    """Number of corners of the patch about x, and mean distance r of its area [m]. Writes: data."""
    spots = data[0]
    s, t = tangents(n)
    count = outline(a, nodes[a.node], n, x, s, t, spots, 0)
    count_b = outline(b, nodes[b.node], n, x, s, t, spots, CORNERS)
    for k in range(count_b):
        count = cut(spots, count, CORNERS + k, CORNERS + (k + 1) % count_b)
    for k in range(count):
        spot = spots[k]
        offset = add(scale(PRESSURE_LEVER * spot.u, s), scale(PRESSURE_LEVER * spot.v, t))
        for j in range(3):
            spot.point[j] = x[j] + offset[j]
    return count, set_shares(spots, count)


@kernel
def outline(shape, body, n, x, s, t, spots, first):
    """Part of a shape that is symmetric about x: corners in rows from `first`. Writes: spots."""
    d = matvec_t(shape.axes, matvec_t(body.A, sub(x, world_position(body, vec(shape.point)))))
    m = matvec_t(shape.axes, matvec_t(body.A, n))
    edge, half = shape.edge, shape.half
    if shape.is_round == 1 and abs(m[2]) > DIAGONAL:
        r = OCTAGON * max(edge, half[0] - sqrt(d[0] * d[0] + d[1] * d[1]))
        return octagon(spots, first, r)
    # the axis most along the normal, and the extents along the other two
    k = 0 if abs(m[0]) > abs(m[1]) else 1
    k = 2 if abs(m[2]) > abs(m[k]) else k
    i, j = (k + 1) % 3, (k + 2) % 3
    if shape.is_round == 1:
        # a line along the lateral surface
        e = matvec(body.A, (shape.axes[2], shape.axes[5], shape.axes[8]))
        p = scale(max(edge, half[2] - abs(d[2])), e)
        q = scale(edge / norm(cross(n, e)), cross(n, e))
    else:
        p = scale(max(edge, half[i] - abs(d[i])), axis_of(shape, body, i))
        q = scale(max(edge, half[j] - abs(d[j])), axis_of(shape, body, j))
    return parallelogram(spots, first, (dot(p, s), dot(p, t)), (dot(q, s), dot(q, t)))


@kernel
def octagon(spots, first, r):
    """Corners on a circle of radius r. Writes: spots."""
    u, v = r, 0.0
    for k in range(8):
        spots[first + k].u, spots[first + k].v = u, v
        u, v = DIAGONAL * (u - v), DIAGONAL * (u + v)
    return 8


@kernel
def parallelogram(spots, first, p, q):
    """Corners p + q, q - p, -p - q, p - q, in the sense from the first tangent to the second.

    Writes: spots.
    """
    sense = 1.0 if p[0] * q[1] >= p[1] * q[0] else -1.0
    for k in range(4):
        side, ahead = (1.0 if k == 0 or k == 3 else -1.0), (sense if k < 2 else -sense)
        spots[first + k].u = side * p[0] + ahead * q[0]
        spots[first + k].v = side * p[1] + ahead * q[1]
    return 4


@kernel
def cut(spots, count, i, j):
    """Cut the first polygon along the line from row i to row j, keeping its left side; returns the
    number of corners.

    Writes: spots.
    """
    u, v = spots[i].u, spots[i].v
    du, dv = spots[j].u - u, spots[j].v - v
    least = 0.0
    for k in range(count):
        least = min(least, du * (spots[k].v - v) - dv * (spots[k].u - u))
    if least >= 0.0:
        return count
    kept, room = 0, 2 * CORNERS
    before = spots[count - 1]
    side = du * (before.v - v) - dv * (before.u - u)
    for k in range(count):
        corner, last = spots[k], spots[k - 1 if k > 0 else count - 1]
        side_here = du * (corner.v - v) - dv * (corner.u - u)
        if side * side_here < 0.0:
            part = side / (side - side_here)
            spots[room + kept].u = last.u + part * (corner.u - last.u)
            spots[room + kept].v = last.v + part * (corner.v - last.v)
            kept += 1
        if side_here >= 0.0:
            spots[room + kept].u, spots[room + kept].v = corner.u, corner.v
            kept += 1
        side = side_here
    for k in range(kept):
        spots[k].u, spots[k].v = spots[room + k].u, spots[room + k].v
    return kept


@kernel
def set_shares(spots, count):
    """Shares of the corners by the sides next to them; mean distance of the area [m].

    Writes: spots.
    """
    around, area, moment = 0.0, 0.0, 0.0
    for k in range(count):
        spots[k].share = 0.0
    for k in range(count):
        corner, following = spots[k], spots[k + 1 if k + 1 < count else 0]
        du, dv = following.u - corner.u, following.v - corner.v
        length = sqrt(du * du + dv * dv)
        # twice the area of the triangle from the middle to this side, and its mean distance
        double = corner.u * following.v - corner.v * following.u
        area += double
        moment += double * distance_of_side(corner, following, du, dv, length, double)
        corner.share += length
        following.share += length
        around += length
    for k in range(count):
        spots[k].share *= 0.5 / around
    return 2.0 / 3.0 * moment / area


@kernel
def distance_of_side(corner, following, du, dv, length, double):
    """Mean distance of the points of a side from the middle [m]."""
    if length * length <= double * 1e-15:
        return sqrt(corner.u * corner.u + corner.v * corner.v)
    h = double / length
    at, to = (
        (corner.u * du + corner.v * dv) / length,
        (following.u * du + following.v * dv) / length,
    )
    d_at, d_to = sqrt(h * h + at * at), sqrt(h * h + to * to)
    bow = h * h * log((to + d_to) / (at + d_at)) if at + d_at > 0.0 else 0.0
    return 0.5 * (to * d_to - at * d_at + bow) / length
