"""Geodesics of a belt over a sphere, a cylinder or an ellipsoid, from a point to another.

    sphere     the great circle in the plane of both points and the centre
    cylinder   a helix: a straight line once the cylinder is unrolled
    ellipsoid  x'' = -(x' . H x') / |grad F|^2 grad F, shot from a point of tangency P so that it
               leaves towards the other point; unknowns are P on its silhouette and the arc

The belt leaves where its tangent meets the points. All is in axes of the shape. `bend` is the
integral of the curvature along the arc, which replaces the angle beta of a ring.
Consequence to test: length and directions are continuous as the belt leaves, and the length is
that of an independent search for the shortest line.
"""

from math import acos, atan2, cos, pi, sin, sqrt
from typing import NamedTuple

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import ZERO, Vector, add, add_scaled, cross, dot, norm, scale, sub

SPHERE, CYLINDER, ELLIPSOID = 1, 2, 3
SHAPES = {"sphere": SPHERE, "cylinder": CYLINDER, "ellipsoid": ELLIPSOID}
# steps of the geodesic on an ellipsoid, and passes of Newton's method for its beginning
PIECES, TRIALS = 24, 20
# of the semi-axes: how close the geodesic comes to its end, how far it may be at worst, and the
# step of differences
CLOSE, FAR, STEP = 1e-11, 1e-7, 1e-6
# sine of the angle between points opposite each other, as seen from a ball: no line over it is the
# shortest
OPPOSITE = 1e-9
# of a belt that passes by: a share of it stays on either side of the surface, as a segment of no
# length has no strain
PASSING = 0.1


class Arc(NamedTuple):
    """The part of a belt that lies on a body."""

    # 1, or 0 where it passes by; -1 where a point is within the shape or both are opposite each
    # other about its middle, -2 where no geodesic is left
    touches: int
    first: Vector  # points where it reaches the body, and leaves
    last: Vector
    middle: Vector  # of the arc, or the nearest point of the belt
    along: Vector  # its direction there
    length: float  # of the arc [m]
    bend: float  # integral of the curvature [rad]
    turned: float  # angle of a cylinder that is wrapped, below 0 where it passes by [rad]


@kernel
def straight_arc(touches, A, B, share, turned):
    """The Arc of a belt that is straight: its nearest point at a share of the line from A to B, or
    one beside it, where that is near an end; it divides webbing that moves without resistance.
    """
    line = sub(B, A)
    length = norm(line)
    middle = add_scaled(A, min(max(share, PASSING), 1.0 - PASSING), line)
    along = scale(1.0 / length, line) if length > 0.0 else (1.0, 0.0, 0.0)
    return Arc(touches, middle, middle, middle, along, 0.0, 0.0, turned)


@kernel
def nearest_share(A, B):
    """Share of the line from A to B at which it is nearest to the origin."""
    line = sub(B, A)
    square = dot(line, line)
    return -dot(A, line) / square if square > 0.0 else 0.0


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
        return straight_arc(-1, A, B, share, 0.0)
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
    """The Arc on a cylinder about the third axis; `sense` of rotation, `before` the last angle."""
    a, b = sqrt(A[0] * A[0] + A[1] * A[1]), sqrt(B[0] * B[0] + B[1] * B[1])
    flat_A, flat_B = (A[0], A[1], 0.0), (B[0], B[1], 0.0)
    share = nearest_share(flat_A, flat_B)
    if a <= R or b <= R:
        return straight_arc(-1, A, B, share, before)
    from_A, from_B = acos(R / a), acos(R / b)
    theta = atan2(A[1], A[0])
    turned = sense * (atan2(B[1], B[0]) - theta) - from_A - from_B
    while turned > before + pi:
        turned -= 2.0 * pi
    while turned < before - pi:
        turned += 2.0 * pi
    if turned <= 0.0:
        return straight_arc(0, A, B, share, turned)
    straight_A, straight_B = sqrt(a * a - R * R), sqrt(b * b - R * R)
    plane = straight_A + R * turned + straight_B
    pitch = (B[2] - A[2]) / plane
    on = theta + sense * from_A
    first = (R * cos(on), R * sin(on), A[2] + pitch * straight_A)
    off = on + sense * turned
    last = (R * cos(off), R * sin(off), B[2] - pitch * straight_B)
    c, s = cos(on + 0.5 * sense * turned), sin(on + 0.5 * sense * turned)
    middle = (R * c, R * s, 0.5 * (first[2] + last[2]))
    steep = sqrt(1.0 + pitch * pitch)
    along = scale(1.0 / steep, (-sense * s, sense * c, pitch))
    length = R * turned * steep
    return Arc(1, first, last, middle, along, length, turned / steep, turned)


@kernel
def over_ellipsoid(semi, A, B, begun, arc):
    """The Arc on an ellipsoid; it began at `begun` and had the length `arc` [m]; 0: not known."""
    a, b = divided(A, semi), divided(B, semi)
    aa, bb = dot(a, a), dot(b, b)
    share = min(max(nearest_share(a, b), 0.0), 1.0)
    if aa <= 1.0 or bb <= 1.0:
        return straight_arc(-1, A, B, share, 0.0)
    nearest = add_scaled(a, share, sub(b, a))
    if dot(nearest, nearest) >= 1.0:
        return straight_arc(0, A, B, share, 0.0)
    # silhouette seen from A, begun where it was, or in the plane of A, B and the centre
    near = divided(begun, semi) if arc > 0.0 else b
    towards = add_scaled(near, -dot(a, near) / aa, a)
    size = norm(towards)
    if size < 1e-9:
        return straight_arc(-1, A, B, share, 0.0)
    e = scale(1.0 / size, towards)
    f = scale(1.0 / sqrt(aa), cross(a, e))
    psi = 0.0
    s = arc if arc > 0.0 else approximate_length(semi, a, b, e)
    largest = 1.0
    for _ in range(TRIALS):
        gap, tip = shoot_geodesic(semi, A, B, a, e, f, psi, s)
        other, _ = shoot_geodesic(semi, A, B, a, e, f, psi + STEP, s)
        d_n, d_b = (other[0] - gap[0]) / STEP, (other[1] - gap[1]) / STEP
        determinant = d_n * gap[3] - d_b * gap[2]
        if determinant == 0.0:
            break
        d_psi = (-gap[0] * gap[3] + gap[1] * gap[2]) / determinant
        d_s = (-d_n * gap[1] + d_b * gap[0]) / determinant
        largest = max(abs(d_psi), abs(d_s) / semi[0])
        relaxation = min(1.0, 0.3 / largest) if largest > 0.0 else 1.0
        psi += relaxation * d_psi
        s = max(s + relaxation * d_s, 0.1 * s)
        if largest < CLOSE:
            break
    if largest > FAR:
        return straight_arc(-2, A, B, share, 0.0)
    first = tangent_point(semi, a, e, f, psi)
    t = scale(1.0 / norm(sub(first, A)), sub(first, A))
    half = travel(semi, first, t, 0.5 * s)
    tip = travel(semi, half[0], half[1], 0.5 * s)
    return Arc(1, first, tip[0], half[0], half[1], s, half[2] + tip[2], 0.0)


@kernel
def divided(x, semi):
    """x over the semi-axes."""
    return (x[0] / semi[0], x[1] / semi[1], x[2] / semi[2])


@kernel
def tangent_point(semi, a, e, f, psi):
    """Point of the silhouette of the ellipsoid as A sees it."""
    aa = dot(a, a)
    radius = sqrt(1.0 - 1.0 / aa)
    y = add_scaled(scale(1.0 / aa, a), radius * cos(psi), e)
    y = add_scaled(y, radius * sin(psi), f)
    return (semi[0] * y[0], semi[1] * y[1], semi[2] * y[2])


@kernel
def approximate_length(semi, a, b, e):
    """About how long the arc is: of the ellipse in the plane of A, B and the centre [m]."""
    size_a, size_b = norm(a), norm(b)
    on = acos(1.0 / size_a)
    arc = max(
        acos(max(min(dot(a, b) / (size_a * size_b), 1.0), -1.0)) - on - acos(1.0 / size_b), 0.0
    )
    x = scale(1.0 / size_a, a)
    length, before = 0.0, ZERO
    for k in range(9):
        at = on + arc * k / 8.0
        y = around(1.0, x, e, at)
        point = (semi[0] * y[0], semi[1] * y[1], semi[2] * y[2])
        length += norm(sub(point, before)) if k > 0 else 0.0
        before = point
    return max(length, 1e-12 * semi[0])


@kernel
def second_derivative(H, x, t):
    """x'' of the geodesic; H, the diagonal of half the second derivatives of
    F = sum (x_i / a_i)^2 - 1, times x is half its gradient.
    """
    g = products(H, x)
    return scale(-dot(t, products(H, t)) / dot(g, g), g)


@kernel
def half_second_derivatives(semi):
    """H of an ellipsoid [1/m^2]."""
    return (1.0 / semi[0] ** 2, 1.0 / semi[1] ** 2, 1.0 / semi[2] ** 2)


@kernel
def products(a, b):
    """Products of components."""
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@kernel
def travel(semi, x, t, s):
    """The geodesic from x along t: its end after s, direction there, integral of the curvature."""
    h, H = s / PIECES, half_second_derivatives(semi)
    k1 = second_derivative(H, x, t)
    bend, before = 0.0, norm(k1)
    for _ in range(PIECES):
        t2 = add_scaled(t, 0.5 * h, k1)
        k2 = second_derivative(H, add_scaled(x, 0.5 * h, t), t2)
        t3 = add_scaled(t, 0.5 * h, k2)
        k3 = second_derivative(H, add_scaled(x, 0.5 * h, t2), t3)
        t4 = add_scaled(t, h, k3)
        k4 = second_derivative(H, add_scaled(x, h, t3), t4)
        x = add_scaled(x, h / 6.0, add(add(t, t4), scale(2.0, add(t2, t3))))
        t = add_scaled(t, h / 6.0, add(add(k1, k4), scale(2.0, add(k2, k3))))
        k1 = second_derivative(H, x, t)
        now = norm(k1)
        bend += 0.5 * h * (before + now)
        before = now
    return x, t, bend


@kernel
def shoot_geodesic(semi, A, B, a, e, f, psi, s):
    """Distances of the end of a geodesic from B along its normal and binormal, their derivatives by
    s, and the end.
    """
    first = tangent_point(semi, a, e, f, psi)
    arrival = sub(first, A)
    t = scale(1.0 / norm(arrival), arrival)
    x, t, _ = travel(semi, first, t, s)
    H = half_second_derivatives(semi)
    g = products(H, x)
    size = norm(g)
    n = scale(1.0 / size, g)
    r, side = sub(B, x), cross(n, t)
    g_s = products(H, t)
    n_s = scale(1.0 / size, add_scaled(g_s, -dot(g_s, n), n))
    side_s = cross(n_s, t)
    return (dot(r, n), dot(r, side), dot(r, n_s) - dot(t, n), dot(r, side_s) - dot(t, side)), x
