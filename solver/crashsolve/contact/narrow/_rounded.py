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
    if shape.is_round == 1:
        return support_of_cylinder(shape, u[2], n)
    total, even = (0.0, 0.0, 0.0), 0.0
    for k in range(3):
        alpha, beta = shape.alpha[k], shape.beta[k]
        q = dot(u[k], n)
        size = 1.0 / sqrt(alpha + beta * q * q)
        even += size * alpha
        total = add_scaled(total, size * beta * q, u[k])
    return add_scaled(total, even, n)


@kernel
def support_of_cylinder(shape, axis, n):
    """As of support_point.

    alpha + beta q^2 loses, along the axis of a thin disc, the digits of the thickness.
    """
    q = dot(axis, n)
    across, total = add_scaled(n, -q, axis), (0.0, 0.0, 0.0)
    for k in range(2):
        alpha, gamma = shape.alpha[k], shape.gamma[k]
        size = 1.0 / sqrt(alpha * dot(across, across) + gamma * q * q)
        total = add_scaled(add_scaled(total, size * alpha, across), size * gamma * q, axis)
    return total


@kernel
def support_and_hessian(shape, u, n, s, t):
    """Farthest point along n [m] and its second derivatives along s and t: (ss, st, tt) [m]."""
    if shape.is_round == 1:
        return support_of_cylinder(shape, u[2], n), hessian_of_cylinder(shape, u[2], n, s, t)
    total, ss, st, tt, even = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        alpha, beta = shape.alpha[k], shape.beta[k]
        q = dot(u[k], n)
        size = 1.0 / sqrt(alpha + beta * q * q)
        even += size * alpha
        total = add_scaled(total, size * beta * q, u[k])
        more = alpha * beta * size * size * size
        e_s, e_t = dot(u[k], s), dot(u[k], t)
        ss += more * e_s * e_s
        st += more * e_s * e_t
        tt += more * e_t * e_t
    return add_scaled(total, even, n), (even + ss, st, even + tt)


@kernel
def hessian_of_cylinder(shape, axis, n, s, t):
    """Second derivatives as of support_and_hessian."""
    q, e_s, e_t = dot(axis, n), dot(axis, s), dot(axis, t)
    across, ss, st, tt, even = add_scaled(n, -q, axis), 0.0, 0.0, 0.0, 0.0
    for k in range(2):
        alpha, gamma = shape.alpha[k], shape.gamma[k]
        size = 1.0 / sqrt(alpha * dot(across, across) + gamma * q * q)
        even += size * alpha
        more = alpha * shape.beta[k] * size * size * size
        ss += more * e_s * e_s
        st += more * e_s * e_t
        tt += more * e_t * e_t
    return even + ss, st, even + tt
