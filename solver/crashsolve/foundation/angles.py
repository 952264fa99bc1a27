"""Angle of body b against body a about an axis, counted over any number of revolutions.

With the axis u and the side s fixed in a, t = u x s, and the side x fixed in b:

    theta = atan2(x . t, x . s) + 2 pi n      theta_dot = g . (w_b - w_a)
    g = u - e p / (p . p),   e = x . u,   p = x - e u

g = u while x stays at right angles to the axis, as in a revolute joint. Where there is no axis, the
orientation of b in a is a quaternion, and a step turns b by a rotation vector, as does the whole
rotation from the start. Consequence to test: g is the derivative of theta in every configuration,
and n follows a body that turns for ever.
"""

from math import acos, atan2, cos, floor, pi, sin, sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, scale, sub, vec

# largest angle at which a rotation vector is trusted [rad], and the cosine of half of it
FOLDED = 3.0
NEARLY_HALF = cos(0.5 * FOLDED)


# of two bodies of which b rotates about an axis of a
ROTATION_ABOUT_AXIS = Record("""
    node_a  index     first body
    node_b  index     second body
    axis_a  1      3  axis, axes of a
    side_a  1      3  at right angles to the axis, axes of a
    side_b  1      3  the same direction at the start, axes of b
""")


@kernel
def angle_about(a, b, axis_a, side_a, side_b):
    """Angle from side_a to side_b about the axis, in (-pi, pi] [rad]."""
    u, s, x = arm(a, vec(axis_a)), arm(a, vec(side_a)), arm(b, vec(side_b))
    return atan2(dot(x, cross(u, s)), dot(x, s))


@kernel
def counted(angle, before):
    """The angle with as many whole revolutions as bring it nearest to the one before [rad]."""
    return angle + 2.0 * pi * floor((before - angle) / (2.0 * pi) + 0.5)


@kernel
def angle_gradient(a, b, axis_a, side_b):
    """g with theta_dot = g . (w_b - w_a)."""
    u, x = arm(a, vec(axis_a)), arm(b, vec(side_b))
    e = dot(x, u)
    p = add_scaled(x, -e, u)
    return add_scaled(u, -e / dot(p, p), p)


@kernel
def angle_rate(a, b, axis_a, side_b):
    """theta_dot [rad/s]."""
    return dot(angle_gradient(a, b, axis_a, side_b), sub(vec(b.w), vec(a.w)))


@kernel
def angle_jacobian_rate(a, b, axis_a, side_b):
    """g_dot . (w_b - w_a): theta_ddot of bodies without angular acceleration [rad/s^2]."""
    w_a, w_b = vec(a.w), vec(b.w)
    u, x = arm(a, vec(axis_a)), arm(b, vec(side_b))
    u_dot, x_dot = cross(w_a, u), cross(w_b, x)
    e, e_dot = dot(x, u), dot(x_dot, u) + dot(x, u_dot)
    p = add_scaled(x, -e, u)
    p_dot = add_scaled(add_scaled(x_dot, -e_dot, u), -e, u_dot)
    n = dot(p, p)
    n_dot = 2.0 * dot(p, p_dot)
    g_dot = add_scaled(u_dot, -e_dot / n + e * n_dot / (n * n), p)
    return dot(add_scaled(g_dot, -e / n, p_dot), sub(w_b, w_a))


@kernel
def orientation_in(a, b):
    """Quaternion (w, x, y, z) that takes components in b to components in a: conj(q_a) q_b."""
    return times((a.q[0], -a.q[1], -a.q[2], -a.q[3]), (b.q[0], b.q[1], b.q[2], b.q[3]))


@kernel
def rotation_between(before, after):
    """Rotation vector of b from one orientation in a to the next, axes of a [rad]."""
    w, x, y, z = times(after, (before[0], -before[1], -before[2], -before[3]))
    sine = sqrt(x * x + y * y + z * z)
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    # twice the half angle over its sine, in the limit as well
    factor = 2.0 * atan2(sine, w) / sine if sine > 1e-12 else 2.0
    return (factor * x, factor * y, factor * z)


@kernel
def axes_at(body, rotation):
    """Unit quaternion q Q of axes that are fixed in a body by the unit quaternion Q."""
    q = (body.q[0], body.q[1], body.q[2], body.q[3])
    return times(q, (rotation[0], rotation[1], rotation[2], rotation[3]))


@kernel
def times(p, q):
    """Product of two quaternions."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
        p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
    )


@kernel
def check_rotation_limit(curves, node, w):
    """Half a revolution of body `node` is near, where its rotation vector would change its sign.

    `w` is the cosine of half the angle. Writes: curves[0].fault and x.
    """
    if w < NEARLY_HALF:
        curves[0].fault, curves[0].x = -node, 2.0 * acos(max(w, -1.0))


@kernel
def rotation_vector(a, b, reference):
    """theta of b's rotation relative to a since the start, axes of a [rad]."""
    w, v = relative_rotation(a, b, reference)
    # q and -q are one orientation: take the shorter turn
    if w < 0.0:
        w, v = -w, scale(-1.0, v)
    s = sqrt(dot(v, v))
    if s < 1e-8:
        return scale(2.0, v)
    return scale(2.0 * atan2(s, w) / s, v)


@kernel
def relative_rotation(a, b, reference):
    """Unit quaternion (w, v) of b's rotation relative to a since the start, axes of a."""
    w_a, w_b, w_0 = a.q[0], b.q[0], reference[0]
    v_a, v_b = (a.q[1], a.q[2], a.q[3]), (b.q[1], b.q[2], b.q[3])
    v_0 = (reference[1], reference[2], reference[3])
    w = w_a * w_b + dot(v_a, v_b)
    v = sub(sub(scale(w_a, v_b), scale(w_b, v_a)), cross(v_a, v_b))
    rotated = sub(sub(scale(w_0, v), scale(w, v_0)), cross(v, v_0))
    return w * w_0 + dot(v, v_0), rotated


@kernel
def tangent_factor(phi):
    """c(phi); a series where the formula would cancel, its next term below 1e-10."""
    if phi < 0.05:
        return 1.0 / 12.0 + phi * phi / 720.0 + phi**4 / 30240.0
    half = 0.5 * phi
    # (1 + cos phi) / sin phi = cot(phi / 2), finite at half a revolution
    cot = sin(phi) / (2.0 * sin(half) ** 2)
    return 1.0 / (phi * phi) - cot / (2.0 * phi)


@kernel
def tangent_map(theta, c, half, x):
    """T x for half = -1/2, T^T x for half = 1/2."""
    rotation = cross(theta, x)
    return add(x, add_scaled(scale(half, rotation), c, cross(theta, rotation)))
