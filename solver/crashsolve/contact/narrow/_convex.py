"""Gap between two convex bodies, each a sum of ellipsoids.

    depth = - max over unit n of  (c_a - c_b) . n - h_a(n) - h_b(n),   h = sum_k sqrt(n^T E_k n)

h is the support function. For separated bodies the maximum is unique and its value is their
distance; for bodies that overlap it is the shortest exit, one of several local maxima, searched
from the best of the directions in which edged bodies meet, by Newton's method on the sphere of
directions, damped until every step ascends. Point of contact: midway between the deepest points.
Consequence to test: depth and normal of two spheres, and those of a brute-force search.

References: Gilbert and Foo (1990), IEEE Trans. Robotics Autom. 6, 53-61 (support functions).
"""

from collections.abc import Iterable, Sequence
from math import sqrt
from types import ModuleType

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, scale, sub, vec

# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True
PARAMETERS = Record("""
    node   index      body
    point  m       3  centre from the mass centre, body axes
    axes   1       9  rotation matrix, shape to body, by rows
    count  count      ellipsoids in the sum
    E      m^2    27  their matrices, body axes
""")
# directions are found to this angle [rad]; the depth is then right to its square
ANGLE = 1e-10
ITERATIONS = 60
# rounding of edges against ellipsoids, over the radius of the enclosing sphere; and its maximum,
# over the least half size
SHARP, THINNEST = 1e-5, 0.1
# relative round-off of a separation
ROUND_OFF = 1e-13
# directions to start from, and searches for different maxima of bodies that overlap; cosine of the
# angle within which two searches have reached the same maximum
STARTS, SEARCHES, SAME_MAXIMUM = 22, 4, 1.0 - 1e-8


def expand(elements: Iterable[Columns], shape: ModuleType) -> list[Columns]:
    """Elements of a shape as sums of ellipsoids."""
    return [_as_sum(element, shape.rounds(element)) for element in elements]


def expand_sharp(elements: Sequence[Columns], shape: ModuleType) -> list[Columns]:
    """Boxes or cylinders that meet ellipsoids, as sums of ellipsoids.

    The roundness of the ellipsoid is enough for a unique contact: the edges of the other shape are
    only as round as Newton's method needs with sixteen digits.
    """
    found = []
    for element in elements:
        most = THINNEST * shape.half_thickness(element)
        edge = min(most, SHARP * shape.bounding(element)[1])
        found.append(_as_sum(element, shape.rounds(element | {"edge": edge})))
    return found


def _as_sum(element: Columns, rounds: list[np.ndarray]) -> Columns:
    E = np.zeros(27)
    E[: 9 * len(rounds)] = np.concatenate([r.ravel() for r in rounds])
    kept = {name: element[name] for name in ("node", "point", "axes")}
    return kept | {"count": len(rounds), "E": E}


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    depth, n, x, _ = search(a, b, nodes, data)
    return depth, n, x


@kernel
def search(a, b, nodes, data):
    """Depth, normal and point as of gap, and how much lower the next maximum found is [m]."""
    body_a, body_b = nodes[a.node], nodes[b.node]
    c = sub(world_position(body_a, vec(a.point)), world_position(body_b, vec(b.point)))
    best, n, next_maximum = -1e300, (0.0, 0.0, 1.0), -1e300
    starts = best_directions(a, b, body_a, body_b, c)
    for climb_number in range(SEARCHES):
        k = direction_number(starts, climb_number)
        start = (
            unit_towards(direction(a, b, body_a, body_b, c, k), c) if k >= 0 else (0.0, 0.0, 1.0)
        )
        height, n_maximum = find_maximum(a, b, body_a, body_b, c, start)
        if dot(n_maximum, n) < SAME_MAXIMUM:
            next_maximum = max(next_maximum, min(best, height))
        if height > best:
            best, n = height, n_maximum
        # separated bodies have a single maximum
        if best >= 0.0:
            break
    depth, n, x = depth_at_maximum(a, b, nodes, best, n)
    return depth, n, x, best - next_maximum


@kernel
def follow(a, b, nodes, data, n):
    """Gap at the local maximum nearest to direction n."""
    body_a, body_b = nodes[a.node], nodes[b.node]
    c = sub(world_position(body_a, vec(a.point)), world_position(body_b, vec(b.point)))
    best, n = find_maximum(a, b, body_a, body_b, c, n)
    return depth_at_maximum(a, b, nodes, best, n)


@kernel
def depth_at_maximum(a, b, nodes, best, n):
    """Depth, normal and point of contact at the maximum in direction n."""
    body_a, body_b = nodes[a.node], nodes[b.node]
    x_a = sub(world_position(body_a, vec(a.point)), support_point(a, body_a, n))
    x_b = add(world_position(body_b, vec(b.point)), support_point(b, body_b, n))
    return -best, n, scale(0.5, add(x_a, x_b))


@kernel
def bound(a, b, nodes, data):
    """Depth that the bodies do not exceed [m]: along the line of centres and the axes of b."""
    body_a, body_b = nodes[a.node], nodes[b.node]
    c = sub(world_position(body_a, vec(a.point)), world_position(body_b, vec(b.point)))
    length = norm(c)
    if length == 0.0:
        return 1e300
    best = separation_along(a, b, body_a, body_b, c, scale(1.0 / length, c))
    for k in range(3, 6):
        n = axis_of(a, b, body_a, body_b, k)
        best = max(
            best,
            separation_along(a, b, body_a, body_b, c, n if dot(n, c) >= 0.0 else scale(-1.0, n)),
        )
    return -best


@kernel
def best_directions(a, b, body_a, body_b, c):
    """The SEARCHES directions with the largest separations; -1 without any.

    Of those with the same distance one is enough.
    """
    none = (-1e300, -1)
    one, two, three, four = none, none, none, none
    for k in range(STARTS):
        n = direction(a, b, body_a, body_b, c, k)
        if norm(n) > 1e-6 * norm(c):
            value = separation_along(a, b, body_a, body_b, c, unit_towards(n, c))
            if value > one[0]:
                one, two, three, four = (value, k), one, two, three
            elif two[0] < value < one[0]:
                two, three, four = (value, k), two, three
            elif three[0] < value < two[0]:
                three, four = (value, k), three
            elif four[0] < value < three[0]:
                four = (value, k)
    return one[1], two[1], three[1], four[1]


@kernel
def direction_number(starts, number):
    """Direction from which the search of that number starts; -1 without any."""
    first, second, third, fourth = starts
    if number < 2:
        return first if number == 0 else second
    return third if number == 2 else fourth


@kernel
def unit_towards(n, c):
    """Unit vector along n, to the side of c."""
    length = norm(n)
    return scale(1.0 / length if dot(n, c) >= 0.0 else -1.0 / length, n)


@kernel
def direction(a, b, body_a, body_b, c, k):
    """Normals of faces, of edge on edge, of edge on corner, and the line of centres."""
    if k < 6:
        return scale(norm(c), axis_of(a, b, body_a, body_b, k))
    if k < 15:
        u = axis_of(a, b, body_a, body_b, (k - 6) // 3)
        return scale(norm(c), cross(u, axis_of(a, b, body_a, body_b, 3 + (k - 6) % 3)))
    if k < 21:
        u = axis_of(a, b, body_a, body_b, k - 15)
        return add_scaled(c, -dot(c, u), u)
    return c


@kernel
def axis_of(a, b, body_a, body_b, k):
    """Axis k of the first shape, or axis k - 3 of the second, world components."""
    shape, body, i = (a, body_a, k) if k < 3 else (b, body_b, k - 3)
    return matvec(body.A, (shape.axes[i], shape.axes[3 + i], shape.axes[6 + i]))


@kernel
def find_maximum(a, b, body_a, body_b, c, n):
    """The local maximum nearest to direction n: separation and direction."""
    separation = separation_vector(a, b, body_a, body_b, c, n)
    best, damping, round_off = dot(separation, n), 0.0, ROUND_OFF * norm(c)
    for _ in range(ITERATIONS):
        s, t = tangents(n)
        curved = add(support_hessian(a, body_a, n, s, t), support_hessian(b, body_b, n, s, t))
        n_new, angle = newton_step(n, s, t, separation, curved, best, damping)
        separation_new = separation_vector(a, b, body_a, body_b, c, n_new)
        value = dot(separation_new, n_new)
        if value >= best - round_off:
            n, best, separation = n_new, value, separation_new
            damping *= 0.1
        else:
            damping = max(4.0 * damping, 1e-3)
        if angle < ANGLE:
            break
    return best, n


@kernel
def separation_vector(a, b, body_a, body_b, c, n):
    """Vector [m] from the farthest point of b along n to that of a against n."""
    return sub(c, add(support_point(a, body_a, n), support_point(b, body_b, n)))


@kernel
def separation_along(a, b, body_a, body_b, c, n):
    """Separation of the bodies along n [m]."""
    return dot(separation_vector(a, b, body_a, body_b, c, n), n)


@kernel
def support_point(shape, body, n):
    """Farthest point of the shape along n from its centre, world components."""
    u = matvec_t(body.A, n)
    total = (0.0, 0.0, 0.0)
    for k in range(shape.count):
        w = product(shape.E, 9 * k, u)
        total = add_scaled(total, 1.0 / sqrt(dot(w, u)), w)
    return matvec(body.A, total)


@kernel
def newton_step(n, s, t, separation, hessian, best, damping):
    """Next direction by a damped Newton step from n, and the angle to it [rad].

    `separation`: from one farthest point to the other [m]; `hessian`: second derivatives of both
    support functions along the tangents s and t, (ss, st, tt) [m]; `best`: the largest so far [m].
    """
    m_ss, m_st, m_tt = hessian[0] + best, hessian[1], hessian[2] + best
    lowest = 0.5 * (m_ss + m_tt) - sqrt(0.25 * (m_ss - m_tt) ** 2 + m_st * m_st)
    size = hessian[0] + hessian[2]
    # the curvature must be positive, or the step would descend
    more = damping * size + max(0.0, 1e-6 * size - lowest)
    m_ss, m_tt = m_ss + more, m_tt + more
    g_s, g_t = dot(separation, s), dot(separation, t)
    det = m_ss * m_tt - m_st * m_st
    step_s, step_t = (m_tt * g_s - m_st * g_t) / det, (m_ss * g_t - m_st * g_s) / det
    angle = sqrt(step_s * step_s + step_t * step_t)
    rotated = add(n, add(scale(step_s, s), scale(step_t, t)))
    return scale(1.0 / norm(rotated), rotated), angle


@kernel
def support_hessian(shape, body, n, s, t):
    """Second derivatives of the support function along the tangents s and t: (ss, st, tt) [m]."""
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
