"""Gaps between a box or cylinder and a mesh of triangles, one for each position it may rest on.

The corners of a box are points over the mesh, as the centre of a cap is. The lowest position of a
rim, of the lateral surface midway, and the highest of a rim are those along the normal N of a face,

    x = c - rho t / |t|,   t = N - (N . e) e,   depth = -(x - x_0) . N

where the foot of x is on that face, which may be of several triangles: over a flat mesh each
position is as deep as over a plane. One position more is that of the edge of the mesh that is
deepest in the body (`_ridges.py`). Consequence to test: the forces of a plane, and no others.

References: `cylinder_plane.py` and `box_plane.py` (positions), `sphere_mesh.py` (tree, sides).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.contact.narrow import _ridges, _tree, sphere_mesh
from crashsolve.contact.narrow._ascent import ROUND_OFF
from crashsolve.contact.narrow._frame import axes_of_a, local_position, to_shape_axes, to_world_axes
from crashsolve.contact.narrow.cylinder_plane import lowest
from crashsolve.contact.narrow.sphere_mesh import FACE, beyond, by_facing, nearest, outward
from crashsolve.contact.shape import mesh
from crashsolve.deck.building import Columns
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, scale, sub, vec

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

POINT, LOWEST, HIGHEST, RIDGES = 0, 1, 2, 3
PARAMETERS_A = Record("""
    node      index     body
    point     m      3  on the axis, or the corner, from the mass centre, body axes
    axes      1      9  rotation matrix, shape to body, by rows
    half      m      3  half sizes; of a cylinder radius, radius, half length
    is_round  flag      a cylinder about axis 3, not a box
    feature      count     which of the positions above
    rho       m         from the axis downwards; negative upwards
    share     1         of the force of the law
    radius    m         0, as of a point
""")
PARAMETERS_B = mesh.PARAMETERS + Record(
    "ridge_root  index  first box of its edges; -1: it has none"
)
# cosine between normals of triangles that are one face
FLAT = 1.0 - 1e-12
# points of a rim under which faces are looked for
SPOKES = 6
# share of the least half size beyond which an edge has no exit that is the right one
MIDDLE = 0.8


def part(
    element: Columns, half: ArrayLike, feature: int, point: ArrayLike, rho: float, share: float
) -> Columns:
    """A position of a box or cylinder that may touch."""
    kept = {"node": element["node"], "axes": element["axes"], "half": np.asarray(half, float)}
    own = {"point": point, "rho": rho, "share": share, "feature": feature, "radius": 0.0}
    return kept | own | {"is_round": "radius" in element}


def data(elements_a: object, elements_b: Sequence[Columns]) -> tuple[np.ndarray, ...]:
    """Tables of triangles and of edges of all meshes on side b."""
    return *_tree.data(elements_a, elements_b), *_ridges.tables(elements_b)


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    if a.feature == POINT:
        return sphere_mesh.gap(a, b, nodes, data)
    body = nodes[b.node]
    y = local_position(b, body, world_position(nodes[a.node], vec(a.point)))
    axes = axes_of_a(a, b, nodes)
    if a.feature == RIDGES and b.ridge_root >= 0:
        depth, N, x = _ridges.deepest(data[2], data[3], a, b.ridge_root, y, axes)
    elif a.feature == RIDGES:
        depth, N, x = off(data[0], data[1], b, y)
    else:
        depth, N, x = of_rim(data[0], data[1], a, b, y, axes)
    return (
        depth,
        to_world_axes(b, body, N),
        add(world_position(body, vec(b.point)), to_world_axes(b, body, x)),
    )


@kernel
def bound(a, b, nodes, data):
    """Depth that the bodies do not exceed [m]: by the ball around a, and the box around the mesh or
    its nearest triangle.

    With the round-off of the depth: a pair that touches by it must not be skipped.
    """
    y = local_position(b, nodes[b.node], world_position(nodes[a.node], vec(a.point)))
    ball = norm(vec(a.half)) if a.feature == RIDGES else abs(a.rho)
    ball += ROUND_OFF * (ball + norm(y))
    # an open mesh is solid beyond its triangles
    solid = b.thickness if b.thickness < inf else 0.0
    apart = sqrt(beyond(data[0][b.root], y)) - ball - solid
    if apart <= 0.0 and a.feature != POINT:
        foot, index, at = nearest(data[0], data[1], b.root, y)
        out, is_open = outward(data[1][index], at)
        offset = sub(y, foot)
        if not is_open and dot(offset, out) > 0.0:
            apart = norm(offset) - ball
    return -apart if apart > 0.0 else inf


@kernel
def gap_by(a, b, nodes, data, normal):
    """Depth, normal and point as of gap by the triangles that face `normal`, and the depth beyond
    the middle [m]. Edges have no face to be kept.
    """
    if a.feature == POINT:
        return sphere_mesh.gap_by(a, b, nodes, data, normal)
    body = nodes[b.node]
    y, m = (
        local_position(b, body, world_position(nodes[a.node], vec(a.point))),
        to_shape_axes(b, body, normal),
    )
    if a.feature == RIDGES:
        return -1.0, vec(normal), y, -1.0
    axes = axes_of_a(a, b, nodes)
    y, _ = position(a.rho, y, axes, m)
    distance, m, over = by_facing(data[0], data[1], b, y, m)
    depth = distance if distance < 1e300 else -1.0
    x = add(world_position(body, vec(b.point)), to_world_axes(b, body, y))
    return depth, to_world_axes(b, body, m), x, over


@kernel
def middle(a, b, nodes, n):
    """Depth beyond which an edge has no exit that is the right one; none for positions [m]."""
    return MIDDLE * min(a.half[0], a.half[1], a.half[2]) if a.feature == RIDGES else inf


@kernel
def position(rho, y, axes, N):
    """Position on the rim about y along the normal N, and how far it is below y; mesh axes."""
    drop, down = lowest(N, axes[2], axes[0])
    return add_scaled(y, -rho, down), rho * drop


@kernel
def of_rim(tree, triangles, a, b, y, axes):
    """Depth, normal and position of a rim about y by the face that it is over; mesh axes.

    Between faces the deeper counts. Over none it is a point where it is within the solid.
    """
    N = face_under(tree, triangles, b.root, y)
    before, best, n, x, across, ahead = N, -1e300, N, y, axes[0], axes[1]
    for spoke in range(SPOKES + 1):
        if spoke > 0:
            # faces under the rim, of which any may be in touch
            N = face_under(tree, triangles, b.root, add_scaled(y, abs(a.rho), across))
            across, ahead = rotated(across, ahead), rotated(ahead, scale(-1.0, across))
        if spoke == 0 or dot(N, before) < FLAT:
            before = N
            low, below = position(abs(a.rho), y, axes, N)
            depth, m, following = at_position(tree, triangles, b, y, low, below, N)
            if depth > best:
                best, n, x = depth, m, low
            if dot(following, N) < FLAT:
                low, below = position(abs(a.rho), y, axes, following)
                depth, m, _ = at_position(tree, triangles, b, y, low, below, following)
                if depth > best:
                    best, n, x = depth, m, low
    if a.feature == HIGHEST and best > -1e300:
        x, below = position(a.rho, y, axes, n)
        best, n, _ = at_position(tree, triangles, b, y, x, below, n)
    if best > b.thickness:
        # the distance to the back
        return b.thickness - best, scale(-1.0, n), x
    return (best, n, x) if best > -1e300 else off(tree, triangles, b, y)


@kernel
def rotated(u, v):
    """u, rotated toward v by a sixth of a revolution."""
    return add_scaled(scale(0.5, u), sqrt(0.75), v)


@kernel
def face_under(tree, triangles, root, y):
    """Normal of the triangle nearest to y."""
    _, index, _ = nearest(tree, triangles, root, y)
    return vec(triangles[index].n)


@kernel
def at_position(tree, triangles, b, y, z, below, N):
    """Depth and normal of the position z of a rim about y, and the normal of the nearest triangle.

    z is `below` y along N. Beside a face of that normal it is a point, which counts within the
    solid alone: else the depth is -1e300.
    """
    foot, index, at = nearest(tree, triangles, b.root, z)
    face = vec(triangles[index].n)
    if is_over(triangles[index], at, N):
        return below - dot(sub(y, foot), N), N, face
    out, is_open = outward(triangles[index], at)
    offset = sub(z, foot)
    distance = norm(offset)
    if not is_open and dot(offset, out) < 0.0 and distance > 0.0:
        return distance, scale(-1.0 / distance, offset), face
    return -1e300, N, face


@kernel
def is_over(triangle, at, N):
    """Whether a foot is within a face of the normal N, also on an edge between its triangles."""
    if at == FACE:
        return dot(vec(triangle.n), N) >= FLAT
    out, is_open = outward(triangle, at)
    return not is_open and dot(out, N) >= FLAT * norm(out)


@kernel
def off(tree, triangles, b, y):
    """A gap as wide as y is far from the mesh, which it never closes."""
    foot, index, _ = nearest(tree, triangles, b.root, y)
    offset = sub(y, foot)
    distance = norm(offset)
    N = scale(1.0 / distance, offset) if distance > 0.0 else vec(triangles[index].n)
    return -distance, N, y
