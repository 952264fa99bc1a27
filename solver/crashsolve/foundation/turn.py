"""How far body b has turned relative to body a since the start: rotation, and angle about an axis.

    q = (w, v) = q_a^-1 q_b (q_a^-1 q_b at the start)^-1,  axes of a;   t = v . n
    theta = 2 atan2(t, w),   theta_dot = g . (w_b - w_a),   g = (w^2 n + w v x n + t v) / (w^2 + t^2)

theta is the twist of q about the axis n of a: the joint angle where n is fixed in b too, and defined
while b tilts by less than half a turn. A moment M that works on theta is the torque M g.

Reference: Dobrowolski (2015), Swing-twist decomposition in Clifford algebra, arXiv 1506.05481.
"""

from math import atan2, floor, pi

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.motion import arm
from crashsolve.foundation.vec3 import add, cross, dot, scale, sub, vec


@kernel
def relative_rotation(a, b, reference):
    """Unit quaternion (w, v) of b's turn since the start, in axes of a.

    `reference` is q_a^-1 q_b at the start, see foundation.posture.relative.
    """
    w_a, w_b, w_0 = a.q[0], b.q[0], reference[0]
    v_a, v_b = (a.q[1], a.q[2], a.q[3]), (b.q[1], b.q[2], b.q[3])
    v_0 = (reference[1], reference[2], reference[3])
    w = w_a * w_b + dot(v_a, v_b)
    v = sub(sub(scale(w_a, v_b), scale(w_b, v_a)), cross(v_a, v_b))
    turned = sub(sub(scale(w_0, v), scale(w, v_0)), cross(v, v_0))
    return w * w_0 + dot(v, v_0), turned


@kernel
def turn_about(a, b, axis, reference, before):
    """Angle about `axis` (axes of a) nearest to `before`, its rate, and g in world axes [rad]."""
    n = vec(axis)
    w, v = relative_rotation(a, b, reference)
    t = dot(v, n)
    angle = 2.0 * atan2(t, w)
    # q and -q are one posture: the angle is known up to whole turns
    angle += 2.0 * pi * floor((before - angle) / (2.0 * pi) + 0.5)
    g = add(scale(w, add(scale(w, n), cross(v, n))), scale(t, v))
    g = arm(a, scale(1.0 / (w * w + t * t), g))
    return angle, dot(g, sub(vec(b.w), vec(a.w))), g
