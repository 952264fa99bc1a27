"""Newton's method on the sphere of directions, for the largest separation of two convex bodies.

    f(n) = c . n - h_a(n) - h_b(n),   h the support functions

Each step is damped until it ascends. The gradient of f jumps where n crosses the normals of a sharp
edge, whose rounding is narrower than any step: one that crosses them and does not ascend ends on
them, where the rounding curves f. Each kind of shapes has a module with its support functions
(_rounded.py, _ellipsoids.py).
"""

from math import sqrt

from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, scale, sub

# steps at most, and relative round-off of a separation
ITERATIONS, ROUND_OFF = 60, 1e-13
# least curvature, over the sum of both: round-off is 1e-16, and a face 1e9 times as wide as the
# rounding of its edge has more
LEAST_CURVATURE = 1e-12
# cosine to an axis above which a direction is that of the cap
ON_AXIS = 1.0 - 1e-14


@kernel
def find_maximum(shapes, a, b, u, w, c, n, last):
    """The local maximum nearest to direction n: separation before the last step, direction.

    `shapes` is the module of the support functions; steps below `last` [rad] end the search.
    The gradient jumps across the normals of an edge: a step that crosses them, and does not ascend,
    ends on them.
    """
    s, t = tangents(n)
    separation, hessian = separation_and_hessian(shapes, a, b, u, w, c, n, s, t)
    best, damping, round_off = dot(separation, n), 0.0, ROUND_OFF * norm(c)
    for _ in range(ITERATIONS):
        n_new, angle = newton_step(n, s, t, separation, hessian, best, damping)
        if angle < last:
            return best, n_new
        s_new, t_new = tangents(n_new)
        separation_new, bend_new = separation_and_hessian(
            shapes, a, b, u, w, c, n_new, s_new, t_new
        )
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
            on_edge, n_edge = largest_on_edges(shapes, a, b, u, w, c, n, n_new)
            if on_edge > best:
                n, best, damping = n_edge, on_edge, 0.0
                s, t = tangents(n)
                separation, hessian = separation_and_hessian(shapes, a, b, u, w, c, n, s, t)
            else:
                damping = max(4.0 * damping, 1e-3)
    return best, n


@kernel
def largest_on_edges(shapes, a, b, u, w, c, n, n_new):
    """Largest separation among normals of edges between n and n_new, and that normal; -1e300
    without any.
    """
    best, at = -1e300, n
    for k in range(6):
        axis = u[k] if k < 3 else w[k - 3]
        if shapes.has_edges(a, k) if k < 3 else shapes.has_edges(b, k - 3):
            if dot(axis, n) * dot(axis, n_new) < 0.0:
                normal = crossing(axis, n, n_new)
                value = separation_along(shapes, a, b, u, w, c, normal)
                if value > best:
                    best, at = value, normal
            is_cylinder = shapes.is_cylinder(a) if k < 3 else shapes.is_cylinder(b)
            if is_cylinder and passes_cap(axis, n, n_new):
                normal = unit_towards(axis, n)
                value = separation_along(shapes, a, b, u, w, c, normal)
                if value > best:
                    best, at = value, normal
    return best, at


@kernel
def separation_and_hessian(shapes, a, b, u, w, c, n, s, t):
    """Vector [m] from the farthest point of b along n to that of a against n, and the second
    derivatives of both.
    """
    x_a, bend_a = shapes.support_and_hessian(a, u, n, s, t)
    x_b, bend_b = shapes.support_and_hessian(b, w, n, s, t)
    return sub(c, add(x_a, x_b)), add(bend_a, bend_b)


@kernel
def separation_along(shapes, a, b, u, w, c, n):
    """Separation of the bodies along n [m]."""
    return dot(sub(c, add(shapes.support_point(a, u, n), shapes.support_point(b, w, n))), n)


@kernel
def tangents(n):
    """Two unit vectors normal to n and to each other."""
    helper = (1.0, 0.0, 0.0) if abs(n[0]) < 0.6 else (0.0, 1.0, 0.0)
    s = cross(n, helper)
    s = scale(1.0 / norm(s), s)
    return s, cross(n, s)


@kernel
def newton_step(n, s, t, separation, hessian, best, damping):
    """Next direction by a damped Newton step from n, and at most how far the maximum is by the step
    without damping [rad].

    `separation`: from one farthest point to the other [m]; `hessian`: second derivatives of both
    support functions along the tangents s and t, (ss, st, tt) [m]; `best`: the largest so far [m].
    """
    m_ss, m_st, m_tt = hessian[0] + best, hessian[1], hessian[2] + best
    lowest = 0.5 * (m_ss + m_tt) - sqrt(0.25 * (m_ss - m_tt) ** 2 + m_st * m_st)
    size = hessian[0] + hessian[2]
    # the curvature must be positive, or the step would descend
    least = max(lowest, LEAST_CURVATURE * size)
    more = damping * size + least - lowest
    m_ss, m_tt = m_ss + more, m_tt + more
    g_s, g_t = dot(separation, s), dot(separation, t)
    det = m_ss * m_tt - m_st * m_st
    step_s, step_t = (m_tt * g_s - m_st * g_t) / det, (m_ss * g_t - m_st * g_s) / det
    angle = sqrt(step_s * step_s + step_t * step_t) * (1.0 + damping * size / least)
    rotated = add(n, add(scale(step_s, s), scale(step_t, t)))
    return scale(1.0 / norm(rotated), rotated), angle


@kernel
def crossing(axis, n, n_new):
    """Direction normal to the axis on the arc from n to n_new, which lie on both sides of it."""
    before, after = dot(axis, n), dot(axis, n_new)
    normal = add_scaled(n, before / (before - after), sub(n_new, n))
    return scale(1.0 / norm(normal), normal)


@kernel
def passes_cap(axis, n, n_new):
    """Whether the axis of a cylinder is nearer to n than n_new, and n not on it."""
    cosine = abs(dot(axis, n))
    return dot(n, n_new) < cosine < ON_AXIS


@kernel
def axis_of(shape, body, k):
    """Axis k of the shape, world components."""
    return matvec(body.A, (shape.axes[k], shape.axes[3 + k], shape.axes[6 + k]))


@kernel
def axes_of(shape, body):
    """The three axes of the shape, world components."""
    return axis_of(shape, body, 0), axis_of(shape, body, 1), axis_of(shape, body, 2)


@kernel
def along(u, x):
    """Components of x along three axes."""
    return dot(u[0], x), dot(u[1], x), dot(u[2], x)


@kernel
def direction(u, w, c, k):
    """Normals of faces, of edge on edge, of edge on corner, and the line of centres."""
    if k < 3:
        return u[k]
    if k < 6:
        return w[k - 3]
    if k < 15:
        return cross(u[(k - 6) // 3], w[(k - 6) % 3])
    if k < 21:
        e = u[k - 15] if k < 18 else w[k - 18]
        return add_scaled(c, -dot(c, e), e)
    return c


@kernel
def unit_towards(n, c):
    """Unit vector along n, to the side of c."""
    length = norm(n)
    return scale(1.0 / length if dot(n, c) >= 0.0 else -1.0 / length, n)
