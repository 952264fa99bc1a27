"""Friction of nodal contact: point of contact, slip there, and forces on both sides.

    y = x - s (gap - depth) n,   slip = v_a(y) - v_b(y) without its part along n

The point of contact divides the gap between both sides, s of it for the probe: friction has a lever
arm of the radius on a ball and the nodes of a shell, of half the thickness on faces. Friction t
acts on the probe and -t on the faces, at the same point y: consequence to test, angular momentum is
conserved to round-off. As with the normal force, points predict their velocity by all other forces,
and that of the last step stands for the friction itself.
"""

from crashsolve.contact.cells import corner_points
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import add_stiffness_bound, apply_force, arm, mobility
from crashsolve.foundation.point import ATTACHED
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub, vec
from crashsolve.system.contact.node_contact import (
    add_mobility_stiffness,
    free_part,
    predicted_velocity,
)
from crashsolve.system.contact.work import add_friction_work, arms


@kernel
def position_on_shape(p, hit, x):
    """The point of contact with a shape, relative to a probe at x and in the world."""
    d, _ = arms(p, hit)
    return d, add(x, d)


@kernel
def predicted_spin(b, h):
    """Angular velocity of a point at the end of the step, by the torques so far."""
    if b.fixed >= ATTACHED:
        return vec(b.w)
    return add_scaled(vec(b.w), 0.5 * h * b.J_inv, free_part(b.fixed >> 3, vec(b.torque)))


@kernel
def tangential_mobility(b, d):
    """Acceleration at d from a point per unit force across d [1/kg]."""
    return b.mass_inv + dot(d, d) * b.J_inv


@kernel
def probe_velocity(probe, v, d, h, nodes, points):
    """Velocity at d from a probe that moves with v."""
    if probe.point >= 0:
        return add(v, cross(predicted_spin(points[probe.point], h), d))
    body = nodes[probe.node]
    return add(v, cross(vec(body.w), d))


@kernel
def acceleration_at(b, d, f):
    """Acceleration at d from a point by a force f there, where its velocity is predicted."""
    if b.fixed >= ATTACHED:
        return 0.0, 0.0, 0.0
    rotation = scale(b.J_inv, free_part(b.fixed >> 3, cross(d, f)))
    return add_scaled(cross(rotation, d), b.mass_inv, free_part(b.fixed, f))


@kernel
def predicted_probe_acceleration(probe, d, old, points):
    """Acceleration of a probe by the last friction force, if its velocity is predicted [m/s^2]."""
    if probe.point < 0:
        return 0.0, 0.0, 0.0
    return acceleration_at(points[probe.point], d, vec(old.friction_force))


@kernel
def face_velocity(p, hit, d, h, points, corners):
    """Velocity at d from the point of contact of a face."""
    at, v, w = corner_points(p, hit.face, corners), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(4):
        v = add_scaled(v, hit.N[k], predicted_velocity(points[at[k]], h))
        w = add_scaled(w, hit.N[k], predicted_spin(points[at[k]], h))
    return add(v, cross(w, d))


@kernel
def predicted_face_acceleration(p, hit, d, old, a, points, corners):
    """a, plus the opposite acceleration at d from the point of a face by the same friction."""
    at = corner_points(p, hit.face, corners)
    for k in range(4):
        b = points[at[k]]
        a = add_scaled(a, hit.N[k] * hit.N[k], acceleration_at(b, d, vec(old.friction_force)))
    return a


@kernel
def slip_velocity(v, u, hit, h, a):
    """Tangential velocity of the probe over the other side, with the accelerations a, and n."""
    n = vec(hit.normal)
    slip = add_scaled(sub(v, u), 0.5 * h, a)
    return add_scaled(slip, -dot(slip, n), n), n


@kernel
def clear_friction_stiffness(h, scene):
    """Start the sums of friction stiffness of a step; a sample has none.

    Writes: scene.stiffened.
    """
    if h == 0.0:
        return
    for j in range(scene.touched[0].count):
        at = scene.stiffened[scene.touched_points[j]]
        at.was_pressed, at.pressed = at.pressed, 0.0


@kernel
def add_pressed_rate(b, h, rate):
    """Add rate [m/s^2], normal force times mobility, of one contact; returns that of all.

    Writes: b.
    """
    if h > 0.0:
        b.pressed += rate
    return max(b.was_pressed, rate)


@kernel
def pressed_probe(probe, d, u, f, h, nodes, scene):
    """Acceleration [m/s^2] along u by the normal forces of all friction at a probe, this one
    included. Writes: nodes, stiffened.
    """
    if probe.point >= 0:
        return add_pressed_rate(
            scene.stiffened[probe.point], h, f * tangential_mobility(scene.points[probe.point], d)
        )
    body = nodes[probe.node]
    to = add(arm(body, vec(probe.at)), d)
    return add_pressed_rate(body, h, f * mobility(body, to, u))


@kernel
def pressed_on_face(h, p, touch, arms, u, f, nodes, scene):
    """Acceleration along u [m/s^2] by the normal forces of all friction at a probe and the corners
    of its face.

    Sums of f N w over the last step; `arms` are those of the position from both sides.
    Writes: nodes, scene.stiffened.
    """
    if f <= 0.0:
        return 0.0
    hit, (d, e) = touch.hit, arms
    total = pressed_probe(touch.probe, d, u, f, h, nodes, scene)
    at = corner_points(p, hit.face, scene.corners)
    for k in range(4):
        rate = f * hit.N[k] * tangential_mobility(scene.points[at[k]], e)
        total += hit.N[k] * add_pressed_rate(scene.stiffened[at[k]], h, rate)
    return total


@kernel
def pressed_on_shape(h, touch, body, positions, u, f, nodes, scene):
    """The same for a probe on a shape, at a point relative to the probe and in the world.

    Writes: nodes, scene.stiffened.
    """
    if f <= 0.0:
        return 0.0
    d, y = positions
    total = pressed_probe(touch.probe, d, u, f, h, nodes, scene)
    return total + add_pressed_rate(body, h, f * mobility(body, sub(y, vec(body.r)), u))


@kernel
def friction_compliance(clock, h, total, f):
    """Decrease of the slip in half a step per unit of friction [s/kg].

    All friction there decreases it; this one has the share of its normal force f.
    """
    if f <= 0.0:
        return 0.0
    return 0.5 * max(h, clock.next_step) * total / f


@kernel
def add_friction_to_probe(probe, t, u, d, k, c, nodes, scene):
    """Apply friction t, along u, at d from a probe. Writes: nodes, scene.points, stiffened."""
    if probe.point >= 0:
        b = scene.points[probe.point]
        add_to(b.force, t)
        add_to(b.torque, cross(d, t))
        add_mobility_stiffness(probe.point, tangential_mobility(b, d), k, c, scene)
        return
    body = nodes[probe.node]
    to = add(arm(body, vec(probe.at)), d)
    apply_force(body, t, to)
    add_stiffness_bound(body, mobility(body, to, u), k, c)


@kernel
def add_friction_to_face(p, hit, t, d, k, c, scene):
    """Apply minus the friction t at d from a face. Writes: scene.points, stiffened."""
    at = corner_points(p, hit.face, scene.corners)
    for j in range(4):
        b, share = scene.points[at[j]], scale(-hit.N[j], t)
        add_to(b.force, share)
        add_to(b.torque, cross(d, share))
        add_mobility_stiffness(at[j], hit.N[j] * tangential_mobility(b, d), k, c, scene)


@kernel
def add_friction_to_body(body, y, t, u, k, c):
    """Apply minus the friction t, along u, at the position y. Writes: body."""
    d = sub(y, vec(body.r))
    apply_force(body, scale(-1.0, t), d)
    add_stiffness_bound(body, mobility(body, d, u), k, c)


@kernel
def add_friction(h, p, totals, card, t, stored, loss, new):
    """Add the friction of a touch to the sums of card and ledger. Writes: totals, card, new."""
    totals.bristle_energy += stored
    if h > 0.0:
        totals.friction_loss += loss
    new.bristle_energy = stored
    put(new.friction_force, t)
    add_to(card.force, scale(p.order, t))
    card.tangential += norm(t)


@kernel
def end_friction(h, totals, u, old, new, card):
    """End of friction: the energy of its bristle is lost, less its last work over u.

    Writes: totals, new, card.
    """
    if h > 0.0:
        totals.friction_loss += old.bristle_energy - add_friction_work(old, u, card)
    new.bristle_energy = 0.0
    put(new.friction_force, (0.0, 0.0, 0.0))
