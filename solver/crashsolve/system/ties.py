"""Tied points: they follow their faces, and hand them their forces and bounds of frequency.

    r = sum N_i r_i + c n,   v = (r - r_start) / h,   w = sum N_i w_i
    f_i = N_i f + c (dn / dr_i)^T f,   t_i = N_i t

The stiffness at a point, bounded by L |v|^2, is one at the corners of at most
(1 + s) (S |N_i| + s) L with S = sum |N_i| and s = 2 |c| max(|d|, |e|) / |d x e|, d and e the
diagonals of the face. Consequence to test: with c = 0 a tie shortens no step, as its corners have
the mass of the point in the same shares.
"""

from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub, vec
from crashsolve.system.points import acceleration


@kernel
def unit_normal(a, b, c, d):
    """Unit normal of the diagonals between four points."""
    n = cross(sub(vec(c.r), vec(a.r)), sub(vec(d.r), vec(b.r)))
    return scale(1.0 / norm(n), n)


@kernel
def normal_rate(h, a, b, c, d):
    """Change of that normal in a step of h [s] over h, its rate for h = 0 [1/s].

    Without differences of large numbers: a point at rest stays at rest.
    """
    p, q = sub(vec(c.r), vec(a.r)), sub(vec(d.r), vec(b.r))
    p_dot, q_dot = sub(vec(c.v), vec(a.v)), sub(vec(d.v), vec(b.v))
    half_p, half_q = add_scaled(p, -0.5 * h, p_dot), add_scaled(q, -0.5 * h, q_dot)
    rate = add(cross(p_dot, half_q), cross(half_p, q_dot))
    new = cross(p, q)
    old = add_scaled(new, -h, rate)
    size, before = norm(new), norm(old)
    growth = dot(add(new, old), rate) / (size + before)
    return scale(1.0 / size, add_scaled(rate, -growth / before, old))


@kernel
def carry_tied(h, points, ties):
    """Tied points follow their faces; velocities are those of the step. Writes: points."""
    for i in range(ties.shape[0]):
        tie = ties[i]
        a, b = points[tie.corner[0]], points[tie.corner[1]]
        c, d = points[tie.corner[2]], points[tie.corner[3]]
        own, N = points[tie.point], tie.weight
        put(own.w, mean_of(N, vec(a.w), vec(b.w), vec(c.w), vec(d.w)))
        r = mean_of(N, vec(a.r), vec(b.r), vec(c.r), vec(d.r))
        v = mean_of(N, vec(a.v), vec(b.v), vec(c.v), vec(d.v))
        if tie.height != 0.0:
            r = add_scaled(r, tie.height, unit_normal(a, b, c, d))
            v = add_scaled(v, tie.height, normal_rate(h, a, b, c, d))
        put(own.r, r)
        put(own.v, v)


@kernel
def mean_of(N, a, b, c, d):
    """Mean of four vectors with weights N."""
    return add(
        add(scale(N[0], a), scale(N[1], b)),
        add(scale(N[2], c), scale(N[3], d)),
    )


@kernel
def unload_tied(points, ties):
    """Forces on tied points go to the corners of their faces. Writes: points."""
    for i in range(ties.shape[0]):
        tie = ties[i]
        own = points[tie.point]
        f, t, s = vec(own.force), vec(own.torque), 0.0
        if tie.height != 0.0:
            s = unload_height(points, tie, f)
        size = 0.0
        for k in range(4):
            size += abs(tie.weight[k])
        for k in range(4):
            corner, N = points[tie.corner[k]], tie.weight[k]
            add_to(corner.force, scale(N, f))
            add_to(corner.torque, scale(N, t))
            corner.load += (1.0 + s) * (size * abs(N) + s) * own.load
            corner.spin_load += size * abs(N) * own.spin_load
        zero = (0.0, 0.0, 0.0)
        put(own.force, zero)
        put(own.torque, zero)
        own.load = own.spin_load = 0.0


@kernel
def set_tied_forces(points, ties):
    """Tied points take the forces that would give them the accelerations of their faces, without
    those by velocities. Writes: points.
    """
    for i in range(ties.shape[0]):
        tie = ties[i]
        a, b = points[tie.corner[0]], points[tie.corner[1]]
        c, d = points[tie.corner[2]], points[tie.corner[3]]
        of_a, of_b = acceleration(a), acceleration(b)
        of_c, of_d = acceleration(c), acceleration(d)
        v_dot = mean_of(tie.weight, of_a, of_b, of_c, of_d)
        if tie.height != 0.0:
            p, q = sub(vec(c.r), vec(a.r)), sub(vec(d.r), vec(b.r))
            across = cross(p, q)
            n = scale(1.0 / norm(across), across)
            change = add(cross(sub(of_c, of_a), q), cross(p, sub(of_d, of_b)))
            share = tie.height / norm(across)
            v_dot = add_scaled(v_dot, share, add_scaled(change, -dot(change, n), n))
        put(points[tie.point].force, scale(1.0 / points[tie.point].mass_inv, v_dot))


@kernel
def clear_tied_forces(points, ties):
    """Tied points have no forces again: their faces have them. Writes: points."""
    for i in range(ties.shape[0]):
        put(points[ties[i].point].force, (0.0, 0.0, 0.0))


@kernel
def unload_height(points, tie, f):
    """Apply the moment of a force at a height over the face; s of the stiffness. Writes: points."""
    a, b = points[tie.corner[0]], points[tie.corner[1]]
    c, d = points[tie.corner[2]], points[tie.corner[3]]
    p, q = sub(vec(c.r), vec(a.r)), sub(vec(d.r), vec(b.r))
    across = cross(p, q)
    n = scale(1.0 / norm(across), across)
    g = scale(tie.height / norm(across), add_scaled(f, -dot(f, n), n))
    # the power of g on p_dot x q + p x q_dot
    f_p, f_q = cross(q, g), cross(g, p)
    add_to(c.force, f_p)
    add_to(a.force, scale(-1.0, f_p))
    add_to(d.force, f_q)
    add_to(b.force, scale(-1.0, f_q))
    return 2.0 * abs(tie.height) * max(norm(p), norm(q)) / norm(across)
