"""Contact of a surface along a field of normals that is continuous from face to face.

    x = sum N_k (x_k + lambda n_k),   n = sum N_k n_k / |sum N_k n_k|,   d = lambda |sum N_k n_k|

N_k are bilinear in a quadrilateral and linear in a triangle; n_k is the normal at a corner, that of
the faces there weighted by angle. The position is found by Newton's method from the nearest one,
across an edge where it lies in the next face. The force acts along the line through x and c as
before, so momenta are conserved to round-off; energy is conserved as far as n is normal to the
face. An ellipsoid is represented by the ball at the foot with this normal (`ellipsoids.py`), whose
centre x depends on n. Consequence to test: on a faceted cylinder the force points to the axis,
wherever it is touched.

Reference: Puso and Laursen (2004), Computer Methods in Applied Mechanics and Engineering 193,
601-629.
"""

from math import sqrt

from crashsolve.contact.narrow._face import CORNER, point_of
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub
from crashsolve.system.contact.ellipsoids import centre_from_ball, change_of_centre
from crashsolve.system.contact.projection import relative_corners, surface_normal

MAX_ITERATIONS = 20
MAX_FACES = 4  # that are tried, the nearest first
# of the gap: the root is as good as round-off allows
RELATIVE_RESIDUAL = 1e-13
BORDER = 1.0 + 1e-9  # a position so far beyond a side still belongs to the face


@kernel
def apply_field(i, x, ellipsoid_data, p, mesh, excluded, hits):
    """Normals, weights and depths of both sides by the field of normals. Writes: hits.

    x is a probe's position, or the centre of the ellipsoid of `ellipsoid_data`, else None. Where a
    line along the field would pass a free border the nearest point stays.
    """
    for s in range(2):
        if hits[s].face >= 0:
            sign = 1.0 if s == 0 else -1.0
            f, xi, eta, distance, n = solve_along_field(
                i, x, ellipsoid_data, sign, p, hits[s], mesh, excluded
            )
            if f < 0:
                continue
            N, size = shape(f >= p.quads, xi, eta), norm(n)
            hits[s].face = f
            for k in range(4):
                hits[s].N[k] = N[k]
            put(hits[s].normal, scale(sign / size, n))
            hits[s].depth = p.gap - sign * distance * size


@kernel
def solve_along_field(i, x, ellipsoid_data, sign, p, hit, mesh, excluded):
    """Face (-1: none), xi, eta, lambda and field of normals of the position whose normal leads to
    x.
    """
    f = hit.face
    xi, eta = natural_coordinates(f >= p.quads, hit.N)
    for _ in range(MAX_FACES):
        is_found, xi, eta, distance, n = newton(x, ellipsoid_data, sign, p, f, xi, eta, mesh)
        if not is_found:
            break
        side, over = distance_beyond(f >= p.quads, xi, eta)
        if over <= BORDER:
            return f, xi, eta, distance, n
        f = mesh[2][4 * f + side]
        if f < 0 or is_excluded(i, f, excluded):
            break
        xi = eta = 1.0 / 3.0 if f >= p.quads else 0.0
    return -1, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0)


@kernel
def natural_coordinates(is_triangle, N):
    """xi and eta of a position with these weights of the corners."""
    if is_triangle:
        return N[1], N[2] + N[3]
    return N[1] + N[2] - N[0] - N[3], N[2] + N[3] - N[0] - N[1]


@kernel
def distance_beyond(is_triangle, xi, eta):
    """The edge beyond which a position lies farthest, and its distance from the opposite one, 1 on
    the edge.
    """
    first = 1.0 - 2.0 * eta if is_triangle else -eta
    second = 2.0 * (xi + eta) - 1.0 if is_triangle else xi
    third = -1.0 if is_triangle else eta
    last = 1.0 - 2.0 * xi if is_triangle else -xi
    side, over = 0, first
    if second > over:
        side, over = 1, second
    if third > over:
        side, over = 2, third
    if last > over:
        side, over = 3, last
    return side, over


@kernel
def is_excluded(i, f, excluded):
    """Whether a face is one that a probe does not meet."""
    (first, faces), is_one = excluded, False
    for k in range(first[i], first[i + 1]):
        is_one = is_one or faces[k] == f
    return is_one


@kernel
def newton(x, ellipsoid_data, sign, p, f, xi, eta, mesh):
    """Newton's method within a face: whether it converges, xi, eta, lambda, field of normals."""
    a, b, c, d = relative_corners(x, p, f, mesh)
    n_a, n_b = corner_normal(p, f, 0, mesh), corner_normal(p, f, 1, mesh)
    n_c, n_d = corner_normal(p, f, 2, mesh), corner_normal(p, f, 3, mesh)
    distance, n, is_triangle = 0.0, n_a, f >= p.quads
    for k in range(MAX_ITERATIONS):
        N = shape(is_triangle, xi, eta)
        n = point_of(N, n_a, n_b, n_c, n_d)
        offset = (0.0, 0.0, 0.0)
        if ellipsoid_data is not None:
            offset = scale(sign, centre_from_ball(ellipsoid_data, n))
        if k == 0:
            distance = -dot(add(point_of(N, a, b, c, d), offset), n) / dot(n, n)
        u, v = add_scaled(a, distance, n_a), add_scaled(b, distance, n_b)
        w, y = add_scaled(c, distance, n_c), add_scaled(d, distance, n_d)
        residual = add(point_of(N, u, v, w, y), offset)
        if dot(residual, residual) <= (RELATIVE_RESIDUAL * p.gap) ** 2:
            return True, xi, eta, distance, n
        by_xi, by_eta = slopes(is_triangle, xi, eta, u, v, w, y)
        if ellipsoid_data is not None:
            n_xi, n_eta = slopes(is_triangle, xi, eta, n_a, n_b, n_c, n_d)
            by_xi = add_scaled(by_xi, sign, change_of_centre(ellipsoid_data, n, n_xi))
            by_eta = add_scaled(by_eta, sign, change_of_centre(ellipsoid_data, n, n_eta))
        plane = cross(by_xi, by_eta)
        volume = dot(plane, n)
        # lines along the field intersect: no position of the face is unique
        if not abs(volume) > 1e-12 * sqrt(dot(plane, plane) * dot(n, n)):
            break
        xi -= dot(residual, cross(by_eta, n)) / volume
        eta -= dot(residual, cross(n, by_xi)) / volume
        distance -= dot(residual, plane) / volume
        if not max(abs(xi), abs(eta)) < 10.0:
            break
    return False, xi, eta, distance, n


@kernel
def shape(is_triangle, xi, eta):
    """Weights of the corners, bilinear or linear."""
    if is_triangle:
        return 1.0 - xi - eta, xi, eta, 0.0
    return (
        0.25 * (1.0 - xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 + eta),
        0.25 * (1.0 - xi) * (1.0 + eta),
    )


@kernel
def slopes(is_triangle, xi, eta, a, b, c, d):
    """Derivatives by xi and eta of a field given at the corners."""
    if is_triangle:
        return sub(b, a), sub(c, a)
    by_xi = scale(0.25, add_scaled(scale(1.0 - eta, sub(b, a)), 1.0 + eta, sub(c, d)))
    return by_xi, scale(0.25, add_scaled(scale(1.0 - xi, sub(d, a)), 1.0 + xi, sub(c, b)))


@kernel
def corner_normal(p, f, k, mesh):
    """Unit normal of the surface at a corner of a face."""
    n = surface_normal(p, f, CORNER + k, mesh)
    return scale(1.0 / norm(n), n)
