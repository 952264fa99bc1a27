"""Gap between a sphere (or a point: radius 0) and a mesh of triangles.

    depth = r - d,   d the signed distance of the centre k from the nearest triangle i, j, l

    n = r_ij x r_jl / |r_ij x r_jl|,   foot = r_k - (r_ik . n) n
    k above the triangle:   (r_ij x r_ik).n >= 0,   (r_jl x r_jk).n >= 0,   (r_li x r_lk).n >= 0

Elsewhere the foot is the nearest point of an edge, and the sign is that of the sum of the normals
that meet there, weighted by their angles; the open edge of a mesh has no inside. The nearest
triangle alone counts, so that an edge shared by two is met once: `gap_by` takes that among those
which face the direction in which a contact continues. A centre deeper than the thickness below the
surface is behind the mesh and does not touch. (The chapter prints a normal that is not of unit
length and products that are negative inside; these are the corrected ones.)

The nearest triangle is found in a tree of boxes: each is followed by its inner boxes and knows
the next one when it is too far. Consequence to test: a brute-force search over all triangles.

References: Ambrosio (2003), Eq. 11-16; Baerentzen and Aanaes (2005), IEEE Trans. Vis. Comput.
Graph. 11, 243-253 (signs).
"""

from math import sqrt

from crashsolve.contact.narrow import _tree
from crashsolve.contact.narrow._frame import local_position, to_shape_axes, to_world_axes
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.vec3 import add_scaled, cross, dot, norm, scale, sub, vec

# cosine to the normal of a touch, below which a triangle faces another direction
FACING = 0.5
FACE = 0  # features 1 to 3 are the edges, 4 to 6 the corners at which they start
data = _tree.data


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    body = nodes[b.node]
    centre = world_position(nodes[a.node], vec(a.point))
    y = local_position(b, body, centre)
    foot, index, at = nearest(data[0], data[1], b.root, y)
    offset = sub(y, foot)
    distance = norm(offset)
    m, is_open = outward(data[1][index], at)
    inside = not is_open and dot(offset, m) < 0.0
    if distance > 0.0:
        m = scale(-1.0 / distance if inside else 1.0 / distance, offset)
    n = to_world_axes(b, body, m)
    if inside and distance > b.thickness:
        # the distance to the back
        return b.thickness - distance, scale(-1.0, n), centre
    return a.radius + (distance if inside else -distance), n, add_scaled(centre, -a.radius, n)


@kernel
def gap_by(a, b, nodes, data, normal):
    """Depth, normal and point as of gap by the triangles that face `normal`, and the depth beyond
    the middle [m].

    The middle is where those that face the opposite direction are as near, or, of an open mesh,
    where it ends. Without a triangle that faces `normal` there is no depth.
    """
    body = nodes[b.node]
    centre = world_position(nodes[a.node], vec(a.point))
    y, m = local_position(b, body, centre), to_shape_axes(b, body, vec(normal))
    distance, m, over = by_facing(data[0], data[1], b, y, m)
    n = to_world_axes(b, body, m)
    depth = a.radius + distance if distance < 1e300 else -1.0
    return depth, n, add_scaled(centre, -a.radius, n), over


@kernel
def by_facing(tree, triangles, b, y, m):
    """Distance of y from the triangles that face m, the direction there, the depth beyond the
    middle [m].
    """
    foot, distance = nearest_facing(tree, triangles, b.root, y, m)
    _, opposite = nearest_facing(tree, triangles, b.root, y, scale(-1.0, m))
    if distance > 0.0 and distance < 1e300:
        m = scale(1.0 / distance, sub(foot, y))
    return distance, m, distance - min(opposite, b.thickness)


@kernel
def nearest_facing(tree, triangles, root, y, m):
    """Nearest point to y on triangles whose normal is within 60 degrees of m; its distance [m]."""
    foot, best = y, 1e300
    i = root
    while i < tree[root].skip:
        box = tree[i]
        if beyond(box, y) >= best:
            i = box.skip
            continue
        for k in range(box.first, box.first + box.count):
            if dot(vec(triangles[k].n), m) > FACING:
                candidate, _ = foot_on(triangles[k], y)
                far = square(sub(y, candidate))
                if far < best:
                    best, foot = far, candidate
        i += 1
    return foot, sqrt(best) if best < 1e300 else best


@kernel
def nearest(tree, triangles, root, y):
    """Nearest point of a mesh to y, its triangle, and its position on that."""
    leaf = root
    while tree[leaf].count == 0:
        left = leaf + 1
        right = tree[left].skip
        leaf = left if beyond(tree[left], y) <= beyond(tree[right], y) else right
    index = tree[leaf].first
    foot, at = foot_on(triangles[index], y)
    best = square(sub(y, foot))
    i = root
    while i < tree[root].skip:
        box = tree[i]
        if beyond(box, y) >= best:
            i = box.skip
            continue
        for k in range(box.first, box.first + box.count):
            candidate, position_k = foot_on(triangles[k], y)
            far = square(sub(y, candidate))
            if far < best:
                best, foot, index, at = far, candidate, k, position_k
        i += 1
    return foot, index, at


@kernel
def beyond(box, y):
    """Square of the distance of y from a box; 0 inside."""
    total = 0.0
    for c in range(3):
        d = max(box.low[c] - y[c], 0.0, y[c] - box.high[c])
        total += d * d
    return total


@kernel
def square(x):
    return dot(x, x)


@kernel
def foot_on(triangle, y):
    """Nearest point of a triangle to y (Eq. 11-16), and its position."""
    n = vec(triangle.n)
    i, j, third = vec(triangle.i), vec(triangle.j), vec(triangle.l)
    above = edge_products(i, j, third, y, n)
    if above[0] >= 0.0 and above[1] >= 0.0 and above[2] >= 0.0:
        return add_scaled(y, -dot(sub(y, i), n), n), FACE
    foot, at, best = i, FACE, 1e300
    for c in range(3):
        # the nearest point lies on an edge that y is outside of
        if above[c] < 0.0:
            p, q = (i, j) if c == 0 else ((j, third) if c == 1 else (third, i))
            candidate, position_c = foot_on_edge(p, q, y, c)
            far = square(sub(y, candidate))
            if far < best:
                best, foot, at = far, candidate, position_c
    return foot, at


@kernel
def edge_products(i, j, third, k, n):
    """Ambrosio (2003), Eq. 16 corrected: on which side of each edge k lies [m^2]."""
    return (
        dot(cross(sub(j, i), sub(k, i)), n),
        dot(cross(sub(third, j), sub(k, j)), n),
        dot(cross(sub(i, third), sub(k, third)), n),
    )


@kernel
def foot_on_edge(p, q, y, c):
    """Nearest point of edge c from p to q, and its position: the edge or one of its corners."""
    e = sub(q, p)
    s = dot(sub(y, p), e) / dot(e, e)
    if s <= 0.0:
        return p, 4 + c
    if s >= 1.0:
        return q, 4 + (c + 1) % 3
    return add_scaled(p, s, e), 1 + c


@kernel
def outward(triangle, at):
    """Direction that distinguishes inside from outside there, and whether it is an open edge."""
    if at == FACE:
        return vec(triangle.n), False
    c = 3 * (at - 1)
    N = triangle.edge_n
    return (N[c], N[c + 1], N[c + 2]), triangle.is_open[at - 1] != 0
