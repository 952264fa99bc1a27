"""Support functions of sums of ellipsoids.

    h = sum_k sqrt(sum_i (s_ki n . e_i)^2)

As of contact/narrow/_convex.py, with its point and second derivatives.
"""

from math import sqrt

from crashsolve.contact.narrow._ascent import along
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add_scaled, dot, scale


@kernel
def has_edges(shape, k):
    """Whether edges lie along the axis k, or around it: an ellipsoid has none, a cylinder those of
    its caps.
    """
    return shape.count == 3 or (shape.count == 2 and k == 2)


@kernel
def is_cylinder(shape):
    """Whether it is a cylinder."""
    return shape.count == 2


@kernel
def support_point(shape, u, n):
    """Farthest point of the shape along n from its centre, world components."""
    q, total = along(u, n), (0.0, 0.0, 0.0)
    for k in range(shape.count):
        e = weighted(shape.squares, 3 * k, q)
        total = add_scaled(total, 1.0 / sqrt(dot(e, q)), e)
    return combined(u, total)


@kernel
def support_and_hessian(shape, u, n, s, t):
    """Farthest point along n [m] and its second derivatives along s and t: (ss, st, tt) [m]."""
    q, p, r = along(u, n), along(u, s), along(u, t)
    total, ss, st, tt = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0
    for k in range(shape.count):
        e = weighted(shape.squares, 3 * k, q)
        e_s, e_t = weighted(shape.squares, 3 * k, p), weighted(shape.squares, 3 * k, r)
        square = dot(e, q)
        size = 1.0 / sqrt(square)
        total = add_scaled(total, size, e)
        g_s, g_t = dot(e, p), dot(e, r)
        ss += size * (dot(e_s, p) - g_s * g_s / square)
        st += size * (dot(e_s, r) - g_s * g_t / square)
        tt += size * (dot(e_t, r) - g_t * g_t / square)
    return combined(u, total), (ss, st, tt)


@kernel
def weighted(squares, first, q):
    """Components q times the squares of three semi-axes, from `first` on."""
    return squares[first] * q[0], squares[first + 1] * q[1], squares[first + 2] * q[2]


@kernel
def combined(u, x):
    """The vector that has the components x along three axes."""
    return add_scaled(add_scaled(scale(x[0], u[0]), x[1], u[1]), x[2], u[2])
