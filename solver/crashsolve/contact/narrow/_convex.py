"""Gap between two convex bodies, each a sum of ellipsoids.

    depth = - max over unit n of  (c_a - c_b) . n - h_a(n) - h_b(n),   h = sum_k sqrt(n^T E_k n)

h is how far a body reaches along n. For bodies apart the maximum is unique and its value is their
distance; for bodies that overlap it is the shortest way out. Newton's method on the sphere of
directions, damped until every step climbs. Point of contact: midway between the deepest points.
Consequence to test: depth and normal of two spheres, and those of a brute-force search.

References: Gilbert and Foo (1990), IEEE Trans. Robotics Autom. 6, 53-61 (support functions).
"""

from math import sqrt
from typing import Any

import numpy as np

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.motion import place
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import (
    add,
    add_scaled,
    cross,
    dot,
    matvec,
    matvec_t,
    norm,
    scale,
    sub,
    vec,
)

PARAMETERS = Record(
    node=("index", "body"),
    point=("m", 3, "centre from the mass centre, body axes"),
    axes=("1", 9, "rotation matrix, shape to body, by rows"),
    count=("count", "ellipsoids in the sum"),
    E=("m^2", 27, "their matrices, body axes"),
)
# directions are found to this angle [rad]; the depth is then right to its square
ANGLE = 1e-10
ITERATIONS = 60


def expand(elements: Any, shape: Any) -> list[dict[str, Any]]:
    """Elements of a shape as sums of ellipsoids."""
    return [_as_sum(element, shape.rounds(element)) for element in elements]


def _as_sum(element: dict[str, Any], rounds: list[np.ndarray]) -> dict[str, Any]:
    E = np.zeros(27)
    E[: 9 * len(rounds)] = np.concatenate([r.ravel() for r in rounds])
    kept = {name: element[name] for name in ("node", "point", "axes")}
    return kept | {"count": len(rounds), "E": E}


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    body_a, body_b = nodes[a.node], nodes[b.node]
    centre_a, centre_b = place(body_a, vec(a.point)), place(body_b, vec(b.point))
    c = sub(centre_a, centre_b)
    n = first_direction(a, b, body_a, body_b, c)
    x_a, x_b = reach(a, body_a, n), reach(b, body_b, n)
    way = sub(c, add(x_a, x_b))
    best = dot(way, n)
    damping = 0.0
    for _ in range(ITERATIONS):
        n_new, angle = climb(a, b, body_a, body_b, n, way, best, damping)
        y_a, y_b = reach(a, body_a, n_new), reach(b, body_b, n_new)
        way_new = sub(c, add(y_a, y_b))
        value = dot(way_new, n_new)
        if value >= best:
            n, best, way, x_a, x_b = n_new, value, way_new, y_a, y_b
            damping *= 0.1
        else:
            damping = max(4.0 * damping, 1e-3)
        if angle < ANGLE:
            break
    x = scale(0.5, add(sub(centre_a, x_a), add(centre_b, x_b)))
    return -best, n, x


@kernel
def first_direction(a, b, body_a, body_b, c):
    """The farthest apart of the line of centres and the axes of both shapes."""
    length = norm(c)
    best_n = scale(1.0 / length, c) if length > 0.0 else (0.0, 0.0, 1.0)
    best = apart(a, b, body_a, body_b, c, best_n)
    for i in range(3):
        for side in range(2):
            shape, body = (a, body_a) if side == 0 else (b, body_b)
            n = matvec(body.A, (shape.axes[i], shape.axes[3 + i], shape.axes[6 + i]))
            n = n if dot(n, c) >= 0.0 else scale(-1.0, n)
            value = apart(a, b, body_a, body_b, c, n)
            if value > best:
                best, best_n = value, n
    return best_n


@kernel
def apart(a, b, body_a, body_b, c, n):
    """How far apart the bodies are along n [m]."""
    return dot(sub(c, add(reach(a, body_a, n), reach(b, body_b, n))), n)


@kernel
def reach(shape, body, n):
    """Farthest point of the shape along n from its centre, world components."""
    u = matvec_t(body.A, n)
    total = (0.0, 0.0, 0.0)
    for k in range(shape.count):
        w = product(shape.E, 9 * k, u)
        total = add_scaled(total, 1.0 / sqrt(dot(w, u)), w)
    return matvec(body.A, total)


@kernel
def climb(a, b, body_a, body_b, n, way, best, damping):
    """Next direction by a damped Newton step, and the angle to it."""
    s, t = tangents(n)
    a_ss, a_st, a_tt = bend(a, body_a, n, s, t)
    b_ss, b_st, b_tt = bend(b, body_b, n, s, t)
    m_ss, m_st, m_tt = a_ss + b_ss + best, a_st + b_st, a_tt + b_tt + best
    lowest = 0.5 * (m_ss + m_tt) - sqrt(0.25 * (m_ss - m_tt) ** 2 + m_st * m_st)
    size = a_ss + a_tt + b_ss + b_tt
    # the curvature must be positive, or the step would go down
    more = damping * size + max(0.0, 1e-6 * size - lowest)
    m_ss, m_tt = m_ss + more, m_tt + more
    g_s, g_t = dot(way, s), dot(way, t)
    det = m_ss * m_tt - m_st * m_st
    step_s, step_t = (m_tt * g_s - m_st * g_t) / det, (m_ss * g_t - m_st * g_s) / det
    angle = sqrt(step_s * step_s + step_t * step_t)
    turned = add(n, add(scale(step_s, s), scale(step_t, t)))
    return scale(1.0 / norm(turned), turned), angle


@kernel
def bend(shape, body, n, s, t):
    """Second derivatives of the reach along the tangents s and t: (ss, st, tt) [m]."""
    u, s_b, t_b = matvec_t(body.A, n), matvec_t(body.A, s), matvec_t(body.A, t)
    ss, st, tt = 0.0, 0.0, 0.0
    for k in range(shape.count):
        w = product(shape.E, 9 * k, u)
        e_s, e_t = product(shape.E, 9 * k, s_b), product(shape.E, 9 * k, t_b)
        square = dot(w, u)
        along = 1.0 / sqrt(square)
        w_s, w_t = dot(w, s_b), dot(w, t_b)
        ss += along * (dot(e_s, s_b) - w_s * w_s / square)
        st += along * (dot(e_s, t_b) - w_s * w_t / square)
        tt += along * (dot(e_t, t_b) - w_t * w_t / square)
    return ss, st, tt


@kernel
def tangents(n):
    """Two unit vectors normal to n and to each other."""
    helper = (1.0, 0.0, 0.0) if abs(n[0]) < 0.6 else (0.0, 1.0, 0.0)
    s = cross(n, helper)
    s = scale(1.0 / norm(s), s)
    return s, cross(n, s)


@kernel
def product(E, first, u):
    """Symmetric matrix stored from E[first] on, times u."""
    return (
        E[first] * u[0] + E[first + 1] * u[1] + E[first + 2] * u[2],
        E[first + 3] * u[0] + E[first + 4] * u[1] + E[first + 5] * u[2],
        E[first + 6] * u[0] + E[first + 7] * u[1] + E[first + 8] * u[2],
    )
