"""Contact of many probes (nodes and balls), each with the nearest face or shape on either side.

    due:  a probe at a distance d from contact is searched again when sum 2 |v|_max h has grown by d

Most probes are far from contact in most steps, and only the others are searched. A probe has a
slot for each side of a surface, with two records that alternate: the accepted one, and that of the
present force pass. Consequence to test: the same forces as with a search of all probes
in all steps.
"""

from math import sqrt

from crashsolve.foundation.columns import add_to, matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_force,
    arm,
    mobility,
    point_at,
    point_velocity,
    world_position,
)
from crashsolve.foundation.point import ATTACHED
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, put, scale, sub, vec

# least mobility of two sides [1/kg], against division by zero
LEAST_MOBILITY = 1e-30


@kernel
def clear_loads(scene):
    """Zero the sums of a force pass. Writes: scene.touched, stiffened."""
    total = scene.touched[0]
    for j in range(total.count):
        at = scene.stiffened[scene.touched_points[j]]
        at.stiffness = at.damping = 0.0
        at.listed = 0
    total.count, total.first_point = 0, -1
    total.rate = total.damping = 0.0


@kernel
def sum_stiffness_bounds(scene):
    """Bound of the squared frequency of points in contact. Writes: scene.touched.

    omega^2 <= max_i (sum omega_e^2 m_ei + 2 sum k N_i) / m_i, the first as in points.py, the second
    since (x - sum N_i x_i)^2 <= 2 x^2 + 2 sum N_i x_i^2; dampers as in timestep.py.
    """
    total = scene.touched[0]
    for j in range(total.count):
        i = scene.touched_points[j]
        b, more = scene.points[i], scene.stiffened[i]
        total.rate = max(total.rate, b.load * b.mass_inv + 2.0 * more.stiffness)


@kernel
def shorten_step(clock, scene):
    """Bound of the highest frequency of the mesh without contact, and with it.

    Writes: clock, scene.touched.
    """
    total, alone = scene.touched[0], clock.element_rate
    half = total.damping
    speed = sqrt(max(alone, total.rate) + half * half) + half
    clock.element_rate = max(alone, speed * speed)
    total.shortened = max(total.shortened, speed / sqrt(alone))


@kernel
def position_and_velocity(probe, h, nodes, points):
    """Position and velocity of a probe; of a point, that at the end of the step as predicted."""
    if probe.point >= 0:
        b = points[probe.point]
        return vec(b.r), predicted_velocity(b, h)
    body = nodes[probe.node]
    d = arm(body, vec(probe.at))
    return point_at(body, d), point_velocity(body, d)


@kernel
def predicted_velocity(b, h):
    """Velocity of a point at the end of the step, by the forces so far."""
    if b.fixed >= ATTACHED:
        return vec(b.v)
    return add_scaled(vec(b.v), 0.5 * h * b.mass_inv, free_part(b.fixed, vec(b.force)))


@kernel
def free_part(fixed, u):
    """A vector along or about the world axes, without its constrained components."""
    if fixed & 7 == 0:
        return u
    return (
        0.0 if fixed & 1 else u[0],
        0.0 if (fixed >> 1) & 1 else u[1],
        0.0 if (fixed >> 2) & 1 else u[2],
    )


@kernel
def fastest(h, p, probes, nodes, scene):
    """Largest speed in this step of the probes, and of the points of the faces."""
    most = fastest_point(p, scene)
    if p.is_self_contact == 0:
        for i in range(probes.shape[0]):
            most = max(most, speed_of(probes[i], h, p, nodes, scene.points))
    return most


@kernel
def fastest_point(p, scene):
    """Largest speed of the points of the faces; another group may have computed it in this pass.

    Writes: scene.touched.
    """
    if not is_fastest_known(p, scene):
        store_fastest(p, fastest_of(p.first_point, p.point_count, scene.points), scene)
    return scene.touched[0].speed


@kernel
def is_fastest_known(p, scene):
    """Whether the largest speed of these points has been found in this pass."""
    total = scene.touched[0]
    return total.first_point == p.first_point and total.point_count == p.point_count


@kernel
def store_fastest(p, speed, scene):
    """Store the largest speed of the points of a contact. Writes: scene.touched."""
    total = scene.touched[0]
    total.first_point, total.point_count, total.speed = p.first_point, p.point_count, speed


@kernel
def fastest_of(first, count, points):
    """Largest speed of some points."""
    most = 0.0
    for i in range(first, first + count):
        v = vec(points[i].v)
        most = max(most, dot(v, v))
    return sqrt(most)


@kernel
def touches_faces(hits, probe_states, slot_in_use, i):
    """Whether a probe touches a face on either side, or has touched one."""
    for s in range(2):
        j = 2 * i + s
        if hits[s].depth > 0.0 or probe_states[slot_in_use[j], j].active == 1:
            return True
    return False


@kernel
def speed_of(probe, h, p, nodes, points):
    """Mean speed of a probe over the step."""
    if probe.point >= 0:
        return norm(vec(points[probe.point].v))
    body = nodes[probe.node]
    by_spin = p.over * norm(vec(body.w))
    if h == 0.0:
        return by_spin + norm(point_velocity(body, arm(body, vec(probe.at))))
    before = add(vec(body.start_r), matvec(body.start_A, vec(probe.at)))
    return by_spin + norm(sub(world_position(body, vec(probe.at)), before)) / h


@kernel
def limit_closing(clock, p, totals):
    """Cut the next step so that no two sides come nearer by more than `reach`.

    Writes: clock.next_step.
    """
    if totals.fastest * clock.next_step > p.reach:
        clock.next_step = p.reach / totals.fastest


@kernel
def clear_sums(totals):
    """Zero the sums of a force pass. Writes: totals."""
    totals.stored = totals.bristle_energy = totals.depth = 0.0


@kernel
def accept_record(slot_in_use, j):
    """Accept the record of the last step; returns its number. Writes: slot_in_use."""
    if slot_in_use[j] > 1:
        slot_in_use[j] = 3 - slot_in_use[j]
    return slot_in_use[j]


@kernel
def mark_for_acceptance(h, slot_in_use, j):
    """Mark the record of this step for acceptance; those of a sample never are.

    Writes: slot_in_use.
    """
    if h > 0.0:
        slot_in_use[j] += 2


@kernel
def release_record(clock, totals, old, new):
    """Clear a record. Writes: totals, new."""
    totals.dissipated += clock.lead * old.power
    new.active = 0
    new.power = new.depth = new.impact_speed = new.force = new.stored = 0.0


@kernel
def closing_speed(v, v_other, hit, h, old, w):
    """Closing speed; the force of the last step is used for the present one, which is not known
    yet.

    w is the acceleration of the points over that force [1/kg].
    """
    return dot(sub(v_other, v), vec(hit.normal)) - 0.5 * h * w * old.force


@kernel
def mobility_along(b, n):
    """Acceleration of a point along n per unit force [1/kg]; 0 along constrained axes."""
    return b.mass_inv * dot(free_part(b.fixed, n), n)


@kernel
def predicted_mobility(b, n):
    """Acceleration of a point per unit force [1/kg] where its velocity is predicted; 0 for
    points attached to bodies.
    """
    return mobility_along(b, n) if b.fixed < ATTACHED else 0.0


@kernel
def predicted_probe_mobility(probe, hit, points):
    """Acceleration of a probe per unit force [1/kg] where its velocity is predicted."""
    return predicted_mobility(points[probe.point], vec(hit.normal)) if probe.point >= 0 else 0.0


@kernel
def mobility_of(probe, hit, nodes, points):
    """Acceleration of a probe per unit force along the normal [1/kg]."""
    if probe.point >= 0:
        return mobility_along(points[probe.point], vec(hit.normal))
    body = nodes[probe.node]
    return mobility(body, arm(body, vec(probe.at)), vec(hit.normal))


@kernel
def add_touch(clock, h, p, totals, card, touch, f, energies):
    """Add a probe that touches to the sums of card and ledger. Writes: totals, card, new.

    `energies`: stored energy [J], power [W] and loss [J] of its normal force f.
    """
    old, new, hit = touch.old, touch.new, touch.hit
    stored, power, loss = energies
    totals.stored += stored
    if h > 0.0:
        totals.dissipated += clock.lead * old.power + clock.share * power + loss
        totals.deepest = max(totals.deepest, hit.depth)
    new.power = power
    new.force, new.stored = f, stored
    new.face = hit.face
    put(new.normal, vec(hit.normal))
    for j in range(4):
        new.N[j] = hit.N[j]
    totals.depth = max(totals.depth, hit.depth)
    add_to(card.force, scale(p.order * f, vec(hit.normal)))
    card.normal += f
    card.touching += 1.0
    card.depth = max(card.depth, hit.depth)
    card.impact_speed = max(card.impact_speed, new.impact_speed)


@kernel
def add_energies(totals, card, count):
    """Energies of the group to its card. Writes: card, count."""
    count.stored += totals.stored
    count.bristle_energy += totals.bristle_energy
    card.depth = max(card.depth, 0.0)
    card.stored += totals.stored + totals.bristle_energy
    card.dissipated += totals.dissipated
    card.friction_dissipated += totals.friction_loss


@kernel
def apply_to_probe(probe, f, k, c, hit, nodes, scene):
    """Force f along the normal on a probe. Writes: nodes, scene.points, stiffened, touched."""
    n = vec(hit.normal)
    if probe.point >= 0:
        add_to(scene.points[probe.point].force, scale(f, n))
        add_point_stiffness(probe.point, 1.0, k, c, scene)
        return
    body = nodes[probe.node]
    d = arm(body, vec(probe.at))
    apply_force(body, scale(f, n), d)
    add_stiffness_bound(body, mobility(body, d, n), k, c)


@kernel
def add_point_stiffness(i, share, k, c, scene):
    """Report a contact on a point to the step control. Writes: scene.stiffened, touched."""
    add_mobility_stiffness(i, share * scene.points[i].mass_inv, k, c, scene)


@kernel
def add_mobility_stiffness(i, w, k, c, scene):
    """Report a contact on a point of mobility w [1/kg] to the step control.

    Writes: scene.stiffened, touched.
    """
    total, at = scene.touched[0], scene.stiffened[i]
    if at.listed == 0:
        scene.touched_points[total.count] = i
        total.count += 1
        at.listed = 1
    at.stiffness += k * w
    at.damping += c * w
    total.damping = max(total.damping, at.damping)


# --- rigid shapes: their gap routines, with the probe as a body among copies of bodies -----------


@kernel
def update_shapes(h, p, totals, probes, nodes, scene, copies):
    """Update the copies of the bodies with the shapes, behind those for probes, and the travel of
    probes.

    `copies`: their table, the first row of a body, and the nodes of the bodies.

    Writes: totals, frames.
    """
    clear_sums(totals)
    speed, (frames, first_body, frame_bodies) = 0.0, copies
    for k in range(first_body, frames.shape[0]):
        frame, body = frames[k], nodes[frame_bodies[k]]
        put(frame.r, vec(body.r))
        for j in range(9):
            frame.A[j] = body.A[j]
        speed = max(speed, norm(vec(body.v)) + norm(vec(body.w)) * p.extent)
    totals.fastest = fastest(h, p, probes, nodes, scene) + speed
    # the motion of a shape is known too late: moving shapes are searched in every step
    totals.travel = totals.travel + h * totals.fastest if speed == 0.0 else 1e300


@kernel
def place_probe(frame, x, hit):
    """Place the body that stands for the probe, and reset `hit`. Writes: frame, hit."""
    put(frame.r, x)
    hit.depth = -1e300


@kernel
def keep_deepest(hit, e, depth, n):
    """Keep the deepest of the shapes. Writes: hit."""
    if depth > hit.depth:
        hit.depth, hit.face = depth, e
        put(hit.normal, n)


@kernel
def set_due(i, hit, totals, due):
    """The travel at which a separated probe is due again. Writes: due."""
    due[i] = totals.travel + max(-hit.depth, 0.0)


@kernel
def body_velocity(body, x):
    """Velocity of a body at a position."""
    return point_velocity(body, sub(x, vec(body.r)))


@kernel
def body_mobility(body, x, hit):
    """Acceleration of a body at a position per unit force along the normal [1/kg]."""
    return mobility(body, sub(x, vec(body.r)), vec(hit.normal))


@kernel
def apply_to_body(body, x, f, k, c, hit, mob):
    """Minus a force f along the normal at x. Writes: body."""
    apply_force(body, scale(-f, vec(hit.normal)), sub(x, vec(body.r)))
    add_stiffness_bound(body, mob, k, c)
