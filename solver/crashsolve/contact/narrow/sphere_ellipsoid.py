"""Gap between a sphere (or a point: radius 0) and an ellipsoid.

    depth = r - d,   d the signed distance of the centre from the ellipsoid, negative inside

The nearest point of the ellipsoid to y is x_i = s_i^2 y_i / (t + d_i), d_i = s_i^2 - min s^2, with
t the largest root of sum (s_i y_i / (t + d_i))^2 = 1. The sum is convex and falls, so Newton's
method from the left never overshoots. Point of contact: the deepest of the sphere, c - r n.

References: Eberly (2013), Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid.
"""

from math import copysign

from crashsolve.contact.narrow._frame import local_centre, touch_of_sphere
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import dot, norm, scale, sub

# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True
# a coordinate of 0 is moved by this share of its semi-axis: the nearest point is then unique
PERTURBATION = 1e-14
ITERATIONS = 60  # six do in most places


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    distance, m = from_ellipsoid(b.semi, local_centre(a, b, nodes))
    return touch_of_sphere(a, b, nodes, distance, m)


@kernel
def from_ellipsoid(s, position_seen):
    """Signed distance of a point from an ellipsoid about the origin, and the unit normal there."""
    y = (
        perturbed(position_seen[0], s[0]),
        perturbed(position_seen[1], s[1]),
        perturbed(position_seen[2], s[2]),
    )
    low = min(s[0], s[1], s[2])
    t = root(s, low, y)
    x = (foot(s[0], low, y[0], t), foot(s[1], low, y[1], t), foot(s[2], low, y[2], t))
    slope = (x[0] / s[0] ** 2, x[1] / s[1] ** 2, x[2] / s[2] ** 2)
    m = scale(1.0 / norm(slope), slope)
    return dot(sub(y, x), m), m


@kernel
def perturbed(y, s):
    """Coordinate y, but not 0."""
    return copysign(max(abs(y), PERTURBATION * s), y)


@kernel
def foot(s, low, y, t):
    """Coordinate of the nearest point."""
    return s * s * y / (t + (s - low) * (s + low))


@kernel
def root(s, low, y):
    """Largest root t of sum (s_i y_i / (t + d_i))^2 = 1, by Newton's method from the left."""
    t = 0.0
    for i in range(3):
        t = max(t, s[i] * abs(y[i]) - (s[i] - low) * (s[i] + low))
    for _ in range(ITERATIONS):
        total, fall = -1.0, 0.0
        for i in range(3):
            below = t + (s[i] - low) * (s[i] + low)
            share = s[i] * y[i] / below
            total += share * share
            fall += 2.0 * share * share / below
        step = total / fall
        t += step
        if not step > 1e-14 * t:
            break
    return t
