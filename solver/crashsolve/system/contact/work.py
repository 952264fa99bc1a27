"""Work of contact forces on both sides over a step, and their relative displacement in it.

    W = 1/2 (f_old . u_old + f_new . u_new),   u the displacement of side a over side b in the step

Kick, drift, kick: half of the force at the start and half of that at the end act along the
displacement of the step, so W is to the bit the kinetic energy that points receive from the
contact, for any other forces. u_old is that of the point of contact at the start, u_new of
that at the end. Velocities at the end of a step, predicted before all forces are known, cannot
replace it: near the stable step they differ much from the mean over the step.
"""

from crashsolve.contact.cells import corner_points
from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, put, scale, sub, vec
from crashsolve.system.points import half_rotation

# of a pair that has not moved
NO_MOTION = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@kernel
def along_plane(u, n):
    """A vector without its part along n."""
    return add_scaled(u, -dot(u, n), n)


@kernel
def mean_velocity(h, u, slip):
    """Velocity over a step of h with displacement u [m/s]; without a step the present slip."""
    return scale(1.0 / h, u) if h > 0.0 else slip


@kernel
def motion_of(body):
    """Displacement of the mass centre over the step [m], and the rotation of the body [rad].

    The rotation is that of the drift, along which torques do work. The displacement of a point at d
    is perpendicular to d: a normal force through the centre of a ball does no work by its spin.
    """
    return sub(vec(body.r), vec(body.start_r)), scale(2.0, half_rotation(body.start_q, body.q))


@kernel
def displacement_at(body, d):
    """Displacement over the step of the point at d from the mass centre, at its start or at its
    end.
    """
    displacement, rotation = motion_of(body)
    return add(displacement, cross(rotation, d))


@kernel
def load_work(acting, body):
    """Half of the work of a force with its arm, and of a torque, over the step [J].

    The halves of the forces at the start and at the end of a step add up to the kinetic energy that
    the body receives from them, to the bit. Powers of predicted velocities do not: a force that
    rises from zero within a step has none.
    """
    f, d, torque = acting
    displacement, angle = motion_of(body)
    return 0.5 * (dot(f, displacement) + dot(add(cross(d, f), torque), angle))


# --- pairs of elements on bodies -----------------------------------------------------------------


@kernel
def motion_over(h, old, depth, a, b, of_b):
    """Motion of body a over body b, number `of_b`, in a step at one end of which they touch.

    Displacement at the mass centre of a, where it was at the start and where it is at the end, as
    if that position were fixed in both [m]; rotation [rad].
    """
    if h == 0.0 or (old.active == 0 and depth <= 0.0):
        return NO_MOTION
    displacement, rotation = motion_of(a)
    if of_b == 0:
        # the ground
        return displacement, displacement, rotation
    displacement_b, rotation_b = motion_of(b)
    displacement = sub(displacement, displacement_b)
    at_start = sub(displacement, cross(rotation_b, sub(vec(a.start_r), vec(b.start_r))))
    at_end = sub(displacement, cross(rotation_b, sub(vec(a.r), vec(b.r))))
    return at_start, at_end, sub(rotation, rotation_b)


@kernel
def displacement_from(motion, a, x):
    """Displacement of a over b of the point of contact x at the start of the step."""
    return add(motion[0], cross(motion[2], sub(x, vec(a.start_r))))


@kernel
def displacement_to(motion, a, x):
    """Displacement of a over b of the point of contact x at the end of the step."""
    return add(motion[1], cross(motion[2], sub(x, vec(a.r))))


@kernel
def add_start_work(h, old, motion, a, card):
    """Work of the normal force of the start of the step. Writes: card."""
    if old.active == 1 and h > 0.0:
        card.work += 0.5 * dot(
            vec(old.normal_force), displacement_from(motion, a, vec(old.position))
        )


@kernel
def add_end_work(applied, u, f, n, x, out, new, card):
    """Work of the normal force at the end of the step, stored for the next; see
    add_second_half_work.

    Writes: new, card.
    """
    card.work += 0.5 * applied * f * dot(n, u)
    card.stored += out.stored
    put(new.normal_force, scale(f, n))
    put(new.position, x)


@kernel
def normal_work(old, motion, a, push, n, u):
    """Work of the normal force on both sides in both halves of the step [J]; `push` at its end."""
    work = 0.5 * push * dot(n, u)
    if old.active == 1:
        work += 0.5 * dot(vec(old.normal_force), displacement_from(motion, a, vec(old.position)))
    return work


@kernel
def add_first_half_work(h, old, motion, a, card):
    """Work of the forces at the start of the step; returns that of friction [J].

    Writes: card.
    """
    if old.active == 0 or h == 0.0:
        return 0.0
    u = displacement_from(motion, a, vec(old.position))
    friction_loss = 0.5 * dot(vec(old.friction_force), u)
    card.work += 0.5 * dot(vec(old.normal_force), u)
    card.friction_work += friction_loss
    return friction_loss


@kernel
def add_second_half_work(applied, pair, sliding, x, t, card):
    """Work of the forces at the end of the step, which are stored for the next.

    `applied` is the share of them that acts in this step, x where they act, t the friction.
    Writes: new, card.
    """
    u, out, new = sliding.displacement, pair.out, pair.new
    add_end_work(applied, u, sliding.f, sliding.n, x, out, new, card)
    card.friction_work += 0.5 * applied * dot(t, u)
    card.bristle_energy += out.friction_stored
    put(new.friction_force, t)
    new.bristle_energy = out.friction_stored


@kernel
def end_friction(old, new, friction_loss):
    """End of friction: the energy of its bristle is lost, less its last work. Writes: new."""
    put(new.friction_force, (0.0, 0.0, 0.0))
    new.bristle_energy = 0.0
    new.friction_dissipated += old.bristle_energy - friction_loss


# --- probes on faces of shells and on shapes -----------------------------------------------------


@kernel
def arms(p, touch):
    """Vectors [m] to the point of contact: from the probe, and from the nearest point of the mid-
    surface.
    """
    left = p.gap - touch.depth
    n = vec(touch.normal)
    return scale(-p.share * left, n), scale((1.0 - p.share) * left, n)


@kernel
def displacement_of_probe(probe, d, is_past, h, nodes, points):
    """Displacement over the step of the position d from a probe, at the start or at the end of
    it.
    """
    if probe.point >= 0:
        b = points[probe.point]
        return scale(h, add(vec(b.v), cross(vec(b.w), d)))
    body = nodes[probe.node]
    if is_past:
        return displacement_at(body, add(matvec(body.start_A, vec(probe.at)), d))
    return displacement_at(body, add(matvec(body.A, vec(probe.at)), d))


@kernel
def displacement_over_face(p, probe, touch, is_past, h, nodes, points, corners):
    """Displacement of a probe over the face in contact at the end, or at the start (`is_past`)."""
    if h == 0.0:
        return 0.0, 0.0, 0.0
    d, e = arms(p, touch)
    at, v, w = corner_points(p, touch.face, corners), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(4):
        b = points[at[k]]
        v = add_scaled(v, touch.N[k], vec(b.v))
        w = add_scaled(w, touch.N[k], vec(b.w))
    return sub(
        displacement_of_probe(probe, d, is_past, h, nodes, points), scale(h, add(v, cross(w, e)))
    )


@kernel
def displacement_over_body(p, probe, touch, is_past, position, h, nodes, points):
    """Displacement of a probe over the body of a shape.

    `position`: the body, and the position of the probe at the end [m].
    """
    if h == 0.0:
        return 0.0, 0.0, 0.0
    (body, x), (d, _) = position, arms(p, touch)
    return sub(
        displacement_of_probe(probe, d, is_past, h, nodes, points),
        displacement_at(body, sub(add(x, d), vec(body.r))),
    )


@kernel
def add_normal_work(touch, u, card):
    """Work of the normal force of a touch, in one half of the step. Writes: card."""
    card.work += 0.5 * touch.force * dot(vec(touch.normal), u)


@kernel
def add_friction_work(touch, u, card):
    """Work of its friction; returns it [J]. Writes: card."""
    work = 0.5 * dot(vec(touch.friction_force), u)
    card.friction_work += work
    return work
