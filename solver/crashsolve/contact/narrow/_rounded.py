"""Largest separation of two boxes or cylinders with rounded edges, from a direction on.

    h = sum_k sqrt(alpha_k + beta_k (n . e_k)^2)

The support function of contact/narrow/_edged.py, its point and second derivatives.
"""

from math import sqrt

from crashsolve.contact.narrow._ascent import (
    ITERATIONS,
    ROUND_OFF,
    crossing,
    newton_step,
    passes_cap,
    tangents,
    unit_towards,
)
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, sub


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


@kernel
def separation_and_hessian(a, b, u, w, c, n, s, t):
    """Vector [m] from the farthest point of b along n to that of a against n, and the second
    derivatives of both.
    """
    x_a, bend_a = support_and_hessian(a, u, n, s, t)
    x_b, bend_b = support_and_hessian(b, w, n, s, t)
    return sub(c, add(x_a, x_b)), add(bend_a, bend_b)


@kernel
def separation_along(a, b, u, w, c, n):
    """Separation of the bodies along n [m]."""
    return dot(sub(c, add(support_point(a, u, n), support_point(b, w, n))), n)


@kernel
def find_maximum(a, b, u, w, c, n, last):
    """The local maximum nearest to direction n: separation before the last step, direction.

    As of contact/narrow/_convex.py.
    """
    s, t = tangents(n)
    separation, hessian = separation_and_hessian(a, b, u, w, c, n, s, t)
    best, damping, round_off = dot(separation, n), 0.0, ROUND_OFF * norm(c)
    for _ in range(ITERATIONS):
        n_new, angle = newton_step(n, s, t, separation, hessian, best, damping)
        if angle < last:
            return best, n_new
        s_new, t_new = tangents(n_new)
        separation_new, bend_new = separation_and_hessian(a, b, u, w, c, n_new, s_new, t_new)
        value = dot(separation_new, n_new)
        if value >= best - round_off:
            n, s, t, separation, hessian, best = (
                n_new,
                s_new,
                t_new,
                separation_new,
                bend_new,
                value,
            )
            damping *= 0.1
        else:
            on_edge, n_edge = largest_on_edges(a, b, u, w, c, n, n_new)
            if on_edge > best:
                n, best, damping = n_edge, on_edge, 0.0
                s, t = tangents(n)
                separation, hessian = separation_and_hessian(a, b, u, w, c, n, s, t)
            else:
                damping = max(4.0 * damping, 1e-3)
    return best, n


@kernel
def largest_on_edges(a, b, u, w, c, n, n_new):
    """Largest separation among normals of edges between n and n_new, and that normal; -1e300
    without any.
    """
    best, at = -1e300, n
    for k in range(6):
        axis = u[k] if k < 3 else w[k - 3]
        is_round = a.is_round if k < 3 else b.is_round
        # a cylinder has the edges of its caps
        if is_round == 0 or k % 3 == 2:
            if dot(axis, n) * dot(axis, n_new) < 0.0:
                normal = crossing(axis, n, n_new)
                value = separation_along(a, b, u, w, c, normal)
                if value > best:
                    best, at = value, normal
            if is_round == 1 and passes_cap(axis, n, n_new):
                normal = unit_towards(axis, n)
                value = separation_along(a, b, u, w, c, normal)
                if value > best:
                    best, at = value, normal
    return best, at
