"""Motion of points: kick and drift at the start of a step, kick at its end, points on bodies.

    v_half = (v + h/2 f / m) / (1 + alpha h/2),   r += h v_half
    v      = v_half + h/2 (f_new / m - alpha v_half)

alpha is a drag proportional to mass. A step of no length leaves everything as it is. Consequence
to test: the drag takes alpha m v_half^2 h, and nothing else is lost.
"""

from crashsolve.foundation.columns import add_to, matvec
from crashsolve.foundation.kernels import apart, inlined, kernel
from crashsolve.foundation.point import ATTACHED, OWN
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub, vec
from crashsolve.model.clock import NOT_FINITE


@apart
def first_kick_and_drift(h, p, points):
    """First kick and drift of the points of a part. Writes: points."""
    slow = 1.0 / (1.0 + 0.5 * p.drag * h)
    for i in range(p.first_point, p.first_point + p.point_count):
        b = points[i]
        put(b.v, scale(slow, add_scaled(vec(b.v), 0.5 * h * b.mass_inv, vec(b.force))))
        put(b.w, scale(slow, add_scaled(vec(b.w), 0.5 * h * b.J_inv, vec(b.torque))))
        put(b.r, add_scaled(vec(b.r), h, vec(b.v)))
        zero = (0.0, 0.0, 0.0)
        put(b.force, zero)
        put(b.torque, zero)
        b.load = b.spin_load = 0.0


@kernel
def apply_drag(clock, h, p, old, new, points):
    """Apply drag to the points of a part. Writes: clock, new."""
    lost = 0.0
    if p.drag > 0.0:
        for i in range(p.first_point, p.first_point + p.point_count):
            if points[i].fixed < ATTACHED:
                lost += drag_point(clock, h * p.drag, points[i])
    new.damped = old.damped + lost


@kernel
def drag_point(clock, share, b):
    """Impulse of the drag on a point from outside; returns the energy lost. Writes: clock."""
    p, spin = scale(share / b.mass_inv, vec(b.v)), scale(share / b.J_inv, vec(b.w))
    rotation = add(cross(vec(b.r), p), spin)
    for k in range(3):
        clock.impulse[k] -= p[k]
        clock.angular_impulse[k] -= rotation[k]
    return dot(p, vec(b.v)) + dot(spin, vec(b.w))


@kernel
def move_attached(h, nodes, points, attached_points):
    """Attached points follow their bodies; velocities are those of the step, as points have them.

    Writes: points.
    """
    for i in range(attached_points.shape[0]):
        attached_point = attached_points[i]
        b, body = points[attached_point.point], nodes[attached_point.node]
        d = matvec(body.A, vec(attached_point.spot))
        position = add(vec(body.r), d)
        if h > 0.0:
            before = add(vec(body.start_r), matvec(body.start_A, vec(attached_point.spot)))
            put(b.v, scale(1.0 / h, sub(position, before)))
            put(b.w, scale(2.0 / h, half_rotation(body.start_q, body.q)))
        else:
            put(b.v, add(vec(body.v), cross(vec(body.w), d)))
            put(b.w, vec(body.w))
        put(b.r, position)


@kernel
def half_rotation(old, new):
    """Cayley vector of the rotation from one quaternion to another, world axes."""
    w = old[0] * new[0] + old[1] * new[1] + old[2] * new[2] + old[3] * new[3]
    a, b = (old[1], old[2], old[3]), (new[1], new[2], new[3])
    rotation = sub(scale(old[0], b), add(scale(new[0], a), cross(b, a)))
    return scale(1.0 / w, rotation)


@kernel
def bound_rate(rate, b):
    """The larger of a squared frequency and of the share of the elements at a point.

    K <= sum omega_e^2 M_e, a diagonal matrix, so omega^2 <= max_i sum omega_e^2 m_ei / m_i.
    """
    return max(rate, b.load * b.mass_inv, b.spin_load * b.J_inv)


@apart
def second_kick(clock, h, p, points):
    """Second kick of the points of a part, whose bound of frequency may be the largest.

    Writes: clock, points.
    """
    rate = clock.element_rate
    for i in range(p.first_point, p.first_point + p.point_count):
        b = points[i]
        drag = 0.5 * h * p.drag
        v = add_scaled(scale(1.0 - drag, vec(b.v)), 0.5 * h * b.mass_inv, vec(b.force))
        w = add_scaled(scale(1.0 - drag, vec(b.w)), 0.5 * h * b.J_inv, vec(b.torque))
        put(b.v, v)
        put(b.w, w)
        rate = bound_rate(rate, b)
    clock.element_rate = rate


@kernel
def transfer_reactions(nodes, points, holds):
    """Transfer the forces on suppressed motions of the listed points to the ground.

    Writes: points, nodes.
    """
    for k in range(holds.shape[0]):
        b = points[holds[k].point]
        transfer_reaction(b, b.fixed, nodes[0])


@kernel
def transfer_reaction(b, fixed, ground):
    """Take the suppressed components from the force and torque on a point, or on its body.

    `fixed` are the bits of POINT. Writes: b, ground.
    """
    f, t = constrained_part(vec(b.force), fixed), constrained_part(vec(b.torque), fixed >> 3)
    put(b.force, sub(vec(b.force), f))
    put(b.torque, sub(vec(b.torque), t))
    # the reaction is -f, and its moment about the origin -r x f
    rotation = add(cross(vec(b.r), f), t)
    for k in range(3):
        ground.external[k] -= f[k]
        ground.external[3 + k] -= rotation[k]


@inlined
def constrained_part(u, bits):
    """Components of a vector whose bits are set."""
    return (
        u[0] if bits & 1 else 0.0,
        u[1] if bits & 2 else 0.0,
        u[2] if bits & 4 else 0.0,
    )


@kernel
def transfer_attached_reactions(nodes, points):
    """Transfer the forces on points without free motions, which have no body, to the ground.

    Writes: points, nodes.
    """
    for i in range(points.shape[0]):
        b = points[i]
        if b.fixed < OWN and b.fixed % ATTACHED > 0:
            transfer_reaction(b, b.fixed, nodes[0])


@kernel
def transfer_own_reactions(nodes, points, attached_points):
    """Transfer the forces on suppressed motions of the bodies of points to the ground.

    They bear those on their points, and those that act on every body, such as weight.
    Writes: nodes.
    """
    for i in range(attached_points.shape[0]):
        attached_point = attached_points[i]
        fixed = points[attached_point.point].fixed
        if fixed >= OWN and fixed % ATTACHED > 0:
            transfer_reaction(nodes[attached_point.node], fixed, nodes[0])


@kernel
def transfer_to_bodies(clock, nodes, points, attached_points):
    """Forces on attached points go to their bodies, their bound of frequency to the others'.

    Writes: nodes, points, clock.
    """
    for i in range(attached_points.shape[0]):
        attached_point = attached_points[i]
        b, body = points[attached_point.point], nodes[attached_point.node]
        d, f = matvec(body.A, vec(attached_point.spot)), vec(b.force)
        add_to(body.force, f)
        add_to(body.torque, add(vec(b.torque), cross(d, f)))
        put(b.force, (0.0, 0.0, 0.0))
        put(b.torque, (0.0, 0.0, 0.0))
        clock.element_rate = bound_rate(clock.element_rate, b)
        b.load = b.spin_load = 0.0


@kernel
def acceleration(b):
    """Acceleration of a point by its forces [m/s^2]."""
    return scale(b.mass_inv, vec(b.force))


@kernel
def set_attached_forces(nodes, points, attached_points):
    """Attached points take the forces that would give them the accelerations of their bodies by
    applied forces alone, without rates of rotation. Writes: points.
    """
    for i in range(attached_points.shape[0]):
        attached_point = attached_points[i]
        b, body = points[attached_point.point], nodes[attached_point.node]
        d, w_dot = sub(vec(b.r), vec(body.r)), matvec(body.W, vec(body.torque))
        v_dot = add_scaled(cross(w_dot, d), body.mass_inv, vec(body.force))
        put(b.force, scale(1.0 / b.mass_inv, v_dot))


@kernel
def clear_attached_forces(points, attached_points):
    """Attached points have no forces again: their bodies have them. Writes: points."""
    for i in range(attached_points.shape[0]):
        put(points[attached_points[i].point].force, (0.0, 0.0, 0.0))


@kernel
def sum_momenta(points, total):
    """Momenta of the points that are attached to no body. Writes: total."""
    zero = (0.0, 0.0, 0.0)
    put(total.linear, zero)
    put(total.angular, zero)
    total.linear_size = total.angular_size = 0.0
    for i in range(points.shape[0]):
        b = points[i]
        if b.fixed >= ATTACHED:
            continue
        r, p, spin = vec(b.r), scale(1.0 / b.mass_inv, vec(b.v)), scale(1.0 / b.J_inv, vec(b.w))
        add_to(total.linear, p)
        add_to(total.angular, add(cross(r, p), spin))
        total.linear_size += norm(p)
        total.angular_size += norm(r) * norm(p) + norm(spin)


@kernel
def check_points(clock, nodes, points):
    """Stop at a point whose motion is not a finite number; its position follows those of the nodes.

    Writes: clock.
    """
    for i in range(points.shape[0]):
        b = points[i]
        total = 0.0
        for k in range(3):
            total += abs(b.r[k]) + abs(b.v[k]) + abs(b.w[k])
        if not total < 1e100:
            clock.status, clock.index = NOT_FINITE, nodes.shape[0] + i
            return
