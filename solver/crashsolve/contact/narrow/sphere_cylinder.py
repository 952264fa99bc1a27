"""Gap between a sphere (or a point: radius 0) and a cylinder with flat caps.

    depth = r - d,   d the signed distance of the centre from the cylinder, negative inside

Inside, mantle and caps are ways out: `gap` takes the nearest, `gap_by` that by which a touch goes
on. Point of contact: the deepest of the sphere, c - r n.
"""

from math import copysign, inf, sqrt

from crashsolve.contact.narrow._frame import into, out_of, seen_from
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import place
from crashsolve.foundation.vec3 import add_scaled, dot, unit, vec

# share of the radius at which the normal turns too fast as a ball goes by the axis
AXIS = 0.8


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    body = nodes[b.node]
    centre = place(nodes[a.node], vec(a.point))
    distance, m = from_cylinder(b.radius, b.half_length, seen_from(b, body, centre))
    n = out_of(b, body, m)
    return a.radius - distance, n, add_scaled(centre, -a.radius, n)


@kernel
def gap_by(a, b, nodes, data, normal):
    """The same by the mantle or the cap of `normal`, and how far beyond its middle [m]."""
    body = nodes[b.node]
    centre = place(nodes[a.node], vec(a.point))
    y, m = seen_from(b, body, centre), into(b, body, vec(normal))
    radial, rho = sqrt(m[0] * m[0] + m[1] * m[1]), sqrt(y[0] * y[0] + y[1] * y[1])
    if radial >= abs(m[2]) and rho > 0.0:
        distance = rho - b.radius
        over = -(y[0] * m[0] + y[1] * m[1])
        n = out_of(b, body, (y[0] / rho, y[1] / rho, 0.0))
    else:
        side = copysign(1.0, m[2])
        distance = side * y[2] - b.half_length
        over = -side * y[2]
        n = out_of(b, body, (0.0, 0.0, side))
    return a.radius - distance, n, add_scaled(centre, -a.radius, n), over


@kernel
def middle(a, b, nodes, n):
    """Depth beyond which the mantle has no way out that is the right one; none for the caps [m]."""
    axis = out_of(b, nodes[b.node], unit(2))
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
