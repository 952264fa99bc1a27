"""Gap between a sphere (or a point: radius 0) and a cylinder with flat caps.

    depth = r - d,   d the signed distance of the centre from the cylinder, negative inside

Inside, lateral surface and caps are exits: `gap` takes the nearest, `gap_by` that by which a touch
goes on. Point of contact: the deepest of the sphere, c - r n.
"""

from math import copysign, inf, sqrt

from crashsolve.contact.narrow._frame import (
    local_centre,
    to_shape_axes,
    to_world_axes,
    touch_of_sphere,
)
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import dot, unit, vec

# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True
# share of the radius at which the normal turns too fast as a ball passes the axis
AXIS = 0.8


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    distance, m = from_cylinder(b.radius, b.half_length, local_centre(a, b, nodes))
    return touch_of_sphere(a, b, nodes, distance, m)


@kernel
def gap_by(a, b, nodes, data, normal):
    """Depth, normal and point as of gap by the lateral surface or cap nearest to `normal`, and the
    depth beyond its middle [m].
    """
    y, m = local_centre(a, b, nodes), to_shape_axes(b, nodes[b.node], vec(normal))
    radial, rho = sqrt(m[0] * m[0] + m[1] * m[1]), sqrt(y[0] * y[0] + y[1] * y[1])
    if radial >= abs(m[2]) and rho > 0.0:
        distance = rho - b.radius
        over = -(y[0] * m[0] + y[1] * m[1])
        direction = (y[0] / rho, y[1] / rho, 0.0)
    else:
        side = copysign(1.0, m[2])
        distance = side * y[2] - b.half_length
        over = -side * y[2]
        direction = (0.0, 0.0, side)
    depth, n, point = touch_of_sphere(a, b, nodes, distance, direction)
    return depth, n, point, over


@kernel
def middle(a, b, nodes, n):
    """Depth beyond which the lateral surface has no exit that is the right one; none for the caps
    [m].
    """
    axis = to_world_axes(b, nodes[b.node], unit(2))
    return a.radius + AXIS * b.radius if abs(dot(n, axis)) < 0.5 else inf


@kernel
def from_cylinder(radius, half, y):
    """Signed distance of y from a cylinder along axis 3, and the unit normal there."""
    rho = sqrt(y[0] * y[0] + y[1] * y[1])
    side, cap = rho - radius, abs(y[2]) - half
    if side > 0.0 and cap > 0.0:
        distance = sqrt(side * side + cap * cap)
        radial, axial = side / distance, cap / distance
    elif side > cap:
        distance, radial, axial = side, 1.0, 0.0
    else:
        distance, radial, axial = cap, 0.0, 1.0
    axial = copysign(axial, y[2])
    # on the axis every radial direction is as near
    if rho == 0.0:
        return distance, (radial, 0.0, axial)
    return distance, (radial * y[0] / rho, radial * y[1] / rho, axial)
