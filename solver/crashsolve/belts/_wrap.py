"""Geodesics of a belt over a sphere or a cylinder, from a point to another.

    sphere     the great circle in the plane of both points and the centre
    cylinder   a helix: a straight line once the cylinder is unrolled

The belt leaves where its tangent meets the points. All is in axes of the shape. `bend` is the
integral of the curvature along the arc, which replaces the angle beta of a ring; an ellipsoid is in
`_ellipsoid.py`.
Consequence to test: length and directions are continuous as the belt leaves, and the length is
that of an independent search for the shortest line.
"""

from math import acos, atan2, cos, pi, sin, sqrt

from crashsolve.belts._arc import OPPOSITE, Arc, nearest_share, straight_arc
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add_scaled, cross, dot, norm, scale


@kernel
def over_sphere(R, A, B):
    """The Arc on a sphere."""
    a, b = norm(A), norm(B)
    share = nearest_share(A, B)
    if a <= R or b <= R:
        return straight_arc(-1, A, B, share, 0.0)
    across = cross(A, B)
    size, on = norm(across), acos(R / a)
    arc = atan2(size, dot(A, B)) - on - acos(R / b)
    if arc <= 0.0:
        return straight_arc(0, A, B, share, 0.0)
    if size <= OPPOSITE * a * b:
        return straight_arc(-2, A, B, share, 0.0)
    n = scale(1.0 / size, across)
    e = scale(1.0 / a, A)
    f = cross(n, e)
    first = around(R, e, f, on)
    last = around(R, e, f, on + arc)
    c, s = cos(on + 0.5 * arc), sin(on + 0.5 * arc)
    middle, along = add_scaled(scale(R * c, e), R * s, f), add_scaled(scale(-s, e), c, f)
    return Arc(1, first, last, middle, along, R * arc, arc, 0.0)


@kernel
def around(R, e, f, angle):
    """Point of a circle."""
    return add_scaled(scale(R * cos(angle), e), R * sin(angle), f)


@kernel
def over_cylinder(R, A, B, sense, before):
    """The Arc on a cylinder about the third axis. The angle from A to B about it, positive in its
    `sense` of rotation, is followed from `before` on: the belt lies on the side of its sign.
    """
    a, b = sqrt(A[0] * A[0] + A[1] * A[1]), sqrt(B[0] * B[0] + B[1] * B[1])
    flat_A, flat_B = (A[0], A[1], 0.0), (B[0], B[1], 0.0)
    share = nearest_share(flat_A, flat_B)
    if a <= R or b <= R:
        return straight_arc(-1, A, B, share, before)
    from_A, from_B = acos(R / a), acos(R / b)
    theta = atan2(A[1], A[0])
    turned = sense * (atan2(B[1], B[0]) - theta)
    while turned > before + pi:
        turned -= 2.0 * pi
    while turned < before - pi:
        turned += 2.0 * pi
    wrapped = abs(turned) - from_A - from_B
    if wrapped <= 0.0:
        return straight_arc(0, A, B, share, turned)
    side = sense if turned > 0.0 else -sense
    straight_A, straight_B = sqrt(a * a - R * R), sqrt(b * b - R * R)
    plane = straight_A + R * wrapped + straight_B
    pitch = (B[2] - A[2]) / plane
    on = theta + side * from_A
    first = (R * cos(on), R * sin(on), A[2] + pitch * straight_A)
    off = on + side * wrapped
    last = (R * cos(off), R * sin(off), B[2] - pitch * straight_B)
    c, s = cos(on + 0.5 * side * wrapped), sin(on + 0.5 * side * wrapped)
    middle = (R * c, R * s, 0.5 * (first[2] + last[2]))
    steep = sqrt(1.0 + pitch * pitch)
    along = scale(1.0 / steep, (-side * s, side * c, pitch))
    length = R * wrapped * steep
    return Arc(1, first, last, middle, along, length, wrapped / steep, turned)
