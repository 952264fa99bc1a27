"""Gap between an ellipsoid and a plane.

    depth = sqrt(n^T E n) - (c - x_0) . n,   E = R diag(s^2) R^T

Point of contact: the deepest of the ellipsoid, c - E n / sqrt(n^T E n).
"""

from math import sqrt

from crashsolve.contact.narrow._frame import to_shape_axes, to_world_axes
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, world_position
from crashsolve.foundation.vec3 import add_scaled, dot, sub, vec

# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    body = nodes[a.node]
    centre = world_position(body, vec(a.point))
    origin = world_position(nodes[b.node], vec(b.point))
    n = arm(nodes[b.node], vec(b.normal))
    m = to_shape_axes(a, body, n)
    s = a.semi
    lever = (s[0] * s[0] * m[0], s[1] * s[1] * m[1], s[2] * s[2] * m[2])
    reach = sqrt(dot(lever, m))
    depth = reach - dot(sub(centre, origin), n)
    return depth, n, add_scaled(centre, -1.0 / reach, to_world_axes(a, body, lever))
