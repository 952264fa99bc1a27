"""Ellipsoids in contact with faces: treated as balls within them at the point of contact.

    z = c - (d + s) m,   s the shortest semi-axis: the ball of radius s about z touches at the foot

c is the point of a face nearest to the ellipsoid, d their distance and m the normal there; the
equations of balls and faces then hold with z for the centre. Consequence to test: an ellipsoid of
equal semi-axes behaves as a ball; momentum and angular momentum are kept to round-off, since
the force acts along the line through z, the foot and c.

Along a field of normals n (normals.py) the foot is the position of the ellipsoid with the normal
-n:

    z = x - S(n) + s n / |n|,   S(n) = B n / sqrt(n . B n),   x its centre, B its matrix
"""

from math import sqrt

from crashsolve.contact.cells import corner_points
from crashsolve.contact.narrow._ellipsoid_face import nearest_to_ellipsoid
from crashsolve.contact.narrow._frame import local_position, to_shape_axes, to_world_axes
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, point_velocity, world_position
from crashsolve.foundation.vec3 import add_scaled, dot, norm, put, scale, sub, vec
from crashsolve.system.contact.projection import (
    keep_nearest,
    remove_hidden,
    report_depth,
    reset_found,
)


@kernel
def find_nearest_faces(i, p, totals, ellipsoid, nodes, sides, mesh, lists, excluded):
    """The nearest face on either side of an ellipsoid within the gap. Writes: sides, lists."""
    is_deep = reset_found(i, p, sides)
    search_list(i, p, totals, is_deep, ellipsoid, nodes, sides, mesh, lists, excluded)
    if remove_hidden(i, p, sides, mesh, excluded):
        search_list(i, p, totals, is_deep, ellipsoid, nodes, sides, mesh, lists, excluded)
    report_depth(p, sides.hits)


@kernel
def search_list(i, p, totals, is_deep, ellipsoid, nodes, sides, mesh, lists, excluded):
    """Keep the nearest faces of an ellipsoid's list. Writes: sides, lists.

    A face that is farther than the gap is due when the travel may have closed it.
    """
    first, near, wait, due = lists
    body, soonest = nodes[ellipsoid.node], 1e300
    low = min(ellipsoid.semi[0], ellipsoid.semi[1], ellipsoid.semi[2])
    for k in range(first[i], first[i + 1]):
        f = near[k]
        if mesh[5][f] == 1:
            continue
        if wait[k] <= totals.travel or is_deep:
            a, b, c, d = local_corners(ellipsoid, body, p, f, mesh)
            N, spot, distance, m = nearest_to_ellipsoid(
                vec(ellipsoid.semi), p.gap - low, a, b, c, d
            )
            wait[k] = totals.travel + max(distance + low - p.gap, 0.0)
            if distance + low < p.gap:
                to = scale(distance + low, to_world_axes(ellipsoid, body, m))
                keep_nearest(i, p, (f, N, spot), abs(distance + low), to, sides, mesh, excluded)
        soonest = min(soonest, wait[k])
    due[i] = soonest


@kernel
def local_corners(ellipsoid, body, p, f, mesh):
    """Corners of a face from the centre of the ellipsoid, in its axes."""
    points, at = mesh[0], corner_points(p, f, mesh[1])
    return (
        local_position(ellipsoid, body, vec(points[at[0]].r)),
        local_position(ellipsoid, body, vec(points[at[1]].r)),
        local_position(ellipsoid, body, vec(points[at[2]].r)),
        local_position(ellipsoid, body, vec(points[at[3]].r)),
    )


@kernel
def place_ball(ball, p, hit, nodes, points, corners):
    """Place the ball that represents the ellipsoid at the point of contact; returns its velocity.

    Writes: ball.
    """
    at, z = corner_points(p, hit.face, corners), (0.0, 0.0, 0.0)
    for k in range(4):
        z = add_scaled(z, hit.N[k], vec(points[at[k]].r))
    z = add_scaled(z, p.gap - hit.depth, vec(hit.normal))
    body = nodes[ball.node]
    put(ball.at, matvec_t(body.A, sub(z, vec(body.r))))
    return point_velocity(body, arm(body, vec(ball.at)))


@kernel
def centre_of(ellipsoid, nodes):
    """Centre of an ellipsoid, and the arguments of centre_from_ball()."""
    body = nodes[ellipsoid.node]
    low = min(ellipsoid.semi[0], ellipsoid.semi[1], ellipsoid.semi[2])
    return world_position(body, vec(ellipsoid.point)), (ellipsoid, body, low)


@kernel
def scaled_by_squares(ellipsoid, y):
    """A direction in the axes of the ellipsoid times its semi-axes squared."""
    a, b, c = vec(ellipsoid.semi)
    return a * a * y[0], b * b * y[1], c * c * y[2]


@kernel
def centre_from_ball(ellipsoid_data, n):
    """Vector [m] to the centre from that of the ball at the foot with normal -n, of any length."""
    ellipsoid, body, low = ellipsoid_data
    y = to_shape_axes(ellipsoid, body, n)
    w = scaled_by_squares(ellipsoid, y)
    S = to_world_axes(ellipsoid, body, scale(1.0 / sqrt(dot(w, y)), w))
    return add_scaled(S, -low / norm(n), n)


@kernel
def change_of_centre(ellipsoid_data, n, d):
    """Change of that vector with a change d of n."""
    ellipsoid, body, low = ellipsoid_data
    y, y_d = to_shape_axes(ellipsoid, body, n), to_shape_axes(ellipsoid, body, d)
    w, size = scaled_by_squares(ellipsoid, y), norm(n)
    k = 1.0 / sqrt(dot(w, y))
    w_d = add_scaled(scaled_by_squares(ellipsoid, y_d), -k * k * dot(w, y_d), w)
    distance = add_scaled(d, -dot(n, d) / (size * size), n)
    return add_scaled(to_world_axes(ellipsoid, body, scale(k, w_d)), -low / size, distance)
