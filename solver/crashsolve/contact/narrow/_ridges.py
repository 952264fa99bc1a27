"""Gap between a box or cylinder and the edges of a mesh at which it is convex or ends.

    depth = the largest over these edges of   min over n of  h_a(n) + h_s(n) - (c_a - c_s) . n

h is how far a body reaches along n, c its centre, s an edge. An edge in one plane with both of its
triangles is none, and those in line with each other are one, so that the triangulation of a face
does not matter. The exits of a straight edge from a convex body are few, n being a normal of it,
or normal to the edge and to one of its own edges, or of the ellipse as which a rim appears along
the edge. The deepest edge alone counts. Consequence to test: the shortest exit of all directions.

References: Gottschalk, Lin and Manocha (1996), Proc. SIGGRAPH, 171-180 (separating axes).
"""

from collections.abc import Iterable
from math import copysign, sqrt

import numpy as np

from crashsolve.contact.narrow._frame import into_axes, out_of_axes
from crashsolve.contact.narrow._tree import BOX, grow
from crashsolve.contact.narrow.sphere_box import from_box
from crashsolve.contact.narrow.sphere_cylinder import from_cylinder
from crashsolve.contact.narrow.sphere_mesh import beyond
from crashsolve.deck.building import Columns
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, cross, dot, norm, scale, sub, unit, vec

SEGMENT = Record("""
    middle  m  3  middle of the edge, shape axes
    half    m  3  from there to its end
""")
# sine of the angle between two triangles up to which they are one face: files of single precision
# leave 1e-7 of the size of a mesh in its points
FLAT = 1e-5
# cosine between two edges in line
IN_LINE = 1.0 - 1e-12
# sine between an edge and a direction up to which they are at right angles or parallel, and no
# end of the edge is deeper than the other but by round-off
LEVEL = 1e-9
ITERATIONS = 60


def tables(elements_b: Iterable[Columns]) -> tuple[np.ndarray, np.ndarray]:
    """Tables BOX and SEGMENT of the edges of all meshes. Writes: ridge_root; -1 without any."""
    boxes: list[np.ndarray] = [np.zeros(0, BOX.dtype)]
    segments: list[np.ndarray] = [np.zeros(0, SEGMENT.dtype)]
    first_box = first = 0
    for element in elements_b:
        ends = _ridges(element)
        element["ridge_root"] = first_box if len(ends) else -1
        if not len(ends):
            continue
        tree, order = grow(ends.min(axis=1), ends.max(axis=1))
        tree["skip"] += first_box
        tree["first"] += first
        table = np.zeros(len(ends), SEGMENT.dtype)
        table["middle"], table["half"] = 0.5 * ends.sum(axis=1), 0.5 * (ends[:, 1] - ends[:, 0])
        boxes.append(tree)
        segments.append(table[order])
        first_box, first = first_box + len(tree), first + len(table)
    return np.concatenate(boxes), np.concatenate(segments)


def _ridges(element: Columns) -> np.ndarray:
    """Ends (m, 2, 3) [m] of the edges at which a mesh is convex or ends; those in line joined."""
    points, faces = element["points"], element["faces"]
    owner, edge, other = element["edges"].T
    i, j, k = (points[faces[:, c]] for c in range(3))
    normal = np.cross(j - i, k - i)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    start, end = faces[owner, edge], faces[owner, (edge + 1) % 3]
    along = points[end] - points[start]
    along /= np.linalg.norm(along, axis=1)[:, None]
    # the normals turn outwards about an edge that is convex
    bend = np.einsum("ij,ij->i", np.cross(normal[owner], normal[other]), along)
    fold = np.einsum("ij,ij->i", normal[owner], normal[other])
    is_open = other < 0
    # of an edge shared by two the triangle with the lower number has it
    kept = is_open | ((owner < other) & ((bend > FLAT) | (fold < -1.0 + FLAT)))
    pairs = np.sort(np.stack([start[kept], end[kept]], axis=1), axis=1)
    return points[_joined(points, np.unique(pairs, axis=0))]


def _joined(points: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Pairs of points with those in line joined to one."""
    edges: dict[int, list[tuple[int, int]]] = {}
    for p, q in pairs.tolist():
        edges.setdefault(p, []).append((p, q))
        edges.setdefault(q, []).append((p, q))
    for p, triangles in sorted(edges.items()):
        if len(triangles) == 2:
            q, r = (sum(e) - p for e in triangles)
            u, v = points[q] - points[p], points[p] - points[r]
            if u @ v >= IN_LINE * np.linalg.norm(u) * np.linalg.norm(v):
                for old, far in zip(list(triangles), (q, r), strict=True):
                    edges[far][edges[far].index(old)] = (q, r)
                edges[p] = []
    return np.array(sorted({e for some in edges.values() for e in some})).reshape(-1, 2)


@kernel
def deepest(tree, segments, a, root, y, axes):
    """Depth [m], normal out of the mesh and point on it, of the edge deepest in a; mesh axes.

    y is the centre of a and `axes` its axes, in those of the mesh.
    """
    best, n, x = -1e300, (0.0, 0.0, 1.0), y
    ball = sqrt(dot(vec(a.half), vec(a.half)))
    i = root
    while i < tree[root].skip:
        box = tree[i]
        # a lies within a ball
        if ball - sqrt(beyond(box, y)) <= best:
            i = box.skip
            continue
        for k in range(box.first, box.first + box.count):
            middle, half = vec(segments[k].middle), vec(segments[k].half)
            m, g = into_axes(axes, sub(middle, y)), into_axes(axes, half)
            depth, N, t = exit_of(a, m, g)
            if depth > best and depth < 0.0:
                depth, N, t = distance_of(a, m, g)
            if depth > best:
                best, n, x = depth, out_of_axes(axes, N), add_scaled(middle, t, half)
        i += 1
    return best, n, x


@kernel
def exit_of(a, m, g):
    """Least overlap [m] of a with the edge m + t g, |t| <= 1, the normal toward a, and t there."""
    if a.is_round == 1:
        return exit_of_cylinder(a.half[0], a.half[2], m, g)
    return exit_of_box(vec(a.half), m, g)


@kernel
def exit_of_box(half, m, g):
    """The same for a box: by a face, or across one of its edges."""
    best, n, axis, length = 1e300, (0.0, 0.0, 1.0), 0, norm(g)
    for k in range(3):
        overlap = half[k] + abs(g[k]) - abs(m[k])
        if overlap < best:
            best, n, axis = overlap, scale(-copysign(1.0, m[k]), unit(k)), k
    face = best
    for k in range(3):
        across = cross(unit(k), g)
        size = norm(across)
        if size > LEVEL * length:
            u = scale(1.0 / size, across)
            c = dot(m, u)
            extent = half[0] * abs(u[0]) + half[1] * abs(u[1]) + half[2] * abs(u[2])
            if extent - abs(c) < best:
                best, n, axis = extent - abs(c), scale(-copysign(1.0, c), u), k
    if best < face:
        return best, n, where_it_crosses(half, m, g, n, axis)
    if abs(g[axis]) > LEVEL * length:
        # the end that is deeper
        return best, n, copysign(1.0, g[axis] * n[axis])
    low, high = -1.0, 1.0
    for k in range(3):
        if k != axis:
            low, high = clipped(low, high, m[k], g[k], half[k])
    return best, n, 0.5 * (low + high)


@kernel
def where_it_crosses(half, m, g, n, k):
    """Position t at which an edge passes that edge of a box along its axis k which faces -n."""
    i, j = (k + 1) % 3, (k + 2) % 3
    p_i, p_j = -copysign(half[i], n[i]) - m[i], -copysign(half[j], n[j]) - m[j]
    t = (p_i * g[i] + p_j * g[j]) / (g[i] * g[i] + g[j] * g[j])
    return max(-1.0, min(1.0, t))


@kernel
def clipped(low, high, m, g, half):
    """What is left of the interval of t in which |m + t g| <= half."""
    if g == 0.0:
        return low, high
    one, other = (-half - m) / g, (half - m) / g
    left, right = max(low, min(one, other)), min(high, max(one, other))
    # nothing of a face beside it, whose overlap is not the least
    return (left, right) if left < right else (low, high)


@kernel
def exit_of_cylinder(r, half, m, g):
    """The same for a cylinder: by a cap, by the lateral surface, or over a rim."""
    length = norm(g)
    best, n = half + abs(g[2]) - abs(m[2]), (0.0, 0.0, -copysign(1.0, m[2]))
    if abs(g[2]) > LEVEL * length:
        t = copysign(1.0, g[2] * n[2])
    else:
        t = middle_of(m[0], m[1], g[0], g[1], r)
    square = g[0] * g[0] + g[1] * g[1]
    is_oblique = square > LEVEL * LEVEL * length * length
    s = max(-1.0, min(1.0, -(m[0] * g[0] + m[1] * g[1]) / square)) if is_oblique else 0.0
    p, q = m[0] + s * g[0], m[1] + s * g[1]
    d = sqrt(p * p + q * q)
    if r - d < best:
        if not is_oblique:
            low, high = clipped(-1.0, 1.0, m[2], g[2], half)
            s = 0.5 * (low + high)
        # of an edge through the axis either side is as near
        p, q, d = (p, q, d) if d > 0.0 else (-g[1], g[0], sqrt(square))
        if d > 0.0:
            best = r - sqrt((m[0] + s * g[0]) ** 2 + (m[1] + s * g[1]) ** 2)
            n, t = (-p / d, -q / d, 0.0), s
    overlap, over, w = exit_over_rim(r, half, m, scale(1.0 / length, g))
    if overlap < best:
        best, n, t = overlap, over, dot(sub(w, m), g) / (length * length)
    return best, n, max(-1.0, min(1.0, t))


@kernel
def middle_of(m_0, m_1, g_0, g_1, r):
    """Middle of the part of an edge along a cap that is within its radius."""
    square = g_0 * g_0 + g_1 * g_1
    t = -(m_0 * g_0 + m_1 * g_1) / square
    p, q = m_0 + t * g_0, m_1 + t * g_1
    reach = sqrt(max(0.0, r * r - p * p - q * q) / square)
    low, high = max(-1.0, t - reach), min(1.0, t + reach)
    return 0.5 * (low + high) if low < high else max(-1.0, min(1.0, t))


@kernel
def exit_over_rim(r, half, m, s):
    """Overlap of a line along s over a rim, normal toward the cylinder, and position on the rim.

    Along s the rim is an ellipse of the semi-axes r |s_z| and r.
    """
    q = sqrt(s[0] * s[0] + s[1] * s[1])
    none = (1e300, (0.0, 0.0, 1.0), m)
    if q < LEVEL or abs(s[2]) < LEVEL:
        return none
    u = scale(1.0 / q, (-s[2] * s[0], -s[2] * s[1], q * q))
    v = (-s[1] / q, s[0] / q, 0.0)
    x, y, flat = dot(m, u), dot(m, v), r * abs(s[2])
    inward = half * q - abs(x)
    t = rim_slope(r, flat, inward, abs(y))
    if t < 0.0:
        return none
    cosine = 1.0 / sqrt(1.0 + t * t)
    overlap = cosine * (inward - abs(y) * t + sqrt(flat * flat + r * r * t * t))
    out = add_scaled(scale(copysign(cosine, x), u), copysign(t * cosine, y), v)
    size = sqrt(out[0] * out[0] + out[1] * out[1])
    w = (r * out[0] / size, r * out[1] / size, copysign(half, x))
    return overlap, scale(-1.0, out), w


@kernel
def rim_slope(r, flat, inward, y):
    """Tangent t of the angle of the shortest exit over an ellipse, or -1 if that is not over it.

    Root of (r^2 - flat^2) t / sqrt(flat^2 + r^2 t^2) - inward t - y, which is concave, by Newton's
    method from the left; `inward`, y: from the middle of the ellipse [m].
    """
    t, d = 0.0, (r - flat) * (r + flat)
    for _ in range(ITERATIONS):
        root = sqrt(flat * flat + r * r * t * t)
        value = d * t / root - inward * t - y
        slope = d * flat * flat / (root * root * root) - inward
        if slope <= 0.0:
            return -1.0
        step = -value / slope
        t += step
        if not step > 1e-15 * t:
            break
    return t


@kernel
def distance_of(a, m, g):
    """Least distance as a depth [m], normal and position t, of an edge apart from a.

    The distance from a convex body is a convex function of t: its slope is zero there.
    """
    low, high = -1.0, 1.0
    for _ in range(ITERATIONS):
        t = 0.5 * (low + high)
        _, n = from_body(a, add_scaled(m, t, g))
        if dot(n, g) < 0.0:
            low = t
        else:
            high = t
    t = 0.5 * (low + high)
    d, n = from_body(a, add_scaled(m, t, g))
    return -d, scale(-1.0, n), t


@kernel
def from_body(a, y):
    """Signed distance of a point from the box or cylinder, and the unit normal there."""
    if a.is_round == 1:
        return from_cylinder(a.half[0], a.half[2], y)
    return from_box(vec(a.half), y)
