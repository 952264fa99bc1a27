"""Gap between an ellipsoid and a mesh of triangles.

    d the least signed distance from the ellipsoid over all triangles, m its normal there, N = -m
    depth = -d,   and on a face   depth = sqrt(n^T E n) - (c - x_0) . n,   E = R diag(s^2) R^T

The triangle with the least d alone counts, so that an edge shared by two is met once. On a face,
which may be of several triangles, both formulas agree while the depth is below the least radius of
curvature of the ellipsoid; beyond it d has its exit sideways, and that of the face is kept. A
centre within the solid is pushed out by the same face; deeper than the thickness it is behind the
mesh, and does not touch. Point of contact: the deepest of the ellipsoid, c - E N / sqrt(N^T E N).
Consequence to test: the separation of all directions; with equal semi-axes the gap of a sphere.

References: `_ellipsoid_face.py` (d on a triangle), `sphere_mesh.py` (tree, inside and outside).
"""

from math import sqrt

from crashsolve.contact.narrow import _tree
from crashsolve.contact.narrow._ellipsoid_face import nearest_by_newton
from crashsolve.contact.narrow._face import CORNER, EDGE, INSIDE
from crashsolve.contact.narrow._frame import (
    axes_of_a,
    into_axes,
    local_position,
    out_of_axes,
    to_world_axes,
)
from crashsolve.contact.narrow.sphere_mesh import FACE, beyond, outward
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.vec3 import add_scaled, dot, norm, scale, sub, vec

# cosine between the normals that meet at an edge or corner above which it lies within a flat face
FLAT = 1.0 - 1e-12
data = _tree.data


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    body = nodes[b.node]
    centre = world_position(nodes[a.node], vec(a.point))
    y, axes = local_position(b, body, centre), axes_of_a(a, b, nodes)
    index, at, d, m = least_distance(data[0], data[1], b.root, vec(a.semi), y, axes)
    out, is_open = outward(data[1][index], at)
    inside = not is_open and dot(out, m) > 0.0
    face = vec(data[1][index].n)
    on_face = at == FACE or (not is_open and dot(out, face) >= FLAT * norm(out))
    N = face if on_face else (m if inside else scale(-1.0, m))
    lever = levered(a.semi, axes, N)
    reach = sqrt(dot(lever, N))
    # of the centre over the surface, along the normal
    height = dot(sub(y, vec(data[1][index].i)), N) if on_face else reach + d
    if inside and not on_face:
        height = -height
    n = to_world_axes(b, body, N)
    if height < -b.thickness:
        # the distance to the back
        return b.thickness + height, scale(-1.0, n), centre
    return reach - height, n, add_scaled(centre, -1.0 / reach, to_world_axes(b, body, lever))


@kernel
def levered(s, axes, n):
    """E n."""
    z = into_axes(axes, n)
    return out_of_axes(axes, (s[0] * s[0] * z[0], s[1] * s[1] * z[1], s[2] * s[2] * z[2]))


@kernel
def least_distance(tree, triangles, root, s, y, axes):
    """The triangle nearest to the ellipsoid, the position on it, its distance, and the normal.

    y is the centre of the ellipsoid; the normal points out of it, in the axes of the mesh.
    """
    leaf = nearest_leaf(tree, root, y)
    none = (tree[leaf].first, FACE, 1e300, (0.0, 0.0, 1.0))
    nearest_yet = nearer(tree, triangles, leaf, leaf + 1, s, y, axes, none)
    return nearer(tree, triangles, root, tree[root].skip, s, y, axes, nearest_yet)


@kernel
def nearer(tree, triangles, first, last, s, y, axes, before):
    """The same among the boxes from first to last, or `before` where none is nearer."""
    index, at, best, m = before
    longest = max(s[0], s[1], s[2])
    i = first
    while i < last:
        box = tree[i]
        # the ellipsoid lies within a ball
        if sqrt(beyond(box, y)) - longest >= best:
            i = box.skip
            continue
        for k in range(box.first, box.first + box.count):
            p = into_axes(axes, sub(vec(triangles[k].i), y))
            q = into_axes(axes, sub(vec(triangles[k].j), y))
            r = into_axes(axes, sub(vec(triangles[k].l), y))
            _, position, d, m_k = nearest_by_newton(s, best, p, q, r, r)
            if d < best:
                best, index, at, m = d, k, feature(position), out_of_axes(axes, m_k)
        i += 1
    return index, at, best, m


@kernel
def nearest_leaf(tree, root, y):
    """A smallest box near y."""
    leaf = root
    while tree[leaf].count == 0:
        left = leaf + 1
        right = tree[left].skip
        leaf = left if beyond(tree[left], y) <= beyond(tree[right], y) else right
    return leaf


@kernel
def feature(position):
    """Position on a triangle, of that on a face whose third and fourth corners are one."""
    if position == INSIDE:
        return FACE
    k = position - EDGE
    if position >= CORNER:
        return 4 + min(position - CORNER, 2)
    # its third side has no length
    return 6 if k == 2 else (3 if k == 3 else 1 + k)
