"""Support functions of boxes and cylinders with rounded edges.

    h = sum_k sqrt(alpha_k + beta_k (n . e_k)^2)

As of contact/narrow/_edged.py, with its point and second derivatives.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add_scaled, dot


@kernel
def has_edges(shape, k):
    """Whether edges lie along the axis k, or around it: those of the caps of a cylinder."""
    return shape.is_round == 0 or k == 2


@kernel
def is_cylinder(shape):
    """Whether it is a cylinder."""
    return shape.is_round == 1


@kernel
def support_point(shape, u, n):
    """Farthest point of the shape along n from its centre, world components."""
    e = (u[2], u[2], u[2]) if shape.is_round == 1 else u
    total, even = (0.0, 0.0, 0.0), 0.0
    for k in range(3):
        alpha, beta = shape.alpha[k], shape.beta[k]
        q = dot(e[k], n)
        square = alpha + beta * q * q
        if square > 0.0:
            size = 1.0 / sqrt(square)
            even += size * alpha
            total = add_scaled(total, size * beta * q, e[k])
    return add_scaled(total, even, n)


@kernel
def support_and_hessian(shape, u, n, s, t):
    """Farthest point along n [m] and its second derivatives along s and t: (ss, st, tt) [m]."""
    e = (u[2], u[2], u[2]) if shape.is_round == 1 else u
    total, ss, st, tt, even = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        alpha, beta = shape.alpha[k], shape.beta[k]
        q = dot(e[k], n)
        square = alpha + beta * q * q
        if square > 0.0:
            size = 1.0 / sqrt(square)
            even += size * alpha
            total = add_scaled(total, size * beta * q, e[k])
            more = alpha * beta * size * size * size
            e_s, e_t = dot(e[k], s), dot(e[k], t)
            ss += more * e_s * e_s
            st += more * e_s * e_t
            tt += more * e_t * e_t
    return add_scaled(total, even, n), (even + ss, st, even + tt)
