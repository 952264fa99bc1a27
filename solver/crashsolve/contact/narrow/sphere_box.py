"""Gap between a sphere (or a point: radius 0) and a box.

    depth = r - d,   d the signed distance of the centre from the box, negative inside

Inside, every face is an exit: `gap` takes the nearest, `gap_by` that by which contact continues.
Point of contact: the deepest of the sphere, c - r n.
"""

from math import copysign

from crashsolve.contact.narrow._frame import local_centre, to_shape_axes, touch_of_sphere
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import norm, scale, unit, vec

# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    distance, m = from_box(b.half, local_centre(a, b, nodes))
    return touch_of_sphere(a, b, nodes, distance, m)


@kernel
def gap_by(a, b, nodes, data, normal):
    """Depth, normal and point as of gap by the face nearest to `normal`, and the depth beyond its
    middle [m].
    """
    y, m = local_centre(a, b, nodes), to_shape_axes(b, nodes[b.node], vec(normal))
    size = max(abs(m[0]), abs(m[1]), abs(m[2]))
    k = 0 if abs(m[0]) == size else (1 if abs(m[1]) == size else 2)
    side = copysign(1.0, m[k])
    distance = side * y[k] - b.half[k]
    depth, n, point = touch_of_sphere(a, b, nodes, distance, scale(side, unit(k)))
    return depth, n, point, -distance - b.half[k]


@kernel
def from_box(half, y):
    """Signed distance of y from a box about the origin, and the unit normal there."""
    q = (abs(y[0]) - half[0], abs(y[1]) - half[1], abs(y[2]) - half[2])
    beyond = (max(q[0], 0.0), max(q[1], 0.0), max(q[2], 0.0))
    distance = norm(beyond)
    if distance > 0.0:
        m = scale(1.0 / distance, beyond)
    else:
        # inside: out by the nearest face
        distance = max(q[0], q[1], q[2])
        x, y_ = q[0] == distance, q[1] == distance
        m = (1.0, 0.0, 0.0) if x else ((0.0, 1.0, 0.0) if y_ else (0.0, 0.0, 1.0))
    return distance, (copysign(m[0], y[0]), copysign(m[1], y[1]), copysign(m[2], y[2]))
