"""Frame half-way between two triads, in which a beam element measures its deformation.

    q_a^-1 q_b = (w, v),   R = A_a exp(theta / 2),   theta = 2 eta v,   eta = atan2(|v|, w) / |v|

In axes of R, with s the spin of b over a and w_0 the mean of both spins,

    theta_dot = T s,   T = eta I + (1 - eta) n n^T,   n = v / |v|
    spin of R = w_0 - g x s,   g = v / (2 + 2 w) = tan(|theta| / 4) n / 2

R does not depend on which end is a. Consequence to test: these are the derivatives, in any
orientation below half a rotation of b over a.

Reference: Crisfield (1990), A consistent co-rotational formulation for non-linear,
three-dimensional beam-elements, Computer Methods in Applied Mechanics and Engineering 81, 131-150.
"""

from math import sqrt

from crashsolve.foundation.angles import times
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.vec3 import add_scaled, cross, dot, scale

# square of the sine below which the next term of the series, 0.012 x^8, is below 2e-18
SMALL = 0.01
C_1, C_2, C_3, C_4 = 1.0 / 6.0, 3.0 / 40.0, 5.0 / 112.0, 35.0 / 1152.0
C_5, C_6, C_7 = 63.0 / 2816.0, 231.0 / 13312.0, 143.0 / 10240.0


@inlined
def mean_frame(a, b):
    """R by rows (9), v and w."""
    return mean_frame_of((a.q[0], a.q[1], a.q[2], a.q[3]), (b.q[0], b.q[1], b.q[2], b.q[3]))


@inlined
def mean_frame_of(p, q):
    """R by rows (9), v and w between two triads given by their quaternions."""
    w, x, y, z = times((p[0], -p[1], -p[2], -p[3]), q)
    # q and -q are one orientation: take the shorter rotation
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    s = 1.0 / sqrt(2.0 + 2.0 * w)
    half = (s * (1.0 + w), s * x, s * y, s * z)
    return matrix_of(times(p, half)), (x, y, z), w


@kernel
def matrix_of(q):
    """Rotation matrix of a unit quaternion, by rows (9)."""
    w, x, y, z = q
    return (
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )


@kernel
def half_angle_over_sine(v, w):
    """eta, to round-off, by the series of the arcsine at an angle that is halved until it is small.

    eta(phi) = eta(phi / 2) / cos(phi / 2)
    """
    x, share = dot(v, v), 1.0
    while x >= SMALL:
        half = 0.5 * (1.0 + w)
        x *= 0.25 / half
        w = sqrt(half)
        share *= w
    rest = C_4 + x * (C_5 + x * (C_6 + x * C_7))
    return (1.0 + x * (C_1 + x * (C_2 + x * (C_3 + x * rest)))) / share


@inlined
def rotated_rate(eta, v, s):
    """T s, axes of R. T is symmetric."""
    square = dot(v, v)
    if square < 1e-24:
        return s
    return add_scaled(scale(eta, s), (1.0 - eta) * dot(v, s) / square, v)


@inlined
def frame_lag(v, w, s):
    """g x s, the lag of the spin of R behind the mean spin [rad/s], axes of R."""
    return cross(scale(0.5 / (1.0 + w), v), s)
