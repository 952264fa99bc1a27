"""Nearest point of a four-node face to an ellipsoid, or the deepest within it.

    the least of d(c) over the face,   d the signed distance of c from the ellipsoid, m its normal

d is convex, so that a triangle has one least. Near a position c the square of d + r, r the shortest
semi-axis, is that of the length of

    y = ((c' - c) . m + d + r,   sqrt((d + r) / (R_k + d)) (c' - c) . t_k),   R_k radii of curvature

to second order, and the position nearest to y = 0 on the face so stretched is Newton's next. Where
it comes no nearer the next is that nearest to a ball within the ellipsoid that touches it at the
foot of c, which always does. Consequence to test: no position of the face is nearer; with equal
semi-axes it is the position nearest to the centre.

References: Boyd and Vandenberghe (2004), Convex Optimization, 3.2.5 and 9.5.
"""

from math import sqrt

from crashsolve.contact.narrow._ascent import tangents
from crashsolve.contact.narrow._face import corner_weights, nearest_on_face, point_of
from crashsolve.contact.narrow.sphere_ellipsoid import from_ellipsoid
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add_scaled, dot, norm, scale, sub

ITERATIONS = 60  # four to eight do
# of the longest semi-axis: smaller gains are round-off
ROUND_OFF = 1e-15
# of a semi-axis: least gain for which another triangle is searched
GAIN = 1e-12
# of the shortest semi-axis: distance from the centre below which no exit is the shortest
NO_DISTANCE = 1e-9


@kernel
def nearest_to_ellipsoid(s, far, a, b, c, d):
    """Weights N of the corners, given in the axes of the ellipsoid from its centre; and the
    feature.

    The position is INSIDE, EDGE + k or CORNER + k. Also the signed distance, and the normal there.
    For a face farther than `far` the position is any, and the distance a lower bound.
    """
    N, position, least, m = nearest_by_newton(s, far, a, b, c, d)
    at, middle = point_of(N, a, b, c, d), point_of((0.25, 0.25, 0.25, 0.25), a, b, c, d)
    for k in range(4):
        # a warped face may have a second minimum
        p, q = (a, b) if k == 0 else ((b, c) if k == 1 else ((c, d) if k == 2 else (d, a)))
        if lower_bound(least, m, at, p, q, middle, middle) < least - GAIN * s[0] and least < far:
            M, _, other, m_other = nearest_by_newton(s, far, p, q, middle, middle)
            if other < least:
                N, position = corner_weights(k, M[0], M[1], M[2] + M[3])
                least, m = other, m_other
    return N, position, least, m


@kernel
def lower_bound(d, m, at, a, b, c, e):
    """Lower bound of the distance within the corners: d is convex, and m its slope."""
    lowest = min(dot(m, sub(a, at)), dot(m, sub(b, at)), dot(m, sub(c, at)), dot(m, sub(e, at)))
    return d + lowest


@kernel
def nearest_by_newton(s, far, a, b, c, d):
    """The minimum by Newton's method, from the position touched first by a growing ellipsoid."""
    N, _, position = nearest_on_face(
        to_unit_sphere(s, a), to_unit_sphere(s, b), to_unit_sphere(s, c), to_unit_sphere(s, d)
    )
    at = point_of(N, a, b, c, d)
    least, m = from_ellipsoid(s, at)
    beyond = lower_bound(least, m, at, a, b, c, d)
    if beyond > far:
        return N, position, beyond, m
    noise = ROUND_OFF * max(s[0], s[1], s[2])
    for _ in range(ITERATIONS):
        N_new, position_new = newton_position(s, at, least, m, a, b, c, d)
        new, m_new = from_ellipsoid(s, point_of(N_new, a, b, c, d))
        if new > least + noise:
            N_new, position_new = ball_position(s, at, least, m, a, b, c, d)
            new, m_new = from_ellipsoid(s, point_of(N_new, a, b, c, d))
        if new > least + noise:
            break
        gain = least - new
        N, position, at, least, m = N_new, position_new, point_of(N_new, a, b, c, d), new, m_new
        # the last Newton step improves only the digits of the position
        if gain <= noise:
            break
    return N, position, least, m


@kernel
def to_unit_sphere(s, x):
    """Coordinates in which the ellipsoid is the unit sphere."""
    return x[0] / s[0], x[1] / s[1], x[2] / s[2]


@kernel
def newton_position(s, at, d, m, a, b, c, e):
    """Newton's next point: weights and position."""
    low = min(s[0], s[1], s[2])
    t, u, R_t, R_u = curvatures(s, add_scaled(at, -d, m), m)
    r = max(d + low, NO_DISTANCE * low)
    k_t, k_u = sqrt(r / max(R_t + d, NO_DISTANCE * low)), sqrt(r / max(R_u + d, NO_DISTANCE * low))
    N, _, position = nearest_on_face(
        scaled_coordinates(sub(a, at), m, t, u, r, k_t, k_u),
        scaled_coordinates(sub(b, at), m, t, u, r, k_t, k_u),
        scaled_coordinates(sub(c, at), m, t, u, r, k_t, k_u),
        scaled_coordinates(sub(e, at), m, t, u, r, k_t, k_u),
    )
    return N, position


@kernel
def scaled_coordinates(x, m, t, u, r, k_t, k_u):
    """y of a corner at x from the present position."""
    return dot(x, m) + r, k_t * dot(x, t), k_u * dot(x, u)


@kernel
def curvatures(s, x, m):
    """Principal directions of the ellipsoid at its position x with normal m, and radii there
    [m].
    """
    v, w = tangents(m)
    slope = norm(to_unit_sphere(s, to_unit_sphere(s, x)))
    S_vv = dot(to_unit_sphere(s, v), to_unit_sphere(s, v)) / slope
    S_vw = dot(to_unit_sphere(s, v), to_unit_sphere(s, w)) / slope
    S_ww = dot(to_unit_sphere(s, w), to_unit_sphere(s, w)) / slope
    middle, half = 0.5 * (S_vv + S_ww), 0.5 * (S_vv - S_ww)
    mohr_radius = sqrt(half * half + S_vw * S_vw)
    # half the angle by which the larger curvature is turned from v
    cosine = 1.0 if mohr_radius == 0.0 else sqrt(max(0.5 + 0.5 * half / mohr_radius, 0.0))
    sine = 0.0 if mohr_radius == 0.0 else sqrt(max(0.5 - 0.5 * half / mohr_radius, 0.0))
    sine = sine if S_vw >= 0.0 else -sine
    t = add_scaled(scale(cosine, v), sine, w)
    u = add_scaled(scale(cosine, w), -sine, v)
    return t, u, 1.0 / (middle + mohr_radius), 1.0 / max(middle - mohr_radius, 1e-300)


@kernel
def ball_position(s, at, d, m, a, b, c, e):
    """The position nearest to the ball inscribed at the foot of c: weights, and feature."""
    low, high = min(s[0], s[1], s[2]), max(s[0], s[1], s[2])
    z = add_scaled(at, -d - low * low / high, m)
    N, _, position = nearest_on_face(sub(a, z), sub(b, z), sub(c, z), sub(e, z))
    return N, position
