"""Angle of body b against body a about an axis, counted over any number of turns.

With the axis u and the side s fixed in a, t = u x s, and the side x fixed in b:

    theta = atan2(x . t, x . s) + 2 pi n      theta_dot = g . (w_b - w_a)
    g = u - e p / (p . p),   e = x . u,   p = x - e u

g = u while x stays at right angles to the axis, as in a revolute joint. Where there is no axis, the
posture of b in a is a quaternion, and a step turns b by a rotation vector. Consequence to test: g
is the derivative of theta in every posture, and n follows a body that turns for ever.
"""

from math import atan2, floor, pi, sqrt

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.motion import arm
from crashsolve.foundation.vec3 import add_scaled, cross, dot, sub, vec


@kernel
def angle_about(a, b, axis_a, side_a, side_b):
    """Angle from side_a to side_b about the axis, in (-pi, pi] [rad]."""
    u, s, x = arm(a, vec(axis_a)), arm(a, vec(side_a)), arm(b, vec(side_b))
    return atan2(dot(x, cross(u, s)), dot(x, s))


@kernel
def counted(angle, before):
    """The angle with as many whole turns as bring it nearest to the one before [rad]."""
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
def angle_turning(a, b, axis_a, side_b):
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
def posture_in(a, b):
    """Quaternion (w, x, y, z) that takes components in b to components in a: conj(q_a) q_b."""
    return times((a.q[0], -a.q[1], -a.q[2], -a.q[3]), (b.q[0], b.q[1], b.q[2], b.q[3]))


@kernel
def turn_between(before, after):
    """Rotation vector of b from one posture in a to the next, axes of a [rad]."""
    w, x, y, z = times(after, (before[0], -before[1], -before[2], -before[3]))
    sine = sqrt(x * x + y * y + z * z)
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    # twice the half angle over its sine, in the limit as well
    factor = 2.0 * atan2(sine, w) / sine if sine > 1e-12 else 2.0
    return (factor * x, factor * y, factor * z)


@kernel
def times(p, q):
    """Product of two quaternions."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
        p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
    )
